//! Every kernel against the closed form of its equation.

use hpf_core::admittance::{Instant, relax, step_offset};
use hpf_core::{AxisPrimitives, Basis, Gain, HybridPrimitive, Law, Movement, MovementState, Phase, Transition};

const ALPHA: f64 = 25.0;

/// `sum_n coefficient(n) (-x)^n / n!`, to well past the last bit for |x| below 1: the terms fall from the first one on.
fn taylor(x: f64, coefficient: impl Fn(f64) -> f64) -> f64 {
    let mut factor = 1.0;
    let mut terms = [0.0; 30];
    for (n, term) in terms.iter_mut().enumerate() {
        *term = factor * coefficient(n as f64);
        factor *= -x / (n as f64 + 1.0);
    }
    terms.iter().rev().sum()
}

/// `(1 - exp(-x))/x`.
fn mean_decay(x: f64) -> f64 {
    taylor(x, |n| 1.0 / (n + 1.0))
}

/// Solution of the movement equation at normalised time `t`, forcing constant: critically damped about `goal + F/p^2`.
fn held_forcing(start: MovementState<f64>, goal: f64, forcing: f64, t: f64) -> MovementState<f64> {
    let p = ALPHA / 2.0;
    let rest = goal + forcing / (p * p);
    let y = start.position - rest;
    let slope = start.scaled_velocity + p * y;
    let decay = (-p * t).exp();
    MovementState {
        position: rest + (y + slope * t) * decay,
        scaled_velocity: (start.scaled_velocity - p * slope * t) * decay,
    }
}

fn walk(start: MovementState<f64>, goal: f64, forcing: f64, t: f64, steps: u32) -> MovementState<f64> {
    let transition = Transition::new(ALPHA, t / f64::from(steps));
    let mut state = start;
    for _ in 0..steps {
        transition.apply(&mut state, goal, forcing);
    }
    state
}

#[track_caller]
fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found:e} is not {expected:e} within {tolerance:e}");
}

#[test]
fn movement_without_forcing_is_exact_for_any_number_of_steps() {
    let start = MovementState { position: -0.3, scaled_velocity: 4.0 };
    for t in [0.1, 0.5, 1.0] {
        let exact = held_forcing(start, 0.7, 0.0, t);
        for steps in [1, 2, 7, 100, 1000] {
            let state = walk(start, 0.7, 0.0, t, steps);
            // All thousand steps share the rounding of one transition, 1e-16 each.
            assert_close(state.position, exact.position, 1e-13);
            // Velocities are up to p = 12.5 times larger.
            assert_close(state.scaled_velocity, exact.scaled_velocity, 1e-12);
        }
    }
}

#[test]
fn movement_from_rest_is_the_textbook_formula() {
    let movement = Movement::new(0.2, 1.0, ALPHA, 1.0, [0.0; 2]).unwrap();
    let p = ALPHA / 2.0;
    for steps in [1, 10, 1000] {
        let state = walk(movement.initial_state(), movement.goal(), 0.0, 0.4, steps);
        // x = g + (1 + p t) exp(-p t) (x0 - g)
        assert_close(state.position, 1.0 + (1.0 + p * 0.4) * (-p * 0.4_f64).exp() * (0.2 - 1.0), 1e-13);
    }
}

#[test]
fn movement_under_constant_forcing_is_exact_for_any_number_of_steps() {
    let start = MovementState { position: 0.1, scaled_velocity: -2.0 };
    for forcing in [-300.0, 60.0] {
        let exact = held_forcing(start, 0.7, forcing, 0.8);
        // 5 000 steps have u = 0.002, deep in the series; 1 step has u = 10.
        for steps in [1, 3, 50, 5000] {
            let state = walk(start, 0.7, forcing, 0.8, steps);
            // As above, five thousand steps about a rest position F/p^2 up to 2 away.
            assert_close(state.position, exact.position, 1e-12);
            assert_close(state.scaled_velocity, exact.scaled_velocity, 1e-11);
        }
    }
}

