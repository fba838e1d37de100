//! Policies of demonstrations: what was rolled out is found again, and every source of gains gives what it should.

use core::f64::consts::PI;

use hpf_core::{Basis, Phase};
use hpf_learn::fit::{movement_forcing, ridge};
use hpf_sim::demonstration::{
    DampingFrom, DurationFrom, Fit, Follow, Outline, RecordedAxis, ScaleBy, Smoothing, StiffnessFrom,
};
use hpf_sim::task::Unit;
use hpf_sim::{Demonstration, Imitated, Imitation, ImitationError, Simulation, Task};

fn axis(name: &str, position: Vec<f64>) -> RecordedAxis {
    RecordedAxis {
        name: name.into(),
        unit: Unit::M,
        position,
        reference: None,
        stiffness: None,
        damping: None,
        force: None,
        emg: None,
    }
}

/// `steps` equal steps over `duration` of one axis.
fn demonstration(steps: usize, duration: f64, position: impl Fn(f64) -> f64) -> Demonstration {
    let shares = || (0..=steps).map(|i| i as f64 / steps as f64);
    Demonstration {
        time: shares().map(|t| t * duration).collect(),
        axes: vec![axis("x", shares().map(position).collect())],
    }
}

fn task(outline: &Outline, demonstrations: &[Demonstration]) -> Task {
    let text = outline.write(demonstrations);
    let task = Task::parse(&text).unwrap_or_else(|found| panic!("{found:?}\n{text}"));
    // What is recorded ends at the duration.
    Task { ends_at_duration: true, ..task }
}

fn imitate(imitation: &Imitation, outline: &Outline, demonstrations: &[Demonstration]) -> (Task, Imitated) {
    let task = task(outline, demonstrations);
    let imitated = imitation.of(demonstrations, &task).unwrap();
    (task, imitated)
}

/// Root mean square of the distance of the policy's reference from the demonstrations, by axis.
fn errors(task: &Task, imitated: &Imitated) -> Vec<f64> {
    let simulation = Simulation::new(task, &imitated.policy).unwrap();
    imitated.aligned_errors(&simulation.rollout(&imitated.policy.weights()))
}

fn unsmoothed() -> Imitation {
    Imitation { smoothing: Smoothing::Off, ..Imitation::default() }
}

fn minimum_jerk(t: f64) -> f64 {
    t * t * t * (10.0 - t * (15.0 - 6.0 * t))
}

/// A path that starts and ends at rest.
fn bent(t: f64) -> f64 {
    0.3 * minimum_jerk(t) + 0.05 * (PI * t).sin().powi(3)
}

#[test]
fn a_rolled_out_policy_is_found_again() {
    let (task, first) = imitate(&unsmoothed(), &Outline::default(), &[demonstration(1000, 2.0, bent)]);
    let mut policy = first.policy;
    for i in 0..20 {
        policy.axes[0].stiffness.weights[i] = 200.0 + 150.0 * (0.5 * i as f64).cos();
        policy.axes[0].damping.weights[i] = 50.0 + 30.0 * (0.4 * i as f64).sin();
    }
    let trace = Simulation::new(&task, &policy).unwrap().rollout(&policy.weights());
    let signals = &trace.axes[0];
    let recorded = RecordedAxis {
        stiffness: Some(signals.stiffness.clone()),
        damping: Some(signals.damping.clone()),
        ..axis("x", signals.position.clone())
    };
    let again = Demonstration { time: trace.time.clone(), axes: vec![recorded] };
    let (task, imitated) = imitate(&unsmoothed(), &Outline::default(), &[again]);
    assert_eq!((task.duration, task.steps()), (2.0, 1000));
    // Differences over steps of h = 1/1000 are second order: h^2/24 of the third derivative, at most 60 travels, times
    // 4/alpha, and h^2/8 of the second, which counts once. Some 6e-7 m; measured 2.7e-7 m.
    let error = errors(&task, &imitated)[0];
    println!("round trip at 1/1000 of the duration: {error:.1e} m of 0.3 m");
    assert!(error < 6e-7, "{error:e}");
    let (found, made) = (&imitated.policy.axes[0], &policy.axes[0]);
    // Gains are mixtures exactly; the penalty moves weights by some 1e-6 of their spread over samples per function.
    for (found, made) in [(&found.stiffness, &made.stiffness), (&found.damping, &made.damping)] {
        for (found, made) in found.weights.iter().zip(&made.weights) {
            assert!((found - made).abs() < 1e-4, "{found} {made}");
        }
    }
    assert_eq!(imitated.stiffness, [StiffnessFrom::Columns]);
    assert_eq!(imitated.damping, [DampingFrom::Columns]);
    assert!(imitated.notes.is_empty(), "{:?}", imitated.notes);
}

