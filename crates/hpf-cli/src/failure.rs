//! How a command ends, and what it says when it fails.

use core::fmt;
use std::process::ExitCode;

use crate::terminal::shown;

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

/// A command that could not do its work.
#[derive(Debug)]
pub enum Failure {
    /// The user's input or arguments are wrong: the message says what is right.
    Input(String),
    /// Mistakes in a task file, already rendered with their places and colours; all else in it is
    /// [`shown`](crate::terminal::shown).
    Report(String),
    /// The work itself failed.
    Work(String),
    /// It was asked to end, and has no results to show.
    Interrupted(String),
}

impl Failure {
    /// The same failure with one more line to say.
    pub fn with(self, line: &str) -> Self {
        match self {
            Self::Input(message) => Self::Input(format!("{message}\n{line}")),
            Self::Report(message) => Self::Report(format!("{message}\n{}", shown(line))),
            Self::Work(message) => Self::Work(format!("{message}\n{line}")),
            Self::Interrupted(message) => Self::Interrupted(format!("{message}\n{line}")),
        }
    }

    /// The exit code that goes with it.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Input(_) | Self::Report(_) => ExitCode::from(2),
            Self::Work(_) => ExitCode::from(1),
            Self::Interrupted(_) => ExitCode::from(130),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(message) | Self::Work(message) => write!(f, "error: {message}"),
            Self::Interrupted(message) => write!(f, "interrupted: {message}"),
            Self::Report(report) => f.write_str(report),
        }
    }
}
