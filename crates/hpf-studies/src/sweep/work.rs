//! Learning the runs that are not there yet: several at once, each as it would be learned alone.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use hpf::failure::Failure;
use hpf::files::{read_text, sha256};
use hpf::results::{OwnTable, read_learning};
use hpf::trial::{self, Broken};
use serde_json::{Value, json};

use super::plan::{Job, Plan};
use super::shard::Shard;
use crate::many::{OneOfMany, StudyWatch, side_by_side};

/// What became of the runs of a plan.
pub struct Done {
    /// For each run, why it failed, if it did.
    pub failures: Vec<Option<String>>,
    /// Runs that were there before.
    pub kept: usize,
    /// Whether the watch asked to end.
    pub interrupted: bool,
}

/// What stands where a run belongs.
enum Standing {
    /// Nothing that is to be kept.
    Nothing,
    /// The same run, finished.
    Finished,
    /// Something else: why it is no such run.
    Other(&'static str),
}

/// Looks for the run of `job` in `folder`. It is finished where the same task, tables included, left its summary last.
fn standing(job: &Job, folder: &Path, full: bool) -> Standing {
    let directory = folder.join(&job.directory);
    if !directory.exists() {
        return Standing::Nothing;
    }
    let text = |name: &str| read_text(&directory.join(name)).unwrap_or_default();
    let summary: Value = serde_json::from_str(&text("summary.json")).unwrap_or_default();
    if summary["format"] != json!("hpf-summary") || summary["version"] != json!(1) {
        return Standing::Other("has no summary.json that is whole");
    }
    let has_table = |table: &OwnTable| text(&table.name) == table.csv;
    if summary["task_sha256"] != json!(sha256(&job.prepared.loaded.text)) || !job.prepared.tables.iter().all(has_table)
    {
        return Standing::Other("holds a run of another task");
    }
    if summary["policy_sha256"] != json!(sha256(&text("policy.json"))) {
        return Standing::Other("has a policy.json that is not the one it learned");
    }
    if read_learning(&text("learning.csv")).is_err() {
        return Standing::Other("has no learning.csv that is whole");
    }
    // What is kept of a light run is not enough: it is learned again, to the same bytes.
    if full && !directory.join("log.mcap").exists() { Standing::Nothing } else { Standing::Finished }
}

/// Learns every run of `plan`, or of `shard`, that is not finished in `folder`; with `force`, every run.
///
/// # Errors
/// [`Failure::Input`] where other results are in the way and `force` is not given, before anything is learned.
pub fn learn_all(
    plan: &Plan,
    shard: Option<Shard>,
    folder: &Path,
    full: bool,
    force: bool,
    watch: &dyn StudyWatch,
) -> Result<Done, Failure> {
    let is_ours = |index: usize| shard.is_none_or(|shard| shard.has(index));
    let all = (0..plan.jobs.len()).filter(|&index| is_ours(index)).count();
    let mut waiting = Vec::new();
    for (index, job) in plan.jobs.iter().enumerate().filter(|(index, _)| is_ours(*index)) {
        match standing(job, folder, full) {
            Standing::Finished if !force => {}
            Standing::Other(why) if !force => {
                return Err(Failure::Input(format!(
                    "{} {why} and is left as it is; remove it to learn it again, pass --force to learn all runs again, \
                     or --out to write elsewhere",
                    folder.join(&job.directory).display()
                )));
            }
            _ => waiting.push(index),
        }
    }
    let kept = all - waiting.len();
    let failures = Mutex::new(vec![None; plan.jobs.len()]);
    watch.planned(&plan.task, all, kept);
    side_by_side(waiting.len(), watch, |index| {
        let index = waiting[index];
        let job = &plan.jobs[index];
        let failure = match learn(job, folder, full, watch) {
            Err(Broken::Interrupted) => return,
            Err(Broken::Failed(why)) => Some(why),
            Ok(()) => None,
        };
        watch.run_ended(&job.directory.display().to_string(), failure.as_deref());
        failures.lock().unwrap_or_else(PoisonError::into_inner)[index] = failure;
    })?;
    let failures = failures.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(Done { failures, kept, interrupted: watch.is_asked() })
}

fn learn(job: &Job, folder: &Path, full: bool, watch: &dyn StudyWatch) -> Result<(), Broken> {
    let watch = OneOfMany(watch);
    let trial = trial::learn(&job.prepared.loaded, &watch)?;
    Ok(trial::save(&trial, &job.prepared, full, &folder.join(&job.directory), &watch)?)
}
