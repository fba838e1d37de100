//! A task learned as one of many: no log and no progress on the way, the results in memory.
//!
//! ```
//! use hpf::{Nobody, Prepared, trial};
//! # let (tasks, folder) = (concat!(env!("CARGO_MANIFEST_DIR"), "/../../tasks"), tempfile::tempdir().unwrap());
//! # let (task, runs) = (format!("{tasks}/reach.toml"), folder.path());
//! let prepared = Prepared::read(task.as_ref(), &["learning.updates=20".into()])?;
//! let learned = trial::learn(&prepared.loaded, &Nobody)?;
//! assert!(learned.summary.last.0 < learned.summary.initial.0);
//! trial::save(&learned, &prepared, true, &runs.join("reach"), &Nobody)?;
//! assert!(runs.join("reach/plots/cost.png").is_file());
//! # Ok::<(), hpf::Failure>(())
//! ```

use std::path::Path;
use std::time::Instant;

use hpf_learn::TerminationReason;
use hpf_sim::{Policy, Simulation, Task};

use crate::failure::Failure;
use crate::files::{LoadedTask, read_task, sha256};
use crate::learning::{self, Learned};
use crate::overrides;
use crate::results::{self, LearningRow, OwnTable, Run};
use crate::save::Whole;
use crate::sinks::combined;
use crate::summary::Summary;
use crate::watch::Watch;

/// A task ready to be learned.
pub struct Prepared {
    /// The task as it will run, its force tables beside it.
    pub loaded: LoadedTask,
    /// Those tables.
    pub tables: Vec<OwnTable>,
}

impl Prepared {
    /// Reads the task `path` with `changes`.
    ///
    /// # Errors
    /// As [`read_task`].
    pub fn read(path: &Path, changes: &[String]) -> Result<Self, Failure> {
        Self::own(read_task(path, changes)?)
    }

    /// A task that is already read.
    ///
    /// # Errors
    /// As [`overrides::apply`].
    pub fn own(mut loaded: LoadedTask) -> Result<Self, Failure> {
        let tables = results::own_tables(&mut loaded.task);
        let changes: Vec<String> = tables.iter().map(|table| table.change.clone()).collect();
        loaded.text = overrides::apply(&loaded.text, &changes)?;
        Ok(Self { loaded, tables })
    }
}

/// Why a trial has no results.
#[derive(Debug)]
pub enum Broken {
    /// The watch asked to end.
    Interrupted,
    /// What went wrong.
    Failed(String),
}

impl From<Broken> for Failure {
    fn from(broken: Broken) -> Self {
        match broken {
            Broken::Interrupted => Self::Interrupted("it was asked to end".into()),
            Broken::Failed(why) => Self::Work(why),
        }
    }
}

impl From<Failure> for Broken {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure.to_string().trim_start_matches("error: ").to_owned())
    }
}

/// A trial that was learned.
pub struct Trial {
    /// The run.
    pub run: Run,
    /// Its result.
    pub summary: Summary,
}

impl Trial {
    /// Of what was learned since `begun`.
    pub fn of(learned: Learned, begun: Instant) -> Self {
        let Learned { run, history, metrics, time, failure, .. } = learned;
        let seconds = [time, begun.elapsed()].map(|time| time.as_secs_f64());
        let summary = Summary::of_learning(&run, &history, metrics, seconds, failure.as_deref());
        Self { run, summary }
    }
}

/// The motion of `policy` in the task of `loaded`, simulated, with its cost and measures.
///
/// # Errors
/// [`Failure::Input`] where policy and task do not belong together, or the motion has no finite cost.
pub fn simulate(policy: Policy, loaded: &LoadedTask) -> Result<Trial, Failure> {
    let begun = Instant::now();
    let task = &loaded.task;
    let simulation = Simulation::new(task, &policy).map_err(|error| bad_task(task, &error))?;
    let parameters = simulation.parameters(&policy);
    let (cost, metrics) = simulation.evaluate(&parameters);
    let price = (cost.total(), cost.terms.clone());
    if !price.0.is_finite() {
        return Err(bad_task(task, &"the motion has no finite cost in this environment"));
    }
    let rollouts = task.evaluation_draws();
    let run = Run {
        task: task.clone(),
        trajectory: simulation.rollout(&parameters),
        policy,
        learning: vec![LearningRow { update: 0, rollouts, total: price.0, terms: cost.terms, exploration: 0.0 }],
        snapshots: Vec::new(),
        demonstrations: Vec::new(),
    };
    let summary = Summary {
        task: task.name.clone(),
        task_sha256: sha256(&loaded.text),
        policy_sha256: sha256(&run.policy.to_json()),
        method: "simulation",
        seed: task.learning.seed,
        threads: rayon::current_num_threads(),
        updates: 0,
        best_update: 0,
        rollouts,
        learning_s: 0.0,
        total_s: begun.elapsed().as_secs_f64(),
        initial: price.clone(),
        last: price,
        metrics,
        rejected: 0,
        stopped_because: "a policy was run, nothing learned".into(),
    };
    Ok(Trial { run, summary })
}

fn bad_task(task: &Task, error: &dyn core::fmt::Display) -> Failure {
    Failure::Input(format!("{}: {error}", task.name))
}

/// Learns `loaded`, until `watch` asks to end.
///
/// # Errors
/// [`Broken`] where learning did not finish.
pub fn learn(loaded: &LoadedTask, watch: &dyn Watch) -> Result<Trial, Broken> {
    let begun = Instant::now();
    let learned = learning::learn(loaded, None, watch)?;
    if let Some(why) = learned.failure {
        return Err(Broken::Failed(why));
    }
    if learned.history.stop == TerminationReason::Requested {
        return Err(Broken::Interrupted);
    }
    Ok(Trial::of(learned, begun))
}

/// Writes the run directory `target` of a trial, over what is there; with its snapshots, log and plots where `full`.
/// `watch` hears what this build of the library leaves out.
///
/// # Errors
/// [`Failure`] that names what could not be written; a log or figures that failed leave the rest whole.
pub fn save(trial: &Trial, prepared: &Prepared, full: bool, target: &Path, watch: &dyn Watch) -> Result<(), Failure> {
    let Trial { run, summary } = trial;
    let Prepared { loaded, tables } = prepared;
    let whole =
        Whole { run, task_text: &loaded.text, tables, metrics: &summary.metrics, others: Vec::new(), in_full: full };
    let (_, failures) = whole.write(target, true, watch, || summary.to_json())?;
    combined(&failures, &target.display().to_string())
}
