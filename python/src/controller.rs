//! `hpf.Controller`: the controller of `hpf-core`, the one that a robot runs.

use core::array;
use std::collections::VecDeque;

use hpf::conduct;
use hpf_core::ConfigError;
use hpf_core::controller::{self, AxisOutput, Counters, Input, Output, Request};
use hpf_sim::robot::Settings;
use hpf_sim::task::Axis;
use hpf_sim::{AdmittancePolicy, Policy};
use numpy::{PyArray1, PyArrayMethods as _};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::errors;
use crate::policy::PyPolicy;

/// Most axes.
const MOST: usize = hpf_sim::task::MAX_AXES;

/// Numbers of every axis; those past the last are not looked at.
type Axes = [f64; MOST];

/// What is asked of a controller.
#[derive(Clone, Copy)]
enum Wish {
    Start,
    Hold,
    Resume,
    Stop,
    Tare,
    Goal(Axes),
    Reset(Axes),
}

/// One step's input.
struct Step {
    force: Axes,
    force_age: u32,
    position: Option<Axes>,
    rate: f64,
    wish: Option<Wish>,
}

/// A controller of any number of axes.
trait Loop: Send + Sync {
    fn update(&mut self, step: &Step, dt: f64) -> PyCommand;
    fn output(&self) -> PyCommand;
    fn set(&mut self, settings: &Settings, longest_step: f64) -> Result<(), ConfigError>;
    fn bias(&self) -> Vec<f64>;
    fn counters(&self) -> Counters;
}

/// The first D numbers.
fn first<const D: usize>(axes: &Axes) -> [f64; D] {
    array::from_fn(|a| axes[a])
}

impl<const D: usize> Loop for controller::Controller<f64, Vec<f64>, D> {
    fn update(&mut self, step: &Step, dt: f64) -> PyCommand {
        let input = Input {
            measured_force: first(&step.force),
            force_age: step.force_age,
            measured_position: step.position.as_ref().map(first),
            rate: step.rate,
            request: step.wish.map(|wish| match wish {
                Wish::Start => Request::Start,
                Wish::Hold => Request::Hold,
                Wish::Resume => Request::Resume,
                Wish::Stop => Request::Stop,
                Wish::Tare => Request::Tare,
                Wish::Goal(goal) => Request::Goal(first(&goal)),
                Wish::Reset(position) => Request::Reset(first(&position)),
            }),
        };
        PyCommand::of(&self.update(&input, dt))
    }

    fn output(&self) -> PyCommand {
        PyCommand::of(&self.output())
    }

    fn set(&mut self, settings: &Settings, longest_step: f64) -> Result<(), ConfigError> {
        let settings = settings.controller([0.0; D], longest_step)?;
        self.set(settings)
    }

    fn bias(&self) -> Vec<f64> {
        self.bias().to_vec()
    }

    fn counters(&self) -> Counters {
        *self.counters()
    }
}

/// What is joined by `+`.
fn words(joined: &str) -> Vec<&str> {
    joined.split('+').filter(|word| !word.is_empty()).collect()
}

/// The command of one step: what the robot is to do, and what has happened.
///
/// Arrays have shape (axes,).
#[pyclass(frozen, module = "hpf", name = "Command")]
pub struct PyCommand {
    output: Output<f64, MOST>,
    count: usize,
}

impl PyCommand {
    fn of<const D: usize>(output: &Output<f64, D>) -> Self {
        let Output { axes, phase, rate, energy, port_energy, mode, status } = *output;
        let axes = array::from_fn(|a| axes[a.min(D - 1)]);
        Self { output: Output { axes, phase, rate, energy, port_energy, mode, status }, count: D }
    }

    fn each<'py>(&self, py: Python<'py>, number: fn(&AxisOutput<f64>) -> f64) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.output.axes[..self.count].iter().map(number))
    }
}

