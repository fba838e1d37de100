//! A run written into its directory: tables first, then the log and the figures that show them.

use std::path::Path;

use hpf_sim::Metric;
use serde_json::Value;

use crate::directory::Unfinished;
use crate::failure::Failure;
#[cfg(feature = "figures")]
use crate::figure;
use crate::results::{DEMONSTRATIONS, OwnTable, Run, beam_csv, demonstrations, learning_csv, trajectory_csv};
use crate::watch::Watch;
#[cfg(feature = "logs")]
use crate::{files::while_writing, log, sinks::guarded};

/// A run to be written at once, into a directory of its own.
pub struct Whole<'r> {
    /// The run.
    pub run: &'r Run,
    /// The text of its task.
    pub task_text: &'r str,
    /// The force tables of the task.
    pub tables: &'r [OwnTable],
    /// Measures of its motion.
    pub metrics: &'r [Metric],
    /// Other files: names and texts.
    pub others: Vec<(&'r str, String)>,
    /// Whether with snapshots, log and figures.
    pub in_full: bool,
}

impl Whole<'_> {
    /// Writes it to `target`, over a run that is there where it may be replaced (`force`); `summary` is asked for at
    /// the end. Returns the names of the files, and why the log or figures could not be made. `watch` hears what this
    /// build of the library leaves out.
    ///
    /// # Errors
    /// [`Failure`] where something is in the way or cannot be written; then nothing is left behind.
    pub fn write(
        &self,
        target: &Path,
        force: bool,
        watch: &dyn Watch,
        summary: impl FnOnce() -> Value,
    ) -> Result<(Vec<String>, Vec<Failure>), Failure> {
        let mut folder = Unfinished::begin(target, force)?;
        let written = (|| {
            folder.write("task.toml", self.task_text)?;
            self.tables.iter().try_for_each(|table| folder.write(&table.name, &table.csv))?;
            let mut failures = Vec::new();
            if self.in_full {
                failures = fill(self.run, self.task_text, self.metrics, &mut folder, watch)?;
            } else {
                folder.write("policy.json", self.run.policy.to_json())?;
                folder.write("learning.csv", learning_csv(&self.run.learning))?;
                folder.write("trajectory.csv", trajectory_csv(&self.run.task, &self.run.trajectory))?;
            }
            self.others.iter().try_for_each(|(name, text)| folder.write(name, text))?;
            folder.write("summary.json", format!("{:#}\n", summary())).map(|()| failures)
        })();
        match written {
            Ok(failures) => {
                let files = folder.files().to_vec();
                folder.finish(false).map(|()| (files, failures))
            }
            Err(failure) => Err(folder.abandon(failure)),
        }
    }
}

/// Writes all of a run but its task and summary, the policy first. The log and the figures only show the run: one that
/// cannot be made does no harm to the rest, and its failure is returned. `watch` hears what this build leaves out.
///
/// # Errors
/// [`Failure`] where a policy or a table cannot be written.
pub fn fill(
    run: &Run,
    task_text: &str,
    metrics: &[Metric],
    folder: &mut Unfinished,
    watch: &dyn Watch,
) -> Result<Vec<Failure>, Failure> {
    let policy = run.policy.to_json();
    folder.write("policy.json", &policy)?;
    write_tables(run, folder)?;
    let failed_log = write_log(run, (task_text, &policy), metrics, folder, watch);
    Ok(failed_log.into_iter().chain(draw_figures(run, folder, watch)).collect())
}

/// Writes every table of a run.
fn write_tables(run: &Run, folder: &mut Unfinished) -> Result<(), Failure> {
    folder.write("learning.csv", learning_csv(&run.learning))?;
    folder.write("trajectory.csv", trajectory_csv(&run.task, &run.trajectory))?;
    for (update, trace) in &run.snapshots {
        folder.write(&format!("snapshots/{update}.csv"), trajectory_csv(&run.task, trace))?;
    }
    if let Some(csv) = beam_csv(&run.task) {
        folder.write("beam.csv", csv)?;
    }
    if run.demonstrations.is_empty() { Ok(()) } else { folder.write(DEMONSTRATIONS, demonstrations::write(run)) }
}

/// Writes the log of a run; returns why it could not be written.
#[cfg(feature = "logs")]
fn write_log(
    run: &Run,
    (task_text, policy): (&str, &str),
    metrics: &[Metric],
    folder: &mut Unfinished,
    _: &dyn Watch,
) -> Option<Failure> {
    let path = folder.path("log.mcap");
    let head = log::Head::new(&run.task, task_text, policy);
    let logged = guarded(&path, || log::write(&path, &head, run, metrics).map_err(while_writing(&path)));
    logged.map(|()| folder.written("log.mcap")).err()
}

/// Says that there is no log.
#[cfg(not(feature = "logs"))]
fn write_log(_: &Run, _: (&str, &str), _: &[Metric], _: &mut Unfinished, watch: &dyn Watch) -> Option<Failure> {
    watch.note("log.mcap is left out: this build of hpf lacks the feature `logs`");
    None
}

/// Draws the figures of a run; returns why some could not be drawn.
#[cfg(feature = "figures")]
fn draw_figures(run: &Run, folder: &mut Unfinished, _: &dyn Watch) -> Vec<Failure> {
    figure::draw_into(run, folder)
}

/// Says that there are no figures.
#[cfg(not(feature = "figures"))]
fn draw_figures(_: &Run, _: &mut Unfinished, watch: &dyn Watch) -> Vec<Failure> {
    watch.note("plots/ is left out: this build of hpf lacks the feature `figures`");
    Vec::new()
}
