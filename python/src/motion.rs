//! `hpf.Motion`: the signals of a motion, by time.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use hpf::results::{LearningRow, Run, signals, trajectory_csv};
use hpf::{Prepared, Trial, files, log};
use hpf_sim::{AxisTrace, Metric, Policy, Simulation, Task, Trace};
use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::errors;
use crate::figure;
use crate::task::PyTask;

/// What a run in another environment may change: the policy decides the rest.
const ENVIRONMENT: [&str; 8] = ["rate", "disturbance", "contact", "sensor", "actuator", "via_point", "cost", "accept"];

/// `task` with steps of 1/rate and `changes` of its environment.
pub fn environment_of(
    py: Python<'_>,
    task: &PyTask,
    rate: Option<f64>,
    changes: Option<&Bound<'_, PyDict>>,
) -> PyResult<PyTask> {
    let all = PyDict::new(py);
    if let Some(changes) = changes {
        for (key, value) in changes.iter() {
            let name: String = key.extract()?;
            let root = name.split('.').next().unwrap_or_default();
            if !ENVIRONMENT.contains(&root) {
                let allowed = ENVIRONMENT.join(", ");
                let message = format!("the policy decides `{root}`; a rollout can change: {allowed}");
                return Err(errors::plain(py, "TaskError", &message));
            }
            all.set_item(key, value)?;
        }
    }
    if let Some(rate) = rate {
        all.set_item("rate", rate)?;
    }
    task.replace_with(py, Some(&all))
}

/// A motion: every signal at the start and after every step, N + 1 samples and those of the rest time after it.
///
/// `motion["x_position_m"]` is a column of trajectory.csv, shape (samples,); `motion.position` and the like hold all
/// axes, shape (samples, axes). Units are those of the axes: m, m/s, N, N/m, N s/m, or rad, rad/s, N m, ...
#[pyclass(frozen, module = "hpf", name = "Motion")]
pub struct PyMotion {
    run: Arc<Run>,
    prepared: Arc<Prepared>,
    metrics: Vec<Metric>,
    cost: f64,
    columns: OnceLock<Py<PyDict>>,
}

impl PyMotion {
    pub fn of(simulated: Trial, prepared: Arc<Prepared>) -> Self {
        let Trial { run, summary } = simulated;
        Self::in_run(Arc::new(run), prepared, summary.metrics, summary.last.0)
    }

    pub fn in_run(run: Arc<Run>, prepared: Arc<Prepared>, metrics: Vec<Metric>, cost: f64) -> Self {
        Self { run, prepared, metrics, cost, columns: OnceLock::new() }
    }

    /// The motion of `policy` as `simulation` plans it.
    pub fn planned(
        policy: &Policy,
        (prepared, task): (&Arc<Prepared>, Task),
        simulation: &Simulation,
        trajectory: Trace,
    ) -> Self {
        let cost = simulation.cost(&trajectory);
        let total = cost.total();
        let row = LearningRow { update: 0, rollouts: 0, total, terms: cost.terms, exploration: 0.0 };
        let (policy, learning) = (policy.clone(), vec![row]);
        let (snapshots, demonstrations) = (Vec::new(), Vec::new());
        let run = Run { task, policy, learning, trajectory, snapshots, demonstrations };
        Self::in_run(Arc::new(run), prepared.clone(), Vec::new(), total)
    }

    fn by_name<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        if let Some(columns) = self.columns.get() {
            return Ok(columns.bind(py).clone());
        }
        let columns = PyDict::new(py);
        for (name, signal) in signals(&self.run.task, &self.run.trajectory) {
            columns.set_item(name, PyArray1::from_vec(py, signal))?;
        }
        let made = columns.unbind();
        Ok(self.columns.get_or_init(|| made).bind(py).clone())
    }

    fn by_axis<'py>(
        &self,
        py: Python<'py>,
        signal: fn(&AxisTrace) -> &Vec<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let axes = &self.run.trajectory.axes;
        let samples = self.run.trajectory.time.len();
        let rows = (0..samples).flat_map(|i| axes.iter().map(move |axis| signal(axis)[i]));
        PyArray1::from_iter(py, rows).reshape([samples, axes.len()])
    }
}

