//! What the first motions of learning from a model cost, over several seeds: the table of docs/learning.md.
//!
//! `cargo run --release -p hpf-sim --example motions_to_target [SEEDS [PART OF A NAME]]`

use std::time::Instant;

use hpf_learn::{LearningLoop, Session};
use hpf_sim::{Policy, Simulation, Task};

const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");
const CANTILEVER: &str = include_str!("../../../tasks/cantilever.toml");
const MOVING_LOAD: &str = include_str!("../../../tasks/cantilever_moving_load.toml");
const WALL: &str = include_str!("../../../tasks/wall.toml");
const ONE_AXIS: &str = include_str!("../tests/data/learning/force_one_axis.toml");
const BETWEEN: &str = include_str!("../tests/data/learning/via_between.toml");
const BEHIND: &str = include_str!("../tests/data/learning/via_behind_start.toml");
const HARD: &str = include_str!("../tests/data/learning/wall_hard.toml");

/// Motions that are shown.
const SHOWN: usize = 8;

struct Row {
    name: &'static str,
    task: &'static str,
    /// Replacements in its text.
    changes: &'static [(&'static str, &'static str)],
    /// Noise of recorded positions [m] and forces [N].
    noise: [f64; 2],
}

impl Row {
    fn task(&self, seed: u64) -> Task {
        let mut text = self.task.to_owned();
        for (from, to) in self.changes {
            assert!(text.contains(from), "{}: no {from}", self.name);
            text = text.replace(from, to);
        }
        let [position, force] = self.noise;
        text = text.lines().filter(|line| !line.starts_with("rest = ")).map(|line| format!("{line}\n")).collect();
        text += &format!("\n[recording]\nposition_noise = {position}\nforce_noise = {force}\n");
        let mut task = Task::parse(&text).unwrap_or_else(|found| panic!("{}: {found:?}", self.name));
        task.learning.method = hpf_sim::task::Method::Model;
        task.learning.max_rollouts = None;
        task.learning.seed = seed;
        task
    }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(values.len() - 1) / 2]
}

fn main() {
    let seeds: u64 = std::env::args().nth(1).map_or(5, |seeds| seeds.parse().expect("a number of seeds"));
    let part = std::env::args().nth(2).unwrap_or_default();
    const TRACKING: (&str, &str) = ("contact_force = 0.1", "contact_force = 0.0");
    let row = |name, task, changes, noise| Row { name, task, changes, noise };
    let rows = [
        row("Task 1", VIA_POINT, &[], [0.0; 2]),
        row("Task 1, 0.2 mm and 0.2 N", VIA_POINT, &[], [0.2e-3, 0.2]),
        row("Task 2", CANTILEVER, &[TRACKING], [0.0; 2]),
        row("Task 2, 0.02 mm and 0.2 N", CANTILEVER, &[TRACKING], [0.02e-3, 0.2]),
        row("Task 2, moving load", MOVING_LOAD, &[TRACKING], [0.0; 2]),
        row("Task 2, moving load, 0.02 mm and 0.2 N", MOVING_LOAD, &[TRACKING], [0.02e-3, 0.2]),
        row("wall 5e3", WALL, &[], [0.0; 2]),
        row("wall 5e3, 0.1 mm and 0.2 N", WALL, &[], [0.1e-3, 0.2]),
        row("wall 1e3", WALL, &[("stiffness = 5000.0", "stiffness = 1e3")], [0.0; 2]),
        row("wall 1e3, 0.1 mm and 0.2 N", WALL, &[("stiffness = 5000.0", "stiffness = 1e3")], [0.1e-3, 0.2]),
        row("wall 1e5", WALL, &[("stiffness = 5000.0", "stiffness = 1e5")], [0.0; 2]),
        row("wall 1e5, 0.1 mm and 0.2 N", WALL, &[("stiffness = 5000.0", "stiffness = 1e5")], [0.1e-3, 0.2]),
        row("wall 1e6", WALL, &[("stiffness = 5000.0", "stiffness = 1e6")], [0.0; 2]),
        row("wall 1e6, 0.1 mm and 0.2 N", WALL, &[("stiffness = 5000.0", "stiffness = 1e6")], [0.1e-3, 0.2]),
        row("case: force on one axis", ONE_AXIS, &[], [0.0; 2]),
        row("case: via point without a time", BETWEEN, &[], [0.0; 2]),
        row("case: via point behind the start", BEHIND, &[], [0.0; 2]),
        row("case: hard wall", HARD, &[], [0.0; 2]),
    ];
    println!("median (worst) of {seeds} seeds: noiseless cost of the cheapest recorded motion so far");
    for row in rows.iter().filter(|row| row.name.contains(&part)) {
        let mut costs = vec![Vec::new(); SHOWN];
        let (mut deviations, mut times, mut ends) = (Vec::new(), Vec::new(), Vec::new());
        for seed in 1..=if row.noise == [0.0; 2] { 1 } else { seeds } {
            let task = row.task(seed);
            let policy = Policy::initial(&task).expect("a task");
            let simulation = Simulation::new(&task, &policy).expect("a task");
            let start = simulation.starting_weights(&policy).expect("a task");
            let session = Session::begin(&simulation, start, &task.learning.method(), None).expect("a model");
            let mut driver = LearningLoop::new(&simulation, session);
            let (mut recorded, mut cheapest) = (f64::INFINITY, f64::INFINITY);
            let mut deviation = None;
            for slot in &mut costs {
                let begun = Instant::now();
                if let Some(progress) = driver.advance().expect("motions")
                    && progress.total < recorded
                {
                    recorded = progress.total;
                    let (cost, metrics) = simulation.evaluate(&progress.weights);
                    cheapest = cost.total();
                    deviation = metrics.into_iter().find(|metric| metric.name == "max_deviation").map(|m| m.value);
                }
                times.push(begun.elapsed().as_secs_f64());
                slot.push(cheapest);
            }
            deviations.extend(deviation.map(|deviation| 1e3 * deviation));
            ends.push(driver.session().history().stop);
        }
        println!("{}", row.name);
        for costs in &mut costs {
            let middle = median(costs);
            print!("  {middle:.4} ({:.4})", costs[costs.len() - 1]);
        }
        let middle = median(&mut times);
        println!("\n  {:.0} ms per motion, at most {:.0} ms", 1e3 * middle, 1e3 * times[times.len() - 1]);
        if !deviations.is_empty() {
            let middle = median(&mut deviations);
            println!("  deviation {middle:.4} ({:.4}) mm", deviations[deviations.len() - 1]);
        }
        println!("  {:?}", ends[0]);
    }
}
