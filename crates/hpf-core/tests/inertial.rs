//! The second-order admittance against 40-digit closed forms, and what its energy does.

use hpf_core::admittance::{Inertial, OffsetMotion, step_offset};
use hpf_core::{ConfigError, Real};

const FORCE: f64 = 10.0;
const START: OffsetMotion<f64> = OffsetMotion { offset: 0.02, velocity: -0.3 };

struct Case {
    mass: f64,
    damping: f64,
    stiffness: f64,
    time: f64,
    offset: f64,
    velocity: f64,
}

fn cases() -> impl Iterator<Item = Case> {
    include_str!("data/inertial.csv").lines().skip(1).map(|line| {
        let row: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        let [mass, damping, stiffness, time, offset, velocity] = row[..] else { panic!("{line}") };
        Case { mass, damping, stiffness, time, offset, velocity }
    })
}

/// Offset and velocity of that case after `steps` steps, and the largest magnitudes each has had.
fn walk<T: Real>(case: &Case, steps: u32) -> [[f64; 2]; 2] {
    let [mass, damping, stiffness] = [case.mass, case.damping, case.stiffness].map(T::of);
    let dt = T::of(case.time / f64::from(steps));
    let law = Inertial::new(mass, stiffness, damping, dt).unwrap();
    let mut motion = OffsetMotion { offset: T::of(START.offset), velocity: T::of(START.velocity) };
    let mut largest = [0.0_f64; 2];
    for _ in 0..steps {
        law.step(&mut motion, stiffness, damping, T::of(FORCE), dt);
        largest = [largest[0].max(motion.offset.to_f64().abs()), largest[1].max(motion.velocity.to_f64().abs())];
    }
    [[motion.offset.to_f64(), motion.velocity.to_f64()], largest]
}

/// The largest error over all cases, relative to the largest offset and velocity of each motion.
fn worst<T: Real>(steps: u32) -> f64 {
    cases()
        .map(|case| {
            let [[offset, velocity], [largest_offset, largest_velocity]] = walk::<T>(&case, steps);
            let errors = [
                (offset - case.offset).abs() / largest_offset.max(START.offset),
                (velocity - case.velocity).abs() / largest_velocity.max(-START.velocity),
            ];
            errors[0].max(errors[1])
        })
        .fold(0.0, f64::max)
}

#[test]
fn every_damping_regime_is_exact_in_one_step_and_in_many() {
    for steps in [1, 2, 3, 10, 100, 1000] {
        let error = worst::<f64>(steps);
        assert!(error < 1e-12, "{error:e} after {steps} steps");
    }
}

#[test]
fn single_precision_keeps_five_digits() {
    for steps in [1, 2, 3, 10, 100] {
        let error = worst::<f32>(steps);
        assert!(error < 1e-5, "{error:e} after {steps} steps");
    }
}

#[test]
fn single_precision_keeps_five_digits_over_a_million_steps() {
    // The offset stands still once its step, k dt/d of the distance left, rounds to zero: 6e-8 d/(k dt) short.
    let (m, k, d, dt) = (1.0_f32, 100.0, 10.0, 1e-3);
    let law = Inertial::new(m, k, d, dt).unwrap();
    let mut motion = OffsetMotion { offset: 0.0, velocity: 0.0 };
    for _ in 0..1_000_000 {
        law.step(&mut motion, k, d, 10.0, dt);
    }
    assert!((motion.offset / 0.1 - 1.0).abs() < 1e-5 && motion.velocity.abs() < 1e-5, "{motion:?}");
}

#[test]
fn halving_and_doubling_change_only_the_last_digits() {
    // A law built for ever longer steps halves ever more often: the same step by another way.
    let (k, d, dt) = (100.0, 50.0, 1e-3);
    let step = |longest: f64| {
        let mut motion = START;
        Inertial::new(2.0, k, d, longest).unwrap().step(&mut motion, k, d, FORCE, dt);
        motion
    };
    let exact = step(dt);
    for longest in [0.1, 1.0, 10.0, 1e3] {
        let found = step(longest);
        assert!((found.offset - exact.offset).abs() < 1e-14, "{found:?} {exact:?}");
        assert!((found.velocity - exact.velocity).abs() < 1e-13, "{found:?} {exact:?}");
    }
}

