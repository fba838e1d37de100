//! `hpf.Policy`: a skill, complete in itself.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use hpf::export::{Format, Precision, export};
use hpf::outside::Plan;
use hpf::{Prepared, files, read_policy, trial};
use hpf_learn::Draws;
use hpf_sim::{Policy, Simulation};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::errors;
use crate::motion::PyMotion;
use crate::task::PyTask;

/// What the policies of one learning share: the task, the policy it starts from, motions as planned.
pub struct Source {
    pub prepared: Arc<Prepared>,
    pub start: Policy,
    pub plan: Plan,
}

/// A learned skill: where to go, how softly to hold it, how much to damp it. It never changes.
///
/// Weights are axis by axis: movement, stiffness [N/m], damping [N s/m]. File format: docs/files.md.
#[pyclass(frozen, module = "hpf", name = "Policy")]
pub struct PyPolicy {
    policy: OnceLock<Arc<Policy>>,
    /// Of a policy that is asked for: its weights, and for which circumstances.
    asked: Option<(Arc<Source>, Vec<f64>, Draws)>,
}

impl From<Policy> for PyPolicy {
    fn from(policy: Policy) -> Self {
        Self { policy: OnceLock::from(Arc::new(policy)), asked: None }
    }
}

impl PyPolicy {
    pub fn asked(source: &Arc<Source>, weights: Vec<f64>, draws: Draws) -> Self {
        Self { policy: OnceLock::new(), asked: Some((source.clone(), weights, draws)) }
    }

    pub fn get(&self) -> &Arc<Policy> {
        self.policy.get_or_init(|| {
            let (source, weights, _) = self.asked.as_ref().expect("a policy is known or was asked for");
            let policy = source.start.clone().with_weights(weights);
            Arc::new(policy.unwrap_or_else(|_| source.start.clone()))
        })
    }
}

