//! What is wrong with a recording, and where.

use core::fmt;

use crate::saw::Saw;

/// Mistakes that are reported at once.
pub const MAX_MISTAKES: usize = 20;

/// What is wrong with a recording, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// The line of a text, or the row of a file without lines, counted from 1; 0 for the whole file.
    pub line: u64,
    /// The name of the column, where it is one's.
    pub column: Option<String>,
    /// What is wrong, and what is allowed.
    pub message: String,
}

impl Mistake {
    /// A mistake of the whole file.
    pub fn whole(message: impl Into<String>) -> Self {
        Self { line: 0, column: None, message: message.into() }
    }

    /// A mistake in a line.
    pub fn at(line: u64, message: impl Into<String>) -> Self {
        Self { line, column: None, message: message.into() }
    }

    /// A mistake in a column of a line.
    pub fn of_column(line: u64, column: &str, message: impl Into<String>) -> Self {
        Self { line, column: Some(column.into()), message: message.into() }
    }
}

impl fmt::Display for Mistake {
    /// `line: column: message`, so that it follows the name of the file and a colon.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => f.write_str(" ")?,
            line => write!(f, "{line}: ")?,
        }
        if let Some(column) = &self.column {
            write!(f, "column `{column}`: ")?;
        }
        f.write_str(&self.message)
    }
}

/// Why a file was refused, and what was seen of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// At least one mistake and at most [`MAX_MISTAKES`].
    pub mistakes: Vec<Mistake>,
    /// What is in the file, where it could be looked into: its columns, and the command that may read it.
    pub saw: Option<Box<Saw>>,
}

impl Refusal {
    /// A refusal for `mistakes`, of which there is at least one.
    pub fn new(mut mistakes: Vec<Mistake>) -> Self {
        mistakes.truncate(MAX_MISTAKES);
        Self { mistakes, saw: None }
    }
}

impl From<Mistake> for Refusal {
    fn from(mistake: Mistake) -> Self {
        Self::new(vec![mistake])
    }
}
