//! A task learned in a run directory of its own: begun, interrupted, resumed, saved.
//!
//! ```
//! use std::sync::atomic::{AtomicUsize, Ordering};
//!
//! use hpf::{Job, LearningRow, Nobody, Watch};
//!
//! /// Ends learning after three evaluations.
//! struct Impatient(AtomicUsize);
//!
//! impl Watch for Impatient {
//!     fn evaluated(&self, _: &LearningRow) {
//!         self.0.fetch_add(1, Ordering::SeqCst);
//!     }
//!
//!     fn is_asked(&self) -> bool {
//!         self.0.load(Ordering::SeqCst) >= 3
//!     }
//! }
//! # let (tasks, folder) = (concat!(env!("CARGO_MANIFEST_DIR"), "/../../tasks"), tempfile::tempdir().unwrap());
//! # let (task, place) = (format!("{tasks}/reach.toml"), folder.path().join("reach"));
//!
//! let changes = ["learning.method=pi2".into(), "learning.updates=20".into()];
//! let begun = Job::begin(task.as_ref(), &changes, None, Some(&place), false)?.learn(&Impatient(AtomicUsize::new(0)))?;
//! assert!(begun.learned.is_open());
//! let finished = Job::resume(&place, false)?.learn(&Nobody)?;
//! assert_eq!(finished.learned.history.updates, 20);
//! # Ok::<(), hpf::Failure>(())
//! ```

use std::path::{Path, PathBuf};
use std::time::Instant;

use hpf_sim::Policy;
use hpf_sim::task::{Environment, Process};

use crate::directory::Unfinished;
use crate::failure::Failure;
use crate::files::{LoadedTask, read_task};
use crate::learning::{self, Learned};
use crate::outside::Maker;
use crate::summary::Summary;
use crate::watch::Watch;
use crate::{overrides, results, save, start};

/// A task and the folder that becomes its run directory.
pub struct Job {
    /// The task as it will run.
    pub loaded: LoadedTask,
    /// The run directory.
    pub place: PathBuf,
    folder: Unfinished,
    started: Instant,
}

/// A job that is done, or was broken off and is kept to go on.
pub struct Finished {
    /// What was learned.
    pub learned: Learned,
    /// Its result, as `summary.json` has it.
    pub summary: Summary,
    /// Why the log or some figures could not be made; all else is saved.
    pub failures: Vec<Failure>,
    /// The files in the run directory.
    pub files: Vec<String>,
    /// The run directory.
    pub place: PathBuf,
}

impl Job {
    /// The task file `task` with `changes` (each `key.path=value`), to be learned into the folder `target`, or
    /// `runs/<name>`; from the policy `from`, a file or a run, where one is named. With `force` a run that is there is
    /// replaced once this one is whole.
    ///
    /// # Errors
    /// [`Failure`] that names what is wrong with the task, the policy or the folder; then nothing is left behind.
    pub fn begin(
        task: &Path,
        changes: &[String],
        from: Option<&Path>,
        target: Option<&Path>,
        force: bool,
    ) -> Result<Self, Failure> {
        let loaded = read_task(task, changes)?;
        let start = from.map(|from| start::policy(&loaded.task, Some(from))).transpose()?;
        Self::of(loaded, start, target, force)
    }