#[test]
fn forcing_gain_has_all_digits_on_both_sides_of_the_series_threshold() {
    // The series serves u < 0.05; alpha = 2 makes p = 1 and u = dt.
    let near = [0.04999, 0.0499999, 0.05, 0.050001, 0.0501];
    let far = [1e-9, 1e-6, 1e-3, 0.01, 0.03, 0.07, 0.1, 0.3, 0.8];
    for u in near.into_iter().chain(far) {
        let mut state = MovementState { position: 0.0, scaled_velocity: 0.0 };
        Transition::new(2.0, u).apply(&mut state, 0.0, 1.0);
        let exact = u * u * taylor(u, |n| 1.0 / (n + 2.0)); // (n+1)/(n+2)! = 1/(n! (n+2))
        // The closed form subtracts two numbers 2/u times its result: 40 roundings at the threshold.
        assert_close(state.position / exact, 1.0, 1e-14);
        assert_close(state.scaled_velocity / (u * (-u).exp()), 1.0, 1e-15);
    }
}

#[test]
fn single_precision_forcing_gain_has_all_digits_too() {
    for u in [1e-4_f32, 0.01, 0.049, 0.0499, 0.0501, 0.06, 0.3, 0.8] {
        let mut state = MovementState { position: 0.0, scaled_velocity: 0.0 };
        Transition::new(2.0_f32, u).apply(&mut state, 0.0, 1.0);
        let exact = f64::from(u) * f64::from(u) * taylor(f64::from(u), |n| 1.0 / (n + 2.0));
        // 40 roundings of 6e-8, as above.
        assert_close(f64::from(state.position) / exact, 1.0, 2.5e-6);
    }
}

#[test]
fn offset_follows_the_step_response_for_any_number_of_steps() {
    let (k, d, force, t) = (120.0_f64, 40.0, 15.0, 0.6);
    let exact = -force / k * (-k * t / d).exp_m1();
    for steps in [1, 2, 13, 1000] {
        let mut offset = 0.0;
        for _ in 0..steps {
            offset = step_offset(offset, k, d, force, t / f64::from(steps));
        }
        // A thousand roundings of 0.1 m at 1e-17 each.
        assert_close(offset, exact, 1e-14);
    }
}

#[test]
fn offset_without_a_spring_drifts_at_force_over_damping() {
    for steps in [1, 100] {
        let mut offset = 0.05;
        for _ in 0..steps {
            offset = step_offset(offset, 0.0, 50.0, 10.0, 2.0 / f64::from(steps));
        }
        assert_close(offset, 0.05 + 2.0 * 10.0 / 50.0, 1e-15);
    }
    // A spring next to nothing is next to no spring.
    assert_close(step_offset(0.0, 1e-300, 50.0, 10.0, 0.5), 0.1, 1e-16);
}

#[test]
fn offset_never_overshoots_however_long_the_step() {
    let rest = 10.0 / 400.0;
    let mut last = 0.0;
    for exponent in -9..300 {
        let offset = step_offset(0.0, 400.0, 10.0, 10.0, 10.0_f64.powi(exponent));
        // Monotone in the step's length; the last bits of f/k are the only slack.
        assert!(offset >= last * (1.0 - 1e-15), "{offset} at 1e{exponent} s");
        assert!(offset <= rest * (1.0 + 1e-15), "{offset} at 1e{exponent} s");
        last = offset;
    }
    assert_close(last, rest, 2e-17);
}

#[test]
fn offset_has_all_digits_on_both_sides_of_the_series_threshold() {
    // The series serves k dt/d < 1e-5.
    for x in [1e-12, 1e-8, 1e-6, 9.99e-6, 9.999_999e-6, 1e-5, 1.000_001e-5, 1.1e-5, 1e-4, 1e-2, 0.5] {
        // k = x, d = dt = f = 1: the offset after the step is the mean decay. A handful of roundings.
        assert_close(step_offset(0.0, x, 1.0, 1.0, 1.0) / mean_decay(x), 1.0, 1e-15);
    }
    for x in [1e-8_f32, 9e-6, 9.99e-6, 1.01e-5, 1e-4, 0.01, 0.5] {
        let found = f64::from(step_offset(0.0_f32, x, 1.0, 1.0, 1.0));
        assert_close(found / mean_decay(f64::from(x)), 1.0, 5e-7);
    }
}

/// Solution of `y' = -lambda (y - q0 - (q1 - q0) t/h)` at h, with x = lambda h.
fn relaxed(y: f64, q0: f64, q1: f64, x: f64) -> f64 {
    let lag = (q1 - q0) / x;
    q1 - lag + (y - q0 + lag) * (-x).exp()
}

