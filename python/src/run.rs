//! `hpf.Run`: what learning led to, and the way there.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use hpf::results::{LearningRow, Run};
use hpf::save::Whole;
use hpf::sinks::combined;
use hpf::{Failure, Nobody, Prepared, Summary, Trial, files, read_task};
use hpf_sim::cost::Term;
use numpy::PyArray1;
use pyo3::exceptions::PyFileExistsError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde_json::Value;

use crate::errors;
use crate::figure;
use crate::motion::{PyMotion, metrics_of};
use crate::policy::PyPolicy;
use crate::task::PyTask;

/// Where a run comes from.
enum Origin {
    /// Learned in memory: what summary.json is to say, and other files of its directory.
    Memory(Box<Summary>, Vec<(&'static str, String)>),
    /// A run directory and its summary.json.
    Directory(PathBuf, Value),
}

/// What learning led to: policy, cost, measures, history and the motion of the policy.
///
/// A notebook shows its path; `run.figures` names the others.
#[pyclass(frozen, module = "hpf", name = "Run")]
pub struct PyRun {
    run: Arc<Run>,
    prepared: Arc<Prepared>,
    origin: Origin,
    notes: Vec<String>,
}

impl PyRun {
    pub fn in_memory(
        trial: Trial,
        prepared: Arc<Prepared>,
        others: Vec<(&'static str, String)>,
        notes: Vec<String>,
    ) -> Self {
        let Trial { run, summary } = trial;
        Self { run: Arc::new(run), prepared, origin: Origin::Memory(Box::new(summary), others), notes }
    }

    /// Reads the run directory `path`.
    pub fn read(path: &Path, notes: Vec<String>) -> Result<Self, Failure> {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let run = Run::load(&path)?;
        let prepared = Prepared::own(read_task(&path.join("task.toml"), &[])?)?;
        let summary = path.join("summary.json");
        let text = files::read_text(&summary)?;
        let summary = serde_json::from_str(&text).map_err(files::in_file(&summary))?;
        Ok(Self { run: Arc::new(run), prepared: Arc::new(prepared), origin: Origin::Directory(path, summary), notes })
    }

    fn summary_json(&self) -> Value {
        match &self.origin {
            Origin::Memory(summary, _) => summary.to_json(),
            Origin::Directory(_, summary) => summary.clone(),
        }
    }
}

#[pymethods]
impl PyRun {
    /// The task as it was run.
    #[getter]
    fn task(&self) -> PyTask {
        PyTask { prepared: self.prepared.clone(), file: None }
    }

    /// The learned policy.
    #[getter]
    fn policy(&self) -> PyPolicy {
        self.run.policy.clone().into()
    }

    /// Total cost of the policy.
    #[getter]
    fn cost(&self) -> f64 {
        self.run.policy.provenance.cost
    }

    /// The cost of the policy by term: those that count, and those that are zero.
    #[getter]
    fn cost_terms<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let terms = PyDict::new(py);
        if let Some(Value::Object(cost)) = self.summary_json()["cost"].get("final") {
            for (name, value) in cost.iter().filter(|(name, _)| *name != "total") {
                terms.set_item(name, value.as_f64().unwrap_or(f64::NAN))?;
            }
        }
        Ok(terms)
    }

    /// The measures of the policy's motion by name.
    #[getter]
    fn metrics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.origin {
            Origin::Memory(summary, _) => metrics_of(py, &summary.metrics),
            Origin::Directory(_, summary) => {
                let rows = summary["metrics"].as_array().map(Vec::as_slice).unwrap_or_default().iter().map(|metric| {
                    let text = |key: &str| metric[key].as_str().unwrap_or_default().to_owned();
                    let value = metric["value"].as_f64().unwrap_or(f64::NAN);
                    (text("name"), value, text("unit"), metric["target"].as_f64(), metric["pass"].as_bool())
                });
                py.import("hpf.records")?.getattr("metrics")?.call1((rows.collect::<Vec<_>>(),))
            }
        }
    }

    /// The evaluations on the way, the start first: hpf.History.
    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        history_of(py, &self.run.learning)
    }

