//! One motion at 100 Hz, 1 kHz and 8 kHz: a finer loop comes nearer to it, by the order that is claimed.

use crate::support::{Family, Kind, Rig, settings, skill};
use hpf_core::controller::{Request, Settings};
use hpf_core::{Damping, Law};

/// What the loops are compared with [Hz].
const FINEST: f64 = 256_000.0;
/// Rates whose ratios measure the order [Hz].
const RATES: [f64; 6] = [100.0, 200.0, 400.0, 1000.0, 2000.0, 8000.0];
/// When the positions are compared [s].
const END: f64 = 1.2;

/// Asserts that the errors fall as `rate^-order` from one of `rates` to the next, within 10 %, and stay below `largest` [m]
/// at the first.
#[track_caller]
fn assert_order(order: i32, rates: &[f64], largest: f64, at: impl Fn(f64) -> f64) {
    let exact = at(FINEST);
    let errors: Vec<f64> = rates.iter().map(|&rate| (at(rate) - exact).abs()).collect();
    println!("{errors:?}");
    assert!(errors[0] < largest, "{errors:?}");
    for (errors, rates) in errors.windows(2).zip(rates.windows(2)) {
        let measured = (errors[0] / errors[1]).ln() / (rates[1] / rates[0]).ln();
        assert!((measured - f64::from(order)).abs() < 0.1, "order {measured} between {rates:?} Hz: {errors:?}");
    }
}

/// Position of a skill under a push that is a function of time, held over each step at its mean.
fn skill_at(family: Family, rate: f64) -> f64 {
    let skill = skill::<f64, 1>(family, 2.0);
    let mut state = skill.initial_state();
    let dt = 1.0 / rate;
    let mut command = 0.0;
    for i in 0..(END * rate).round() as usize {
        let force = 6.0 + 4.0 * (5.0 * (i as f64 + 0.5) * dt).sin();
        command = skill.step(&mut state, [force], 1.0, dt)[0].position;
    }
    command
}

#[test]
fn a_skill_is_second_order_in_the_loop_rate() {
    for family in Family::ALL {
        assert_order(2, &RATES, 1e-6, |rate| skill_at(family, rate));
    }
}

const LAWS: [Law<f64>; 2] = [Law::FirstOrder, Law::SecondOrder { mass: 1.0, damping: Damping::Primitive }];

/// Position of a controller that starts, pauses and resumes.
fn controller_at(kind: Kind, rate: f64) -> f64 {
    let mut settings: Settings<f64, 1> = settings();
    // Far from every limit: a limit is met by whole steps.
    settings.axes[0].limits.velocity = 10.0;
    settings.axes[0].limits.acceleration = 1e4;
    settings.conditioning.cutoff = Some(20.0);
    let mut rig = Rig::<f64, 1>::new(kind, settings, 2.0);
    rig.dt = 1.0 / rate;
    let mut position = 0.0;
    for i in 0..(END * rate).round() as usize {
        let at = |seconds: f64| i == (seconds * rate).round() as usize;
        rig.input.measured_force = [6.0 + 4.0 * (5.0 * (i as f64 + 0.5) * rig.dt).sin()];
        rig.input.request = [(0.0, Request::Start), (0.4, Request::Hold), (0.6, Request::Resume)]
            .into_iter()
            .find_map(|(seconds, request)| at(seconds).then_some(request));
        position = rig.step().axes[0].position;
    }
    position
}

#[test]
fn a_controller_is_first_order_in_the_loop_rate_because_requests_and_readings_wait_for_a_step() {
    for family in Family::ALL {
        for law in LAWS {
            // At 100 Hz what is of second order shows beside it.
            assert_order(1, &RATES[1..], 1.5e-4, |rate| controller_at(Kind { family, law }, rate));
        }
    }
}