#[test]
fn relaxing_to_a_linear_target_is_exact_for_any_number_of_steps() {
    for x in [0.3, 2.0, 30.0] {
        let (y0, q0, q1) = (0.3, 1.0, 1.5);
        let exact = relaxed(y0, q0, q1, x);
        for steps in [1_u32, 4, 100] {
            let share = |i: u32| f64::from(i) / f64::from(steps);
            let target = |i: u32| q0 + (q1 - q0) * share(i);
            let y = (0..steps).fold(y0, |y, i| relax(y, target(i), target(i + 1), x * share(1)));
            assert_close(y, exact, 1e-14);
        }
    }
}

#[test]
fn a_stiff_tool_ends_each_step_on_its_target() {
    for x in [1e3, 1e6, 1e12, 1e300, f64::MAX] {
        // It lags by (q1 - q0)/x and forgets where it was.
        assert_close(relax(-7.0, 1.0, 1.5, x), 1.5 - 0.5 / x, 2e-16);
    }
}

#[test]
fn relaxing_is_continuous_across_the_series_threshold() {
    for x in [1e-12, 1e-7, 9.9e-6, 9.999e-6, 1.0001e-5, 1.1e-5, 1e-3, 0.3] {
        let settled = x * mean_decay(x);
        let exact = 0.3 + settled * (1.0 - 0.3) + 0.5 * taylor(x, |n| if n == 0.0 { 0.0 } else { -1.0 / (n + 1.0) });
        // 1 - mean decay is small there; its absolute error is one rounding of 1, times the drift.
        assert_close(relax(0.3, 1.0, 1.5, x), exact, 3e-16);
    }
}

#[test]
fn a_held_load_and_a_held_target_are_the_same_law() {
    // y = e, x_r = 0, K_e = 0, q = f/k: relax must repeat step_offset.
    let law = Instant {
        stiffness: 80.0,
        damping: 20.0,
        reference_position: 0.0,
        reference_velocity: 0.0,
        load_force: 12.0,
        load_stiffness: 0.0,
    };
    for dt in [1e-7, 1e-3, 0.1, 10.0] {
        let by_force = step_offset(0.02, law.stiffness, law.damping, law.load_force, dt);
        assert_close(relax(0.02, law.target(), law.target(), law.lambda() * dt), by_force, 1e-16);
    }
    // d y' = f - k y, and at the target it rests.
    assert_close(law.velocity(0.02), (12.0 - 80.0 * 0.02) / 20.0, 1e-16);
    assert_close(law.velocity(law.target()), 0.0, 1e-16);
}

#[test]
fn phase_is_its_exponential_for_any_number_of_steps() {
    let phase = Phase::new(2.5, 100.0_f64.ln()).unwrap();
    for steps in [1_u32, 10, 1000] {
        let s = (0..steps).fold(1.0, |s, _| phase.step(s, 1.0, 2.5 / f64::from(steps)));
        // A thousand relative roundings of 1e-16.
        assert_close(s / 0.01, 1.0, 2e-13);
    }
    assert_close(phase.at(1.25).s, 0.1, 1e-16);
    assert_eq!(phase.step(0.37, 0.0, 5.0), 0.37); // rate 0: time stands still
    assert!(phase.at(50.0).s > 0.0 && phase.at(50.0).s < 1e-39); // past the end it goes on decaying
}

/// Position and phase at the end of a movement whose forcing is `60 s`, each step with its own rate and length.
fn travel(steps: impl IntoIterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let phase = Phase::new(2.0, 100.0_f64.ln()).unwrap();
    let mut s = 1.0;
    let mut state = MovementState { position: 0.0, scaled_velocity: 0.0 };
    steps
        .into_iter()
        .map(|(rate, dt)| {
            let middle = phase.step(s, rate, dt / 2.0);
            Transition::new(ALPHA, rate * dt / phase.duration()).apply(&mut state, 1.0, 60.0 * middle);
            s = phase.step(s, rate, dt);
            (s, state.position)
        })
        .collect()
}

#[test]
fn slowing_the_rate_leaves_the_path_unchanged() {
    // Half the rate for twice the time is the same product, exactly.
    assert_eq!(travel([(1.0, 0.01); 200]), travel([(0.5, 0.02); 200]));
    // The same rate written otherwise: a tenth of the rate, ten steps. Only the discretisation of F differs.
    let nominal = travel([(1.0, 0.01); 200]);
    let slow = travel([(0.1, 0.01); 2000]);
    for ((s, x), (slow_s, slow_x)) in nominal.into_iter().zip(slow.into_iter().skip(9).step_by(10)) {
        assert_close(slow_s, s, 1e-13);
        assert_close(slow_x, x, 2e-5); // what 200 steps owe to 2 000: second order, measured 1.5e-5
    }
}

