//! One task learned many times: with several seeds, and with every combination of some settings.
//!
//! The plan says which runs there are and where each belongs; the work learns those that are not there yet; the outcome
//! is read back from their directories, so that it does not matter when a run was made.

mod figures;
mod outcome;
mod plan;
mod work;

use std::fs::{self, File};
use std::path::Path;

use hpf::failure::Failure;
use hpf::files::{self, make_folder, read_text, while_writing};
use hpf::nodes;
use serde_json::{Value, json};

use self::outcome::Outcome;
pub use self::plan::{Factor, Job, Plan, Request, Setting};
use crate::many::StudyWatch;

/// The file that a sweep under way holds locked; one that was broken off leaves it.
const LOCK: &str = ".lock";

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
    let lock = claim(folder)?;
    let done = work::learn_all(plan, folder, full, force, watch)?;
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
    drop(lock);
    fs::remove_file(folder.join(LOCK)).map_err(while_writing(folder))?;
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

/// Makes the directory of a sweep, or takes the one of a sweep that is there, for as long as the lock is held.
fn claim(folder: &Path) -> Result<File, Failure> {
    let refuse = |why: &str| Err(Failure::Input(format!("{} {why}", folder.display())));
    let is_empty = fs::read_dir(folder).map_or(true, |mut entries| entries.next().is_none());
    let summary = read_text(&folder.join("summary.json")).unwrap_or_default();
    let summary: Value = serde_json::from_str(&summary).unwrap_or_default();
    let is_sweep = summary["format"] == json!("hpf-sweep") || folder.join(LOCK).is_file();
    if !(is_empty && !folder.is_file() || is_sweep) {
        return refuse("is no sweep and is left as it is; pass another --out");
    }
    make_folder(folder)?;
    let path = folder.join(LOCK);
    let lock = nodes::replaceable(&path).and_then(|()| File::create(&path)).map_err(while_writing(&path))?;
    match lock.try_lock() {
        Ok(()) => Ok(lock),
        Err(_) => refuse("belongs to a sweep that is going on; wait for it, or pass another --out"),
    }
}
