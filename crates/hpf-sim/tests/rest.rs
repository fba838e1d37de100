//! After the end: what the simulator says of the rest time is what a controller does, and a learned skill stays where it
//! is to rest.

use hpf_core::controller::{Controller, Input, Request, Settings};
use hpf_core::limits::Limits;
use hpf_learn::learn_with;
use hpf_sim::environment::disturbance::Side;
use hpf_sim::task::{Method, PerAxis};
use hpf_sim::{Metric, Policy, Simulation, Task, disturbances};

/// Rate of the control loop [Hz].
const RATE: f64 = 1000.0;

fn parse(text: &str) -> Task {
    Task::parse(text).unwrap_or_else(|found| panic!("{found:?}"))
}

/// The policy that `task` learns as it is shipped, and its measures.
fn learned(task: &Task) -> (Policy, Vec<Metric>) {
    let policy = Policy::initial(task).unwrap();
    let simulation = Simulation::new(task, &policy).unwrap();
    let start = simulation.starting_weights(&policy).unwrap();
    let history =
        learn_with(&simulation, start, &task.learning.method(), task.learning.max_rollouts, |_| true).unwrap();
    let metrics = simulation.evaluate(&history.best.weights).1;
    (policy.with_weights(&history.best.weights).unwrap(), metrics)
}

/// Distances to the goal of `task` after its duration, over three durations, by the controller that a robot runs, the
/// forces as `task` has them in each of its draws.
fn distances<const D: usize>(task: &Task, policy: &Policy) -> Vec<f64> {
    let limits = Limits { force: 1e3, offset: 10.0, velocity: 1e3, acceleration: 1e6, position: [-10.0, 10.0] };
    let mut settings = Settings::compliant([limits; D]);
    settings.timing.ramp = 1e-9;
    let start: [f64; D] = core::array::from_fn(|a| policy.axes[a].start);
    let contact = task.contact.as_ref().map(|contact| (task.axis_index(contact.axis()).unwrap(), contact));
    let mut found = Vec::new();
    for draw in disturbances(task) {
        let mut controller = Controller::new(policy.to_hybrid::<D>().unwrap(), settings, start).unwrap();
        let mut request = Some(Request::Start);
        let mut position = start;
        let steps = (4.0 * task.duration * RATE) as usize;
        for i in 0..steps {
            let time = i as f64 / RATE;
            let measured_force = core::array::from_fn(|a| {
                let name = &task.axis[a].name;
                let pushes = draw.iter().filter(|push| push.axis() == name);
                // A force known over time is held at its value in the middle of the step.
                let push: f64 = pushes.map(|push| push.force(time + 0.5 / RATE, Side::After)).sum();
                let touch = contact.filter(|(axis, _)| *axis == a).map_or(0.0, |(_, contact)| {
                    let surface = contact.surface(time / task.duration, policy.axes[a].start);
                    surface.direction * (surface.set_point - surface.contact_force(position[a]))
                });
                push + touch
            });
            let input =
                Input { measured_force, force_age: 0, measured_position: None, rate: 1.0, request: request.take() };
            let output = controller.update(&input, 1.0 / RATE);
            position = output.axes.map(|axis| axis.position);
            if time >= task.duration {
                let square: f64 = task.axis.iter().zip(position).map(|(axis, x)| (x - axis.goal).powi(2)).sum();
                found.push(square.sqrt());
            }
        }
    }
    found
}

/// The largest distance, and the root of the mean square.
fn largest_and_mean(distances: &[f64]) -> [f64; 2] {
    let square = distances.iter().map(|x| x * x).sum::<f64>() / distances.len() as f64;
    [distances.iter().copied().fold(0.0, f64::max), square.sqrt()]
}

fn measured(metrics: &[Metric], name: &str) -> Option<f64> {
    metrics.iter().find(|metric| metric.name == name).map(|metric| metric.value)
}

/// What a controller at 1 kHz makes of the skill that the task in `text` learns as it is shipped.
fn rests<const D: usize>(text: &str) -> ([f64; 2], Vec<Metric>) {
    let task = parse(text);
    let (policy, metrics) = learned(&task);
    (largest_and_mean(&distances::<D>(&task, &policy)), metrics)
}

#[test]
fn every_shipped_skill_stays_within_two_millimetres_of_its_goal_after_its_end() {
    for (name, [most, _], metrics) in [
        ("via_point", rests::<2>(include_str!("../../../tasks/via_point.toml"))),
        ("dmpbbo_via_point", rests::<2>(include_str!("../../../tasks/dmpbbo_via_point.toml"))),
        ("cantilever", rests::<1>(include_str!("../../../tasks/cantilever.toml"))),
        ("cantilever_moving_load", rests::<1>(include_str!("../../../tasks/cantilever_moving_load.toml"))),
        ("cantilever_robot", rests::<1>(include_str!("../../../tasks/cantilever_robot.toml"))),
        ("wall", rests::<1>(include_str!("../../../tasks/wall.toml"))),
        // In rad.
        ("joint", rests::<1>(include_str!("../../../tasks/joint.toml"))),
    ]
    .map(|(name, (distances, metrics))| (name, distances, metrics))
    {
        let simulated = measured(&metrics, "max_rest_error").unwrap();
        assert!(most < 2e-3 && simulated < 2e-3, "{name}: {most} by the controller, {simulated} by the simulator");
        // A force held over steps of 1 ms, and a path sampled ten times as often.
        assert!((most - simulated).abs() < 2e-4, "{name}: {most} by the controller, {simulated} by the simulator");
    }
}

#[test]
fn where_a_force_lasts_or_is_drawn_a_skill_rests_in_the_mean() {
    // A lasting force of 2 N moves even the stiffest spring allowed, 400 N/m, by 5 mm.
    let ([_, mean], metrics) = rests::<1>(include_str!("../../../tasks/reach.toml"));
    assert!((5e-3..6e-3).contains(&mean), "{mean}");
    assert!(measured(&metrics, "rms_rest_error").unwrap() < 6e-3);
    let ([_, mean], _) = rests::<2>(include_str!("../../../tasks/via_point_stochastic.toml"));
    assert!(mean < 2e-3, "{mean}");
}

#[test]
fn without_the_term_task_1_costs_what_it_did_and_swings_after_its_end() {
    let mut task = parse(include_str!("../../../tasks/via_point.toml"));
    task.learning.method = Method::Auto;
    task.learning.max_rollouts = Some(1000);
    let (_, resting) = learned(&task);
    task.cost.rest = PerAxis::All(0.0);
    let (policy, metrics) = learned(&task);
    let [cost, with_rest] = [&metrics, &resting].map(|metrics| measured(metrics, "max_cost").unwrap());
    assert!((cost - 0.0967).abs() < 5e-4, "{cost}");
    // The price of rest: a tenth more.
    assert!((0.100..0.115).contains(&with_rest), "{with_rest}");
    assert!(measured(&resting, "max_rest_error").unwrap() < 1e-3);
    let [most, _] = largest_and_mean(&distances::<2>(&task, &policy));
    assert!(most > 20e-3 && measured(&metrics, "max_rest_error").unwrap() > 20e-3, "{most}");
}
