//! How a command ends.

use std::process::ExitCode;

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

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Done => Self::from(0),
            Outcome::Missed => Self::from(3),
            Outcome::Interrupted => Self::from(130),
        }
    }
}

/// The exit code of a command that could not do its work.
pub fn exit_code(failure: &Failure) -> ExitCode {
    match failure {
        Failure::Input(_) | Failure::Mistakes(_) => ExitCode::from(2),
        Failure::Work(_) => ExitCode::from(1),
        Failure::Interrupted(_) => ExitCode::from(130),
    }
}