#[pymethods]
impl PyCommand {
    /// Commanded position [axis unit].
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |axis| axis.position)
    }

    /// Commanded velocity: how fast it got there from the last command [axis unit/s].
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |axis| axis.velocity)
    }

    /// Stiffness [N/m or N m/rad].
    #[getter]
    fn stiffness<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |axis| axis.stiffness)
    }

    /// Damping [N s/m or N m s/rad].
    #[getter]
    fn damping<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |axis| axis.damping)
    }

    /// Offset: commanded minus reference position [axis unit].
    #[getter]
    fn offset<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |axis| axis.offset)
    }

    /// Force as the model saw it, conditioned and limited [N or N m].
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.each(py, |axis| axis.force)
    }

    /// Phase s: 1 at the start, falling.
    #[getter]
    fn phase(&self) -> f64 {
        self.output.phase
    }

    /// Rate at which time has run along the path, 0 to 1.
    #[getter]
    fn rate(&self) -> f64 {
        self.output.rate
    }

    /// Energy in the tank [J]; 0 without one.
    #[getter]
    fn energy_j(&self) -> f64 {
        self.output.energy
    }

    /// Energy at the physical port [J]; 0 without one.
    #[getter]
    fn port_energy_j(&self) -> f64 {
        self.output.port_energy
    }

    /// What the controller does: "idle", "run", "hold", "stop" or "fault".
    #[getter]
    fn mode(&self) -> &'static str {
        conduct::mode(self.output.mode)
    }

    /// What has happened in this step: "ended", "refused", "bad_force", ... (docs/embedding.md).
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let flags = conduct::flags(&self.output.status);
        PyTuple::new(py, words(&flags))
    }

    /// Whether the request was refused.
    #[getter]
    fn refused(&self) -> bool {
        self.output.status.refused
    }

    /// Whether the movement has ended: set once.
    #[getter]
    fn ended(&self) -> bool {
        self.output.status.ended
    }

    /// In Idle: whether the force has stood still long enough for tare().
    #[getter]
    fn tare_ready(&self) -> bool {
        self.output.status.tare_ready
    }

    /// The limits that have cut the command of each axis: "force", "offset", "velocity", "acceleration", "position".
    #[getter]
    fn limited<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let axes = self.output.axes[..self.count].iter().map(|axis| {
            let cut = conduct::cut(&axis.hits);
            PyTuple::new(py, words(&cut))
        });
        PyTuple::new(py, axes.collect::<PyResult<Vec<_>>>()?)
    }

    fn __repr__(&self) -> String {
        let positions: Vec<String> =
            self.output.axes[..self.count].iter().map(|axis| format!("{}", axis.position)).collect();
        format!("<hpf.Command: {}, position [{}]>", self.mode(), positions.join(", "))
    }
}

/// Runs a policy on a robot: measured force in, commands out, within limits, energy and modes (docs/embedding.md).
///
/// It is the code that a robot runs: every command is finite and within every limit, whatever comes in. It begins in
/// "idle"; start() is asked for at the next update. Of several requests one is made at each update, in their order.
#[pyclass(module = "hpf", name = "Controller")]
pub struct PyController {
    inner: Box<dyn Loop>,
    axes: Vec<Axis>,
    wishes: VecDeque<Wish>,
}

impl PyController {
    fn axes_from(&self, value: &Bound<'_, PyAny>, what: &str) -> PyResult<Axes> {
        numbers(value, self.axes.len(), what)
    }
}

/// One number for each of `count` axes, of an array, a sequence, or a number of one axis.
#[inline]
fn numbers(value: &Bound<'_, PyAny>, count: usize, what: &str) -> PyResult<Axes> {
    let mut axes = [0.0; MOST];
    let list = if let Ok(array) = value.cast::<PyArray1<f64>>() {
        let array = array.try_readonly().map_err(|error| PyValueError::new_err(error.to_string()))?;
        if let Ok(list) = array.as_slice()
            && list.len() == count
        {
            axes[..count].copy_from_slice(list);
            return Ok(axes);
        }
        array.as_array().to_vec()
    } else if count == 1
        && let Ok(number) = value.extract::<f64>()
    {
        vec![number]
    } else {
        value
            .extract::<Vec<f64>>()
            .map_err(|_| PyTypeError::new_err(format!("{what}: {count} numbers belong there")))?
    };
    if list.len() != count {
        return Err(PyValueError::new_err(format!("{what}: {} numbers for {count} axes", list.len())));
    }
    axes[..count].copy_from_slice(&list);
    Ok(axes)
}