#[test]
fn an_endless_step_settles_at_force_over_stiffness() {
    let (k, d) = (100.0, 50.0);
    for dt in [1e3, 1e6, 1e9] {
        let mut motion = START;
        Inertial::new(2.0, k, d, dt).unwrap().step(&mut motion, k, d, FORCE, dt);
        assert!((motion.offset - FORCE / k).abs() < 1e-12 && motion.velocity.abs() < 1e-12, "{motion:?} at {dt}");
    }
}

#[test]
fn without_mass_to_speak_of_it_is_the_first_order_law() {
    let (k, d, dt) = (100.0, 50.0, 0.01);
    let law = Inertial::new(1e-7, k, d, dt).unwrap();
    let mut motion = OffsetMotion { offset: 0.02, velocity: (FORCE - k * 0.02) / d };
    let mut offset = 0.02;
    for _ in 0..100 {
        law.step(&mut motion, k, d, FORCE, dt);
        offset = step_offset(offset, k, d, FORCE, dt);
        // They differ by m k/d^2 = 4e-9 of the 0.08 m still to go.
        assert!((motion.offset - offset).abs() < 1e-9, "{} {offset}", motion.offset);
    }
}

#[test]
fn varying_gains_at_mid_step_are_second_order() {
    let gains = |t: f64| (200.0 - 150.0 * (3.0 * t).cos(), 50.0 + 30.0 * (2.0 * t).sin());
    let run = |steps: u32| {
        let dt = 1.0 / f64::from(steps);
        let law = Inertial::new(2.0, 400.0, 100.0, dt).unwrap();
        let mut motion = START;
        for i in 0..steps {
            let (k, d) = gains((f64::from(i) + 0.5) * dt);
            law.step(&mut motion, k, d, FORCE, dt);
        }
        motion.offset
    };
    // 12 800 steps are 4 096 times more exact than 200.
    let exact = run(12_800);
    let errors = [100, 200, 400].map(|steps| (run(steps) - exact).abs());
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] / 4.0 - 1.0).abs() < 0.05, "{errors:?}");
    }
}

#[test]
fn energy_is_lost_to_damping_alone() {
    // Stored k e^2/2 + m v^2/2 plus what d e'^2 has burnt is what the force has put in.
    let (m, k, d, dt) = (2.0, 300.0, 8.0, 1e-5);
    let law = Inertial::new(m, k, d, dt).unwrap();
    let stored = |motion: OffsetMotion<f64>| 0.5 * (k * motion.offset.powi(2) + m * motion.velocity.powi(2));
    let mut motion = START;
    let (mut work, mut burnt) = (0.0, 0.0);
    for i in 0..100_000 {
        let before = motion;
        let force = FORCE * (1e-4 * f64::from(i)).sin();
        law.step(&mut motion, k, d, force, dt);
        work += force * (motion.offset - before.offset);
        // The mean of the squared velocities at both ends, second order in 10 us.
        burnt += d * 0.5 * (before.velocity.powi(2) + motion.velocity.powi(2)) * dt;
    }
    let gap = stored(motion) + burnt - stored(START) - work;
    assert!(gap.abs() < 1e-8, "{gap:e} J of {work} J"); // trapezia: (v^2)'' dt^2/12 per second
}

#[test]
fn every_refusal_names_its_culprit() {
    let refusals: [(ConfigError, &str); 5] = [
        (Inertial::new(0.0, 1.0, 1.0, 1.0).unwrap_err(), "mass must be positive, not 0"),
        (Inertial::new(1.0, 1.0, 1.0, f64::NAN).unwrap_err(), "dt is not a finite number"),
        (Inertial::new(1.0, f64::INFINITY, 1.0, 1.0).unwrap_err(), "stiffness is not a finite number"),
        (Inertial::new(1.0, -1.0, 1.0, 1.0).unwrap_err(), "stiffness must lie in [0, inf], not -1"),
        (
            Inertial::new(1.0, 1.0, 1e30, 1.0).unwrap_err(),
            "max(damping/mass, sqrt(stiffness/mass)) dt must lie in [0, 2251799813685248], not 1000000000000000000000000000000",
        ),
    ];
    for (refusal, text) in refusals {
        assert_eq!(refusal.to_string(), text);
    }
}
