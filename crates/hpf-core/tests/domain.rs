//! The domain: what is outside is refused by name, and from its corners no step leads out of the finite numbers.

use crate::support::{Family, settings, skill};
use hpf_core::controller::{AxisSettings, Compliance, Controller, Input, Request, Settings};
use hpf_core::limits::Limits;
use hpf_core::passivity::EnergyTank;
use hpf_core::{
    AxisPrimitives, Basis, Damping, Gain, HybridPrimitive, Law, Movement, MovementState, Phase, Real, Transition,
};

#[test]
fn constructors_refuse_what_lies_outside() {
    let rest = [0.0; 2];
    for outside in [1e-310, 1e-10, 1.001e9, 1e300, 0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Phase::new(outside, 4.6).is_err(), "duration {outside}");
        assert!(Gain::new(outside, outside, [outside]).is_err(), "gain {outside}");
        assert!(Gain::new(1e-9, outside, [1e-9]).is_err(), "gain {outside}");
        assert!(EnergyTank::new(outside, 0.0, 1.0, 1.0).is_err(), "capacity {outside}");
        assert!(EnergyTank::new(1.0, 0.0, 1.0, outside).is_err(), "power {outside}");
        let refused = |change: &dyn Fn(&mut Settings<f64, 1>)| {
            let mut settings = settings();
            change(&mut settings);
            Controller::new(skill::<f64, 1>(Family::Time, 2.0), settings, [0.0]).is_err()
        };
        assert!(refused(&|s| s.axes[0].limits.force = outside));
        assert!(refused(&|s| s.axes[0].limits.offset = outside));
        assert!(refused(&|s| s.axes[0].limits.velocity = outside));
        assert!(refused(&|s| s.axes[0].limits.acceleration = outside));
        assert!(refused(&|s| s.axes[0].trip_force = outside));
        assert!(refused(&|s| s.axes[0].tracking = outside));
        assert!(refused(&|s| s.conditioning.cutoff = Some(outside)));
        assert!(refused(&|s| s.timing.longest_step = outside));
        let refused = |law| skill::<f64, 1>(Family::Time, 2.0).with_laws([law]).is_err();
        assert!(refused(Law::SecondOrder { mass: outside, damping: Damping::Primitive }));
        let ratio = |ratio, floor| Law::SecondOrder { mass: 1.0, damping: Damping::Ratio { ratio, floor } };
        assert!(refused(ratio(outside, 1.0)));
        assert!(refused(ratio(1.0, outside)));
    }
    for outside in [1.001e9, -1.001e9, 1e300, f64::NAN, f64::INFINITY] {
        assert!(Movement::new(outside, 0.0, 25.0, 1.0, rest).is_err(), "start {outside}");
        assert!(Movement::new(0.0, outside, 25.0, 1.0, rest).is_err(), "goal {outside}");
        assert!(Movement::new(0.0, 0.0, 25.0, outside, rest).is_err(), "forcing_scale {outside}");
        assert!(Movement::new(0.0, 0.0, 25.0, 1.0, [outside, 0.0]).is_err(), "weights {outside}");
    }
    assert!(Movement::new(0.0, 0.0, 25.0, 1e4, [-1e9, 0.0]).is_err(), "scale times weight");
    for alpha in [9e-4, 1.1e6, 1e300] {
        assert!(Movement::new(0.0, 0.0, alpha, 1.0, rest).is_err(), "alpha {alpha}");
    }
    for decay in [9e-4, 100.1, 1e300] {
        assert!(Phase::new(1.0, decay).is_err(), "decay {decay}");
    }
    assert!(Phase::new(1.0, 100.0).is_ok() && Phase::new(1.0_f32, 60.1).is_err());
    let refused = Gain::new(1e-310, 100.0, [1.0]).unwrap_err().to_string();
    assert!(refused.starts_with("min must lie in [0.000000001, 1000000000], not 0.0000"), "{refused}");
    // The edges belong to the domain, in single precision too, where they are rounded.
    assert!(Gain::new(1e-9_f32, 1e9, [1e-9, 1e9]).is_ok());
    assert!(Phase::new(1e-9_f32, 1e-3).is_ok() && Phase::new(1e9_f32, 60.0).is_ok());
}

