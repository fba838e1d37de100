//! The first-order admittance against 40-digit closed forms.

use hpf_core::Real;
use hpf_core::admittance::step_offset;

const FORCE: f64 = 10.0;
const START: f64 = 0.02;

/// The largest error over all laws and times in `steps` steps, relative to the largest offset of each motion.
fn worst<T: Real>(steps: u32) -> f64 {
    let rows = include_str!("data/first_order.csv").lines().skip(1).map(|line| {
        let row: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        let [damping, stiffness, time, exact] = row[..] else { panic!("{line}") };
        let (stiffness, damping, dt) = (T::of(stiffness), T::of(damping), T::of(time / f64::from(steps)));
        let offset = (0..steps).fold(T::of(START), |e, _| step_offset(e, stiffness, damping, T::of(FORCE), dt));
        (offset.to_f64() - exact).abs() / exact.abs().max(START)
    });
    rows.fold(0.0, f64::max)
}

#[test]
fn double_precision_keeps_twelve_digits_in_one_step_and_in_many() {
    for steps in [1, 2, 3, 10, 100, 1000] {
        let error = worst::<f64>(steps);
        assert!(error < 1e-12, "{error:e} after {steps} steps");
    }
}

#[test]
fn single_precision_keeps_five_digits() {
    for steps in [1, 2, 3, 10] {
        let error = worst::<f32>(steps);
        assert!(error < 1e-5, "{error:e} after {steps} steps");
    }
}

/// Relative error of a million steps of 1 ms under a force that turns round every second, at the end of a push.
fn after_a_million<T: Real>() -> f64 {
    let (stiffness, damping, dt) = (100.0, 10.0, 1e-3);
    let mut offset = T::ZERO;
    for step in 0..1_000_000 {
        let force = if step / 1000 % 2 == 0 { -FORCE } else { FORCE };
        offset = step_offset(offset, T::of(stiffness), T::of(damping), T::of(force), T::of(dt));
    }
    // Each second turns e - q into exp(-10) of it: e = f/k tanh(5) at the end of one in the long run.
    (offset.to_f64() / (FORCE / stiffness * 5.0_f64.tanh()) - 1.0).abs()
}

#[test]
fn a_million_steps_keep_their_digits() {
    let errors = [after_a_million::<f64>(), after_a_million::<f32>()];
    // In single precision the offset stands still once its step rounds to zero, 6e-8 d/(k dt) short: 6e-6.
    assert!(errors[0] < 1e-12 && errors[1] < 1e-5, "{errors:?}");
}
