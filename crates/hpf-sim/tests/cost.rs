//! Every term of the cost, alone, against the same sum written out here from the trace.

use hpf_sim::cost::Term;
use hpf_sim::task::{CostWeights, PerAxis, Preset, ViaPoint};
use hpf_sim::{Policy, Simulation, Task, Trace};

const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");
const BEAM: &str = include_str!("../../../tasks/cantilever.toml");

/// The task with the weights of `cost` alone, and a motion in it that has nothing equal to zero.
fn motion(text: &str, cost: CostWeights) -> (Simulation, Trace) {
    let mut task = Task::parse(text).unwrap();
    task.cost = cost;
    moved(&task)
}

fn moved(task: &Task) -> (Simulation, Trace) {
    let policy = crate::waves::policy(task);
    let simulation = Simulation::new(task, &policy).unwrap();
    let trace = simulation.rollout(&policy.weights());
    (simulation, trace)
}

fn each(a: f64, b: f64) -> PerAxis {
    PerAxis::Each(vec![a, b])
}

/// Sums of 500 squares in another order.
#[track_caller]
fn assert_same(found: f64, expected: f64) {
    assert!(expected > 0.0 && (found / expected - 1.0).abs() < 1e-12, "{found} is not {expected}");
}

/// The cost is `term` alone, and its parts add up to `expected`.
#[track_caller]
fn assert_only(simulation: &Simulation, trace: &Trace, term: Term, expected: f64) {
    let cost = simulation.cost(trace);
    for other in Term::ALL {
        let value = cost.terms[other as usize];
        if other == term {
            assert_same(value, expected);
        } else {
            assert_eq!(value, 0.0, "{other:?}");
        }
    }
    assert_same(cost.total(), expected);
    assert_eq!(cost.running.len(), 500);
}

/// The integral of the square of a signal by the trapezoid rule, 10 ms to a step.
fn trapezoid(signal: &[f64]) -> f64 {
    let inner: f64 = signal[1..signal.len() - 1].iter().map(|x| x * x).sum();
    0.01 * (0.5 * signal[0].powi(2) + inner + 0.5 * signal[signal.len() - 1].powi(2))
}

#[test]
fn names_and_columns_are_in_one_order() {
    for (i, term) in Term::ALL.into_iter().enumerate() {
        assert_eq!(term as usize, i);
    }
    assert_eq!(Term::NAMES[Term::ContactForce as usize], "contact_force");
    let (simulation, _) = motion(VIA_POINT, CostWeights::default());
    assert_eq!(simulation.term_names(), Term::NAMES);
}

#[test]
fn without_weights_a_motion_is_free() {
    for text in [VIA_POINT, BEAM] {
        let (simulation, trace) = motion(text, CostWeights::default());
        let cost = simulation.cost(&trace);
        assert_eq!((cost.total(), cost.terminal), (0.0, 0.0));
        assert!(cost.terms.iter().chain(&cost.running).all(|value| *value == 0.0));
    }
}

#[test]
fn goal_is_half_the_weighted_square_of_the_distance_at_the_end() {
    let (simulation, trace) = motion(VIA_POINT, CostWeights { goal: each(3.0, 7.0), ..CostWeights::default() });
    let gap = |a: usize| trace.axes[a].position[500] - 1.0;
    let expected = 0.5 * (3.0 * gap(0) * gap(0) + 7.0 * gap(1) * gap(1));
    assert_only(&simulation, &trace, Term::Goal, expected);
    assert_same(simulation.cost(&trace).terminal, expected);
}

#[test]
fn end_velocity_is_that_of_the_tool() {
    let (simulation, trace) = motion(VIA_POINT, CostWeights { end_velocity: each(3.0, 7.0), ..CostWeights::default() });
    let v = |a: usize| trace.axes[a].velocity[500];
    assert!(v(0) != trace.axes[0].reference_velocity[500]);
    let expected = 0.5 * (3.0 * v(0) * v(0) + 7.0 * v(1) * v(1));
    assert_only(&simulation, &trace, Term::EndVelocity, expected);
    assert_same(simulation.cost(&trace).terminal, expected);
}

