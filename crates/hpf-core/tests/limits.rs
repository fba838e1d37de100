//! Limits on random wishes and jittering steps: never broken, never in each other's way.

use hpf_core::limits::{Hits, Limits};
use proptest::collection::vec;
use proptest::prelude::*;

const LIMITS: Limits<f64> =
    Limits { force: 50.0, offset: 0.1, velocity: 0.5, acceleration: 4.0, position: [-0.2, 0.3] };

proptest! {
    #[test]
    fn every_limit_holds_between_consecutive_commands(
        wishes in vec((prop_oneof![-1.0..1.0_f64, -1e9..1e9_f64, Just(1e300), Just(-1e300)], 1e-5..0.02_f64), 1..400),
    ) {
        let (mut position, mut velocity) = (0.0_f64, 0.0_f64);
        for (wanted, dt) in wishes {
            let (next, _) = LIMITS.velocity(position, velocity, wanted, dt);
            prop_assert!(next.abs() <= LIMITS.velocity);
            prop_assert!((next - velocity).abs() <= LIMITS.acceleration * dt + 1e-15);
            position += next * dt;
            velocity = next;
            let [min, max] = LIMITS.position;
            prop_assert!(position >= min - 1e-15 && position <= max + 1e-15, "{position}"); // rounding of p + v h
        }
    }
}

#[test]
fn a_constant_push_stops_at_the_wall_without_a_jolt_and_leaves_it_freely() {
    let (mut position, mut velocity) = (0.0, 0.0);
    let mut walk = |wanted: f64, steps: usize| {
        let mut hits = Hits::default();
        for _ in 0..steps {
            (velocity, hits) = LIMITS.velocity(position, velocity, wanted, 1e-3);
            position += velocity * 1e-3;
        }
        (position, velocity, hits)
    };
    let (position, velocity, hits) = walk(1.0, 3000);
    // The last part of the way takes ever smaller steps: a h^2 = 4 um is the scale at which it creeps.
    assert!((position - 0.3).abs() < 4e-6 && velocity.abs() < 4e-3, "{position} {velocity}");
    assert!(hits.position && hits.velocity && !hits.acceleration);
    let (position, velocity, hits) = walk(-0.1, 100);
    assert!((velocity + 0.1).abs() < 1e-15 && position < 0.3, "inward motion is free");
    assert_eq!(hits, Hits::default());
}

#[test]
fn braking_uses_the_whole_acceleration() {
    // From full speed, the wall brakes at a_max to within a few steps' worth of distance.
    let (mut position, mut velocity) = (0.3 - 0.5 * 0.5 / (2.0 * 4.0) - 1e-3, 0.5);
    let mut largest = 0.0_f64;
    for _ in 0..100 {
        let (next, _) = LIMITS.velocity(position, velocity, 0.5, 1e-3);
        largest = largest.max((velocity - next) / 1e-3);
        (position, velocity) = (position + next * 1e-3, next);
    }
    assert!((largest / 4.0 - 1.0).abs() < 0.02, "{largest}");
}

#[test]
fn every_refusal_names_its_culprit() {
    let refusals = [
        (Limits { force: 0.0, ..LIMITS }, "limits.force must be positive, not 0"),
        (Limits { offset: f64::NAN, ..LIMITS }, "limits.offset is not a finite number"),
        (Limits { velocity: -1.0, ..LIMITS }, "limits.velocity must be positive, not -1"),
        (
            Limits { acceleration: 1e10, ..LIMITS },
            "limits.acceleration must lie in [0.000000001, 1000000000], not 10000000000",
        ),
        (
            Limits { position: [0.3, -0.2], ..LIMITS },
            "limits.position has its lower bound 0.3 above its upper bound -0.2",
        ),
    ];
    for (limits, text) in refusals {
        assert_eq!(limits.check().unwrap_err().to_string(), text);
    }
    let admitted = |position, velocity| LIMITS.admit(position, velocity).map_err(|error| error.to_string());
    assert_eq!(admitted(0.25, 0.5), Ok(()));
    assert_eq!(admitted(0.4, 0.0).unwrap_err(), "position must lie in [-0.2, 0.3], not 0.4");
    assert_eq!(admitted(0.0, 0.6).unwrap_err(), "velocity must lie in [-0.5, 0.5], not 0.6");
    assert!(admitted(0.29, 0.5).unwrap_err().starts_with("stopping distance must lie in"));
    assert_eq!(admitted(0.29, -0.5), Ok(()));
}
