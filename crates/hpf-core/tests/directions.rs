//! Stiffness with directions over the phase: bounds, frames that turn, and the energy that turning moves.

use hpf_core::admittance::{coupled_velocity, step_coupled};
use hpf_core::frame::PathFrame;
use hpf_core::passivity::{EnergyTank, Stored};
use hpf_core::rotation::{Quaternion, dot, length};
use hpf_core::{Basis, MatrixGain, Real, Symmetric};
use proptest::prelude::*;

fn basis<T: Real>() -> Basis<T, [T; 5]> {
    Basis::equally_spaced(T::of(4.605), T::of(0.6), [T::ZERO; 5], [T::ZERO; 5]).unwrap()
}

fn lists<T: Real>(matrices: [Symmetric<T>; 5]) -> [[T; 5]; 6] {
    core::array::from_fn(|entry| core::array::from_fn(|i| matrices[i].numbers()[entry]))
}

#[test]
fn a_mixture_keeps_the_eigenvalues_within_the_bounds() {
    let matrices = core::array::from_fn(|i| {
        let i = i as f64;
        Symmetric::diagonal([400.0, 30.0, 30.0 + 90.0 * i]).turned(&Quaternion::exp([i, 2.0 - i, 0.5 * i * i]))
    });
    let gain = MatrixGain::new(30.0, 400.0, lists(matrices)).unwrap();
    for i in 0..200 {
        let s = (-4.6 * f64::from(i) / 199.0).exp();
        let mixed = gain.at(&basis(), s);
        // The mixture by hand, from the basis' own functions.
        let mut features = [0.0; 5];
        basis::<f64>().features_into(s, &mut features);
        let expected: [f64; 6] = core::array::from_fn(|j| (0..5).map(|i| features[i] * matrices[i].numbers()[j]).sum());
        for (found, expected) in mixed.numbers().into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-11);
        }
        let values = mixed.eigen().values;
        assert!(values.iter().all(|value| (30.0 - 1e-10..=400.0 + 1e-10).contains(value)), "{s}: {values:?}");
    }
}

#[test]
fn a_weight_with_an_eigenvalue_outside_the_bounds_is_refused() {
    let q = Quaternion::exp([0.3, 0.2, 0.9]);
    let stiff = Symmetric::diagonal([401.0, 100.0, 100.0]).turned(&q);
    let soft = Symmetric::diagonal([400.0, 100.0, 29.0]).turned(&q);
    let indefinite = Symmetric { xy: 300.0, ..Symmetric::isotropic(100.0) };
    for wrong in [stiff, soft, indefinite] {
        let mut matrices = [Symmetric::isotropic(100.0); 5];
        matrices[3] = wrong;
        let refusal = MatrixGain::new(30.0, 400.0, lists(matrices)).unwrap_err().to_string();
        assert!(refusal.starts_with("eigenvalue of weights must lie in [30, 400], not "), "{refusal}");
        // Its projection is accepted, in single precision too.
        matrices[3] = wrong.clamped(30.0, 400.0);
        MatrixGain::new(30.0, 400.0, lists(matrices)).unwrap();
        let single = matrices.map(|matrix| Symmetric::of(matrix.numbers().map(|number| number as f32)));
        MatrixGain::new(30.0_f32, 400.0, lists(single)).unwrap();
    }
    let gain = MatrixGain::new(2.0, 1.0, [[1.0; 5]; 6]).unwrap_err();
    assert_eq!(gain.to_string(), "gain has its lower bound 2 above its upper bound 1");
}

#[test]
fn a_turning_ellipsoid_gives_energy_that_no_axis_of_its_own_frame_shows() {
    // Eigenvalues 400 and 30 N/m turn at 1 rad/s past an offset that stands still. The stored energy is
    // e^2/2 (30 + 370 cos^2 a), so its rate is at most 370/2 e^2: 18.5 mW at 10 mm, 36.3 mW at 14 mm.
    for (offset, expected) in [(0.010, 0.0185), (0.014, 0.036_26)] {
        let stiffness = |t: f64| Symmetric::diagonal([400.0, 30.0, 30.0]).turned(&Quaternion::exp([0.0, 0.0, t]));
        let at = [offset, 0.0, 0.0];
        let small = 1e-5;
        let power =
            |t: f64| 0.5 * (stiffness(t + small).quadratic(at) - stiffness(t - small).quadratic(at)) / (2.0 * small);
        let most = (0..3142).map(|i| power(f64::from(i) * 1e-3)).fold(0.0, f64::max);
        assert!((most / expected - 1.0).abs() < 1e-4, "{most} W at {offset} m");

        // The tank pays that, and where it is empty the ellipsoid stops.
        let tank = EnergyTank::new(1.0, 0.0, 1.0, 1e3).unwrap();
        let (mut energy, mut now) = (Stored::new(0.5), stiffness(0.0));
        let dt = 1e-3;
        let mut paid: f64 = 0.0;
        for i in 1..3142 {
            let before = energy.level();
            now = tank.stiffness_matrix(&mut energy, &now, &stiffness(f64::from(i) * dt), at, dt);
            paid = paid.max((before - energy.level()) / dt);
        }
        assert!((paid / expected - 1.0).abs() < 1e-4, "{paid} W at {offset} m");
    }
}

