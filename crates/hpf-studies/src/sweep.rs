//! One task learned many times: with several seeds, and with every combination of some settings.
//!
//! The plan says which runs there are and where each belongs; the work learns those that are not there yet; the outcome
//! is read back from their directories, so that it does not matter when a run was made, nor where.

mod figures;
mod outcome;
mod plan;
mod shard;
mod work;

use std::path::Path;

use hpf::failure::Failure;
use hpf::files;
use serde_json::Value;

use self::outcome::Outcome;
pub use self::plan::{Factor, Job, Plan, Request, Setting};
pub use self::shard::Shard;
use crate::many::StudyWatch;

/// A sweep that is done, or was asked to end.
pub struct Swept {
    /// The contents of `summary.json`.
    pub summary: Value,
    /// The files written, those of single runs left out.
    pub files: Vec<String>,
    /// Runs that were there before.
    pub kept: usize,
    /// Whether the watch asked to end.
    pub interrupted: bool,
    /// The runs that failed: directory and reason.
    pub failed: Vec<(String, String)>,
    /// Finished runs that missed a target.
    pub missed: usize,
    /// Why figures could not be drawn; all else is saved.
    pub failures: Vec<Failure>,
}

/// Learns the runs of `plan` that are not finished in `folder`, with `force` every run, and writes the results there;
/// with snapshots, log and figures of every run where `full`.
///
/// # Errors
/// [`Failure::Input`] where other results are in the way, before anything is learned; [`Failure`] where results cannot be
/// read or written.
pub fn sweep(plan: &Plan, folder: &Path, full: bool, force: bool, watch: &dyn StudyWatch) -> Result<Swept, Failure> {
    let claim = shard::claim(folder, None)?;
    let done = work::learn_all(plan, None, folder, full, force, watch)?;
    let outcome = Outcome::read(plan, &done, folder)?;

    let mut files = vec!["results.csv".to_owned(), "summary.json".to_owned()];
    files::write(&folder.join("results.csv"), outcome.csv()?)?;
    let summary = outcome.to_json();
    files::write(&folder.join("summary.json"), format!("{summary:#}\n"))?;
    let mut failures = Vec::new();
    if outcome.samples.iter().any(Option::is_some) {
        match figures::draw(plan, &outcome, &folder.join("plots")) {
            Ok(drawn) => files.extend(drawn.into_iter().map(|name| format!("plots/{name}"))),
            Err(failure) => failures.push(failure),
        }
    }
    claim.give_up()?;
    Ok(Swept {
        summary,
        files,
        kept: done.kept,
        interrupted: done.interrupted,
        failed: outcome.failed().map(|(run, why)| (run, why.to_owned())).collect(),
        missed: outcome.missed(),
        failures,
    })
}

/// A share of a sweep that is done, or was asked to end.
pub struct SweptShard {
    /// Runs of the share.
    pub runs: usize,
    /// Those that were there before.
    pub kept: usize,
    /// Whether the watch asked to end.
    pub interrupted: bool,
    /// The runs that failed: directory and reason.
    pub failed: Vec<(String, String)>,
}

/// Learns the runs of `plan` that belong to `shard` and are not finished in `folder`; as [`sweep`] otherwise. The tables
/// and figures are written by [`sweep`], which keeps the runs that all shards have left in `folder`.
///
/// # Errors
/// As [`sweep`].
pub fn sweep_shard(
    plan: &Plan,
    shard: Shard,
    folder: &Path,
    full: bool,
    force: bool,
    watch: &dyn StudyWatch,
) -> Result<SweptShard, Failure> {
    // What is claimed stays marked as a part of a sweep.
    let _claim = shard::claim(folder, Some(shard))?;
    let done = work::learn_all(plan, Some(shard), folder, full, force, watch)?;
    let failed = plan.jobs.iter().zip(done.failures);
    Ok(SweptShard {
        runs: (0..plan.jobs.len()).filter(|&run| shard.has(run)).count(),
        kept: done.kept,
        interrupted: done.interrupted,
        failed: failed.filter_map(|(job, why)| Some((job.directory.display().to_string(), why?))).collect(),
    })
}
