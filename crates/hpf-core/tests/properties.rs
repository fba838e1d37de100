//! What holds for every parameter and every input, tried on random ones.

use hpf_core::admittance::step_offset;
use hpf_core::{
    AxisPrimitives, Basis, ConfigError, Damping, Gain, HybridPrimitive, Law, Movement, MovementState, Phase, Transition,
};
use proptest::collection::vec;
use proptest::num::{f32 as any_f32, f64 as any_f64};
use proptest::prelude::*;

/// Falling centers in [0, 1] and widths from useless to needle-sharp: between the functions, all of them underflow.
fn wild_basis() -> impl Strategy<Value = Basis<f64, Vec<f64>>> {
    (2..30_usize).prop_flat_map(|n| (vec(0.0..=1.0_f64, n), vec(-300.0..300.0_f64, n))).prop_filter_map(
        "centers must differ",
        |(mut centers, exponents)| {
            centers.sort_by(|a, b| b.total_cmp(a));
            let widths = exponents.into_iter().map(|exponent| 10.0_f64.powf(exponent)).collect();
            Basis::new(centers, widths).ok()
        },
    )
}

fn any_phase() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..=1.0_f64, Just(0.0), Just(1.0), (-300.0..0.0_f64).prop_map(|exponent| 10.0_f64.powf(exponent))]
}

fn basis_in_single_precision(decay: f64, overlap: f64, n: usize) -> Basis<f32, Vec<f32>> {
    Basis::equally_spaced_in_time(decay as f32, overlap as f32, vec![0.0; n], vec![0.0; n]).unwrap()
}

