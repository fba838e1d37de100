//! Motions that each method needs for a cost, over 20 seeds: the table of docs/learning.md.
//!
//! `cargo run --release -p hpf-sim --example rollouts_to_target [SEEDS [PART OF A NAME]]`

use core::sync::atomic::{AtomicU64, Ordering};

use hpf_learn::{
    AutoOptions, Block, Cost, Draws, GaussNewtonOptions, History, LearnError, Method, Parameters, Pi2Options, Problem,
    SignalModel, learn_with,
};
use hpf_sim::task::PerAxis;
use hpf_sim::{Policy, Simulation, Task, Workspace};

const VIA_POINT: &str = include_str!("../../../tasks/via_point.toml");
const CANTILEVER: &str = include_str!("../../../tasks/cantilever.toml");

/// What of a simulation a learner sees.
#[derive(Clone, Copy, PartialEq)]
enum Seen {
    Signals,
    /// Signals with white noise on every measured position [m].
    Noisy(f64),
    CostsOnly,
}

/// A simulation as a learner sees it.
struct View<'s> {
    simulation: &'s Simulation,
    seen: Seen,
    seed: u64,
    /// Rollouts of the same parameters differ in their noise: those are counted by their weights.
    rollouts: AtomicU64,
}

impl View<'_> {
    /// A normal number for each index, the same for the same rollout.
    fn normal(&self, stream: u64, index: u64) -> f64 {
        let unit = |salt: u64| {
            let mut mixed = self.seed ^ stream.rotate_left(17) ^ (2 * index + salt).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            for _ in 0..3 {
                mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            }
            ((mixed >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        (-2.0 * unit(0).ln()).sqrt() * (core::f64::consts::TAU * unit(1)).cos()
    }
}

impl Problem for View<'_> {
    type Workspace = Workspace;

    fn blocks(&self) -> &[Block] {
        self.simulation.blocks()
    }

    fn steps(&self) -> usize {
        self.simulation.steps()
    }

    fn terms(&self) -> &[&'static str] {
        self.simulation.terms()
    }

    fn workspace(&self) -> Workspace {
        self.simulation.workspace()
    }

    fn rollout(&self, draws: Draws, parameters: Parameters<'_>, workspace: &mut Workspace, cost: &mut Cost) {
        Problem::rollout(self.simulation, draws, parameters, workspace, cost);
    }

    fn signals(&self) -> Option<&SignalModel> {
        if self.seen == Seen::CostsOnly { None } else { self.simulation.signals() }
    }

    fn measure(
        &self,
        draws: Draws,
        parameters: Parameters<'_>,
        workspace: &mut Workspace,
        cost: &mut Cost,
        signals: &mut Vec<f64>,
    ) {
        self.simulation.measure(draws, parameters, workspace, cost, signals);
        if let (Seen::Noisy(deviation), Some(trace)) = (self.seen, &mut workspace.trace) {
            // One thread makes the rollouts of a view with noise, so the count is the same in every run.
            let stream = self.rollouts.fetch_add(1, Ordering::Relaxed) << 32;
            for (a, axis) in trace.axes.iter_mut().enumerate() {
                for (i, position) in axis.position.iter_mut().enumerate() {
                    *position += deviation * self.normal(stream, (a << 24 | i) as u64);
                }
            }
            *cost = self.simulation.cost(trace);
            self.simulation.signals_into(trace, signals);
        }
    }
}

struct Row {
    name: &'static str,
    task: &'static str,
    seen: Seen,
    method: fn(&Task, u64) -> Method,
    marks: &'static [usize],
}

fn gauss_newton(_: &Task, seed: u64) -> Method {
    Method::GaussNewton(GaussNewtonOptions { rollouts: 5, updates: 10_000, seed })
}

/// PI2 with the noise and the schedule of the task, made for it.
fn pi2(task: &Task, seed: u64) -> Method {
    Method::Pi2(Pi2Options { seed, ..task.learning.pi2_options() })
}

fn auto(_: &Task, seed: u64) -> Method {
    Method::Auto(AutoOptions { rollouts: 20, updates: 10_000, seed })
}

/// Motions so far, cost and parameters of each evaluation.
type Evaluations = Vec<(usize, f64, Vec<f64>)>;

fn learn(row: &Row, seed: u64, max: usize) -> Result<(History, Evaluations, Simulation), LearnError> {
    let mut task =
        Task::parse(&row.task.replace("contact_force = 0.1", "contact_force = 0.0")).expect("a shipped task");
    // As figures of other methods are told: of the movement alone.
    task.cost.rest = PerAxis::All(0.0);
    let policy = Policy::initial(&task).expect("a shipped task");
    let simulation = Simulation::new(&task, &policy).expect("a shipped task");
    let start = simulation.starting_weights(&policy).expect("a shipped task");
    let view = View { simulation: &simulation, seen: row.seen, seed, rollouts: AtomicU64::new(0) };
    let mut seen = Vec::new();
    let history = learn_with(&view, start, &(row.method)(&task, seed), Some(max), |progress| {
        seen.push((progress.rollouts, progress.total, progress.weights.clone()));
        true
    })?;
    Ok((history, seen, simulation))
}

fn main() {
    let seeds: u64 = std::env::args().nth(1).map_or(20, |seeds| seeds.parse().expect("a number of seeds"));
    let rows = [
        Row {
            name: "Task 1, signals, gauss-newton",
            task: VIA_POINT,
            seen: Seen::Signals,
            method: gauss_newton,
            marks: &[90, 110, 400, 4000],
        },
        Row {
            name: "Task 1, signals, auto",
            task: VIA_POINT,
            seen: Seen::Signals,
            method: auto,
            marks: &[90, 110, 400, 4000],
        },
        Row {
            name: "Task 1, 0.2 mm noise, gauss-newton",
            task: VIA_POINT,
            seen: Seen::Noisy(0.2e-3),
            method: gauss_newton,
            marks: &[110, 250, 400, 1000],
        },
        Row {
            name: "Task 1, costs only, auto",
            task: VIA_POINT,
            seen: Seen::CostsOnly,
            method: auto,
            marks: &[600, 1500, 4000, 12000],
        },
        Row {
            name: "Task 2, signals, gauss-newton",
            task: CANTILEVER,
            seen: Seen::Signals,
            method: gauss_newton,
            marks: &[80, 100, 150, 4000],
        },
        Row {
            name: "Task 2, signals, auto",
            task: CANTILEVER,
            seen: Seen::Signals,
            method: auto,
            marks: &[80, 100, 150, 4000],
        },
        Row {
            name: "Task 2, costs only, auto",
            task: CANTILEVER,
            seen: Seen::CostsOnly,
            method: auto,
            marks: &[250, 600, 1500, 4000],
        },
        Row {
            name: "Task 1, costs only, pi2",
            task: VIA_POINT,
            seen: Seen::CostsOnly,
            method: pi2,
            marks: &[600, 1500, 4000, 12000],
        },
        Row {
            name: "Task 2, costs only, pi2",
            task: CANTILEVER,
            seen: Seen::CostsOnly,
            method: pi2,
            marks: &[600, 1500, 4000, 12000],
        },
    ];
    println!("median (worst) of {seeds} seeds: noiseless cost of the cheapest measured motion; mm: largest deviation");
    let part = std::env::args().nth(2).unwrap_or_default();
    for row in rows.into_iter().filter(|row| row.name.contains(&part)) {
        let max = row.marks[row.marks.len() - 1];
        let mut table = vec![Vec::new(); row.marks.len()];
        let mut deviations = vec![Vec::new(); row.marks.len()];
        let mut stops = Vec::new();
        for seed in 1..=seeds {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(if row.seen == Seen::Signals { 2 } else { 1 });
            let (history, seen, simulation) =
                pool.build().expect("a pool").install(|| learn(&row, seed, max)).expect("a finite start");
            for (i, &mark) in row.marks.iter().enumerate() {
                let best = seen.iter().filter(|s| s.0 <= mark).min_by(|a, b| a.1.total_cmp(&b.1)).expect("the start");
                let trace = simulation.rollout(&best.2);
                table[i].push(simulation.cost(&trace).total());
                let deviation = simulation.metrics(&trace).into_iter().find(|metric| metric.name == "max_deviation");
                deviations[i].extend(deviation.map(|metric| 1e3 * metric.value));
            }
            stops.push((history.rollouts, history.stop, history.notes));
        }
        let median = |values: &mut Vec<f64>| {
            values.sort_by(f64::total_cmp);
            let middle = (values[(values.len() - 1) / 2] + values[values.len() / 2]) / 2.0;
            (middle, values[values.len() - 1])
        };
        println!("{}", row.name);
        for (i, mark) in row.marks.iter().enumerate() {
            let (middle, worst) = median(&mut table[i]);
            print!("  {mark:>6} motions: {middle:.4} ({worst:.4})");
            if !deviations[i].is_empty() {
                let (middle, worst) = median(&mut deviations[i]);
                print!("  {middle:.4} ({worst:.4}) mm");
            }
            println!();
        }
        stops.sort_by_key(|stop| stop.0);
        println!("  median end: {:?}", stops[stops.len() / 2]);
    }
}
