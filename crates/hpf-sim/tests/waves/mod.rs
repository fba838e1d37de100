//! Weights that have no short decimal form. The end-to-end tests use them too.

use hpf_sim::{Policy, Task};

/// The policy of `task` with weights that rise and fall within their bounds.
pub fn policy(task: &Task) -> Policy {
    let mut policy = Policy::initial(task).unwrap();
    for (a, axis) in policy.axes.iter_mut().enumerate() {
        let wave = |i: usize, speed: f64| (speed * i as f64 + a as f64).sin();
        axis.movement.weights.iter_mut().enumerate().for_each(|(i, w)| *w = 60.0 * wave(i, 1.1));
        axis.stiffness.weights.iter_mut().enumerate().for_each(|(i, w)| *w = 200.0 + 150.0 * wave(i, 0.7));
        axis.damping.weights.iter_mut().enumerate().for_each(|(i, w)| *w = 50.0 + 35.0 * wave(i, 0.9));
    }
    policy
}
