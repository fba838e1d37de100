//! The figures of a run as bytes.

use hpf::figure::{Format, figures};
use hpf::results::Run;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;

/// The names of the figures of `run`.
pub fn names(run: &Run) -> Vec<String> {
    figures(run).into_iter().map(|drawing| drawing.name).collect()
}

fn draw(py: Python<'_>, run: &Run, name: &str, format: Format) -> PyResult<Vec<u8>> {
    let drawings = figures(run);
    let Some(drawing) = drawings.iter().find(|drawing| drawing.name == name) else {
        return Err(PyKeyError::new_err(format!("{name}: there are {}", names(run).join(", "))));
    };
    let drawn = py.detach(|| drawing.bytes(&run.task.name, format));
    drawn.map_err(|failure| errors::of(py, &failure, "WorkError", None))
}

/// The figure `name` of `run` as "png" or "svg".
pub fn bytes<'py>(py: Python<'py>, run: &Run, name: &str, format: &str) -> PyResult<Bound<'py, PyBytes>> {
    let format = match format {
        "png" => Format::Png,
        "svg" => Format::Svg,
        other => return Err(PyValueError::new_err(format!("format must be \"png\" or \"svg\", not {other:?}"))),
    };
    Ok(PyBytes::new(py, &draw(py, run, name, format)?))
}

/// The figure `name` of `run` as text of an SVG file.
pub fn svg(py: Python<'_>, run: &Run, name: &str) -> PyResult<String> {
    Ok(String::from_utf8(draw(py, run, name, Format::Svg)?)?)
}
