//! A task learned as one of many: no log and no progress on the way, the results in memory.

use std::path::Path;
use std::time::Instant;

use hpf_learn::{LearnError, Progress, Stop};
use hpf_sim::{Policy, Simulation};

use crate::directory::Unfinished;
use crate::failure::Failure;
use crate::files::{LoadedTask, read_task};
use crate::results::{self, LearningRow, OwnTable, Run};
use crate::sinks::told;
use crate::summary::Summary;
use crate::{interrupt, overrides};

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
pub enum Broken {
    /// Ctrl-C.
    Interrupted,
    /// What went wrong.
    Failed(String),
}

impl From<Failure> for Broken {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure.to_string().trim_start_matches("error: ").to_owned())
    }
}

/// A trial that was learned.
pub struct Trial {
    /// What it leaves behind.
    pub run: Run,
    /// Its result.
    pub summary: Summary,
}

/// Learns `loaded`, until Ctrl-C.
///
/// # Errors
/// [`Broken`] where learning broke off.
pub fn learn(loaded: &LoadedTask) -> Result<Trial, Broken> {
    let failed = |error: &dyn core::fmt::Display| Broken::Failed(error.to_string());
    let begun = Instant::now();
    let task = &loaded.task;
    let start = Policy::initial(task).map_err(|error| failed(&error))?;
    let simulation = Simulation::new(task, &start).map_err(|error| failed(&error))?;
    let weights = simulation.starting_weights(&start).map_err(|error| failed(&error))?;
    let (mut rows, mut snapshots) = (Vec::new(), Vec::new());
    let observe = |progress: &Progress| {
        rows.push(LearningRow::from(progress));
        if task.snapshots().contains(&progress.update) {
            snapshots.push((progress.update, simulation.rollout(&progress.weights)));
        }
        !interrupt::is_asked()
    };
    let (method, most) = (task.learning.method(), task.learning.max_rollouts);
    let learning = Instant::now();
    let history = hpf_learn::learn_with(&simulation, weights, &method, most, observe).map_err(|error| match error {
        LearnError::Update { reason, .. } => failed(&reason),
        other => failed(&other),
    })?;
    let learning_s = learning.elapsed().as_secs_f64();
    if history.stop == Stop::Asked {
        return Err(Broken::Interrupted);
    }
    let metrics = simulation.evaluate(&history.best.weights).1;
    let run = Run::learned(loaded, start, &simulation, &history.best, rows, snapshots);
    let seconds = [learning_s, begun.elapsed().as_secs_f64()];
    let summary = Summary::of_learning(&run, &history, metrics, seconds, None);
    Ok(Trial { run, summary })
}

/// Writes the run directory `target` of a trial, over what stands there; with its snapshots, log and plots where `full`.
///
/// # Errors
/// [`Failure`] that names what could not be written; a log or figures that failed leave the rest whole.
pub fn save(trial: &Trial, prepared: &Prepared, full: bool, target: &Path) -> Result<(), Failure> {
    let mut folder = Unfinished::begin(target, true)?;
    let saved = (|| {
        folder.write("task.toml", &prepared.loaded.text)?;
        for table in &prepared.tables {
            folder.write(&table.name, &table.csv)?;
        }
        let mut failures = Vec::new();
        if full {
            failures = results::save(&trial.run, &prepared.loaded.text, &trial.summary.metrics, &mut folder)?;
        } else {
            folder.write("policy.json", trial.run.policy.to_json())?;
            folder.write("learning.csv", results::learning_csv(&trial.run.learning))?;
            folder.write("trajectory.csv", results::trajectory_csv(&trial.run.task, &trial.run.trajectory))?;
        }
        folder.write("summary.json", format!("{:#}\n", trial.summary.to_json())).map(|()| failures)
    })();
    match saved {
        Ok(failures) => {
            folder.finish(false)?;
            told(&failures, &target.display().to_string())
        }
        Err(failure) => Err(folder.abandon(failure)),
    }
}