    /// The same of a task that is already read; from the policy `start`, in the structure of the task, where there is one.
    ///
    /// # Errors
    /// As for [`Job::begin`].
    pub fn of(
        mut loaded: LoadedTask,
        start: Option<Policy>,
        target: Option<&Path>,
        force: bool,
    ) -> Result<Self, Failure> {
        let started = Instant::now();
        if start.is_none() {
            // What cannot begin leaves nothing behind.
            start::policy(&loaded.task, None)?;
        }
        let tables = results::own_tables(&mut loaded.task);
        let mut changes: Vec<String> = tables.iter().map(|table| table.change.clone()).collect();
        if let Some(Environment::Process(Process { folder: Some(folder), .. })) = &loaded.task.environment {
            // The run is elsewhere, and its program stays where it is.
            changes.push(format!("environment.folder={}", overrides::quoted(folder)));
        }
        loaded.text = overrides::apply(&loaded.text, &changes)?;
        let place = target.map_or_else(|| PathBuf::from("runs").join(&loaded.task.name), Path::to_path_buf);
        let mut folder = Unfinished::begin(&place, force)?;
        let written = folder.write("task.toml", &loaded.text);
        let written = written.and_then(|()| tables.iter().try_for_each(|table| folder.write(&table.name, &table.csv)));
        let written = written.and_then(|()| match start {
            Some(start) => folder.write(start::START, start.to_json()),
            None => Ok(()),
        });
        match written {
            Ok(()) => Ok(Self { loaded, place, folder, started }),
            Err(failure) => Err(folder.abandon(failure)),
        }
    }

    /// The run `run` that was broken off: all it needs is in there.
    ///
    /// # Errors
    /// [`Failure`] where it cannot go on.
    pub fn resume(run: &Path, force: bool) -> Result<Self, Failure> {
        let started = Instant::now();
        let mut folder = Unfinished::resume(run, force)?;
        let mut loaded = read_task(&folder.path("task.toml"), &[])?;
        folder.written("task.toml");
        results::own_tables(&mut loaded.task).iter().for_each(|table| folder.written(&table.name));
        if folder.path(start::START).is_file() {
            folder.written(start::START);
        }
        let is_partial = run.extension().is_some_and(|extension| extension == "partial");
        let place = if is_partial { run.with_extension("") } else { run.to_owned() };
        Ok(Self { loaded, place, folder, started })
    }

    /// Learns, until `watch` asks to end, and saves everything.
    ///
    /// # Errors
    /// [`Failure`] where nothing was learned, or it cannot be written; what there is to go on from stays.
    pub fn learn(self, watch: &dyn Watch) -> Result<Finished, Failure> {
        self.learn_with(watch, None)
    }

    /// [`Job::learn`] with the rollouts of `maker`, where there is one ([`learning::learn_from`]).
    ///
    /// # Errors
    /// As for [`Job::learn`].
    pub fn learn_with(mut self, watch: &dyn Watch, maker: Option<&dyn Maker>) -> Result<Finished, Failure> {
        let named = Some(self.folder.path(start::START)).filter(|named| named.is_file());
        let saved = start::policy(&self.loaded.task, named.as_deref())
            .and_then(|start| learning::learn_from(&self.loaded, start, Some(&mut self.folder), watch, maker))
            .and_then(|learned| self.save(&learned, watch).map(|(summary, failures)| (learned, summary, failures)));
        let (learned, summary, failures) = match saved {
            Ok(saved) => saved,
            Err(failure) => return Err(self.folder.abandon(failure)),
        };
        let files = self.folder.files().to_vec();
        self.folder.finish(learned.is_open())?;
        Ok(Finished { learned, summary, failures, files, place: self.place })
    }

    /// Writes what was learned; returns its summary, and which log or figures could not be made.
    fn save(&mut self, learned: &Learned, watch: &dyn Watch) -> Result<(Summary, Vec<Failure>), Failure> {
        let Learned { run, history, metrics, .. } = learned;
        let mut failures = save::fill(run, &self.loaded.text, metrics, &mut self.folder, watch)?;
        // The failure of the log written while learning is reported only where the final log failed too: that one has it all.
        if !failures.is_empty() {
            failures.extend(learned.log_failure.iter().map(|why| Failure::Work(why.clone())));
        }
        let seconds = [learned.time, self.started.elapsed()].map(|time| time.as_secs_f64());
        let summary = Summary::of_learning(run, history, metrics.clone(), seconds, learned.failure.as_deref());
        self.folder.write("summary.json", format!("{:#}\n", summary.to_json()))?;
        Ok((summary, failures))
    }
}
