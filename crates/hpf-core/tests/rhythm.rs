//! Rhythmic movement against the equation solved elsewhere, and a phase that loses nothing.

use hpf_core::rhythm::{PeriodicBasis, Rhythm, RhythmicMovement, Turn};
use hpf_core::{Movement, MovementState, Real};
use serde_json::Value;

const N: usize = 15;

fn reference() -> Value {
    let all: Value = serde_json::from_str(include_str!("data/pose/reference.json")).unwrap();
    all["rhythm"].clone()
}

fn rows() -> Vec<[f64; 3]> {
    let line = |line: &str| {
        let row: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        row.try_into().unwrap()
    };
    include_str!("data/pose/rhythm.csv").lines().skip(1).map(line).collect()
}

fn movement<T: Real>() -> RhythmicMovement<T, [T; N]> {
    let rhythm = reference();
    let number = |key: &str| T::of(rhythm[key].as_f64().unwrap());
    let weights: Vec<f64> = serde_json::from_value(rhythm["weights"].clone()).unwrap();
    let weights: [f64; N] = weights.try_into().unwrap();
    let goal = number("goal");
    RhythmicMovement::new(
        Rhythm::new(number("period")).unwrap(),
        PeriodicBasis::new(number("overlap"), [T::ZERO; N], [T::ZERO; N]).unwrap(),
        Movement::new(goal, goal, number("alpha"), number("forcing_scale"), weights.map(T::of)).unwrap(),
    )
    .unwrap()
}

/// The largest errors of position and velocity over a period in `substeps` steps per 5 ms, from its limit cycle on.
fn errors<T: Real>(substeps: u32) -> [f64; 2] {
    let movement = movement::<T>();
    let (mut turn, mut state) = (Turn::START, movement.limit_cycle(250 * substeps));
    let mut worst = [0.0_f64; 2];
    for [_, position, velocity] in rows() {
        worst[0] = worst[0].max((state.position.to_f64() - position).abs());
        worst[1] = worst[1].max((movement.velocity(&state, T::ONE).to_f64() - velocity).abs());
        for _ in 0..substeps {
            movement.step(&mut turn, &mut state, T::ONE, T::of(0.005 / f64::from(substeps)));
        }
    }
    worst
}

#[test]
fn a_period_is_second_order_from_its_limit_cycle_on() {
    let found = [1, 2, 4].map(errors::<f64>);
    println!("{found:?}");
    for pair in found.windows(2) {
        for (coarse, fine) in pair[0].iter().zip(pair[1]) {
            assert!((coarse / fine / 4.0 - 1.0).abs() < 0.05, "{found:?}");
        }
    }
    assert!(found[2][0] < 2e-6, "{found:?}"); // of 0.05 m, at 1.25 ms
    let single = errors::<f32>(4);
    assert!(single[0] < found[2][0] + 1e-6 && single[1] < found[2][1] + 2e-5, "{single:?}");
}

#[test]
fn the_limit_cycle_comes_back_and_draws_every_start_to_it() {
    let movement = movement::<f64>();
    let start = movement.limit_cycle(250);
    let around = |mut state: MovementState<f64>, periods: u32| {
        let mut turn = Turn::START;
        for _ in 0..250 * periods {
            movement.step(&mut turn, &mut state, 1.0, 0.005);
        }
        state
    };
    let back = around(start, 1);
    assert!(
        (back.position - start.position).abs() < 1e-14 && (back.scaled_velocity - start.scaled_velocity).abs() < 1e-14
    );
    let drawn = around(MovementState { position: 5.0, scaled_velocity: -3.0 }, 2);
    assert!((drawn.position - start.position).abs() < 1e-13, "{drawn:?} {start:?}");
    let expected = reference()["state_at_0"][0].as_f64().unwrap();
    assert!((movement.limit_cycle(100_000).position - expected).abs() < 1e-10);
}

#[test]
fn a_weak_spring_has_a_limit_cycle_too() {
    // alpha = 0.2: what is left of a start after a period is exp(-0.63), so that M counts.
    let basis = PeriodicBasis::new(0.6, [0.0; 5], [0.0; 5]).unwrap();
    let weights = [1.0, -2.0, 0.5, 3.0, -1.0];
    let movement = Movement::new(0.0, 1.0, 0.2, 1.0, weights).unwrap();
    let movement = RhythmicMovement::new(Rhythm::new(2.0).unwrap(), basis, movement).unwrap();
    let start = movement.limit_cycle(400);
    let (mut turn, mut state) = (Turn::START, start);
    for _ in 0..400 {
        movement.step(&mut turn, &mut state, 1.0, 0.005);
    }
    let size = start.position.abs().max(start.scaled_velocity.abs());
    assert!((state.position - start.position).abs() < 1e-12 * size, "{state:?} {start:?}");
    assert!((state.scaled_velocity - start.scaled_velocity).abs() < 1e-12 * size);
}

