//! The law is the skill's: a skill gives way by it, and so does a controller that is told nothing but the skill.

use crate::support::{DT, Family, Kind, Rig, settings, skill};
use hpf_core::admittance::{Inertial, OffsetMotion, step_offset};
use hpf_core::controller::Request;
use hpf_core::{ConfigError, Damping, Law};

const MASS: f64 = 2.0;

fn laws() -> [Law<f64>; 3] {
    let second = |damping| Law::SecondOrder { mass: MASS, damping };
    [Law::FirstOrder, second(Damping::Primitive), second(Damping::Ratio { ratio: 0.7, floor: 5.0 })]
}

fn push(i: usize) -> f64 {
    4.0 + 3.0 * (0.02 * i as f64).sin()
}

/// The offset after `steps` steps of each law by its own kernel, gains taken from the skill at mid-step.
fn offsets(law: Law<f64>, steps: usize, mut each: impl FnMut(usize, f64)) {
    let skill = skill::<f64, 1>(Family::Phase, 2.0);
    let inertial = Inertial::new(MASS, 400.0, 200.0, DT).unwrap();
    let mut motion = OffsetMotion { offset: 0.0, velocity: 0.0 };
    for i in 0..steps {
        let [profile] = skill.at((-4.605_17 * (i as f64 + 0.5) * DT / 2.0).exp());
        let damping = match law {
            Law::SecondOrder { mass, damping: Damping::Ratio { ratio, floor } } => {
                (2.0 * ratio * (mass * profile.stiffness).sqrt()).max(floor)
            }
            _ => profile.damping,
        };
        match law {
            Law::FirstOrder => {
                motion.offset = step_offset(motion.offset, profile.stiffness, damping, push(i), DT);
            }
            Law::SecondOrder { .. } => inertial.step(&mut motion, profile.stiffness, damping, push(i), DT),
        }
        each(i, motion.offset);
    }
}

#[test]
fn a_skill_and_a_controller_give_way_by_the_law_of_the_skill() {
    for law in laws() {
        let kind = Kind { family: Family::Phase, law };
        let skill = skill::<f64, 1>(kind, 2.0);
        let mut state = skill.initial_state();
        // Far from every limit.
        let mut settings = settings();
        (settings.axes[0].limits.velocity, settings.axes[0].limits.acceleration) = (10.0, 1e5);
        let mut rig = Rig::<f64, 1>::new(kind, settings, 2.0);
        rig.input.request = Some(Request::Start);
        offsets(law, 1500, |i, offset| {
            let [command] = skill.step(&mut state, [push(i)], 1.0, DT);
            assert!((state.axes[0].offset - offset).abs() < 1e-13, "{law:?} at {i}: {state:?}, not {offset}");
            assert_eq!(command.position, state.axes[0].reference.position + state.axes[0].offset);
            rig.input.measured_force = [push(i)];
            let axis = rig.step().axes[0];
            assert!((axis.offset - offset).abs() < 1e-12, "{law:?} at {i}: {axis:?}, not {offset}");
            rig.input.request = None;
        });
    }
}

#[test]
fn a_force_that_is_none_leaves_an_offset_with_inertia_at_rest() {
    let skill = skill::<f64, 1>(Kind { family: Family::Time, law: laws()[1] }, 2.0);
    let mut state = skill.initial_state();
    for _ in 0..100 {
        skill.step(&mut state, [20.0], 1.0, DT);
    }
    let moving = state.axes[0];
    assert!(moving.offset_velocity > 0.01);
    let [command] = skill.step(&mut state, [f64::NAN], 0.0, DT);
    assert_eq!((state.axes[0].offset, state.axes[0].offset_velocity, command.velocity), (moving.offset, 0.0, 0.0));
}

#[test]
fn a_law_that_cannot_be_makes_no_skill() {
    let refused = |law| skill::<f64, 1>(Family::Phase, 2.0).with_laws([law]).unwrap_err().to_string();
    let second = |mass, damping| Law::SecondOrder { mass, damping };
    assert_eq!(refused(second(0.0, Damping::Primitive)), "mass must be positive, not 0");
    assert_eq!(refused(second(f64::NAN, Damping::Primitive)), "mass is not a finite number");
    assert_eq!(
        refused(second(1e10, Damping::Primitive)),
        "mass must lie in [0.000000001, 1000000000], not 10000000000"
    );
    let ratio = |ratio, floor| Damping::Ratio { ratio, floor };
    assert_eq!(refused(second(1.0, ratio(1.0, 0.0))), "damping.floor must be positive, not 0");
    assert_eq!(refused(second(1.0, ratio(-1.0, 5.0))), "damping.ratio must be positive, not -1");
}

#[test]
fn a_mass_too_small_for_a_step_to_see_counts_as_none() {
    let of = |law| skill::<f64, 1>(Family::Time, 2.0).with_laws([law]).unwrap();
    let light = of(Law::SecondOrder { mass: 1e-5, damping: Damping::Primitive });
    let [mut state, mut without] = [light.initial_state(); 2];
    // At 30 to 100 N s/m it settles within 1e-7 s.
    let command = light.step(&mut state, [5.0], 1.0, 1e9);
    assert_eq!(command, of(Law::FirstOrder).step(&mut without, [5.0], 1.0, 1e9));
    assert!((state.axes[0].offset - 5.0 / command[0].stiffness).abs() < 1e-12 && state.axes[0].offset_velocity == 0.0);
}

#[test]
fn three_numbers_are_a_law_or_refused() {
    assert_eq!(Law::of(0.0, 0.0, 0.0), Ok(Law::FirstOrder));
    assert_eq!(Law::of(2.0, 0.0, 0.0), Ok(laws()[1]));
    assert_eq!(Law::of(2.0, 0.7, 5.0), Ok(laws()[2]));
    let unused = |field, value| Err(ConfigError::OutOfRange { field, value, min: 0.0, max: 0.0 });
    assert_eq!(Law::of(0.0, 0.7, 5.0), unused("damping.ratio", 0.7));
    assert_eq!(Law::of(2.0, 0.0, 5.0), unused("damping.floor", 5.0));
}