#[test]
fn rest_is_the_integral_of_distance_and_velocity_after_the_end() {
    let (simulation, trace) = motion(VIA_POINT, CostWeights { rest: each(3.0, 7.0), ..CostWeights::default() });
    // 5 s (0.1 + 13.277/25) are 3.155 s.
    assert_eq!((trace.steps(), trace.time.len()), (500, 500 + 316 + 1));
    let along = |signal: &[f64], offset: f64| trapezoid(&signal[500..].iter().map(|x| x - offset).collect::<Vec<_>>());
    let sum = |a: usize| along(&trace.axes[a].position, 1.0) + 0.25 * along(&trace.axes[a].velocity, 0.0);
    let expected = 0.5 * (3.0 * sum(0) + 7.0 * sum(1));
    assert_only(&simulation, &trace, Term::Rest, expected);
    assert_same(simulation.cost(&trace).terminal, expected);
}

#[test]
fn the_papers_preset_and_motions_of_a_process_have_no_rest() {
    let mut task = Task::parse(VIA_POINT).unwrap();
    task.cost = CostWeights { rest: each(3.0, 7.0), ..CostWeights::default() };
    task.learning.preset = Preset::Paper;
    let (simulation, trace) = moved(&task);
    assert_eq!(simulation.cost(&trace).total(), 0.0);
    task.learning.preset = Preset::Pi2;
    task.ends_at_duration = true;
    let (simulation, trace) = moved(&task);
    assert_eq!((trace.time.len(), simulation.cost(&trace).total()), (501, 0.0));
    assert!(simulation.metrics(&trace).iter().all(|metric| !metric.name.ends_with("rest_error")));
}

#[test]
fn acceleration_is_the_change_of_velocity_over_each_step() {
    let (simulation, trace) = motion(VIA_POINT, CostWeights { acceleration: each(3.0, 7.0), ..CostWeights::default() });
    let sum = |a: usize| -> f64 {
        let v = &trace.axes[a].velocity;
        (0..500).map(|i| ((v[i + 1] - v[i]) / 0.01).powi(2) * 0.01).sum()
    };
    assert_only(&simulation, &trace, Term::Acceleration, 0.5 * (3.0 * sum(0) + 7.0 * sum(1)));
}

#[test]
fn stiffness_and_damping_are_integrals_of_their_squares() {
    let weights = CostWeights { stiffness: each(3.0, 7.0), ..CostWeights::default() };
    let (simulation, trace) = motion(VIA_POINT, weights);
    let k = |a: usize| trapezoid(&trace.axes[a].stiffness[..=500]);
    assert_only(&simulation, &trace, Term::Stiffness, 0.5 * (3.0 * k(0) + 7.0 * k(1)));

    let (simulation, trace) = motion(VIA_POINT, CostWeights { damping: each(3.0, 7.0), ..CostWeights::default() });
    let d = |a: usize| trapezoid(&trace.axes[a].damping[..=500]);
    assert_only(&simulation, &trace, Term::Damping, 0.5 * (3.0 * d(0) + 7.0 * d(1)));
}

#[test]
fn tracking_is_the_deviation_from_the_curve_of_the_contact() {
    let (simulation, trace) = motion(BEAM, CostWeights { tracking: 3.0, ..CostWeights::default() });
    // Eq. 25 of the paper, x(t) of minimum jerk along 0.8 m.
    let deviation: Vec<f64> = (0..=500)
        .map(|i| {
            let u = f64::from(i) / 500.0;
            let x = 0.8 * (10.0 * u.powi(3) - 15.0 * u.powi(4) + 6.0 * u.powi(5));
            let bending = 200e9 * 0.05 * 0.004_f64.powi(3) / 12.0;
            trace.axes[0].position[i as usize] - 10.0 * x * x * (2.4 - x) / (6.0 * bending)
        })
        .collect();
    assert_only(&simulation, &trace, Term::Tracking, 0.5 * 3.0 * trapezoid(&deviation));
}

