//! What went wrong, as the exceptions of `hpf.errors`: with file, line and column where a text is at fault.

use std::path::Path;

use hpf::Failure;
use hpf_sim::{Diagnostic, Mistakes, PolicyError};
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError};
use pyo3::prelude::*;

/// A mistake and its place, as `hpf.errors.Mistake` takes them.
type Place<'m> = (Option<&'m str>, Option<usize>, Option<usize>, &'m str, &'m str);

/// An exception of `hpf.errors` with `mistakes`, which `text` tells.
fn raise(py: Python<'_>, class: &str, text: &str, mistakes: Vec<Place<'_>>) -> PyErr {
    let made = py
        .import("hpf.errors")
        .and_then(|module| module.getattr("make"))
        .and_then(|make| make.call1((class, text, mistakes)));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// The exception `class` without a place.
pub fn plain(py: Python<'_>, class: &str, text: &str) -> PyErr {
    raise(py, class, text, Vec::new())
}

/// The exception `class` of the file `file`.
pub fn in_file(py: Python<'_>, class: &str, file: Option<&str>, text: &str) -> PyErr {
    raise(py, class, text, vec![(file, None, None, text, "")])
}

/// The place of `diagnostic` in `text`: line and column, from 1.
fn place(text: &str, diagnostic: &Diagnostic) -> (usize, usize) {
    let before = text.get(..diagnostic.span.start).unwrap_or_default();
    let line = before.matches('\n').count() + 1;
    (line, before.rsplit('\n').next().unwrap_or_default().chars().count() + 1)
}

/// The mistakes of a text, with `message` for all of them.
pub fn of_mistakes(py: Python<'_>, class: &str, file: Option<&str>, mistakes: &Mistakes, message: &str) -> PyErr {
    let places = mistakes.iter().map(|mistake| {
        let (line, column) = place(mistakes.text(), mistake);
        (file, Some(line), Some(column), mistake.message.as_str(), mistake.help.as_str())
    });
    raise(py, class, message, places.collect())
}

/// The mistakes of a recording.
pub fn of_recording(py: Python<'_>, file: Option<&str>, mistakes: &[hpf::recordings::Mistake]) -> PyErr {
    let lines: Vec<String> = mistakes
        .iter()
        .map(|mistake| if mistake.line == 0 { mistake.message.clone() } else { format!("line {mistake}") })
        .collect();
    let place = file.map_or_else(String::new, |file| format!("{file}: "));
    let message = lines.iter().map(|line| format!("{place}{line}")).collect::<Vec<_>>().join("\n");
    let places = mistakes
        .iter()
        .map(|mistake| (file, (mistake.line > 0).then_some(mistake.line as usize), None, mistake.message.as_str(), ""));
    raise(py, "DemonstrationError", &message, places.collect())
}

/// What is wrong with a policy file.
pub fn of_policy(py: Python<'_>, file: Option<&str>, error: &PolicyError) -> PyErr {
    let text = error.to_string();
    let message = file.map_or_else(|| text.clone(), |file| format!("{file}: {text}"));
    let (line, column) = match error {
        PolicyError::Json { line, column, .. } => (Some(*line), Some(*column)),
        _ => (None, None),
    };
    raise(py, "PolicyError", &message, vec![(file, line, column, &text, "")])
}

/// A failure of the library; `class` is of input that is wrong, where it is no list of mistakes.
pub fn of(py: Python<'_>, failure: &Failure, class: &str, file: Option<&str>) -> PyErr {
    let text = failure.to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    match failure {
        Failure::Mistakes(report) => of_mistakes(py, "TaskError", file, &report.mistakes, text),
        Failure::Input(_) => in_file(py, class, file, text),
        Failure::Work(_) => plain(py, "WorkError", text),
        Failure::Interrupted(_) => PyKeyboardInterrupt::new_err(text.to_owned()),
    }
}

/// A failure to read or write below `path`.
pub fn of_files(py: Python<'_>, failure: &Failure, path: &Path) -> PyErr {
    match failure {
        Failure::Work(message) => PyOSError::new_err(message.clone()),
        _ => of(py, failure, "RunError", path.to_str()),
    }
}