#[test]
fn the_path_of_an_imitation_converges_with_the_square_of_the_step() {
    // Against the imitation of the finest samples: what 20 functions cannot bend is the same in both.
    let path = |steps: usize| {
        let (task, imitated) = imitate(&unsmoothed(), &Outline::default(), &[demonstration(steps, 2.0, bent)]);
        let trace = Simulation::new(&task, &imitated.policy).unwrap().rollout(&imitated.policy.weights());
        trace.axes[0].position.iter().step_by(steps / 100).copied().collect::<Vec<_>>()
    };
    let finest = path(25_600);
    let errors = [100, 200, 400, 800]
        .map(|steps| path(steps).iter().zip(&finest).map(|(x, best)| (x - best).abs()).fold(0.0, f64::max));
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] / 4.0 - 1.0).abs() < 0.05, "{errors:?}");
    }
}

#[test]
fn the_reference_demonstration_is_met_better_than_by_the_exact_solution_of_the_stored_weights() {
    // hpf-learn/tests/data/README.md: dt = 2^-8 s. That implementation's weights, its equation solved exactly, come to
    // within 7.7e-5 (RMS); its own integrators to 7.3e-3 and 1.0e-2. Measured here: 3.4e-5.
    let text = include_str!("../../hpf-learn/tests/data/demo_2d.csv");
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|row| row.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    let column = |i: usize| rows.iter().map(|row| row[i]).collect::<Vec<_>>();
    let axes = ["y0", "y1"].into_iter().enumerate().map(|(i, name)| axis(name, column(i + 1)));
    let demonstration = Demonstration { time: column(0), axes: axes.collect() };
    let (task, imitated) = imitate(&unsmoothed(), &Outline::default(), &[demonstration]);
    let errors = errors(&task, &imitated);
    let whole = (errors.iter().map(|error| error * error).sum::<f64>() / 2.0).sqrt();
    println!("RMS distance per axis at dt = 2^-8: {whole:.2e}");
    assert!(whole < 7.7e-5, "{errors:?}");
}

