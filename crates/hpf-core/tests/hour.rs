//! An hour of single precision beside double precision, at 1 kHz: pauses, new goals, pushes, a new start each minute.
//!
//! 3600 s; `HPF_HOUR_SECONDS=20` asks for another time.

use crate::support::{Family, Kind, Rig, settings};
use hpf_core::conditioning::ForceConditioning;
use hpf_core::controller::Request;
use hpf_core::passivity::EnergyTank;
use hpf_core::{Damping, Law, Real};

const SECONDS: usize = 3600;
/// The largest gap allowed between the two [m]: the phase of a movement is a product of 2000 factors, each rounded at
/// 6e-8, and a relative error in it is a time along the path; a limit may be met a step later.
const GAP: f64 = 3e-5;
/// A tank that never runs dry [J]: in one that does, microjoules decide when the path goes on.
const CAPACITY: f64 = 1e3;

fn seconds() -> usize {
    std::env::var("HPF_HOUR_SECONDS").map_or(SECONDS, |text| text.parse().unwrap())
}

/// A push that comes and goes, without a library function [N].
fn push(tick: usize) -> f64 {
    let ramp = (tick % 7000) as f64 / 3500.0;
    12.0 * (1.0 - (ramp - 1.0).abs()) - 4.0
}

/// What is asked for at `tick`, given where the command is.
fn request<T: Real>(tick: usize, position: T) -> Option<Request<T, 1>> {
    let (minute, within) = (tick / 60_000, tick % 60_000);
    let goals = [0.45, -0.2, 0.3, 0.1, -0.35];
    match within {
        // Where the last run ended, to the bit: what has drifted is carried on.
        0 => Some(Request::Reset([position])),
        1 => Some(Request::Start),
        59_000 => Some(Request::Stop),
        _ => match within % 10_000 {
            1000 => Some(Request::Hold),
            1700 => Some(Request::Resume),
            5000 => Some(Request::Goal([T::of(goals[(minute + within / 10_000) % goals.len()])])),
            _ => None,
        },
    }
}

/// The gap between the two precisions in each tenth of the time [m].
fn gaps(family: Family, law: Law<f64>) -> Vec<f64> {
    fn rig<T: Real + PartialOrd>(family: Family, law: Law<f64>) -> Rig<T, 1> {
        let mut settings = settings();
        settings.conditioning = ForceConditioning { cutoff: Some(T::of(30.0)), ..settings.conditioning };
        settings.tank = Some(EnergyTank::new(T::of(CAPACITY), T::ZERO, T::of(0.9), T::of(100.0)).unwrap());
        Rig::started(Kind { family, law }, settings, 2.0)
    }
    let (mut single, mut double) = (rig::<f32>(family, law), rig::<f64>(family, law));
    let ticks = 1000 * seconds();
    let mut gaps = vec![0.0_f64; 10];
    for tick in 0..ticks {
        single.input.measured_force = [push(tick) as f32];
        double.input.measured_force = [f64::from(push(tick) as f32)];
        single.input.request = request(tick, single.controller.output().axes[0].position);
        double.input.request = request(tick, double.controller.output().axes[0].position);
        let (single, double) = (single.step(), double.step());
        assert_eq!((single.mode, single.status.refused), (double.mode, double.status.refused), "at tick {tick}");
        let gap = (f64::from(single.axes[0].position) - double.axes[0].position).abs();
        let tenth = &mut gaps[10 * tick / ticks];
        *tenth = tenth.max(gap);
    }
    gaps
}

#[test]
fn an_hour_of_single_precision_stays_beside_double_precision() {
    for family in Family::ALL {
        for law in [Law::FirstOrder, Law::SecondOrder { mass: 0.5, damping: Damping::Primitive }] {
            let gaps = gaps(family, law);
            println!("{family:?}, {law:?}: {gaps:?}");
            let worst = |tenths: &[f64]| tenths.iter().copied().fold(0.0, f64::max);
            let (early, late) = (worst(&gaps[..5]), worst(&gaps[5..]));
            assert!(early > 0.0 && early.max(late) < GAP, "{family:?}, {law:?}: {gaps:?}");
            // In a shorter time the tenths hold different motions.
            assert!(late < 1.5 * early || seconds() < 600, "it grows: {family:?}, {law:?}: {gaps:?}");
        }
    }
}
