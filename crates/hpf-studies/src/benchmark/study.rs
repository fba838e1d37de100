//! What is learned: every task by every method with every seed, none of them tuned.

use core::result::Result as Outcome;

use hpf::failure::{Failure, in_text};
use hpf::files::LoadedTask;
use hpf::overrides;
use hpf::statistics::Spread;
use hpf::trial::{Broken, Prepared, Trial};
use hpf_sim::task::Task;

use crate::many::{StudyWatch, learn_each};

/// Rollouts of an update, whatever the task says.
const ROLLOUTS: usize = 20;

/// A task and the costs that are to be reached.
pub struct Target {
    /// Its name.
    pub name: &'static str,
    text: &'static str,
    /// Costs, the largest first, the same for all methods.
    pub levels: [f64; 3],
}

macro_rules! target {
    ($name:literal, $levels:expr) => {
        Target { name: $name, text: include_str!(concat!("../../shipped/tasks/", $name, ".toml")), levels: $levels }
    };
}

/// Every shipped task.
pub const TARGETS: [Target; 8] = [
    target!("via_point", [0.82, 0.3, 0.14]),
    target!("cantilever", [0.5, 0.14, 0.06]),
    target!("cantilever_moving_load", [0.5, 0.14, 0.06]),
    target!("reach", [0.1, 0.01, 0.006]),
    target!("wall", [4.0, 3.0, 2.5]),
    target!("joint", [1.0, 0.1, 0.035]),
    target!("via_point_stochastic", [10.0, 2.0, 1.0]),
    target!("dmpbbo_via_point", [0.11, 0.055, 0.03]),
];

/// A method: its name, and the keys it changes.
const METHODS: [(&str, &[&str]); 5] = [
    ("paper", &["learning.method=pi2", "learning.preset=paper"]),
    ("pi2", &["learning.method=pi2"]),
    ("pi-bb", &["learning.method=pi2", "learning.preset=pi-bb"]),
    ("auto", &["learning.method=auto"]),
    ("cma-es", &["learning.method=cma-es"]),
];

/// What one method made of one task.
pub struct Result {
    /// The task.
    pub target: &'static Target,
    /// Name of the method.
    pub method: &'static str,
    /// A trial per seed.
    pub trials: Vec<Trial>,
}

/// How far a level was from being reached.
pub struct Reached {
    /// Seeds that reached it.
    pub seeds: usize,
    /// Motions made until then, by seed; endless where it was not reached.
    pub motions: Spread,
    /// Seconds until then, in proportion to the motions of the run.
    pub seconds: Spread,
}

impl Result {
    /// When a cost of at most `level` was first evaluated.
    pub fn reached(&self, level: f64) -> Reached {
        let motions = |trial: &Trial| {
            let first = trial.run.learning.iter().find(|row| row.total <= level);
            first.map_or(f64::INFINITY, |row| row.rollouts as f64)
        };
        let seconds = |trial: &Trial| {
            let summary = &trial.summary;
            motions(trial) * summary.learning_s / summary.rollouts as f64
        };
        let spread = |of: &dyn Fn(&Trial) -> f64| Spread::of(self.trials.iter().map(of)).expect("there is a seed");
        Reached {
            seeds: self.trials.iter().filter(|trial| motions(trial).is_finite()).count(),
            motions: spread(&motions),
            seconds: spread(&seconds),
        }
    }

    /// What the learned policies cost.
    pub fn last(&self) -> Spread {
        Spread::of(self.trials.iter().map(|trial| trial.summary.last.0)).expect("there is a seed")
    }
}

/// All of it.
pub struct Study {
    /// Seeds, in order.
    pub seeds: Vec<u64>,
    /// Most motions of a run.
    pub motions: usize,
    /// By task, then by method.
    pub results: Vec<Result>,
}

impl Study {
    /// Learns `tasks`, all where none is named, with each of `seeds` and at most `motions` a run.
    ///
    /// # Errors
    /// [`Failure::Input`] for a task that there is not, [`Failure::Work`] where a run fails; `None` where `watch` asked
    /// to end.
    pub fn learn(
        tasks: &[String],
        seeds: Vec<u64>,
        motions: usize,
        watch: &dyn StudyWatch,
    ) -> Outcome<Option<Self>, Failure> {
        if let Some(stranger) = tasks.iter().find(|task| TARGETS.iter().all(|target| target.name != **task)) {
            let known = TARGETS.iter().map(|target| target.name).collect::<Vec<_>>().join(", ");
            return Err(Failure::Input(format!("there is no task `{stranger}` to compare on; there are: {known}")));
        }
        let is_chosen = |target: &&Target| tasks.is_empty() || tasks.iter().any(|task| task == target.name);
        let mut jobs = Vec::new();
        let mut results = Vec::new();
        for target in TARGETS.iter().filter(is_chosen) {
            for (method, changes) in METHODS {
                for seed in &seeds {
                    jobs.push(Prepared::own(prepared(target, changes, *seed, motions)?)?);
                }
                results.push(Result { target, method, trials: Vec::new() });
            }
        }
        for (index, trial) in learn_each("benchmark", &jobs, watch)?.into_iter().enumerate() {
            let result = &mut results[index / seeds.len()];
            match trial {
                Ok(trial) => result.trials.push(trial),
                Err(Broken::Interrupted) => return Ok(None),
                Err(Broken::Failed(why)) => {
                    let (task, seed) = (result.target.name, seeds[index % seeds.len()]);
                    return Err(Failure::Work(format!("{task} by {} with seed {seed} failed: {why}", result.method)));
                }
            }
        }
        Ok(Some(Self { seeds, motions, results }))
    }

    /// The results of one task after the other.
    pub fn by_task(&self) -> impl Iterator<Item = &[Result]> {
        self.results.chunk_by(|a, b| core::ptr::eq(a.target, b.target))
    }
}

/// A task as one method learns it: all its own keys but those of the method and of the budget.
fn prepared(target: &Target, changes: &[&str], seed: u64, motions: usize) -> Outcome<LoadedTask, Failure> {
    let parse = |text: &str| Task::parse(text).map_err(in_text(target.name));
    let draws = parse(target.text)?.draws();
    // Annealing ends with the budget.
    let updates = (motions / ((ROLLOUTS + 1) * draws)).max(1);
    let mut all: Vec<String> = changes.iter().map(|change| (*change).to_owned()).collect();
    all.extend([
        format!("learning.seed={seed}"),
        format!("learning.rollouts={ROLLOUTS}"),
        format!("learning.updates={updates}"),
        format!("learning.max_rollouts={motions}"),
        "output.snapshots=[]".to_owned(),
        // Costs as other methods and libraries have them: of the movement alone.
        "cost.rest=0".to_owned(),
    ]);
    let text = overrides::apply(target.text, &all)?;
    Ok(LoadedTask { task: parse(&text)?, text, notes: Vec::new() })
}
