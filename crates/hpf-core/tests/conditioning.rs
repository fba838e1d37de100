//! Force conditioning against closed forms, at every loop rate.

use core::f64::consts::PI;

use hpf_core::conditioning::{ForceConditioning, ForceState, dead_zone};
use proptest::prelude::*;

const BARE: ForceConditioning<f64, 1> =
    ForceConditioning { tool_mass: 0.0, gravity: [0.0], cutoff: Some(20.0), dead_zone: [0.0] };

#[test]
fn a_step_of_force_is_filtered_alike_at_every_rate() {
    for rate in [100_u32, 1000, 8000] {
        let mut state = ForceState::default();
        let mut force = [0.0];
        for _ in 0..rate / 20 {
            force = BARE.step(&mut state, [10.0], 1.0 / f64::from(rate));
        }
        // 50 ms at 20 Hz: 1 - exp(-2 pi) of it; 400 roundings.
        assert!((force[0] - 10.0 * (1.0 - (-2.0 * PI).exp())).abs() < 1e-12, "{force:?} at {rate} Hz");
    }
}

#[test]
fn a_sine_at_the_cutoff_is_damped_by_the_square_root_of_two() {
    let mut state = ForceState::default();
    let dt = 1e-5;
    let mut largest = 0.0_f64;
    for i in 0..100_000 {
        let [force] = BARE.step(&mut state, [(2.0 * PI * 20.0 * f64::from(i) * dt).sin()], dt);
        if i > 50_000 {
            largest = largest.max(force);
        }
    }
    assert!((largest - 0.5_f64.sqrt()).abs() < 1e-3, "{largest}");
}

#[test]
fn tare_removes_bias_and_weight_stays_removed() {
    let with_tool = ForceConditioning { tool_mass: 1.2, gravity: [-9.81], ..BARE };
    let mut state = ForceState::default();
    for _ in 0..1000 {
        with_tool.step(&mut state, [-1.2 * 9.81 + 3.0], 1e-3); // weight and 3 N of bias
    }
    assert!((state.filtered[0] - 3.0).abs() < 1e-12, "{state:?}");
    state.tare(state.filtered);
    let [force] = with_tool.step(&mut state, [-1.2 * 9.81 + 3.0], 1e-3);
    assert!(force.abs() < 1e-12, "{force}");
}

proptest! {
    #[test]
    fn the_dead_zone_is_continuous_odd_and_never_adds(a in -1e3..1e3_f64, b in -1e3..1e3_f64, width in 0.0..100.0_f64) {
        let [za, zb] = [a, b].map(|force| dead_zone(force, width));
        prop_assert!((za - zb).abs() <= (a - b).abs() * (1.0 + 1e-12) + 1e-12); // Lipschitz with 1
        prop_assert!(za.abs() <= a.abs() && za * a >= 0.0);
        prop_assert_eq!(dead_zone(-a, width), -za);
    }
}

#[test]
fn every_refusal_names_its_culprit() {
    let refusals = [
        (ForceConditioning { tool_mass: -1.0, ..BARE }, "conditioning.tool_mass must lie in [0, 1000000000], not -1"),
        (ForceConditioning { gravity: [f64::NAN], ..BARE }, "conditioning.gravity is not a finite number"),
        (ForceConditioning { cutoff: Some(0.0), ..BARE }, "conditioning.cutoff must be positive, not 0"),
        (
            ForceConditioning { dead_zone: [-0.5], ..BARE },
            "conditioning.dead_zone must lie in [0, 1000000000], not -0.5",
        ),
    ];
    for (conditioning, text) in refusals {
        assert_eq!(conditioning.check().unwrap_err().to_string(), text);
    }
    assert_eq!(BARE.check(), Ok(()));
}