#[test]
fn uneven_samples_that_start_anywhere_give_the_same_path() {
    let even = demonstration(200, 2.0, |t| 0.3 * minimum_jerk(t));
    let jitter = |i: usize| if i == 0 || i == 200 { 0.0 } else { 0.003 * (1.7 * i as f64).sin() };
    let time: Vec<f64> = (0..=200).map(|i| 71.5 + 0.01 * i as f64 + jitter(i) - 71.5).collect();
    let positions = time.iter().map(|t| 0.3 * minimum_jerk(t / 2.0)).collect();
    let uneven = Demonstration { time, axes: vec![axis("x", positions)] };
    let (even_task, even) = imitate(&Imitation::default(), &Outline::default(), &[even]);
    let (task, uneven) = imitate(&Imitation::default(), &Outline::default(), &[uneven]);
    assert_eq!((task.duration, task.rate), (even_task.duration, even_task.rate));
    let rollout = |imitated: &Imitated| {
        Simulation::new(&task, &imitated.policy).unwrap().rollout(&imitated.policy.weights()).axes[0].position.clone()
    };
    for (a, b) in rollout(&even).iter().zip(rollout(&uneven)) {
        // Cubics between samples 10 ms apart: x''''h^4/384, and what differences make of it.
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
}

#[test]
fn smoothing_keeps_noise_out_of_the_path() {
    let noise = |i: usize| 1e-3 * (12.9898 * i as f64 * i as f64).sin();
    let mut noisy = demonstration(1000, 2.0, |t| 0.3 * minimum_jerk(t));
    noisy.axes[0].position.iter_mut().enumerate().for_each(|(i, x)| *x += noise(i));
    let clean = |imitation: &Imitation| {
        let (task, imitated) = imitate(imitation, &Outline::default(), &[noisy.clone()]);
        let trace = Simulation::new(&task, &imitated.policy).unwrap().rollout(&imitated.policy.weights());
        let position = trace.axes[0].position.iter().enumerate();
        let squares = position.map(|(i, x)| (x - 0.3 * minimum_jerk(i as f64 / 1000.0)).powi(2));
        (squares.sum::<f64>() / 1001.0).sqrt()
    };
    let (smoothed, raw) = (clean(&Imitation::default()), clean(&unsmoothed()));
    assert!(smoothed < 0.5e-3 && smoothed < raw, "{smoothed:e} {raw:e}");
}

#[test]
fn several_demonstrations_are_one_regression_over_all_their_samples() {
    let shapes = [(1.8, 0.0, 0.3, 0.05), (2.0, 0.02, 0.35, 0.0), (2.6, -0.01, 0.25, -0.03)];
    let demonstrations = shapes.map(|(duration, start, goal, bend)| {
        demonstration(200, duration, move |t| start + (goal - start) * minimum_jerk(t) + bend * (PI * t).sin().powi(3))
    });
    let (task, imitated) = imitate(&unsmoothed(), &Outline::default(), &demonstrations);
    // Stacked by hand: features s A phi of each demonstration, its own forcing.
    let basis = Basis::equally_spaced(task.phase.decay, 0.6, vec![0.0; 20], vec![0.0; 20]).unwrap();
    let phase = Phase::new(1.0, task.phase.decay).unwrap();
    let (mut features, mut values, mut squares) = (Vec::new(), Vec::new(), 0.0);
    for ((_, start, goal, _), one) in shapes.iter().zip(&demonstrations) {
        squares += (goal - start) * (goal - start);
        values.extend(movement_forcing(&one.axes[0].position, *goal, 25.0, 1.0 / 200.0));
        // While the forcing term fades, over a tenth of the duration, it is to be zero.
        values.extend([0.0; 20]);
        for i in 0..220 {
            let s = phase.at((f64::from(i) + 0.5) / 200.0).s;
            let mut row = vec![0.0; 20];
            basis.features_into(s, &mut row);
            features.extend(row.iter().map(|phi| phase.gate(s) * (goal - start) * phi));
        }
    }
    let stacked = ridge(&features, 20, &values, 1e-9 * squares).unwrap();
    for (found, stacked) in imitated.policy.axes[0].movement.weights.iter().zip(&stacked) {
        // Weights to 1e3, equations of condition 1e6 or so.
        assert!((found - stacked).abs() < 1e-6, "{found} {stacked}");
    }
    assert!((task.duration - (1.8 + 2.0 + 2.6) / 3.0).abs() < 1e-9, "the mean duration");
    assert!((task.axis[0].goal - 0.3).abs() < 1e-12, "the mean goal");
}

#[test]
fn a_demonstration_is_carried_to_another_goal_as_its_policy_is() {
    let shape = |t: f64| 0.3 * minimum_jerk(t) + 0.05 * (PI * t).sin().powi(3);
    let demonstrations = [demonstration(1000, 2.0, shape)];
    let text = Outline::default().write(&demonstrations);
    let text = text.replace("goal = 0.3\n", "goal = -0.6\n").replace("start = 0.0\n", "start = 0.2\n");
    let task = Task::parse(&text).unwrap();
    assert_eq!((task.axis[0].start, task.axis[0].goal), (0.2, -0.6));
    let imitated = unsmoothed().of(&demonstrations, &task).unwrap();
    let carried = &imitated.aligned[0][0];
    assert!((imitated.demonstrations[0][0][1000] - 0.3).abs() < 1e-12, "as it was recorded");
    for (i, carried) in carried.iter().enumerate() {
        // Under goal scaling everything is proportional to the way to the goal.
        let expected = 0.2 - 0.8 * shape(i as f64 / 1000.0) / 0.3;
        assert!((carried - expected).abs() < 1e-12, "{carried} {expected}");
    }
    assert!(errors(&task, &imitated)[0] < 1e-4, "{:?}", errors(&task, &imitated));
}

#[test]
fn locally_weighted_regression_bends_the_pull_towards_the_demonstration() {
    let demonstrations = [demonstration(200, 2.0, |t| 0.3 * minimum_jerk(t))];
    let lwr = Imitation { fit: Fit::LocallyWeighted, ..Imitation::default() };
    let (task, imitated) = imitate(&lwr, &Outline::default(), &demonstrations);
    let simulation = Simulation::new(&task, &imitated.policy).unwrap();
    let distance = |weights: &[f64]| imitated.errors(&simulation.rollout(weights))[0];
    let (fitted, pull) = (errors(&task, &imitated)[0], distance(&[[0.0; 20], [100.0; 20], [50.0; 20]].concat()));
    // Measured 5.9 mm of 300 mm, the bare pull 86 mm: each function is fitted as if it were alone.
    assert!(fitted < 0.1 * pull, "{fitted:e} {pull:e}");
}

#[test]
fn stiffness_from_spread_is_the_mapping_of_the_spread() {
    let share = |t: f64| 0.04 * (PI * t).sin().powi(2);
    let demonstrations =
        [1.0, -1.0].map(|side| demonstration(200, 2.0, move |t| 0.3 * minimum_jerk(t) + side * share(t)));
    let (_, imitated) = imitate(&unsmoothed(), &Outline::default(), &demonstrations);
    assert_eq!(imitated.stiffness, [StiffnessFrom::Spread]);
    let task = task(&Outline::default(), &demonstrations);
    let trace = Simulation::new(&task, &imitated.policy).unwrap().rollout(&imitated.policy.weights());
    for (i, stiffness) in trace.axes[0].stiffness.iter().enumerate() {
        let expected = 400.0 - 370.0 * (PI * i as f64 / 200.0).sin().powi(2);
        // What 20 functions cannot bend; measured 4.1 N/m.
        assert!((stiffness - expected).abs() < 5.0, "{stiffness} {expected} at {i}");
    }
}

#[test]
fn stiffness_from_muscle_activity_rises_with_its_envelope() {
    // A carrier at the Nyquist frequency: rectified, it is the activity itself.
    let activity = |t: f64| 0.2 + 0.8 * minimum_jerk(t);
    let mut one = demonstration(1000, 2.0, |t| 0.3 * minimum_jerk(t));
    let sign = |i: i32| if i % 2 == 0 { 1.0 } else { -1.0 };
    one.axes[0].emg = Some((0..=1000).map(|i| 5.0 * sign(i) * activity(f64::from(i) / 1000.0)).collect());
    let ratio = Imitation { damping: Some(DampingFrom::Ratio), mass: 4.0, damping_ratio: 0.7, ..unsmoothed() };
    let (task, imitated) = imitate(&ratio, &Outline::default(), &[one]);
    assert_eq!((imitated.stiffness[0], imitated.damping[0]), (StiffnessFrom::Emg, DampingFrom::Ratio));
    let trace = Simulation::new(&task, &imitated.policy).unwrap().rollout(&imitated.policy.weights());
    for (i, (k, d)) in trace.axes[0].stiffness.iter().zip(&trace.axes[0].damping).enumerate() {
        let expected = 30.0 + 370.0 * activity(i as f64 / 1000.0);
        // The 3 Hz filter on a rise of 2 s, and 20 functions; measured 0.6 N/m.
        assert!((k - expected).abs() < 2.0, "{k} {expected} at {i}");
        let critical = 2.0 * 0.7 * (4.0 * k).sqrt();
        assert!((d - critical).abs() < 0.1, "{d} {critical} at {i}");
    }
}

/// Positions under `f = k e + d e'` with known e, so that f is exact, and noise on the force.
fn pushed(stiffness: f64, damping: f64, noise: f64, sides: &[f64], reference: bool) -> Vec<Demonstration> {
    let mut state = 0.5_f64;
    let mut even = || {
        state = (state * 9301.0 + 0.211_327).fract();
        2.0 * state - 1.0
    };
    let offset = |t: f64, side: f64| side * 0.03 * (6.0 * PI * t + side).sin();
    let rate = |t: f64, side: f64| side * 0.03 * 6.0 * PI * (6.0 * PI * t + side).cos() / 2.0;
    let one = |side: &f64| {
        let path = |t: f64| 0.3 * minimum_jerk(t);
        let mut one = demonstration(1000, 2.0, |t| path(t) + offset(t, *side));
        let shares = (0..=1000).map(|i| f64::from(i) / 1000.0);
        one.axes[0].reference = reference.then(|| shares.clone().map(path).collect());
        let force = shares.map(|t| stiffness * offset(t, *side) + damping * rate(t, *side) + noise * even());
        one.axes[0].force = Some(force.collect());
        one
    };
    sides.iter().map(one).collect()
}

#[test]
fn stiffness_and_damping_are_found_from_a_noisy_force() {
    let force = Imitation { stiffness: Some(StiffnessFrom::Force), ..Imitation::default() };
    for (demonstrations, what) in [
        (pushed(150.0, 25.0, 0.3, &[1.0], true), "one with a reference"),
        (pushed(150.0, 25.0, 0.3, &[1.0, -0.7, 0.4], false), "three without"),
    ] {
        let force = Imitation { window: Some(2.0 / 3.0), ..force.clone() };
        let (_, imitated) = imitate(&force, &Outline::default(), &demonstrations);
        assert_eq!((imitated.stiffness[0], imitated.damping[0]), (StiffnessFrom::Force, DampingFrom::Force));
        // Noise of 0.17 N over windows of one whole wave, 333 samples, in which e of 0.02 m and e' of 0.2 m/s RMS are
        // orthogonal: standard deviations of 0.17/(0.02 sqrt(333)) = 0.46 N/m and 0.046 N s/m, at the ends, where half the
        // window is left, 0.65 N/m and 0.065 N s/m. Five of them.
        let axis = &imitated.policy.axes[0];
        for weight in &axis.stiffness.weights {
            assert!((weight - 150.0).abs() < 3.3, "{what}: {:?}", axis.stiffness.weights);
        }
        for weight in &axis.damping.weights {
            assert!((weight - 25.0).abs() < 0.33, "{what}: {:?}", axis.damping.weights);
        }
    }
}

#[test]
fn gains_from_force_stay_within_their_bounds() {
    let force = Imitation { stiffness: Some(StiffnessFrom::Force), ..Imitation::default() };
    let (_, imitated) = imitate(&force, &Outline::default(), &pushed(900.0, 2.0, 0.0, &[1.0], true));
    let axis = &imitated.policy.axes[0];
    assert!(axis.stiffness.weights.iter().all(|k| (k - 400.0).abs() < 1e-6), "{:?}", axis.stiffness.weights);
    assert!(axis.damping.weights.iter().all(|d| (10.0..=100.0).contains(d)), "{:?}", axis.damping.weights);
}

#[test]
fn the_reference_can_be_followed_instead_of_the_tool() {
    let demonstrations = pushed(150.0, 25.0, 0.0, &[1.0], true);
    let reference = Imitation { follow: Follow::Reference, ..unsmoothed() };
    let outline = Outline { follow: Follow::Reference, ..Outline::default() };
    let (task, imitated) = imitate(&reference, &outline, &demonstrations);
    assert_eq!((task.axis[0].start, task.axis[0].goal), (0.0, 0.3));
    let reference = demonstrations[0].axes[0].reference.as_ref().unwrap();
    assert!(imitated.demonstrations[0][0].iter().zip(reference).all(|(a, b)| (a - b).abs() < 1e-12));
    assert!(errors(&task, &imitated)[0] < 1e-4);
}

#[test]
fn what_is_missing_is_named() {
    let one = demonstration(100, 2.0, |t| 0.3 * minimum_jerk(t));
    let refused = |imitation: Imitation, demonstrations: &[Demonstration]| {
        imitation.of(demonstrations, &task(&Outline::default(), &demonstrations[..1])).unwrap_err().to_string()
    };
    let stiffness = |source| Imitation { stiffness: Some(source), ..Imitation::default() };
    let cases = [
        (StiffnessFrom::Columns, "axis `x` has no column x_stiffness_n_m, which stiffness from columns needs"),
        (StiffnessFrom::Emg, "axis `x` has no column x_emg, which stiffness from emg needs"),
        (StiffnessFrom::Force, "axis `x` has no column x_force_n, which gains from force needs"),
        (StiffnessFrom::Spread, "stiffness from spread needs at least two demonstrations, there is one"),
    ];
    for (source, message) in cases {
        assert_eq!(refused(stiffness(source), core::slice::from_ref(&one)), message);
    }
    let twice = refused(stiffness(StiffnessFrom::Spread), &[one.clone(), one.clone()]);
    assert!(twice.contains("spread alike everywhere"), "{twice}");
    let mut still = one.clone();
    still.axes[0].force = Some(vec![1.0; 101]);
    still.axes[0].reference = Some(still.axes[0].position.clone());
    assert!(refused(stiffness(StiffnessFrom::Force), &[still.clone()]).contains("determines no stiffness"));
    still.axes[0].reference = None;
    assert!(refused(stiffness(StiffnessFrom::Force), &[still]).contains("x_reference_m"));
    let reference =
        refused(Imitation { follow: Follow::Reference, ..Imitation::default() }, core::slice::from_ref(&one));
    assert!(reference.contains("x_reference_m"), "{reference}");
    let few = demonstration(10, 2.0, |t| 0.3 * minimum_jerk(t));
    assert_eq!(
        refused(Imitation::default(), &[few]),
        "10 steps cannot determine 20 basis functions; take fewer, or a higher rate"
    );
    let mut other = one.clone();
    other.axes[0].name = "y".into();
    let error = Imitation::default().of(&[one.clone(), other], &task(&Outline::default(), &[one])).unwrap_err();
    assert_eq!(error.demonstration(), Some(1));
    assert_eq!(error.to_string(), "it moves the axes y [m], x [m] are wanted");
    let there_and_back = demonstration(100, 2.0, |t| 0.1 * (PI * t).sin().powi(2));
    let goal = Outline { scaling: Some(ScaleBy::Goal), ..Outline::default() };
    let text = goal.write(core::slice::from_ref(&there_and_back));
    assert!(Task::parse(&text).unwrap_err()[0].message.contains("goal scaling"));
    let forth = task(&Outline::default(), &[demonstration(100, 2.0, minimum_jerk)]);
    let error = Imitation::default().of(&[there_and_back], &forth).unwrap_err();
    assert!(matches!(error, ImitationError::NoTravel { demonstration: 0, .. }), "{error}");
}

#[test]
fn notes_tell_what_a_policy_cannot_keep() {
    let mut one = demonstration(200, 2.0, |t| 0.3 * t);
    one.axes[0].stiffness = Some(vec![500.0; 201]);
    let (_, imitated) = imitate(&Imitation::default(), &Outline::default(), &[one]);
    let notes = imitated.notes.join("\n");
    assert!(notes.contains("stiffness from 500.0000 to 500.0000 is held within its bounds, 30 to 400"), "{notes}");
    assert!(notes.contains("demonstration 1 begins at 0.150 m/s on axis `x`"), "{notes}");
    assert!(imitated.policy.axes[0].stiffness.weights.iter().all(|k| *k == 400.0));
}

#[test]
fn an_axis_that_ends_at_its_start_is_scaled_by_its_range() {
    let one = demonstration(200, 2.0, |t| 0.1 * (PI * t).sin().powi(2));
    let (task, imitated) = imitate(&unsmoothed(), &Outline::default(), &[one]);
    assert!((imitated.policy.axes[0].movement.forcing_scale - 0.1).abs() < 1e-12);
    assert!(errors(&task, &imitated)[0] < 1e-4);
    let still = demonstration(200, 2.0, |_| 0.25);
    let (task, imitated) = imitate(&Imitation::default(), &Outline::default(), &[still]);
    assert!(errors(&task, &imitated)[0] < 1e-12, "an axis that never moves");
}

#[test]
fn durations_and_rates_are_those_asked_for() {
    let demonstrations = [(1.9, 95), (2.1, 105)].map(|(duration, steps)| demonstration(steps, duration, minimum_jerk));
    let found = |duration, rate| {
        let task = task(&Outline { duration, rate, ..Outline::default() }, &demonstrations);
        (task.duration, task.steps())
    };
    assert_eq!(found(DurationFrom::Mean, None), (2.0, 100));
    assert_eq!(found(DurationFrom::First, None), (1.9, 100));
    assert_eq!(found(DurationFrom::Given(4.0), Some(250.0)), (4.0, 1000));
    // A rate that is asked for is exact: the duration is the nearest that it cuts into whole steps.
    assert_eq!(found(DurationFrom::Given(0.999), Some(100.0)), (1.0, 100));
    assert_eq!(found(DurationFrom::First, Some(1000.0 / 3.0)), (633.0 / (1000.0 / 3.0), 633));
}
