//! One stepper: a skill, its controller and a planned reference go the same way.

use hpf_core::controller::{Controller, Input, Request, Settings};
use hpf_core::limits::Limits;
use hpf_core::{
    AxisPrimitives, Basis, Gain, HybridPrimitive, Law, Movement, Phase, PhasePoint, PlannedReference, Transition,
};

const DURATION: f64 = 2.0;
const DT: f64 = 2e-3;
/// Of the movement, and of as much time after it: the forcing term fades meanwhile.
const STEPS: usize = 2000;

fn basis() -> Basis<f64, [f64; 9]> {
    Basis::equally_spaced(100.0_f64.ln(), 0.6, [0.0; 9], [0.0; 9]).unwrap()
}

/// Two axes with forcing of half a meter, each with its own alpha.
fn skill() -> HybridPrimitive<f64, [f64; 9], 2> {
    let axis = |goal: f64, alpha: f64, turn: f64| AxisPrimitives {
        movement: Movement::new(0.1, goal, alpha, 0.5, core::array::from_fn(|i| 90.0 * (turn * i as f64).cos()))
            .unwrap(),
        stiffness: Gain::new(30.0, 400.0, [100.0; 9]).unwrap(),
        damping: Gain::new(10.0, 100.0, [50.0; 9]).unwrap(),
        law: Law::FirstOrder,
    };
    let axes = [axis(0.6, 25.0, 1.1), axis(-0.4, 40.0, 0.7)];
    HybridPrimitive::new(Phase::new(DURATION, 100.0_f64.ln()).unwrap(), [basis(); 3], axes).unwrap()
}

/// Position and velocity of the reference of both axes after each step, by the skill itself.
fn stepped() -> Vec<[[f64; 2]; 2]> {
    let skill = skill();
    let mut state = skill.initial_state();
    let step = |_| {
        skill.step(&mut state, [0.0; 2], 1.0, DT);
        state.axes.map(|axis| [axis.reference.position, axis.reference.scaled_velocity / DURATION])
    };
    (0..STEPS).map(step).collect()
}

/// The largest difference between two motions.
fn distance(one: &[[[f64; 2]; 2]], other: &[[[f64; 2]; 2]]) -> f64 {
    assert_eq!((one.len(), other.len()), (STEPS, STEPS));
    let pairs = one.as_flattened().as_flattened().iter().zip(other.as_flattened().as_flattened());
    pairs.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

#[test]
fn a_planned_reference_goes_where_the_skill_goes_to_rounding() {
    let (skill, basis) = (skill(), basis());
    let axes = skill.axes().each_ref().map(|axis| {
        let m = &axis.movement;
        let planned = PlannedReference::new(m.start(), m.goal(), m.alpha(), m.forcing_scale(), DURATION, DT).unwrap();
        (planned, m)
    });
    let mut states = axes.map(|(planned, _)| planned.initial_state());
    let mut motion = Vec::new();
    for i in 0..STEPS {
        let PhasePoint { s, gate } = skill.phase().at((i as f64 + 0.5) * DT);
        let mut now = [[0.0; 2]; 2];
        for ((now, state), (planned, movement)) in now.iter_mut().zip(&mut states).zip(axes) {
            let [mixed] = basis.mix(s, [movement.weights()]);
            planned.step(state, planned.goal(), gate, mixed);
            *now = [state.position, planned.velocity(state)];
        }
        motion.push(now);
    }
    // Motions of a meter, and of several meters per second.
    let apart = distance(&motion, &stepped());
    assert!(apart < 2e-12, "{apart:e}");
    assert!(apart > 0.0, "two forms of the step that round alike are one");
}

#[test]
fn a_planned_step_is_the_transition_under_the_forcing_of_its_gate() {
    let planned = PlannedReference::new(0.1, 0.6, 25.0, 0.5, DURATION, DT).unwrap();
    let movement = Movement::new(0.1, 0.6, 25.0, 0.5, []).unwrap();
    let (mut found, mut exact) = (planned.initial_state(), movement.initial_state());
    for i in 0..100 {
        let (gate, mixed) = (1.0 - 0.01 * f64::from(i), 7.0 * f64::from(i));
        planned.step(&mut found, 0.6, gate, mixed);
        Transition::new(25.0, DT / DURATION).apply(&mut exact, 0.6, movement.forcing(gate, mixed));
        assert_eq!(found, exact);
    }
}

#[test]
fn a_controller_whose_limits_are_far_goes_where_the_skill_goes_to_rounding() {
    let limits = Limits { force: 50.0, offset: 1.0, velocity: 1e3, acceleration: 1e6, position: [-9.0, 9.0] };
    let mut controller = Controller::new(skill(), Settings::compliant([limits; 2]), [0.1; 2]).unwrap();
    let mut input = Input {
        measured_force: [0.0; 2],
        force_age: 0,
        measured_position: None,
        rate: 1.0,
        request: Some(Request::Start),
    };
    let mut motion = Vec::new();
    let mut last = [0.1; 2];
    for _ in 0..STEPS {
        let output = controller.update(&input, DT);
        input.request = None;
        assert_eq!(output, controller.output());
        let now = output.axes.map(|axis| axis.position - axis.offset);
        // Of a controller the velocity is what the command has gone by: the mean of the step.
        assert!(
            output
                .axes
                .iter()
                .zip(now.iter().zip(last))
                .all(|(axis, (now, last))| { (axis.velocity - (now - last) / DT).abs() < 1e-9 })
        );
        last = now;
        motion.push(now.map(|position| [position, 0.0]));
    }
    let stepped: Vec<[[f64; 2]; 2]> = stepped().into_iter().map(|axes| axes.map(|[x, _]| [x, 0.0])).collect();
    let apart = distance(&motion, &stepped);
    assert!(apart < 1e-13, "{apart:e}");
}