macro_rules! corners {
    ($name:ident, $float:ident) => {
        mod $name {
            use super::*;

            /// A skill of one axis at a corner.
            fn skill(
                [k, d]: [f64; 2],
                [alpha, duration, decay]: [f64; 3],
                goal: f64,
            ) -> HybridPrimitive<$float, [$float; 3], 1> {
                let of = |value: f64| value as $float;
                let basis = Basis::equally_spaced_in_time(of(decay), 0.6, [0.0; 3], [0.0; 3]).unwrap();
                let weight = (1e9 / goal.abs().max(1.0)).min(1e9);
                let axis = AxisPrimitives {
                    movement: Movement::new(0.0, of(goal), of(alpha), of(goal), [of(weight * 0.99); 3]).unwrap(),
                    stiffness: Gain::new(of(k), of(k), [of(k); 3]).unwrap(),
                    damping: Gain::new(of(d), of(d), [of(d); 3]).unwrap(),
                    law: Law::FirstOrder,
                };
                HybridPrimitive::new(Phase::new(of(duration), of(decay)).unwrap(), [basis; 3], [axis]).unwrap()
            }

            #[test]
            fn every_step_of_a_skill_is_finite() {
                for k in [1e-9, 1.0, 1e9] {
                    for d in [1e-9, 1.0, 1e9] {
                        for alpha in [1e-3, 25.0, 1e6] {
                            for duration in [1e-9, 1.0, 1e9] {
                                for decay in [1e-3, 4.6, 60.0] {
                                    for dt in [1e-12, 1e-3, 1.0, 1e8, 1e9, 1e30] {
                                        let skill = skill([k, d], [alpha, duration, decay], 1e9);
                                        let mut state = skill.initial_state();
                                        for step in 0..6 {
                                            let force = [1e30, -1e9, 50.0][step % 3] as $float;
                                            let [out] = skill.step(&mut state, [force], 1.0, dt as $float);
                                            let [axis] = state.axes;
                                            let all = [
                                                out.position,
                                                out.velocity,
                                                out.stiffness,
                                                out.damping,
                                                state.phase,
                                                state.phase_remainder,
                                                axis.reference.position,
                                                axis.reference.scaled_velocity,
                                                axis.remainder.position,
                                                axis.remainder.scaled_velocity,
                                                axis.offset,
                                                axis.offset_velocity,
                                            ];
                                            assert!(
                                                all.iter().all(|value| value.is_finite()),
                                                "k {k} d {d} alpha {alpha} duration {duration} decay {decay} dt {dt}: \
                                                 {out:?} {state:?}"
                                            );
                                        }
                                    }
                                }
                            }
                        }
                    }
                }
            }

            #[test]
            fn every_update_of_a_controller_is_finite() {
                let of = |value: f64| value as $float;
                for (k, d) in [(1e9, 1e-9), (1e-9, 1e9), (1e9, 1e9), (1e-9, 1e-9), (100.0, 50.0)] {
                    for mass in [None, Some(1e-9), Some(1.0), Some(1e9)] {
                        for wide in [1e-9, 1.0, 1e9] {
                            for step in [1e-6, 1e-3, 1.0] {
                                let limits = Limits {
                                    force: of(wide),
                                    offset: of(wide),
                                    velocity: of(wide),
                                    acceleration: of(wide),
                                    position: [-1e9, 1e9],
                                };
                                let mut settings = Settings::compliant([limits]);
                                settings.axes[0] = AxisSettings { trip_force: 1e9, tracking: 1e9, ..settings.axes[0] };
                                let law = mass.map_or(Law::FirstOrder, |mass| Law::SecondOrder {
                                    mass: of(mass),
                                    damping: Damping::Primitive,
                                });
                                settings.axes[0].compliance = Compliance::Press(of(wide));
                                settings.conditioning.cutoff = Some(1e9);
                                settings.tank = EnergyTank::new(of(wide), 0.0, 1.0, of(wide)).ok();
                                settings.timing.longest_step = of(step);
                                let made = skill([k, d], [1e6, 1e-9, 4.6], 1e8)
                                    .with_laws([law])
                                    .and_then(|skill| Controller::new(skill, settings, [0.0]));
                                // Of the second order, steps without a right digit are refused.
                                let Ok(mut arm) = made else {
                                    assert!(mass.is_some(), "k {k} d {d} wide {wide}: {made:?}");
                                    continue;
                                };
                                for update in 0..60 {
                                    let input = Input {
                                        measured_force: [of([1e30, -1e9, 3.0][update % 3])],
                                        force_age: 0,
                                        measured_position: None,
                                        rate: 1.0,
                                        request: (update == 0).then_some(Request::Start),
                                    };
                                    let out = arm.update(&input, of(step));
                                    let [axis] = out.axes;
                                    let all =
                                        [axis.position, axis.velocity, axis.offset, axis.force, out.energy, out.phase];
                                    assert!(
                                        all.iter().all(|value| value.is_finite()),
                                        "k {k} d {d} mass {mass:?} wide {wide} step {step}, update {update}: {out:?}"
                                    );
                                }
                            }
                        }
                    }
                }
            }

            #[test]
            fn a_transition_of_any_spring_factor_and_step_is_finite() {
                for alpha in [1e-30, 1e-3, 25.0, 1e6, 1e30] {
                    for dt in [0.0, 1e-30, 1.0, 1e9, 1e38] {
                        let mut state = MovementState { position: 1e9, scaled_velocity: -1e9 };
                        Transition::<$float>::new(of(alpha), of(dt)).apply(&mut state, -1e9, 1e9);
                        assert!(
                            state.position.is_finite() && state.scaled_velocity.is_finite(),
                            "{alpha} {dt}: {state:?}"
                        );
                    }
                }
            }

            fn of(value: f64) -> $float {
                <$float as Real>::of(value)
            }
        }
    };
}

corners!(single_precision, f32);
corners!(double_precision, f64);
