//! Failures, by their cause: the input, the system, an interruption.

use core::fmt;

use hpf_sim::Mistakes;

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
    /// The user asked to end, and there are no results.
    Interrupted(String),
}

impl Failure {
    /// The same failure with one more line in its message.
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

/// The mistakes of the file `name`, as a failure.
pub fn in_text(name: &str) -> impl FnOnce(Mistakes) -> Failure {
    move |mistakes| Failure::Mistakes(Box::new(Report { mistakes, name: name.to_owned(), lines: Vec::new() }))
}