#[test]
fn contact_force_is_its_error_from_the_set_point() {
    let (simulation, trace) = motion(BEAM, CostWeights { contact_force: 3.0, ..CostWeights::default() });
    // The contact's stiffness, compliances in series, on the depth of the tool.
    let error: Vec<f64> = (0..=500)
        .map(|i| {
            let x = trace.contact.as_ref().unwrap().travel[i];
            let bending = 200e9 * 0.05 * 0.004_f64.powi(3) / 12.0;
            let compliance = x * x * (2.4 - x) / (6.0 * bending) + 1e-6;
            trace.axes[0].position[i].max(0.0) / compliance - 10.0
        })
        .collect();
    assert_only(&simulation, &trace, Term::ContactForce, 0.5 * 3.0 * trapezoid(&error));
}

fn via(time: f64, position: [f64; 2]) -> ViaPoint {
    ViaPoint { time: Some(time), position: position.to_vec(), radius: None }
}

#[test]
fn a_via_point_on_a_sample_is_charged_to_the_step_that_ends_there() {
    let (simulation, trace) = motion(VIA_POINT, CostWeights { via_point: each(3.0, 7.0), ..CostWeights::default() });
    let gap = |a: usize, at: f64| trace.axes[a].position[250] - at;
    let expected = 0.5 * (3.0 * gap(0, 0.6).powi(2) + 7.0 * gap(1, 0.8).powi(2));
    assert_only(&simulation, &trace, Term::ViaPoint, expected);
    let cost = simulation.cost(&trace);
    assert_same(cost.running[249], expected);
    assert_eq!(cost.terminal, 0.0);
}

#[test]
fn a_via_point_between_samples_is_measured_on_the_line_between_them() {
    let mut task = Task::parse(VIA_POINT).unwrap();
    task.cost = CostWeights { via_point: each(3.0, 7.0), ..CostWeights::default() };
    task.via_point = vec![via(2.504, [0.6, 0.8]), via(5.0, [0.1, 0.2]), via(0.001, [0.3, 0.4])];
    let (simulation, trace) = moved(&task);
    let at = |a: usize, before: usize, share: f64| {
        let p = &trace.axes[a].position;
        p[before] + share * (p[before + 1] - p[before])
    };
    let price = |before: usize, share: f64, [x, y]: [f64; 2]| {
        0.5 * (3.0 * (at(0, before, share) - x).powi(2) + 7.0 * (at(1, before, share) - y).powi(2))
    };
    let prices = [(250, 0.4, [0.6, 0.8]), (499, 1.0, [0.1, 0.2]), (0, 0.1, [0.3, 0.4])];
    let cost = simulation.cost(&trace);
    for (step, share, position) in prices {
        // The share of a step is a difference of times: 1e-13 of it, on a price that is flat in it.
        let expected = price(step, share, position);
        assert!((cost.running[step] / expected - 1.0).abs() < 1e-10, "step {step}");
    }
    assert_eq!(cost.running.iter().filter(|cost| **cost > 0.0).count(), 3);
}

#[test]
fn a_weight_for_all_axes_is_the_same_weight_for_each() {
    let all = |w: f64| CostWeights {
        goal: PerAxis::All(w),
        end_velocity: PerAxis::All(w),
        via_point: PerAxis::All(w),
        acceleration: PerAxis::All(w),
        stiffness: PerAxis::All(w),
        damping: PerAxis::All(w),
        ..CostWeights::default()
    };
    let same = |w: f64| CostWeights {
        goal: each(w, w),
        end_velocity: each(w, w),
        via_point: each(w, w),
        acceleration: each(w, w),
        stiffness: each(w, w),
        damping: each(w, w),
        ..CostWeights::default()
    };
    let (simulation, trace) = motion(VIA_POINT, all(2.0));
    assert_eq!(simulation.cost(&trace), motion(VIA_POINT, same(2.0)).0.cost(&trace));
}