#[pymethods]
impl PyMotion {
    /// The names of all columns, as trajectory.csv has them: name, signal and unit.
    #[getter]
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        Ok(self.by_name(py)?.keys().to_tuple())
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let columns = self.by_name(py)?;
        columns.get_item(name)?.ok_or_else(|| {
            let names: Vec<String> = columns.keys().iter().map(|key| key.to_string()).collect();
            PyKeyError::new_err(format!("{name}: there are {}", names.join(", ")))
        })
    }

    fn __len__(&self) -> usize {
        self.run.trajectory.time.len()
    }

    /// Time [s], shape (samples,).
    #[getter]
    fn time_s<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.__getitem__(py, "time_s")
    }

    /// Step of time [s].
    #[getter]
    fn dt_s(&self) -> f64 {
        self.run.trajectory.dt()
    }

    /// Steps of the movement, N: its last sample is motion.time_s[N].
    #[getter]
    fn steps(&self) -> usize {
        self.run.trajectory.steps()
    }

    /// Position of the tool [axis unit], shape (samples, axes).
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.by_axis(py, |axis| &axis.position)
    }

    /// Velocity of the tool [axis unit/s], shape (samples, axes).
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.by_axis(py, |axis| &axis.velocity)
    }

    /// Position of the reference [axis unit], shape (samples, axes).
    #[getter]
    fn reference_position<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.by_axis(py, |axis| &axis.reference_position)
    }

    /// Velocity of the reference [axis unit/s], shape (samples, axes).
    #[getter]
    fn reference_velocity<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.by_axis(py, |axis| &axis.reference_velocity)
    }

    /// Force that the admittance sees [N or N m], shape (samples, axes).
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.by_axis(py, |axis| &axis.force)
    }

    /// Stiffness [N/m or N m/rad], shape (samples, axes).
    #[getter]
    fn stiffness<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.by_axis(py, |axis| &axis.stiffness)
    }

    /// Damping [N s/m or N m s/rad], shape (samples, axes).
    #[getter]
    fn damping<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.by_axis(py, |axis| &axis.damping)
    }

    /// What the motion costs in its task.
    #[getter]
    fn cost(&self) -> f64 {
        self.cost
    }

    /// The measures of the motion by name; of one that is only planned, none.
    #[getter]
    fn metrics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        metrics_of(py, &self.metrics)
    }

    /// The task it was made in.
    #[getter]
    fn task(&self) -> PyTask {
        PyTask { prepared: self.prepared.clone(), file: None }
    }

    /// The motion as a pandas.DataFrame, a row per sample.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("pandas")?.getattr("DataFrame")?.call1((self.by_name(py)?,))
    }

    /// Writes the table `path`, as trajectory.csv is.
    #[pyo3(signature = (path, *, force = false))]
    fn to_csv(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<()> {
        let text = trajectory_csv(&self.run.task, &self.run.trajectory);
        files::place(&path, text.as_bytes(), force).map_err(|failure| errors::of_files(py, &failure, &path))
    }

    /// Writes the log `path` (MCAP), which Foxglove, Rerun and PlotJuggler open.
    #[pyo3(signature = (path, *, force = false))]
    fn to_mcap(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<()> {
        let written = files::refuse_occupied(&path, force).and_then(|()| {
            let policy = self.run.policy.to_json();
            let head = log::Head::new(&self.run.task, &self.prepared.loaded.text, &policy);
            log::write(&path, &head, &self.run, &self.metrics).map_err(files::while_writing(&path))
        });
        written.map_err(|failure| errors::of_files(py, &failure, &path))
    }

    /// Names of its figures.
    #[getter]
    fn figures(&self) -> Vec<String> {
        figure::names(&self.run)
    }

    /// The figure `name`: its bytes as PNG or SVG.
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
        let trace = &self.run.trajectory;
        let axes: Vec<&str> = self.run.task.axis.iter().map(|axis| axis.name.as_str()).collect();
        format!(
            "<hpf.Motion of {:?}: axes {}, {} samples of {} s, cost {}>",
            self.run.task.name,
            axes.join(", "),
            trace.time.len(),
            hpf::words::number(trace.dt()),
            hpf::words::number(self.cost)
        )
    }
}

/// Measures by name, as `hpf.Metric`.
pub fn metrics_of<'py>(py: Python<'py>, metrics: &[Metric]) -> PyResult<Bound<'py, PyAny>> {
    let rows: Vec<_> = metrics.iter().map(|one| (one.name, one.value, one.unit, one.target, one.pass())).collect();
    py.import("hpf.records")?.getattr("metrics")?.call1((rows,))
}
