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

use crate::failure::Failure;
use crate::files::{LoadedTask, read_task};
use crate::learning::{self, Learned};
use crate::overrides;
use crate::results::{self, OwnTable, Run};
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

/// Learns `loaded`, until `watch` asks to end.
///
/// # Errors
/// [`Broken`] where learning did not finish.
pub fn learn(loaded: &LoadedTask, watch: &dyn Watch) -> Result<Trial, Broken> {
    let begun = Instant::now();
    let Learned { run, history, metrics, time, failure, .. } = learning::learn(loaded, None, watch)?;
    if let Some(why) = failure {
        return Err(Broken::Failed(why));
    }
    if history.stop == TerminationReason::Requested {
        return Err(Broken::Interrupted);
    }
    let seconds = [time, begun.elapsed()].map(|time| time.as_secs_f64());
    let summary = Summary::of_learning(&run, &history, metrics, seconds, None);
    Ok(Trial { run, summary })
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
