//! What is computed on both sides: tasks are read, learned and measured; no clock, no file, no thread.

use hpf_learn::learn_with;
use hpf_sim::{Policy, Simulation, Task};

/// Tasks and the updates made of each: a movement alone, a contact, one with random forces.
const TASKS: [(&str, usize); 3] = [
    (include_str!("../../../tasks/via_point.toml"), 5),
    (include_str!("../../../tasks/cantilever.toml"), 3),
    (include_str!("../../../tasks/via_point_stochastic.toml"), 2),
];

/// How many results there are.
pub const COUNT: usize = 2 * TASKS.len();

/// Result `index`: of a task the learned weights and, after it, the motion, each as a checksum of its bits (FNV-1a).
pub fn result(index: usize) -> u64 {
    let (text, updates) = TASKS[index / 2];
    let mut task = Task::parse(text).expect("a shipped task is valid");
    task.learning.updates = updates;
    let policy = Policy::initial(&task).expect("a shipped task has a beginning");
    let simulation = Simulation::new(&task, &policy).expect("a shipped task can be simulated");
    let start = simulation.starting_weights(&policy).expect("a shipped task has weights");
    let method = task.learning.method();
    let learned = learn_with(&simulation, start, &method, None, |_| true).expect("a shipped task is learned");
    let weights = &learned.best.weights;
    if index % 2 == 0 {
        return checksum(weights.iter());
    }
    let motion = simulation.rollout(weights);
    checksum(motion.axes.iter().flat_map(|axis| axis.position.iter().chain(&axis.velocity)))
}

fn checksum<'n>(numbers: impl Iterator<Item = &'n f64>) -> u64 {
    let bytes = numbers.flat_map(|number| number.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// The same for a host that knows numbers only.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_result(index: u32) -> u64 {
    result(index as usize)
}
