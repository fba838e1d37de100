//! How a command ends.

use hpf::failure::Failure;

/// A command that did its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// All went well.
    Done,
    /// It finished, but a target of `[accept]` was missed.
    Missed,
    /// Ctrl-C; what was learned so far is saved.
    Interrupted,
}

impl Outcome {
    /// Its exit code.
    pub fn exit_code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Missed => 3,
            Self::Interrupted => 130,
        }
    }
}

/// The exit code of a command that could not do its work.
pub fn exit_code(failure: &Failure) -> u8 {
    match failure {
        Failure::Input(_) | Failure::Mistakes(_) => 2,
        Failure::Work(_) => 1,
        Failure::Interrupted(_) => 130,
    }
}