/// The settings that keywords say, for `axes`, and the longest step [s].
fn settings_of(py: Python<'_>, keywords: &Bound<'_, PyDict>, axes: &[Axis]) -> PyResult<(Settings, f64)> {
    let keywords = keywords.copy()?;
    let longest_step = match keywords.get_item("longest_step_s")? {
        Some(step) => {
            keywords.del_item("longest_step_s")?;
            step.extract()?
        }
        None => 0.01,
    };
    for foreign in ["watch_position", "request"] {
        if keywords.contains(foreign)? {
            return Err(PyTypeError::new_err(format!(
                "{foreign} is of a settings file: update() and requests have it"
            )));
        }
    }
    let text: String = py.import("hpf._values")?.getattr("document")?.call1((keywords,))?.extract()?;
    let settings = Settings::parse(&text, axes)
        .map_err(|mistakes| errors::of_mistakes(py, "ControllerError", None, &mistakes, &mistakes.to_string()))?;
    Ok((settings, longest_step))
}

/// The policy with another law of admittance.
fn with_law(policy: &Policy, law: &Bound<'_, PyAny>) -> PyResult<Policy> {
    let count = policy.axes.len();
    let admittance = if law.extract::<String>().is_ok_and(|law| law == "first_order") {
        AdmittancePolicy { order: 1, mass: None }
    } else {
        let belongs = "law: \"first_order\" or {\"mass\": kg} belongs there";
        let law = law.cast::<PyDict>().map_err(|_| PyTypeError::new_err(belongs))?;
        let mass = law.get_item("mass")?.filter(|_| law.len() == 1).ok_or_else(|| PyValueError::new_err(belongs))?;
        let mass = match mass.extract::<f64>() {
            Ok(mass) => vec![mass; count],
            Err(_) => numbers(&mass, count, "law.mass")?[..count].to_vec(),
        };
        AdmittancePolicy { order: 2, mass: Some(mass) }
    };
    let policy = Policy { admittance, ..policy.clone() };
    Policy::parse(&policy.to_json()).map_err(|error| errors::of_policy(law.py(), None, &error))
}

fn make<const D: usize>(
    policy: &Policy,
    settings: &Settings,
    longest_step: f64,
    position: &Axes,
) -> Result<Box<dyn Loop>, ConfigError> {
    let settings = settings.controller([0.0; D], longest_step)?;
    Ok(Box::new(controller::Controller::new(policy.to_hybrid::<D>()?, settings, first(position))?))
}

#[pymethods]
impl PyController {
    /// A controller of `policy` for a robot at rest at `position` [axis unit]; None: at the policy's start.
    ///
    /// law: {"mass": kg} or "first_order"; None: the policy's. Settings are the tables of a settings file of
    /// `hpf run --controller`: limits={"force": N, "offset": m, "velocity": m/s, "acceleration": m/s^2, "position_min": m,
    /// "position_max": m}, trips, readings, tank={"capacity": J, ...}, port, timing, compliance, press [N], each number for
    /// all axes or one per axis; longest_step_s: a longer dt is cut to it, 0.01 where left out.
    ///
    /// Raises ControllerError.
    #[new]
    #[pyo3(signature = (policy, position = None, *, law = None, **settings))]
    fn new(
        py: Python<'_>,
        policy: &Bound<'_, PyPolicy>,
        position: Option<&Bound<'_, PyAny>>,
        law: Option<&Bound<'_, PyAny>>,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let policy = policy.get().get();
        let changed = law.map(|law| with_law(policy, law)).transpose()?;
        let policy = changed.as_ref().unwrap_or(policy);
        let axis = |axis: &hpf_sim::AxisPolicy| Axis {
            name: axis.name.clone(),
            unit: axis.unit,
            start: axis.start,
            goal: axis.goal,
        };
        let axes: Vec<Axis> = policy.axes.iter().map(axis).collect();
        let none = PyDict::new(py);
        let (settings, longest_step) = settings_of(py, settings.unwrap_or(&none), &axes)?;
        let position = match position {
            Some(position) => numbers(position, axes.len(), "position")?,
            None => array::from_fn(|a| axes.get(a).map_or(0.0, |axis| axis.start)),
        };
        let make = match axes.len() {
            1 => make::<1>,
            2 => make::<2>,
            3 => make::<3>,
            4 => make::<4>,
            5 => make::<5>,
            6 => make::<6>,
            _ => make::<7>,
        };
        let inner = make(policy, &settings, longest_step, &position)
            .map_err(|error| errors::plain(py, "ControllerError", &error.to_string()))?;
        Ok(Self { inner, axes, wishes: VecDeque::new() })
    }