#[test]
fn the_total_is_the_end_and_the_steps_and_also_the_sum_of_the_terms() {
    for text in [VIA_POINT, BEAM] {
        let (simulation, trace) = motion(text, Task::parse(text).unwrap().cost);
        let cost = simulation.cost(&trace);
        assert_same(cost.total(), cost.terminal + cost.running.iter().sum::<f64>());
        assert_same(cost.total(), cost.terms.iter().sum());
        assert_same(
            cost.terminal,
            [Term::Goal, Term::EndVelocity, Term::Rest].map(|t| cost.terms[t as usize]).iter().sum(),
        );
        assert!(cost.running.iter().all(|cost| *cost > 0.0));
    }
}

#[test]
fn a_weight_means_the_same_at_any_rate() {
    // What the trapezoid rule and mean accelerations leave of a step of 10 ms: the bound is twice what was measured.
    // A sum without dt would be ten times larger at ten times the rate.
    for (text, terms) in [
        // 2.4e-4, 2.8e-7, 2.1e-6
        (VIA_POINT, [(Term::Acceleration, 5e-4), (Term::Stiffness, 1e-6), (Term::Damping, 5e-6)].as_slice()),
        // 1.7e-5, 3.4e-4: the force jumps where contact is lost and made
        (BEAM, &[(Term::Tracking, 4e-5), (Term::ContactForce, 1e-3)]),
    ] {
        let terms_at = |rate: f64| {
            let mut task = Task::parse(text).unwrap();
            task.rate = rate;
            let (simulation, trace) = moved(&task);
            simulation.cost(&trace).terms
        };
        let (hundred, thousand) = (terms_at(100.0), terms_at(1000.0));
        for &(term, tolerance) in terms {
            let gap = (hundred[term as usize] / thousand[term as usize] - 1.0).abs();
            assert!(gap < tolerance, "{term:?}: {gap:e}");
        }
    }
}

#[test]
fn a_via_point_without_a_time_costs_the_distance_of_the_nearest_sample_outside_its_radius() {
    const DMPBBO: &str = include_str!("../../../tasks/dmpbbo_via_point.toml");
    for (radius, is_met) in [(0.1, false), (5.0, true)] {
        let mut task = Task::parse(DMPBBO).unwrap();
        task.cost = CostWeights { via_distance: 2.0, ..CostWeights::default() };
        task.via_point[0].radius = Some(radius);
        // The bare pull passes it by some 0.4.
        let policy = Policy::initial(&task).unwrap();
        let simulation = Simulation::new(&task, &policy).unwrap();
        let trace = simulation.rollout(&policy.weights());
        let [x, y] = [0, 1].map(|a| &trace.axes[a].position);
        let nearest = x
            .iter()
            .zip(y)
            .take(trace.steps() + 1)
            .map(|(x, y)| (x - 3.0_f64).hypot(y - 3.0))
            .fold(f64::INFINITY, f64::min);
        let outside = (nearest - radius).max(0.0);
        assert_eq!(outside == 0.0, is_met);
        let cost = simulation.cost(&trace);
        assert!((cost.total() - 2.0 * outside).abs() < 1e-12 && cost.terms[Term::ViaPoint as usize] == cost.total());
        let mut signals = Vec::new();
        simulation.signals_into(&trace, &mut signals);
        let [distance] = &hpf_learn::Problem::signals(&simulation).unwrap().distances[..] else {
            panic!("one via point")
        };
        assert!((distance.cost(&signals) - cost.total()).abs() < 1e-12, "{}", distance.cost(&signals));
        let metrics = simulation.metrics(&trace);
        let error = metrics.iter().find(|metric| metric.name == "max_via_error").unwrap().value;
        assert!((error - outside).abs() < 1e-12, "{error}");
    }
}
