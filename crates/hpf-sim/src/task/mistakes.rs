//! What is wrong in a file that people write: all of it at once, each with its place.

use core::fmt;
use core::ops::{Deref, Range};

/// A mistake in a file that people write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Where, in bytes of the text.
    pub span: Range<usize>,
    /// What is wrong: lower case, no full stop.
    pub message: String,
    /// What is allowed, or what to do.
    pub help: String,
}

/// All mistakes of a text in its order, at least one. It is an error; the mistakes themselves are a slice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistakes {
    text: String,
    found: Vec<Diagnostic>,
}

impl Mistakes {
    /// The mistakes `found` in `text`.
    pub(crate) fn new(text: &str, found: Vec<Diagnostic>) -> Self {
        Self { text: text.to_owned(), found }
    }

    /// The text they are in.
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl Deref for Mistakes {
    type Target = [Diagnostic];

    fn deref(&self) -> &[Diagnostic] {
        &self.found
    }
}

impl IntoIterator for Mistakes {
    type Item = Diagnostic;
    type IntoIter = std::vec::IntoIter<Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.found.into_iter()
    }
}

impl<'m> IntoIterator for &'m Mistakes {
    type Item = &'m Diagnostic;
    type IntoIter = core::slice::Iter<'m, Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl fmt::Display for Mistakes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, Diagnostic { span, message, help }) in self.found.iter().enumerate() {
            let before = self.text.get(..span.start).unwrap_or_default();
            let line = before.matches('\n').count() + 1;
            let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
            let gap = if i == 0 { "" } else { "\n" };
            write!(f, "{gap}line {line}, column {column}: {message}; {help}")?;
        }
        Ok(())
    }
}

impl core::error::Error for Mistakes {}