#[test]
fn the_first_axis_of_a_path_frame_is_along_the_path_and_turns_least() {
    let mut frame = PathFrame::new(1e-3).unwrap();
    let mut last = frame.orientation();
    for i in 0..2000 {
        let t = f64::from(i) * 2e-3;
        let velocity = [(2.0 * t).cos(), (3.0 * t).sin(), 0.5 * t - 1.0];
        let next = frame.follow(velocity);
        let [x, y, z] = next.turn([1.0, 0.0, 0.0]);
        let speed = length(velocity);
        assert!(
            (x - velocity[0] / speed).abs() + (y - velocity[1] / speed).abs() + (z - velocity[2] / speed).abs() < 1e-12
        );
        if i > 0 {
            // The least rotation has no part about the first axis.
            let turn = (next * last.conjugate()).log();
            assert!(dot(turn, last.turn([1.0, 0.0, 0.0])).abs() < 1e-12);
        }
        last = next;
    }
    let back = frame.follow(last.turn([-1.0, 0.0, 0.0]));
    assert!((back.distance(&last) - core::f64::consts::PI).abs() < 1e-7, "a half turn, about the second axis");
    assert!((dot(back.turn([0.0, 1.0, 0.0]), last.turn([0.0, 1.0, 0.0])) - 1.0).abs() < 1e-12);
    for velocity in [[0.0; 3], [f64::NAN; 3], [f64::INFINITY, 0.0, 0.0]] {
        assert_eq!(frame.follow(velocity), back);
    }
    assert_eq!(PathFrame::new(0.0).unwrap_err().to_string(), "frame.slowest must be positive, not 0");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// `sum W >= -(E_t0 - E_min + S_0)` for every force and every matrix asked for; 5 000 updates a case, 1e6 in all.
    #[test]
    fn a_tank_with_matrices_never_gives_more_than_it_was_given(seed in any::<u64>(), power in 1e-3_f64..1e3, reserve in 0.0_f64..0.2) {
        let tank = EnergyTank::new(0.3, reserve, 0.9, power).unwrap();
        let mut random = seed | 1;
        let mut draw = || {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            (random >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        };
        let (mut energy, mut stiffness, mut offset) = (tank.full(), Symmetric::isotropic(100.0), [0.0; 3]);
        let mut work = 0.0;
        let mut direction = [0.0; 3];
        for _ in 0..5_000 {
            let dt = 10.0_f64.powf(-2.0 + draw());
            // Adversarial: half of the time the matrix is stiff along the offset and the force pulls it back.
            let hostile = draw() > 0.0;
            if draw() > 0.9 {
                direction = [draw(), draw(), draw()].map(|part| 3.0 * part);
            }
            let mut frame = PathFrame::new(1e-9).unwrap();
            let q = if hostile { frame.follow(offset) } else { Quaternion::exp(direction) };
            let wanted = Symmetric::diagonal([400.0, 30.0, 30.0]).turned(&q);
            stiffness = tank.stiffness_matrix(&mut energy, &stiffness, &wanted, offset, dt);
            let values = stiffness.eigen().values;
            prop_assert!(values.iter().all(|value| (30.0 - 1e-9..=400.0 + 1e-9).contains(value)), "{values:?}");
            let force = if hostile { offset.map(|part| -100.0 * part) } else { [draw(), draw(), draw()].map(|part| 40.0 * part) };
            let damping = Symmetric::diagonal([50.0, 20.0, 90.0]).turned(&Quaternion::exp(direction));
            let next = step_coupled(offset, &stiffness, &damping, force, dt);
            let done = (0..3).map(|i| force[i] * (next[i] - offset[i])).sum::<f64>();
            let stored = 0.5 * (stiffness.quadratic(next) - stiffness.quadratic(offset));
            prop_assert!(done - stored > -1e-12, "nothing dissipates less than nothing: {}", done - stored);
            tank.book(&mut energy, done - stored);
            work += done;
            offset = next;
            prop_assert!(work >= -(tank.capacity() - reserve) - 1e-9, "{work} J");
            let energy = energy.level();
            prop_assert!(energy >= reserve - 1e-9, "{energy} J");
        }
        prop_assert!(coupled_velocity(offset, &stiffness, &Symmetric::isotropic(50.0), [0.0; 3]).iter().all(|part| part.is_finite()));
    }
}
