//! The observer of work: a terminal, a notebook, a test.

use hpf_sim::Task;

use crate::results::LearningRow;

/// Receives what work reports, and decides whether work should end.
///
/// Every method may be called from any thread. Every method has a default, which ignores the report and ends nothing.
pub trait Watch: Sync {
    /// A sentence for the user; work continues.
    fn note(&self, sentence: &str) {
        let _ = sentence;
    }

    /// Learning of `task` begins, or continues.
    fn begun(&self, task: &Task) {
        let _ = task;
    }

    /// An update was evaluated, or the start.
    fn evaluated(&self, row: &LearningRow) {
        let _ = row;
    }

    /// Whether work should end as soon as its results are complete. Once true, it must stay true.
    fn is_asked(&self) -> bool {
        false
    }

    /// Whether work should end at once, without waiting for other programs.
    fn is_urgent(&self) -> bool {
        false
    }

    /// Processes run from now on (`true`), or have all ended (`false`). While they run, the program should not exit.
    fn hold(&self, is_held: bool) {
        let _ = is_held;
    }
}

/// An observer that ignores everything.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nobody;

impl Watch for Nobody {}