#[test]
fn without_forcing_any_history_of_rates_gives_the_same_path() {
    let phase = Phase::new(2.0, 100.0_f64.ln()).unwrap();
    let start = MovementState { position: 0.0, scaled_velocity: 0.0 };
    let (mut s, mut state) = (1.0, start);
    for i in 0..500 {
        let rate = 0.5 + 0.5 * f64::from(i % 17).sin();
        let dt = 0.001 * f64::from(1 + i % 5);
        Transition::new(ALPHA, rate * dt / phase.duration()).apply(&mut state, 1.0, 0.0);
        s = phase.step(s, rate, dt);
        let normalised_time = -s.ln() / phase.decay();
        let exact = held_forcing(start, 1.0, 0.0, normalised_time);
        assert_close(state.position, exact.position, 1e-13);
    }
}

#[test]
fn pausing_changes_nothing_but_the_clock() {
    let nominal = travel([(1.0, 0.01); 200]);
    // Three pauses of a second in the middle of the movement.
    let pauses = [(1.0, 0.01); 80].into_iter().chain([(0.0, 1.0); 3]).chain([(1.0, 0.01); 120]);
    let paused = travel(pauses);
    assert_eq!(paused[79].0, paused[82].0);
    assert_close(paused[82].1, paused[79].1, 1e-16); // g + (x - g) may round once
    assert_eq!(paused[202].0, nominal[199].0);
    assert_close(paused[202].1, nominal[199].1, 1e-16);
}

/// Up to the duration the forcing is the paper's; from 1.1 durations on the reference is the bare spring, whose closed
/// form from the state there is written out here.
#[test]
fn after_its_duration_the_forcing_fades_to_exactly_zero() {
    let decay = 100.0_f64.ln();
    let phase = Phase::new(2.0, decay).unwrap();
    let basis = Basis::equally_spaced(decay, 0.6, [0.0; 9], [0.0; 9]).unwrap();
    let weights = [900.0, -700.0, 400.0, 0.0, -2500.0, 3000.0, -1000.0, 5000.0, 8000.0];
    let axis = AxisPrimitives {
        movement: Movement::new(0.1, 0.4, 25.0, 0.3, weights).unwrap(),
        stiffness: Gain::new(30.0, 400.0, [100.0; 9]).unwrap(),
        damping: Gain::new(10.0, 100.0, [50.0; 9]).unwrap(),
        law: Law::FirstOrder,
    };
    let skill = HybridPrimitive::new(phase, [basis; 3], [axis]).unwrap();
    for i in 0..=100 {
        let s = (-decay * f64::from(i) / 100.0).exp();
        let [profile] = skill.at(s);
        let [mixed] = basis.mix(s, [weights.as_slice()]);
        assert!((profile.forcing - s * 0.3 * mixed).abs() <= 1e-12 * profile.forcing.abs(), "at {i} % of the duration");
    }
    // Between, |F| falls from its value at T, whatever the mixture does, without a jump or a kink at either end.
    let fade = |t: f64| phase.at(2.0 * t).gate / phase.at(2.0 * t).s;
    let fades: Vec<f64> = (0..=1000).map(|i| fade(1.0 + 1e-4 * f64::from(i))).collect();
    assert!(fades.windows(2).all(|pair| pair[1] <= pair[0]) && fades[0] == 1.0 && fades[1000] == 0.0);
    assert!(1.0 - fades[1] < 1e-5 && fades[999] < 1e-5, "{} {}", fades[1], fades[999]);

    let dt = 1e-3;
    let mut state = skill.initial_state();
    for _ in 0..2200 {
        skill.step(&mut state, [0.0], 1.0, dt);
    }
    let [at] = state.axes;
    let (y, z, p) = (at.reference.position - 0.4, at.reference.scaled_velocity, 12.5);
    assert!(y.abs() > 1e-3, "it is not at rest there by chance: {y}");
    for step in 1..=1000 {
        skill.step(&mut state, [0.0], 1.0, dt);
        let u = f64::from(step) * dt / 2.0;
        let exact = 0.4 + (y + (z + p * y) * u) * (-p * u).exp();
        let found = state.axes[0].reference.position;
        assert!((found - exact).abs() < 1e-12, "{found} {exact} {u} after the fade");
    }
}
