//! A tare: refused until the force has stood still, and then nothing is left of it.

use crate::support::{DT, Family, Rig, settings};
use hpf_core::controller::{Mode, Request};

type Arm = Rig<f64, 2>;

fn arm(cutoff: Option<f64>) -> Arm {
    let mut settings = settings();
    settings.conditioning.cutoff = cutoff;
    settings.conditioning.tool_mass = 0.5;
    settings.conditioning.gravity = [0.0, -9.81];
    Arm::new(Family::Time, settings, 2.0)
}

/// Reads `force` of axis 0 at every tick [N].
fn read(arm: &mut Arm, seconds: f64, force: impl Fn(f64) -> f64) {
    for i in 0..(seconds / DT).round() as usize {
        arm.input.measured_force = [force(i as f64 * DT), -0.5 * 9.81];
        arm.step();
    }
}

/// Asks for a tare; returns whether it was done.
fn tare(arm: &mut Arm) -> bool {
    let ready = arm.controller.output().status.tare_ready;
    let before = arm.controller.bias();
    let refused = arm.ask(Request::Tare).status.refused;
    assert_eq!(ready, !refused, "the status says beforehand");
    if refused {
        assert_eq!(arm.controller.bias(), before);
    }
    !refused
}

#[test]
fn it_is_refused_until_the_force_has_stood_still() {
    for cutoff in [None, Some(1.0), Some(50.0)] {
        assert!(!tare(&mut arm(cutoff)), "on the first update");
        for seconds in [0.001, 0.05, 0.3, 0.498] {
            let mut arm = arm(cutoff);
            read(&mut arm, seconds, |_| 8.0);
            assert!(!tare(&mut arm), "after {seconds} s");
        }
        // A force that moves, fast, slowly, or has just changed.
        for force in [|t: f64| 8.0 * (20.0 * t).sin(), |t| 6.0 * t, |t| if t < 1.9 { 8.0 } else { 3.0 }] {
            let mut arm = arm(cutoff);
            read(&mut arm, 2.0, force);
            assert!(!tare(&mut arm));
        }
        // A sensor that says nothing, or nothing new.
        let mut dead = arm(cutoff);
        read(&mut dead, 2.0, |_| f64::NAN);
        assert!(!tare(&mut dead));
        let mut stale = arm(cutoff);
        read(&mut stale, 2.0, |_| 20.0);
        stale.input.force_age = 1000;
        stale.run(1.0);
        assert!(!tare(&mut stale));
    }
}

#[test]
fn nothing_is_left_of_a_force_that_stands_still_whatever_the_filter() {
    for cutoff in [None, Some(0.1), Some(1.0), Some(50.0)] {
        for force in [8.0, -49.0, 75.0] {
            let mut arm = arm(cutoff);
            read(&mut arm, 0.51, |_| force);
            assert!(tare(&mut arm));
            assert_eq!(arm.controller.bias()[0], force);
            assert!(arm.controller.bias()[1].abs() < 1e-15, "the weight is no bias");
            arm.ask(Request::Start);
            let output = arm.run(4.0);
            assert_eq!((output.axes[0].force, output.axes[0].offset), (0.0, 0.0));
            assert!((output.axes[0].position - 0.3).abs() < 1e-3);
        }
    }
}

#[test]
fn noise_is_averaged() {
    let mut arm = arm(None);
    let mut state = 1_u64;
    let mut sum = 0.0;
    for i in 0..500 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let noise = (state >> 33) as f64 / (1_u64 << 31) as f64 * 2.0 - 1.0;
        sum += 10.0 + noise;
        arm.input.measured_force = [10.0 + noise, -0.5 * 9.81];
        arm.step();
        assert_eq!(arm.controller.output().status.tare_ready, i >= 499);
    }
    assert!(tare(&mut arm));
    assert!((arm.controller.bias()[0] - sum / 500.0).abs() < 1e-12);
}

#[test]
fn a_second_tare_adds_to_the_first_and_takes_as_long() {
    let mut arm = arm(Some(5.0));
    read(&mut arm, 0.6, |_| 8.0);
    assert!(tare(&mut arm) && !tare(&mut arm));
    read(&mut arm, 1.1, |_| 9.5);
    assert!(tare(&mut arm));
    assert_eq!(arm.controller.bias()[0], 9.5);
    // What stood still before a reset, or before other settings, counts no more.
    read(&mut arm, 0.6, |_| 9.5);
    arm.ask(Request::Reset([0.0; 2]));
    assert!(!tare(&mut arm));
    read(&mut arm, 0.6, |_| 9.5);
    let settings = *arm.controller.settings();
    arm.controller.set(settings).unwrap();
    arm.step();
    assert!(!tare(&mut arm));
    assert_eq!(arm.controller.output().mode, Mode::Idle);
}

