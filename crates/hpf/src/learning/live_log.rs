//! The log during learning. It only shows what is learned: where it cannot be written, learning continues without it.

use std::fs;
use std::io;
use std::path::PathBuf;

use hpf_sim::Policy;
use hpf_sim::task::Task;

use crate::directory::Unfinished;
use crate::files::while_writing;
use crate::log::{Head, Log};
use crate::results::LearningRow;
use crate::watch::Watch;

/// The name of the log during learning.
const LOG: &str = "log.mcap.partial";

/// The log, or why there is none.
pub(super) struct LiveLog {
    log: Option<Log>,
    failure: Option<String>,
    path: PathBuf,
}

impl LiveLog {
    /// Begins the log of learning `task`, whose text is the second of the pair, from the policy `start`; the evaluations
    /// so far are `rows`.
    pub(super) fn open((task, text): (&Task, &str), start: &Policy, rows: &[LearningRow], folder: &Unfinished) -> Self {
        let path = folder.path(LOG);
        let policy = start.to_json();
        match so_far(&Head::new(task, text, &policy), rows, folder) {
            Ok(log) => Self { log: Some(log), failure: None, path },
            Err(error) => Self { log: None, failure: Some(while_writing(&path)(error).to_string()), path },
        }
    }

    /// Adds an evaluation, where there is one.
    pub(super) fn append(&mut self, row: Option<&LearningRow>, watch: &dyn Watch) {
        if let (Some(log), Some(row)) = (&mut self.log, row)
            && let Err(error) = log.update(row)
        {
            let failure = while_writing(&self.path)(error).to_string();
            watch.note(&format!("{failure}; learning goes on without it"));
            (self.log, self.failure) = (None, Some(failure));
        }
    }

    /// Why it failed, if it did.
    pub(super) fn failure(self) -> Option<String> {
        self.failure
    }
}

/// The log with the evaluations so far: under its own name only once they are all in it.
fn so_far(head: &Head<'_>, rows: &[LearningRow], folder: &Unfinished) -> io::Result<Log> {
    let begun = folder.path("log.mcap.partial.begun");
    let mut log = Log::create(&begun, head)?;
    rows.iter().try_for_each(|row| log.update(row))?;
    fs::rename(&begun, folder.path(LOG))?;
    Ok(log)
}