proptest! {
    #[test]
    fn features_are_a_partition_of_unity(basis in wild_basis(), s in any_phase()) {
        let mut features = vec![f64::NAN; basis.count()];
        basis.features_into(s, &mut features);
        prop_assert!(features.iter().all(|phi| (0.0..=1.0).contains(phi)), "{features:?}");
        // Each of up to 30 terms, and their sum, is rounded at 1e-16.
        prop_assert!((features.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn mixtures_stay_between_the_smallest_and_the_largest_weight(
        basis in wild_basis(), s in any_phase(), weights in vec(-1e3..1e3_f64, 30),
    ) {
        let weights = &weights[..basis.count()];
        let [mixed] = basis.mix(s, [weights]);
        let lo = weights.iter().copied().fold(f64::INFINITY, f64::min);
        let hi = weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // Roundings of two sums of up to 30 terms of 1e3.
        prop_assert!(mixed >= lo - 1e-11 && mixed <= hi + 1e-11, "{mixed} outside [{lo}, {hi}]");
    }

    #[test]
    fn mixing_is_weighing_the_features(basis in wild_basis(), s in any_phase(), weights in vec(-1.0..1.0_f64, 30)) {
        let weights = &weights[..basis.count()];
        let mut features = vec![0.0; basis.count()];
        basis.features_into(s, &mut features);
        let [mixed, twice] = basis.mix(s, [weights, &weights.iter().map(|w| 2.0 * w).collect::<Vec<_>>()]);
        let weighed: f64 = features.iter().zip(weights).map(|(phi, w)| phi * w).sum();
        prop_assert!((mixed - weighed).abs() < 1e-14);
        prop_assert_eq!(twice, 2.0 * mixed); // doubling is exact
    }

    #[test]
    fn the_standard_basis_meets_at_its_overlap(n in 2..40_usize, decay in 1.0..10.0_f64, overlap in 0.05..0.95_f64) {
        let basis = Basis::equally_spaced(decay, overlap, vec![0.0; n], vec![0.0; n]).unwrap();
        let mut activations = vec![0.0; n];
        for i in 0..n - 1 {
            basis.activations_into(basis.centers()[i + 1], &mut activations);
            prop_assert!((activations[i] - overlap).abs() < 1e-12); // (c - c)^2 h, twice rounded
            prop_assert!((activations[i + 1] - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn the_time_family_is_gaussians_of_time(
        n in 2..40_usize, decay in 1.0..10.0_f64, overlap in 0.05..0.95_f64, t in -0.2..1.2_f64,
        weights in vec(-1.0..1.0_f64, 40),
    ) {
        let basis = Basis::equally_spaced_in_time(decay, overlap, vec![0.0; n], vec![0.0; n]).unwrap();
        let weights = &weights[..n];
        let s = (-decay * t).exp();
        // n exponentials of the time from start to end, which the basis does without; outside, time stands still.
        let spacings = t.clamp(0.0, 1.0) * (n - 1) as f64;
        let psi: Vec<f64> = (0..n).map(|i| overlap.powf((spacings - i as f64).powi(2))).collect();
        let sum: f64 = psi.iter().sum();
        let exact: f64 = psi.iter().zip(weights).map(|(psi, w)| psi * w).sum::<f64>() / sum;
        let [mixed] = basis.mix(s, [weights]);
        // Time is known to 1e-16 n, and an activation falls by at most 2 |ln 0.05| a spacing.
        prop_assert!((mixed - exact).abs() < 1e-12, "{mixed} {exact}");
        let (mut features, mut activations) = (vec![f64::NAN; n], vec![f64::NAN; n]);
        basis.features_into(s, &mut features);
        basis.activations_into(s, &mut activations);
        prop_assert!((features.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        for ((phi, activation), psi) in features.iter().zip(&activations).zip(&psi) {
            prop_assert!((phi - psi / sum).abs() < 1e-12 && (activation - psi).abs() < 1e-12);
        }
        let single = basis_in_single_precision(decay, overlap, n);
        let narrow: Vec<f32> = weights.iter().map(|&w| w as f32).collect();
        let [found] = single.mix(s as f32, [&narrow]);
        // The logarithm of a rounded phase knows the time to 1e-7 of n/decay spacings.
        prop_assert!((f64::from(found) - exact).abs() < 1e-4, "{found} {exact}");
    }

    #[test]
    fn the_time_family_mixes_at_every_phase(n in 2..40_usize, overlap in 0.01..0.99_f64, s in any_phase()) {
        let basis = Basis::equally_spaced_in_time(4.6, overlap, vec![0.0; n], vec![0.0; n]).unwrap();
        let [mixed] = basis.mix(s, [&vec![7.0; n]]);
        prop_assert!((mixed - 7.0).abs() < 1e-13, "{mixed}");
        let [mixed] = basis_in_single_precision(4.6, overlap, n).mix(s as f32, [&vec![7.0; n]]);
        prop_assert!((mixed - 7.0).abs() < 1e-5, "{mixed}");
    }

    #[test]
    fn offset_is_bounded_whatever_stiffness_damping_and_force_do(
        start in -1.0..1.0_f64,
        steps in vec((30.0..400.0_f64, 10.0..100.0_f64, -50.0..50.0_f64, 1e-4..1.0_f64), 1..60),
    ) {
        // |e| <= |e0| exp(-int k/d) + sup|f| / k_min
        let mut offset = start;
        let mut decayed = 0.0;
        let (mut largest_force, mut least_stiffness) = (0.0_f64, f64::INFINITY);
        for (k, d, force, dt) in steps {
            offset = step_offset(offset, k, d, force, dt);
            decayed += k / d * dt;
            largest_force = largest_force.max(force.abs());
            least_stiffness = least_stiffness.min(k);
            let bound = start.abs() * f64::exp(-decayed) + largest_force / least_stiffness;
            prop_assert!(offset.abs() <= bound + 1e-14, "{offset} above {bound}"); // 60 roundings of 1
        }
    }
}

macro_rules! total {
    ($module:ident, $float:ident, $any:ident, $slack:expr) => {
        mod $module {
            use super::*;

            const N: usize = 8;
            type Skill = HybridPrimitive<$float, [$float; N], 2>;

            /// Either law, of any mass that a skill takes with these gains.
            fn law() -> impl Strategy<Value = Law<$float>> {
                let damping = prop_oneof![
                    Just(Damping::Primitive),
                    (0.1..2.0 as $float, 1.0..20.0 as $float)
                        .prop_map(|(ratio, floor)| Damping::Ratio { ratio, floor }),
                ];
                let second = (-4.0..4.0 as $float, damping)
                    .prop_map(|(exponent, damping)| Law::SecondOrder { mass: <$float>::powf(10.0, exponent), damping });
                prop_oneof![Just(Law::FirstOrder), second]
            }

            fn axis() -> impl Strategy<Value = AxisPrimitives<$float, [$float; N]>> {
                let list = |lo: $float, hi: $float| vec(lo..=hi, N).prop_map(|list| list.try_into().unwrap());
                let movement = (-10.0..10.0 as $float, -10.0..10.0 as $float, 1.0..200.0 as $float);
                (movement, list(-1e3, 1e3), list(30.0, 400.0), list(10.0, 100.0), law()).prop_map(
                    |((start, goal, alpha), weights, stiffness, damping, law)| AxisPrimitives {
                        movement: Movement::new(start, goal, alpha, goal - start, weights).unwrap(),
                        stiffness: Gain::new(30.0, 400.0, stiffness).unwrap(),
                        damping: Gain::new(10.0, 100.0, damping).unwrap(),
                        law,
                    },
                )
            }

            fn skill() -> impl Strategy<Value = Skill> {
                (1e-3..1e3 as $float, 0.5..10.0 as $float, 0.1..0.9 as $float, axis(), axis()).prop_map(
                    |(duration, decay, overlap, x, y)| {
                        let basis = Basis::equally_spaced(decay, overlap, [0.0; N], [0.0; N]).unwrap();
                        HybridPrimitive::new(Phase::new(duration, decay).unwrap(), [basis; 3], [x, y]).unwrap()
                    },
                )
            }

            /// Any bit pattern, and often a plausible value or the worst ones.
            fn input(lo: $float, hi: $float) -> impl Strategy<Value = $float> {
                let worst = [$float::NAN, $float::INFINITY, $float::NEG_INFINITY, $float::MAX, $float::MIN, 0.0];
                prop_oneof![$any::ANY, lo..hi, prop::sample::select(worst.to_vec())]
            }

            proptest! {
                #[test]
                fn no_input_makes_a_step_fail(
                    skill in skill(),
                    inputs in vec((input(-50.0, 50.0), input(-50.0, 50.0), input(0.0, 1.0), input(0.0, 0.1)), 1..40),
                ) {
                    let mut state = skill.initial_state();
                    for (x, y, rate, dt) in inputs {
                        let before = state;
                        let commands = skill.step(&mut state, [x, y], rate, dt);
                        prop_assert!((0.0..=before.phase).contains(&state.phase), "{state:?}");
                        for ((axis, command), primitives) in state.axes.iter().zip(commands).zip(skill.axes()) {
                            let all = [
                                axis.reference.position, axis.reference.scaled_velocity, axis.offset,
                                axis.offset_velocity,
                                command.position, command.velocity, command.stiffness, command.damping,
                            ];
                            prop_assert!(
                                all.iter().all(|value| value.is_finite()),
                                "{axis:?} {command:?} after {x:e}, {y:e}, {rate:e}, {dt:e} from {before:?}"
                            );
                            // The bounds of the weights, up to the rounding of a mixture of eight.
                            prop_assert!(command.stiffness >= 30.0 * (1.0 - $slack), "{command:?}");
                            prop_assert!(command.stiffness <= 400.0 * (1.0 + $slack), "{command:?}");
                            let [least, most] = match primitives.law {
                                Law::SecondOrder { mass, damping: Damping::Ratio { ratio, floor } } => {
                                    [floor, floor.max(2.0 * ratio * (mass * 400.0).sqrt())]
                                }
                                _ => [10.0, 100.0],
                            };
                            prop_assert!(command.damping >= least * (1.0 - $slack), "{command:?}");
                            prop_assert!(command.damping <= most * (1.0 + $slack), "{command:?}");
                        }
                    }
                }

                #[test]
                fn a_force_that_is_no_number_leaves_the_offset_alone(skill in skill(), push in -50.0..50.0 as $float) {
                    let mut state = skill.initial_state();
                    skill.step(&mut state, [push, push], 1.0, 0.01);
                    let mut sound = state;
                    let [x, _] = state.axes;
                    for bad in [$float::NAN, $float::INFINITY, $float::NEG_INFINITY] {
                        skill.step(&mut state, [bad, push], 1.0, 0.01);
                        skill.step(&mut sound, [push, push], 1.0, 0.01);
                        prop_assert_eq!(state.axes[0].offset, x.offset);
                        // The other axis goes on as if nothing were wrong beside it.
                        prop_assert_eq!(state.axes[1], sound.axes[1]);
                    }
                }

                #[test]
                fn no_time_and_no_rate_are_what_they_say(skill in skill(), dt in input(-1.0, 0.0)) {
                    let mut state = skill.initial_state();
                    skill.step(&mut state, [0.0; 2], 1.0, 0.01);
                    let before = state;
                    // A dt that is not positive or not finite counts as zero: everything stands still.
                    if !(dt.is_finite() && dt > 0.0) {
                        skill.step(&mut state, [5.0; 2], 1.0, dt);
                        prop_assert_eq!(state.phase, before.phase);
                        prop_assert_eq!(state.axes[0].offset, before.axes[0].offset);
                    }
                    // A rate that is no number pauses.
                    skill.step(&mut state, [0.0; 2], $float::NAN, 0.01);
                    prop_assert_eq!(state.phase, before.phase);
                }

                #[test]
                fn a_movement_settles_on_its_goal_as_finely_as_its_steps_allow(
                    goal in -10.0..10.0 as $float,
                    position in -10.0..10.0 as $float,
                    velocity in -100.0..100.0 as $float,
                    alpha in 1.0..100.0 as $float,
                    dt in 1e-3..1.0 as $float,
                ) {
                    let mut state = MovementState { position, scaled_velocity: velocity };
                    let transition = Transition::new(alpha, dt);
                    let u = alpha / 2.0 * dt;
                    for _ in 0..(50.0 / u).ceil() as usize + 1 {
                        transition.apply(&mut state, goal, 0.0);
                    }
                    // u t = 50: (20 + 200 t) exp(-50) is 1e-19. The rest is rounding: a position stands still once its
                    // step, u/2 of the distance left, rounds to zero. In single precision, 0.9 m away at 1 kHz over
                    // 1 s, that is 2 um; over 10 s, 20 um.
                    let resolution = $float::EPSILON * goal.abs();
                    prop_assert!((state.position - goal).abs() <= resolution * (1.0 / u + 4.0) + 1e-15, "{state:?}");
                }

                #[test]
                fn a_skill_reaches_its_goal_to_the_last_bits_at_every_rate(
                    goal in -10.0..10.0 as $float,
                    alpha in 10.0..50.0 as $float,
                    rate in prop_oneof![Just(100.0 as $float), Just(1000.0), Just(8000.0)],
                ) {
                    let basis = Basis::equally_spaced(100.0_f64.ln() as $float, 0.6, [0.0; 4], [0.0; 4]).unwrap();
                    let axis = AxisPrimitives {
                        movement: Movement::new(0.0, goal, alpha, goal, [30.0, -20.0, 40.0, 10.0]).unwrap(),
                        stiffness: Gain::new(30.0, 400.0, [100.0; 4]).unwrap(),
                        damping: Gain::new(10.0, 100.0, [50.0; 4]).unwrap(),
                        law: Law::FirstOrder,
                    };
                    let phase = Phase::new(0.1, 100.0_f64.ln() as $float).unwrap();
                    let skill = HybridPrimitive::new(phase, [basis; 3], [axis]).unwrap();
                    let mut state = skill.initial_state();
                    for _ in 0..(2.0 * rate) as usize {
                        skill.step(&mut state, [0.0], 1.0, 1.0 / rate);
                    }
                    let gap = (state.axes[0].reference.position - goal).abs();
                    prop_assert!(gap <= $float::EPSILON * goal.abs(), "{state:?}");
                }

                #[test]
                fn an_endless_step_settles(skill in skill(), force in -50.0..50.0 as $float) {
                    for dt in [1e9, $float::MAX] {
                        let mut state = skill.initial_state();
                        skill.step(&mut state, [force; 2], 1.0, dt);
                        for (state, axis) in state.axes.iter().zip(skill.axes()) {
                            let gap = state.reference.position - axis.movement.goal();
                            prop_assert!(gap.abs() <= 10.0 * $slack, "{state:?}");
                            prop_assert!(state.offset.abs() <= force.abs() / 30.0 * (1.0 + $slack), "{state:?}");
                            prop_assert!(state.offset.abs() >= force.abs() / 400.0 * (1.0 - $slack), "{state:?}");
                        }
                    }
                }
            }
        }
    };
}

total!(single_precision, f32, any_f32, 1e-5);
total!(double_precision, f64, any_f64, 1e-13);

#[test]
fn a_step_past_the_end_of_a_phase_ends_at_zero() {
    // What the last step takes from the phase rounds to one more unit in the last place than there is.
    let axis = AxisPrimitives {
        movement: Movement::new(0.0, 1.0, 25.0, 1.0, [0.0; 2]).unwrap(),
        stiffness: Gain::new(30.0, 400.0, [100.0; 2]).unwrap(),
        damping: Gain::new(10.0, 100.0, [50.0; 2]).unwrap(),
        law: Law::FirstOrder,
    };
    let basis = Basis::equally_spaced(5.899_806_5, 0.5, [0.0; 2], [0.0; 2]).unwrap();
    let skill = HybridPrimitive::new(Phase::new(644.6029_f32, 5.899_806_5).unwrap(), [basis; 3], [axis]).unwrap();
    let mut state = skill.initial_state();
    skill.step(&mut state, [0.0; 1], 0.007_346_378, 0.090_926_5);
    skill.step(&mut state, [0.0; 1], 2.176_099_3e-6, f32::MAX);
    assert_eq!(state.phase, 0.0);
    skill.step(&mut state, [0.0; 1], 1.0, 1.0);
    assert_eq!(state.phase, 0.0);
}

#[test]
fn a_basis_that_can_be_built_can_be_mixed_at_every_phase() {
    // Far away or needle-sharp, all exponents overflow; such a basis is refused, so the mixture is always finite.
    for (centers, widths) in [
        ([1e200, 1e199], [1.0, 1.0]),
        ([-1e199, -1e200], [1.0, 1.0]),
        ([3.0, 2.0], [f64::MAX, f64::MAX]),
        ([1.0, 0.5], [f64::MAX, f64::MAX]),
        ([2.0, -1.0], [1e300, 1e-300]),
    ] {
        if let Ok(basis) = Basis::new(centers, widths) {
            for s in [0.0, 1e-300, 0.3, 1.0] {
                let [mixed] = basis.mix(s, [&[1.0, 2.0]]);
                assert!((1.0..=2.0).contains(&mixed), "{mixed} at {s} of {basis:?}");
            }
        }
    }
}

#[test]
fn narrow_functions_of_the_time_family_do_not_overflow() {
    // Half way between two centers u = 1/overlap = 100, and 100^39 is no number in single precision.
    let basis = basis_in_single_precision(4.6, 0.01, 40);
    for i in 0..=400_u16 {
        let [mixed] = basis.mix((-4.6 * f32::from(i) / 390.0).exp(), [&[7.0; 40]]);
        assert!((mixed - 7.0).abs() < 1e-5, "{mixed} at {i}");
    }
}

#[test]
fn a_basis_that_primitives_share_is_evaluated_once_and_alike() {
    let list = |scale: f64| -> [f64; 5] { core::array::from_fn(|i| 50.0 + scale * i as f64) };
    let axis = AxisPrimitives {
        movement: Movement::new(0.0, 1.0, 25.0, 1.0, list(3.0)).unwrap(),
        stiffness: Gain::new(30.0, 400.0, list(20.0)).unwrap(),
        damping: Gain::new(10.0, 100.0, list(10.0)).unwrap(),
        law: Law::FirstOrder,
    };
    let basis = |overlap: f64| Basis::equally_spaced(4.6, overlap, [0.0; 5], [0.0; 5]).unwrap();
    let in_time = Basis::equally_spaced_in_time(4.6, 0.6, [0.0; 5], [0.0; 5]).unwrap();
    let (a, b) = (basis(0.6), basis(0.7));
    for bases in [[a, a, a], [a, b, b], [a, b, a], [a, a, b], [in_time; 3], [a, in_time, in_time], [in_time, a, b]] {
        let skill = HybridPrimitive::new(Phase::new(1.0, 4.6).unwrap(), bases, [axis; 3]).unwrap();
        for s in [1.0, 0.4, 0.02] {
            let [movement, stiffness, damping] =
                [axis.movement.weights(), axis.stiffness.weights(), axis.damping.weights()];
            let profile = hpf_core::Profile {
                forcing: axis.movement.forcing(s, bases[0].mix(s, [movement])[0]),
                stiffness: bases[1].mix(s, [stiffness])[0],
                damping: bases[2].mix(s, [damping])[0],
            };
            assert_eq!(skill.at(s), [profile; 3]); // to the bit
        }
    }
}

#[test]
fn an_overlap_too_small_for_the_scalar_is_refused() {
    let mixed = |overlap: f32| {
        let basis = Basis::equally_spaced_in_time(4.6_f32, overlap, [0.0; 3], [0.0; 3])?;
        // Half way between two centers, where the powers are largest.
        Ok::<_, ConfigError>(basis.mix((-4.6_f32 / 4.0).exp(), [&[7.0; 3]]))
    };
    assert!((mixed(1e-37).unwrap()[0] - 7.0).abs() < 1e-5);
    let refused = mixed(1e-38).unwrap_err().to_string();
    assert_eq!(refused, "overlap to the power of minus its reach is not a finite number");
}

#[test]
fn a_basis_moves_to_other_storage_only_unchanged() {
    let bases = [Basis::equally_spaced, Basis::equally_spaced_in_time].map(|new| new(4.6, 0.6, [0.0; 3], [0.0; 3]));
    for basis in bases.map(Result::unwrap) {
        let stored = basis.stored(basis.centers(), basis.widths()).unwrap();
        assert_eq!(stored.mix(0.3, [&[1.0, 2.0, 3.0]]), basis.mix(0.3, [&[1.0, 2.0, 3.0]]));
        assert!(basis.stored([1.0, 0.5, 0.2], [1.0; 3]).is_err());
        assert!(basis.stored([1.0, 0.1], [1.0; 2]).is_err());
    }
}

/// What each constructor says when it refuses.
#[test]
fn every_refusal_names_its_culprit() {
    let basis = || Basis::equally_spaced(4.6, 0.6, [0.0; 3], [0.0; 3]).unwrap();
    let phase = || Phase::new(1.0, 4.6).unwrap();
    let skill = |n: [usize; 3]| {
        let axis = AxisPrimitives {
            movement: Movement::new(0.0, 1.0, 25.0, 1.0, vec![0.0; n[0]]).unwrap(),
            stiffness: Gain::new(30.0, 400.0, vec![100.0; n[1]]).unwrap(),
            damping: Gain::new(10.0, 100.0, vec![50.0; n[2]]).unwrap(),
            law: Law::FirstOrder,
        };
        let bases = [(); 3].map(|()| Basis::new(basis().centers().to_vec(), basis().widths().to_vec()).unwrap());
        HybridPrimitive::new(phase(), bases, [axis]).unwrap_err()
    };
    let at_rest = [0.0; 3];
    let refusals: [(ConfigError, &str); 28] = [
        (Phase::new(0.0, 4.6).unwrap_err(), "duration must be positive, not 0"),
        (Phase::new(f64::NAN, 4.6).unwrap_err(), "duration is not a finite number"),
        (Phase::new(1.0, -2.5).unwrap_err(), "decay must be positive, not -2.5"),
        (Phase::new(1.0, f64::INFINITY).unwrap_err(), "decay is not a finite number"),
        (Basis::new([1.0], [1.0]).unwrap_err(), "centers has 1 entries, at least 2 are needed"),
        (Basis::new(vec![1.0, 0.5], vec![1.0; 3]).unwrap_err(), "widths has 3 entries, 2 are needed"),
        (Basis::new([1.0, f64::NAN], [1.0; 2]).unwrap_err(), "centers is not a finite number"),
        (Basis::new([1.0, 0.5], [1.0, f64::NAN]).unwrap_err(), "widths is not a finite number"),
        (Basis::new([1.0, 0.5], [1.0, -3.0]).unwrap_err(), "widths must be positive, not -3"),
        (Basis::new([1.0, 1.0], [1.0; 2]).unwrap_err(), "centers must fall from each entry to the next"),
        (Basis::new([1e200, 0.5], [1.0; 2]).unwrap_err(), "widths times distance squared is not a finite number"),
        (Basis::equally_spaced(0.0, 0.6, [0.0; 2], [0.0; 2]).unwrap_err(), "decay must be positive, not 0"),
        (Basis::equally_spaced(4.6, 1.0, [0.0; 2], [0.0; 2]).unwrap_err(), "overlap must lie in [0, 1], not 1"),
        (Basis::equally_spaced(4.6, f64::NAN, [0.0; 2], [0.0; 2]).unwrap_err(), "overlap must lie in [0, 1], not NaN"),
        (
            Basis::equally_spaced(4.6, 0.6, [0.0; 1], [0.0; 1]).unwrap_err(),
            "centers has 1 entries, at least 2 are needed",
        ),
        (Movement::new(f64::NAN, 1.0, 25.0, 1.0, at_rest).unwrap_err(), "start is not a finite number"),
        (Movement::new(0.0, f64::NAN, 25.0, 1.0, at_rest).unwrap_err(), "goal is not a finite number"),
        (Movement::new(0.0, 1.0, 0.0, 1.0, at_rest).unwrap_err(), "alpha must be positive, not 0"),
        (Movement::new(0.0, 1.0, 25.0, f64::NAN, at_rest).unwrap_err(), "forcing_scale is not a finite number"),
        (Movement::new(0.0, 1.0, 25.0, 1.0, [f64::NAN]).unwrap_err(), "movement.weights is not a finite number"),
        (Gain::new(0.0, 400.0, [100.0]).unwrap_err(), "min must be positive, not 0"),
        (Gain::new(30.0, f64::NAN, [100.0]).unwrap_err(), "max is not a finite number"),
        (Gain::new(30.0, 20.0, [25.0]).unwrap_err(), "gain has its lower bound 30 above its upper bound 20"),
        (Gain::new(30.0, 400.0, [401.5]).unwrap_err(), "weights must lie in [30, 400], not 401.5"),
        (Gain::new(30.0, 400.0, [f64::NAN]).unwrap_err(), "weights is not a finite number"),
        (skill([2, 3, 3]), "movement.weights has 2 entries, 3 are needed"),
        (skill([3, 4, 3]), "stiffness.weights has 4 entries, 3 are needed"),
        (skill([3, 3, 0]), "damping.weights has 0 entries, 3 are needed"),
    ];
    for (refusal, text) in refusals {
        assert_eq!(refusal.to_string(), text);
    }
}