/// The part of a period after `steps` steps, and what it should be: steps times the change, computed exactly.
fn count<T: Real>(steps: u64, change: f64) -> [f64; 2] {
    let rhythm = Rhythm::new(T::ONE).unwrap();
    let change = T::of(change);
    let mut turn = Turn::START;
    for _ in 0..steps {
        rhythm.step(&mut turn, T::ONE, change);
    }
    // In units of 2^-80 the change of either precision is a whole number, and wraps modulo a period exactly.
    let unit = (change.to_f64() * 2.0_f64.powi(80)) as u128;
    let exact = (u128::from(steps) * unit) % (1_u128 << 80);
    [turn.part().to_f64(), exact as f64 / 2.0_f64.powi(80)]
}

#[test]
fn the_phase_wraps_without_loss() {
    // A thousand million in `.ci/long campaign`.
    let steps = std::env::var("HPF_RHYTHM_STEPS").map_or(2_000_000, |text| text.parse().unwrap());
    for change in [7.3e-4, 0.37] {
        let [found, exact] = count::<f64>(steps, change);
        assert!((found - exact).abs() < 1e-15, "{steps} of {change}: {found} {exact}");
        let [found, exact] = count::<f32>(steps, change);
        assert!((found - exact).abs() < 1e-7, "{steps} of {change}: {found} {exact}");
    }
}

#[test]
fn pausing_and_slowing_leave_the_path() {
    let movement = movement::<f64>();
    let start = movement.limit_cycle(250);
    let (mut turn, mut state) = (Turn::START, start);
    let (mut slow_turn, mut slow) = (Turn::START, start);
    for i in 0..500 {
        movement.step(&mut turn, &mut state, 1.0, 0.005);
        movement.step(&mut slow_turn, &mut slow, 0.5, 0.01);
        movement.step(&mut slow_turn, &mut slow, 0.0, 1.0);
        assert!((slow.position - state.position).abs() < 1e-13, "{i}");
    }
    // A period of another length, in flight: the same path at another speed.
    let longer = movement.with_rhythm(Rhythm::new(2.5).unwrap());
    let (mut long_turn, mut long) = (turn, state);
    for _ in 0..100 {
        movement.step(&mut turn, &mut state, 1.0, 0.005);
        longer.step(&mut long_turn, &mut long, 1.0, 0.01);
    }
    assert!((long.position - state.position).abs() < 1e-13);
    assert!((longer.velocity(&long, 1.0) * 2.0 - movement.velocity(&state, 1.0)).abs() < 1e-12);
    for dt in [f64::NAN, -1.0, f64::INFINITY] {
        let before = (long_turn, long);
        longer.step(&mut long_turn, &mut long, 1.0, dt);
        assert_eq!((long_turn, long), before);
    }
}

#[test]
fn functions_are_those_of_their_formula_and_sum_to_one() {
    for (n, overlap) in [(3, 0.6_f64), (15, 0.6), (40, 0.3)] {
        let basis = PeriodicBasis::new(overlap, vec![0.0; n], vec![0.0; n]).unwrap();
        let h = -overlap.ln() / (1.0 - (core::f64::consts::TAU / n as f64).cos());
        assert!((basis.sharpness() / h - 1.0).abs() < 1e-12);
        for i in 0..300 {
            let u = f64::from(i) / 300.0;
            let psi: Vec<f64> = (0..n)
                .map(|i| (h * ((core::f64::consts::TAU * (u - i as f64 / n as f64)).cos() - 1.0)).exp())
                .collect();
            let sum: f64 = psi.iter().sum();
            let mut features = vec![0.0; n];
            basis.features_into(u, &mut features);
            for (found, psi) in features.iter().zip(&psi) {
                assert!((found - psi / sum).abs() < 1e-13);
            }
            let weights: Vec<f64> = (0..n).map(|i| 30.0 + 370.0 * ((i * i) % 7) as f64 / 6.0).collect();
            let [mixed] = basis.mix(u, [&weights[..]]);
            assert!((30.0..=400.0).contains(&mixed));
            let expected: f64 = features.iter().zip(&weights).map(|(f, w)| f * w).sum();
            assert!((mixed - expected).abs() < 1e-11);
        }
    }
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    let basis = |overlap: f64, n: usize| PeriodicBasis::new(overlap, vec![0.0; n], vec![0.0; n]);
    assert_eq!(basis(0.6, 2).unwrap_err().to_string(), "functions has 2 entries, at least 3 are needed");
    assert_eq!(basis(1.0, 5).unwrap_err().to_string(), "overlap must lie in [0, 1], not 1");
    assert!(
        basis(0.6, 5000).unwrap_err().to_string().starts_with("sharpness of the functions must lie in [0, 100000]")
    );
    assert_eq!(Rhythm::new(-1.0).unwrap_err().to_string(), "period must be positive, not -1");
    let movement = Movement::new(0.0, 0.0, 25.0, 1.0, vec![1.0; 4]).unwrap();
    let refused = RhythmicMovement::new(Rhythm::new(1.0).unwrap(), basis(0.6, 5).unwrap(), movement).unwrap_err();
    assert_eq!(refused.to_string(), "movement.weights has 4 entries, 5 are needed");
}