    /// The motion of the learned policy.
    #[getter]
    fn motion(&self) -> PyMotion {
        let metrics = match &self.origin {
            Origin::Memory(summary, _) => summary.metrics.clone(),
            Origin::Directory(..) => Vec::new(),
        };
        PyMotion::in_run(self.run.clone(), self.prepared.clone(), metrics, self.cost())
    }

    /// Whether a target of [accept] was missed.
    #[getter]
    fn missed(&self) -> bool {
        let metrics = &self.summary_json()["metrics"];
        metrics.as_array().is_some_and(|all| all.iter().any(|metric| metric["pass"] == false))
    }

    /// What the user should know.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// The run directory; None where it was learned in memory.
    #[getter]
    fn directory(&self) -> Option<&Path> {
        match &self.origin {
            Origin::Memory(..) => None,
            Origin::Directory(path, _) => Some(path),
        }
    }

    /// What summary.json says (docs/files.md), as a dict.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.getattr("loads")?.call1((self.summary_json().to_string(),))
    }

    /// Writes the run directory `path`: the same bytes as the program's, but for wall times. With `force` over a run that
    /// stands there.
    #[pyo3(signature = (path, *, force = false))]
    fn save(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<()> {
        let (summary, others) = match &self.origin {
            Origin::Memory(summary, others) => (summary, others),
            Origin::Directory(from, _) => {
                if path.exists() {
                    let message = format!("{}: it exists; copy {} elsewhere", path.display(), from.display());
                    return Err(PyFileExistsError::new_err(message));
                }
                py.import("shutil")?.getattr("copytree")?.call1((from, &path))?;
                return Ok(());
            }
        };
        let loaded = &self.prepared.loaded;
        let whole = Whole {
            run: &self.run,
            task_text: &loaded.text,
            tables: &self.prepared.tables,
            metrics: &summary.metrics,
            others: others.clone(),
            in_full: true,
        };
        let saved = crate::desk::work(py, 0, None, None, |_, _| {
            let (_, failures) = whole.write(&path, force, &Nobody, || summary.to_json())?;
            combined(&failures, &path.display().to_string())
        })?;
        saved.result.map_err(|failure| errors::of_files(py, &failure, &path))
    }

    /// Names of its figures.
    #[getter]
    fn figures(&self) -> Vec<String> {
        figure::names(&self.run)
    }

    /// The figure `name`: its bytes as "png" or "svg".
    #[pyo3(signature = (name, format = "png"))]
    fn figure<'py>(&self, py: Python<'py>, name: &str, format: &str) -> PyResult<Bound<'py, PyBytes>> {
        figure::bytes(py, &self.run, name, format)
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        figure::bytes(py, &self.run, "path", "png")
    }

    fn _repr_svg_(&self, py: Python<'_>) -> PyResult<String> {
        figure::svg(py, &self.run, "path")
    }

    fn __repr__(&self) -> String {
        let (run, summary) = (&self.run, self.summary_json());
        let verdict = match (summary["metrics"].as_array(), self.missed()) {
            (_, true) => ", a target was missed",
            (Some(all), false) if all.iter().any(|metric| metric["pass"] == true) => ", all targets met",
            _ => "",
        };
        format!(
            "<hpf.Run of {:?}: cost {}, {} updates, {} motions{verdict}>",
            run.task.name,
            hpf::words::number(self.cost()),
            summary["updates"],
            summary["rollouts_total"]
        )
    }
}

/// Evaluations as `hpf.History`.
pub fn history_of<'py>(py: Python<'py>, rows: &[LearningRow]) -> PyResult<Bound<'py, PyAny>> {
    let numbers = |of: fn(&LearningRow) -> f64| PyArray1::from_iter(py, rows.iter().map(of));
    let counts = |of: fn(&LearningRow) -> usize| PyArray1::from_iter(py, rows.iter().map(|row| of(row) as i64));
    let terms = PyDict::new(py);
    for (k, name) in Term::NAMES.iter().enumerate() {
        let term = rows.iter().map(|row| row.terms.get(k).copied().unwrap_or(0.0));
        terms.set_item(name, PyArray1::from_iter(py, term))?;
    }
    py.import("hpf.records")?.getattr("History")?.call1((
        counts(|row| row.update),
        counts(|row| row.rollouts),
        numbers(|row| row.total),
        terms,
        numbers(|row| row.exploration),
    ))
}
