//! What can go wrong, by whose doing.

use core::fmt;

use crate::report::Report;

/// Work that could not be done.
#[derive(Debug)]
pub enum Failure {
    /// The user's input or arguments are wrong: the message says what is right.
    Input(String),
    /// Mistakes in a file that people write, with their places.
    Mistakes(Box<Report>),
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
            Self::Mistakes(mut mistakes) => {
                mistakes.lines.push(line.to_owned());
                Self::Mistakes(mistakes)
            }
            Self::Work(message) => Self::Work(format!("{message}\n{line}")),
            Self::Interrupted(message) => Self::Interrupted(format!("{message}\n{line}")),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(message) | Self::Work(message) => write!(f, "error: {message}"),
            Self::Interrupted(message) => write!(f, "interrupted: {message}"),
            Self::Mistakes(mistakes) => f.write_str(&mistakes.render(false)),
        }
    }
}

impl core::error::Error for Failure {}