/// A change that is smaller than what noise may be is seen all the same, once it has lasted: of 2 % of the scale for
/// 30 ms, of nearly 5 % for 12 ms.
#[test]
fn it_is_refused_after_a_small_step_until_the_step_is_the_rule() {
    for cutoff in [None, Some(5.0)] {
        for step in [2.45, -2.0, 1.2] {
            let soon = if f64::abs(step) < 1.5 { 30 } else { 12 };
            for milliseconds in [soon, 30, 60, 120, 200, 249, 251, 300, 400, 499] {
                let mut arm = arm(cutoff);
                read(&mut arm, 1.0, |_| 0.0);
                read(&mut arm, f64::from(milliseconds) * 1e-3, |_| step);
                if tare(&mut arm) {
                    let residue = step - arm.controller.bias()[0];
                    assert!(
                        f64::abs(residue) <= 0.01 * 50.0,
                        "{residue} N, {milliseconds} ms after a step of {step} N"
                    );
                }
            }
            let mut arm = arm(cutoff);
            read(&mut arm, 1.0, |_| 0.0);
            read(&mut arm, 1.0, |_| step);
            assert!(tare(&mut arm));
            assert!((arm.controller.bias()[0] - step).abs() < 1e-12);
        }
    }
}

/// One reading 2.4 N below and one 2.4 N above the others, 0.49 s apart: no neighboring quarters of a second have both.
#[test]
fn it_is_refused_where_two_readings_of_half_a_second_lie_further_apart_than_they_may() {
    let mut arm = arm(None);
    for i in 0..741 {
        let force = match i {
            249 => -2.4,
            739 => 2.4,
            _ => 0.0,
        };
        arm.input.measured_force = [force, -0.5 * 9.81];
        arm.step();
        assert_eq!(arm.controller.output().status.tare_ready, (499..739).contains(&i), "after reading {i}");
    }
    assert!(!tare(&mut arm));
}

/// Steps that tell no time do not count as time in which a force has stood still.
#[test]
fn it_is_refused_after_steps_of_no_time() {
    for (force, dt) in [(30.0, 0.0), (f64::NAN, 0.0), (0.0, f64::NAN), (0.0, -1e-3)] {
        let mut arm = arm(None);
        read(&mut arm, 0.7, |_| 0.0);
        (arm.input.measured_force[0], arm.dt) = (force, dt);
        arm.step();
        (arm.input.measured_force[0], arm.dt) = (0.0, DT);
        assert!(arm.controller.output().status.bad_time && !tare(&mut arm), "{force} N, {dt} s");
    }
}

/// Nor do steps longer than the longest: nobody knows what the force did meanwhile.
#[test]
fn it_is_refused_after_steps_that_are_too_long() {
    let mut arm = arm(None);
    read(&mut arm, 0.7, |_| 0.0);
    arm.dt = 0.5;
    arm.step();
    assert!(arm.controller.output().status.long_time && !tare(&mut arm));
    for _ in 0..60 {
        arm.step();
    }
    assert!(!tare(&mut arm), "sixty long steps, and not one in order");
    arm.dt = DT;
    read(&mut arm, 0.51, |_| 0.0);
    assert!(tare(&mut arm));
}

/// The reading that comes with the request is one of the force that stands still.
#[test]
fn it_is_refused_beside_a_reading_that_does_not_fit() {
    let mut ready = arm(Some(5.0));
    read(&mut ready, 0.7, |_| 8.0);
    for (force, age) in [(f64::NAN, 0), (f64::INFINITY, 0), (8.0, 999), (80.0, 0), (-8.0, 0), (11.0, 0)] {
        let mut arm = Arm { controller: ready.controller, ..arm(None) };
        (arm.input.measured_force, arm.input.force_age) = ([force, -0.5 * 9.81], age);
        assert!(arm.ask(Request::Tare).status.refused, "{force} N, {age} steps old");
        assert_eq!(arm.controller.bias(), [0.0; 2]);
    }
    assert!(tare(&mut ready));
}
