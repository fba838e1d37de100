//! How far the real controller's motion is from the continuous simulation, by control rate: the table of
//! docs/embedding.md. The controller reads the force once a step and holds it: half a step late, so the distance halves
//! with the step.
//!
//! `cargo run --release -p hpf-sim --example controller_by_rate [POLICY TASK]...`; without, the policies that learning
//! starts from.

use std::fs;

use hpf_sim::robot::Settings;
use hpf_sim::{Policy, Simulation, Task};

const RATES: [f64; 5] = [250.0, 500.0, 1000.0, 2000.0, 4000.0];

const TASKS: [&str; 3] = [
    include_str!("../../../tasks/reach.toml"),
    include_str!("../../../tasks/via_point.toml"),
    include_str!("../../../tasks/wall.toml"),
];

fn row(mut task: Task, policy: &Policy) {
    let mut row = format!("| {} |", task.name);
    for rate in RATES {
        task.rate = rate;
        let simulation = Simulation::new(&task, policy).expect("policy and task belong together");
        let plain = simulation.rollout(&simulation.parameters(policy));
        let (run, _) = simulation.controlled(policy, &Settings::default()).expect("nothing is limited");
        let pairs = run.axes.iter().zip(&plain.axes).flat_map(|(a, b)| a.position.iter().zip(&b.position));
        let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        row += &format!(" {:.4} |", 1e3 * most);
    }
    println!("{row}");
}

fn main() {
    let head: Vec<String> = RATES.iter().map(|rate| format!(" {rate} Hz |")).collect();
    println!("| farthest from the continuous simulation [mm] |{}", head.concat());
    println!("|---|{}", "---|".repeat(RATES.len()));
    let files: Vec<String> = std::env::args().skip(1).collect();
    for pair in files.chunks_exact(2) {
        let [policy, task] =
            [&pair[0], &pair[1]].map(|file| fs::read_to_string(file).expect("a file that can be read"));
        row(Task::parse(&task).expect("a task"), &Policy::parse(&policy).expect("a policy"));
    }
    if files.is_empty() {
        for text in TASKS {
            let task = Task::parse(text).expect("a shipped task");
            let policy = Policy::initial(&task).expect("a shipped task has a policy");
            row(task, &policy);
        }
    }
}
