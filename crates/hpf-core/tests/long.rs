//! Skills of hours in single precision, far goals, and a long rest: sums of millions of small steps.

use crate::support::{Family, Rig, settings, skill};
use hpf_core::Real;
use hpf_core::controller::Request;

/// Runs a started skill of `duration` [s] at 1 kHz to a tenth beyond its end, in both precisions; returns the largest gap
/// between them [m], and when each has ended [s].
fn beside(family: Family, duration: f64) -> (f64, [f64; 2]) {
    let mut single = Rig::<f32, 1>::started(family, settings(), duration);
    let mut double = Rig::<f64, 1>::started(family, settings(), duration);
    // The same time for both, to the bit.
    let dt = f64::from(1e-3_f32);
    (single.dt, double.dt) = (dt, dt);
    let (mut gap, mut ends) = (0.0_f64, [0.0; 2]);
    for i in 0..(duration * 1100.0) as u64 {
        let (s, d) = (single.step(), double.step());
        gap = gap.max((f64::from(s.axes[0].position) - d.axes[0].position).abs());
        for (end, ended) in ends.iter_mut().zip([s.status.ended, d.status.ended]) {
            if ended {
                *end = i as f64 * dt;
            }
        }
    }
    (gap, ends)
}

#[test]
fn a_long_skill_in_single_precision_is_where_double_precision_is() {
    for (family, duration) in [(Family::Time, 600.0), (Family::Phase, 300.0), (Family::Time, 3600.0)] {
        let (gap, [single, double]) = beside(family, duration);
        println!("{family:?} {duration} s: {gap:e} m, ended at {single} and {double} s");
        // The documented 0.03 mm of an hour of short skills; a relative error of 6e-8 in the rate of the phase is 0.2 ms of
        // an hour.
        assert!(gap < 3e-5, "{family:?} {duration} s: {gap:e} m");
        assert!((single - double).abs() < 0.01, "{family:?} {duration} s: ended at {single} and {double} s");
        assert!((double - duration).abs() < 0.1, "{double}");
    }
}

#[test]
fn a_long_skill_without_a_controller_is_where_double_precision_is() {
    fn last<T: Real>(duration: f64, share: f64) -> [f64; 2] {
        let skill = skill::<T, 1>(Family::Time, duration);
        let mut state = skill.initial_state();
        let dt = T::of(f64::from(1e-3_f32));
        let mut position = 0.0;
        for _ in 0..(duration * 1000.0 * share) as u64 {
            position = skill.step(&mut state, [T::ZERO], T::ONE, dt)[0].position.to_f64();
        }
        [position, state.phase.to_f64()]
    }
    for share in [0.3, 0.7] {
        let [single, double] = [last::<f32>(600.0, share), last::<f64>(600.0, share)];
        assert!((single[0] - double[0]).abs() < 3e-6, "{single:?} {double:?}");
        // The exact phase, in 40 digits or none: exp(-decay t/T).
        let exact = (-f64::from(4.605_17_f32) * share * f64::from(1e-3_f32) * 1000.0).exp();
        assert!((single[1] / exact - 1.0).abs() < 1e-6, "{single:?} {exact}");
    }
}

#[test]
fn a_far_goal_is_no_jump_at_rest() {
    for far in [1.0_f32, 100.0, 1e4, 1e6, 1e9] {
        for family in Family::ALL {
            let mut wide = settings::<f32, 1>();
            wide.axes[0].limits.position = [-far, far];
            (wide.axes[0].limits.velocity, wide.axes[0].limits.acceleration) = (0.1, 1.0);
            let mut arm = Rig::<f32, 1>::started(family, wide, 2.0);
            arm.run(0.3);
            arm.ask(Request::Hold);
            let rest = arm.run(20.0).axes[0].position; // what the acceleration limit has cut off has come back
            let away = arm.ask(Request::Goal([far])).axes[0];
            assert!((away.position - rest).abs() <= 4.0 * f32::EPSILON * rest.abs(), "{far:e}: {rest} {away:?}");
            let back = arm.ask(Request::Goal([0.3])).axes[0].position;
            assert!((back - rest).abs() <= 4.0 * f32::EPSILON * rest.abs().max(far * 1e-8), "{far:e}: {rest} {back}");
            // And on its way it keeps the velocity limit, position by position.
            arm.ask(Request::Goal([far]));
            arm.ask(Request::Resume);
            let mut last = arm.controller.output().axes[0].position;
            for _ in 0..3000 {
                let now = arm.step().axes[0].position;
                assert!((now - last).abs() <= 0.1e-3 * 1.001 + 4.0 * f32::EPSILON * now.abs(), "{far:e}: {last} {now}");
                last = now;
            }
        }
    }
}

/// The numbers in the text of a value, those of its whole state.
fn numbers(text: &str) -> Vec<f64> {
    let fields = text.split(|c: char| !(c.is_ascii_alphanumeric() || "+-.".contains(c)));
    fields.filter_map(|field| field.parse().ok()).collect()
}

#[test]
fn at_rest_nothing_is_subnormal() {
    for family in Family::ALL {
        let mut filtered = settings::<f32, 2>();
        filtered.conditioning.cutoff = Some(20.0);
        let mut arm = Rig::<f32, 2>::started(family, filtered, 1.0);
        arm.input.measured_force = [5.0, -3.0];
        arm.run(0.3);
        arm.ask(Request::Goal([0.25, 0.1]));
        arm.input.measured_force = [0.0; 2];
        for second in 0..60 {
            arm.run(1.0);
            let text = format!("{:?}", arm.controller);
            for number in numbers(&text) {
                let subnormal = number != 0.0 && number.abs() < f64::from(f32::MIN_POSITIVE);
                assert!(!subnormal, "{number:e} after {second} s: {text}");
            }
        }
        let output = arm.controller.output();
        assert_eq!(
            output.axes.map(|axis| (axis.position, axis.velocity, axis.offset)),
            [(0.25, 0.0, 0.0), (0.1, 0.0, 0.0)]
        );

        let skill = skill::<f32, 2>(family, 1.0);
        let mut state = skill.initial_state();
        skill.step(&mut state, [5.0; 2], 1.0, 0.1);
        for _ in 0..60_000 {
            skill.step(&mut state, [0.0; 2], 1.0, 1e-3);
        }
        let text = format!("{state:?}");
        assert!(numbers(&text).iter().all(|x| *x == 0.0 || x.abs() >= f64::from(f32::MIN_POSITIVE)), "{text}");
    }
}
