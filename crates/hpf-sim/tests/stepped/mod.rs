//! Rollouts, and the same made by stepping the controller that a robot runs.

use hpf_core::controller::{Controller, Input, Mode, Request, Settings};
use hpf_core::limits::Limits;
use hpf_sim::{Policy, Simulation, Task};

/// The task in `text`, its policy before learning, and what makes its rollouts.
pub fn prepared(text: &str) -> (Task, Policy, Simulation) {
    let task = Task::parse(text).unwrap();
    let policy = Policy::initial(&task).unwrap();
    let simulation = Simulation::new(&task, &policy).unwrap();
    (task, policy, simulation)
}

/// The commanded positions of both axes after every step [m].
///
/// `forces` are those at mid-steps [N]: the controller holds the force that it measures over a step.
pub fn stepped(policy: &Policy, forces: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let limits = Limits { force: 1e3, offset: 10.0, velocity: 1e3, acceleration: 1e6, position: [-10.0, 10.0] };
    let mut settings = Settings::compliant([limits; 2]);
    settings.timing.longest_step = 1.0;
    // At full speed from the first step on, as a rollout is.
    settings.timing.ramp = 1e-9;
    let start = [policy.axes[0].start, policy.axes[1].start];
    let mut controller = Controller::new(policy.to_hybrid::<2>().unwrap(), settings, start).unwrap();
    let dt = policy.duration_s / forces.len() as f64;
    let mut input = Input { measured_force: [0.0; 2], force_age: 0, measured_position: None, rate: 1.0, request: None };
    let steps = forces.iter().enumerate().map(|(i, &measured_force)| {
        let request = (i == 0).then_some(Request::Start);
        input = Input { measured_force, request, ..input };
        let output = controller.update(&input, dt);
        assert_eq!(output.mode, Mode::Run, "at step {i}");
        output.axes.map(|axis| axis.position)
    });
    steps.collect()
}
