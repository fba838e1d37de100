//! Who looks on while work is done: a terminal, a notebook, a test.

use hpf_sim::Task;

use crate::results::LearningRow;

/// What work says of itself, and whether it is to end.
///
/// Every method may be called from any thread, and has a default: nobody looks on, and nothing ends before its time.
pub trait Watch: Sync {
    /// Something that a user wants to know, in a sentence; work goes on.
    fn note(&self, sentence: &str) {
        let _ = sentence;
    }

    /// Learning of `task` begins, or goes on.
    fn begun(&self, task: &Task) {
        let _ = task;
    }

    /// A policy on the way was evaluated.
    fn evaluated(&self, row: &LearningRow) {
        let _ = row;
    }

    /// Whether work is to end where it is whole. Once it is, it stays so.
    fn is_asked(&self) -> bool {
        false
    }

    /// Whether it is to end without patience: what other programs do is not waited for.
    fn is_urgent(&self) -> bool {
        false
    }

    /// Processes are at work from now on (`true`), or have all ended: before that the program should not end.
    fn hold(&self, is_held: bool) {
        let _ = is_held;
    }
}

/// Nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nobody;

impl Watch for Nobody {}