#[pymethods]
impl PyPolicy {
    /// Reads and checks the policy file `path`, or that of the run directory `path`. Raises PolicyError.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let path =
            files::policy_path(&path).map_err(|failure| errors::of(py, &failure, "PolicyError", path.to_str()))?;
        match read_policy(&path) {
            Ok(policy) => Ok(policy.into()),
            Err(failure) => {
                let text = files::read_text(&path).ok();
                let parsed = text.map(|text| Policy::parse(&text));
                Err(match parsed {
                    Some(Err(error)) => errors::of_policy(py, path.to_str(), &error),
                    _ => errors::of(py, &failure, "PolicyError", path.to_str()),
                })
            }
        }
    }

    /// Reads and checks the text of a policy file. Raises PolicyError.
    #[staticmethod]
    fn parse(py: Python<'_>, text: &str) -> PyResult<Self> {
        Policy::parse(text).map(Self::from).map_err(|error| errors::of_policy(py, None, &error))
    }

    /// The policy before learning: the bare pull to the goal, with the task's initial stiffness and damping.
    #[staticmethod]
    fn initial(py: Python<'_>, task: &PyTask) -> PyResult<Self> {
        let start = Policy::initial(task.task());
        start.map(Self::from).map_err(|error| errors::plain(py, "TaskError", &error.to_string()))
    }

    /// Writes the policy file `path`; with `force` over one that stands there.
    #[pyo3(signature = (path, *, force = false))]
    fn save(&self, py: Python<'_>, path: PathBuf, force: bool) -> PyResult<()> {
        let bytes = self.get().to_json();
        files::place(&path, bytes.as_bytes(), force).map_err(|failure| errors::of_files(py, &failure, &path))
    }

    /// The text of its file, JSON: numbers read back to the same bits.
    fn to_json(&self) -> String {
        self.get().to_json()
    }

    /// A form for firmware: "rust" or "c" as text, "binary" with a checksum; `scalar` is "f32" or "f64".
    #[pyo3(signature = (form, *, scalar = "f64"))]
    fn export<'py>(&self, py: Python<'py>, form: &str, scalar: &str) -> PyResult<Bound<'py, PyAny>> {
        let forms = [Format::Rust, Format::C, Format::Binary];
        let Some(format) = forms.into_iter().find(|format| format.name() == form) else {
            return Err(PyValueError::new_err(format!("form must be \"rust\", \"c\" or \"binary\", not {form:?}")));
        };
        let Some(precision) = [Precision::F32, Precision::F64].into_iter().find(|one| one.name() == scalar) else {
            return Err(PyValueError::new_err(format!("scalar must be \"f32\" or \"f64\", not {scalar:?}")));
        };
        let Some(make) = format.firmware() else { return Err(PyValueError::new_err("no form for firmware")) };
        let bytes = export(self.get(), make, precision)
            .map_err(|error| errors::plain(py, "PolicyError", &error.to_string()))?;
        match format {
            Format::Binary => Ok(PyBytes::new(py, &bytes).into_any()),
            _ => Ok(String::from_utf8(bytes)?.into_pyobject(py)?.into_any()),
        }
    }

    /// The motion in the environment of `task`, simulated, with steps of 1/rate; `changes` are as for Task.load and may
    /// name rate, disturbance, contact, sensor, actuator, via_point, cost and accept.
    #[pyo3(signature = (task, rate = None, **changes))]
    fn rollout(
        &self,
        py: Python<'_>,
        task: &PyTask,
        rate: Option<f64>,
        changes: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<PyMotion> {
        let task = crate::motion::environment_of(py, task, rate, changes)?;
        let policy = self.get().as_ref().clone();
        let simulated = py.detach(|| trial::simulate(policy, &task.prepared.loaded));
        let simulated = simulated.map_err(|failure| errors::of(py, &failure, "PolicyError", None))?;
        Ok(PyMotion::of(simulated, task.prepared.clone()))
    }

    /// The motion as planned, without forces: references, stiffness and damping by time. Of a policy that learning asks
    /// for, `task` may be left out.
    #[pyo3(signature = (task = None))]
    fn planned(&self, py: Python<'_>, task: Option<&PyTask>) -> PyResult<PyMotion> {
        match (task, &self.asked) {
            (None, Some((source, weights, _))) => {
                let simulation = source.plan.simulation();
                let task = source.prepared.loaded.task.as_planned();
                Ok(PyMotion::planned(self.get(), (&source.prepared, task), simulation, simulation.rollout(weights)))
            }
            (None, None) => Err(PyValueError::new_err("name the task that the policy is planned in")),
            (Some(task), _) => {
                let policy = self.get();
                let planned = hpf_sim::Task {
                    contact: None,
                    disturbance: Vec::new(),
                    sensor: None,
                    actuator: None,
                    ends_at_duration: true,
                    ..task.task().as_planned()
                };
                let simulation = Simulation::new(&planned, policy)
                    .map_err(|error| errors::plain(py, "PolicyError", &error.to_string()))?;
                let trace = simulation.rollout(&simulation.parameters(policy));
                Ok(PyMotion::planned(policy, (&task.prepared, planned), &simulation, trace))
            }
        }
    }

    /// The same policy with other weights, shape (n,) as `weights` has them.
    fn with_weights(&self, py: Python<'_>, weights: PyReadonlyArray1<'_, f64>) -> PyResult<Self> {
        let weights = weights.as_array().to_vec();
        let policy = self.get().as_ref().clone().with_weights(&weights);
        let policy = policy.and_then(|policy| Policy::parse(&policy.to_json()));
        policy.map(Self::from).map_err(|error| errors::of_policy(py, None, &error))
    }

    /// All weights, shape (n,): axis by axis movement, stiffness [N/m], damping [N s/m].
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.get().weights())
    }

    /// Of a policy that learning asks for: the number of its random circumstances, which rollouts that are compared
    /// share; None for an evaluation, and for any other policy.
    #[getter]
    fn draw(&self) -> Option<usize> {
        match self.asked {
            Some((_, _, Draws::Update(update))) => Some(update),
            _ => None,
        }
    }

    /// Name of the task it was learned for.
    #[getter]
    fn task(&self) -> &str {
        &self.get().task
    }

    /// Duration of the movement [s].
    #[getter]
    fn duration_s(&self) -> f64 {
        self.get().duration_s
    }

    /// Names of the axes, in their order.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.get().axes.iter().map(|axis| axis.name.as_str()))
    }

    /// Units of the axes: "m" or "rad".
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.get().axes.iter().map(|axis| axis.unit.symbol()))
    }

    /// Where the movement of each axis starts [axis unit], shape (axes,).
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.get().axes.iter().map(|axis| axis.start))
    }

    /// Where the movement of each axis ends [axis unit], shape (axes,).
    #[getter]
    fn goal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.get().axes.iter().map(|axis| axis.goal))
    }

    /// Its cost in the task it was learned for.
    #[getter]
    fn cost(&self) -> f64 {
        self.get().provenance.cost
    }

    /// Updates that led to it.
    #[getter]
    fn updates(&self) -> usize {
        self.get().provenance.updates
    }

    /// Seed of the learning.
    #[getter]
    fn seed(&self) -> u64 {
        self.get().provenance.seed
    }

    /// SHA-256 of its file, in hexadecimal.
    #[getter]
    fn sha256(&self) -> String {
        files::sha256(&self.get().to_json())
    }

    fn __repr__(&self) -> String {
        let policy = self.get();
        let axes: Vec<String> =
            policy.axes.iter().map(|axis| format!("{} [{}]", axis.name, axis.unit.symbol())).collect();
        format!(
            "<hpf.Policy of {:?}: axes {}, {} s, {} weights, cost {}, {} updates>",
            policy.task,
            axes.join(", "),
            policy.duration_s,
            policy.weights().len(),
            hpf::words::number(policy.provenance.cost),
            policy.provenance.updates
        )
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| self.get().to_json() == other.get().get().to_json())
    }

    fn __hash__(&self) -> u64 {
        self.get().weights().iter().fold(0, |hash: u64, weight| hash.rotate_left(7) ^ weight.to_bits())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        Ok((py.import("hpf._restore")?.getattr("policy")?, (self.get().to_json(),)))
    }
}