    /// One step of `dt` [s]: `force` of the environment on the tool as the sensor reads it [N or N m], shape (axes,), and
    /// how many steps ago that was; `measured_position` [axis unit], where it is to be watched; `rate` of time along the
    /// path, 0 to 1. Returns the hpf.Command.
    #[pyo3(signature = (force, dt, *, measured_position = None, force_age = 0, rate = 1.0))]
    fn update(
        &mut self,
        force: &Bound<'_, PyAny>,
        dt: f64,
        measured_position: Option<&Bound<'_, PyAny>>,
        force_age: u32,
        rate: f64,
    ) -> PyResult<PyCommand> {
        let force = self.axes_from(force, "force")?;
        let position = match measured_position {
            Some(position) => Some(self.axes_from(position, "measured_position")?),
            None => None,
        };
        let step = Step { force, force_age, position, rate, wish: self.wishes.pop_front() };
        Ok(self.inner.update(&step, dt))
    }

    /// Asks to start the movement from where the command is.
    fn start(&mut self) {
        self.wishes.push_back(Wish::Start);
    }

    /// Asks to pause on the path.
    fn hold(&mut self) {
        self.wishes.push_back(Wish::Hold);
    }

    /// Asks to go on along the path.
    fn resume(&mut self) {
        self.wishes.push_back(Wish::Resume);
    }

    /// Asks to stop on the path; only a reset ends it.
    fn stop(&mut self) {
        self.wishes.push_back(Wish::Stop);
    }

    /// Asks to call the present force zero: in "idle", without contact, where `command.tare_ready`.
    fn tare(&mut self) {
        self.wishes.push_back(Wish::Tare);
    }

    /// Asks to go to another goal [axis unit], shape (axes,).
    fn goal(&mut self, position: &Bound<'_, PyAny>) -> PyResult<()> {
        let goal = self.axes_from(position, "goal")?;
        self.wishes.push_back(Wish::Goal(goal));
        Ok(())
    }

    /// Asks to go back to "idle" at the measured `position` [axis unit] of a robot at rest, shape (axes,).
    fn reset(&mut self, position: &Bound<'_, PyAny>) -> PyResult<()> {
        let position = self.axes_from(position, "reset")?;
        self.wishes.push_back(Wish::Reset(position));
        Ok(())
    }

    /// Replaces all settings between two steps, keywords as for the constructor; the command goes on from where it is.
    ///
    /// Raises ControllerError where the present command would break them; the old ones then stay.
    #[pyo3(signature = (**settings))]
    fn set(&mut self, py: Python<'_>, settings: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let none = PyDict::new(py);
        let (settings, longest_step) = settings_of(py, settings.unwrap_or(&none), &self.axes)?;
        let set = self.inner.set(&settings, longest_step);
        set.map_err(|error| errors::plain(py, "ControllerError", &error.to_string()))
    }

    /// What it does: "idle", "run", "hold", "stop" or "fault".
    #[getter]
    fn mode(&self) -> &'static str {
        self.inner.output().mode()
    }

    /// The last command.
    #[getter]
    fn command(&self) -> PyCommand {
        self.inner.output()
    }

    /// Requests that no update has taken yet.
    #[getter]
    fn pending(&self) -> usize {
        self.wishes.len()
    }

    /// The force that is called zero [N or N m], shape (axes,): what the last tare has found.
    #[getter]
    fn bias<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.inner.bias())
    }

    /// How often what has gone wrong, by name.
    #[getter]
    fn counters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Counters { bad_time, long_time, bad_force, bad_input, refused, trips, faults } = self.inner.counters();
        let counters = PyDict::new(py);
        for (name, count) in [
            ("bad_time", bad_time),
            ("long_time", long_time),
            ("bad_force", bad_force),
            ("bad_input", bad_input),
            ("refused", refused),
            ("trips", trips),
            ("faults", faults),
        ] {
            counters.set_item(name, count)?;
        }
        Ok(counters)
    }

    fn __repr__(&self) -> String {
        let axes: Vec<&str> = self.axes.iter().map(|axis| axis.name.as_str()).collect();
        format!("<hpf.Controller: axes {}, {}>", axes.join(", "), self.mode())
    }
}
