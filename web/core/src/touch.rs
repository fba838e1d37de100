//! The controller of a robot under the hand of who looks at the page: steps of about 1 ms, in the environment of the task.
//!
//! The robot is one that follows every command at once and whose sensor does not err, as in a simulation of a task
//! without `[sensor]` and `[actuator]`. Without a pull its motion is that of `hpf run --controller --rate 1000`, to the
//! bit. A contact that no loop of this rate can hold is left out, and [`WebTouch::notes`] says so.

use core::array;

use hpf_core::ConfigError;
use hpf_core::controller::{self, Controller, Input, Mode, Output};
use hpf_sim::environment::disturbance::Side;
use hpf_sim::environment::{Contact, Disturbance};
use hpf_sim::robot::{Settings, Tally};
use hpf_sim::task::{MAX_AXES, Task};
use hpf_sim::{Policy, disturbances};
use wasm_bindgen::JsError;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::refused;
use crate::task::WebTask;

/// Steps in a second, about: a movement takes a whole number of them [Hz].
const RATE: f64 = 1000.0;

/// Numbers of each axis in [`WebTouch::state`].
const PER_AXIS: usize = 8;
/// Numbers before those of the axes.
const BEFORE: usize = 6;

/// Numbers of every axis; those past the last are not looked at.
type Axes = [f64; MAX_AXES];

/// What acts on the tool beside the hand.
#[derive(Clone)]
pub struct Environment {
    /// Steps of the movement.
    steps: usize,
    /// Step [s].
    dt: f64,
    /// Where each axis starts.
    starts: Vec<f64>,
    axes: Vec<String>,
    contact: Option<(usize, Contact)>,
    disturbances: Vec<Disturbance>,
}

impl Environment {
    /// That of `task`, and what is left out of it.
    pub fn of(task: &Task) -> (Self, Vec<String>) {
        let mut notes = Vec::new();
        let mut task = task.clone();
        let is_held = task.least_rate().is_some_and(|rate| rate <= RATE);
        let contact = task.contact.take().and_then(|contact| {
            let axis = task.axis_index(contact.axis())?;
            if is_held {
                return Some((axis, contact));
            }
            notes.push(format!(
                "The {} is left out here: a loop of {RATE} Hz that measures its force cannot hold a contact this stiff.",
                contact.kind()
            ));
            None
        });
        task.rate = RATE;
        let steps = task.steps();
        let environment = Self {
            steps,
            dt: task.duration / steps as f64,
            starts: task.axis.iter().map(|axis| axis.start).collect(),
            axes: task.axis.iter().map(|axis| axis.name.clone()).collect(),
            contact,
            disturbances: disturbances(&task).into_iter().next().unwrap_or_default(),
        };
        (environment, notes)
    }

    /// Where the tool of `axis` is at first.
    fn start(&self, axis: usize) -> f64 {
        let start = self.starts[axis];
        self.touching(axis).map_or(start, |contact| contact.initial_position(start))
    }

    fn touching(&self, axis: usize) -> Option<&Contact> {
        self.contact.as_ref().filter(|(touched, _)| *touched == axis).map(|(_, contact)| contact)
    }

    /// Force with which the tool of `axis` is to press, along the axis [N].
    fn push(&self, axis: usize) -> f64 {
        self.touching(axis).map_or(0.0, |contact| {
            let surface = contact.surface(0.0, self.starts[axis]);
            surface.direction * surface.set_point
        })
    }

    /// Force on the tool of `axis` at `position` at sample `i` [N].
    fn force(&self, axis: usize, i: usize, position: f64) -> f64 {
        let time = i as f64 * self.dt;
        let acting = self.disturbances.iter().filter(|one| one.axis() == self.axes[axis]);
        let disturbing = acting.map(|one| one.force(time, Side::After)).sum::<f64>();
        let answer = self.touching(axis).map_or(0.0, |contact| {
            let surface = contact.surface((2 * i) as f64 / (2 * self.steps) as f64, self.starts[axis]);
            -surface.direction * surface.contact_force(position)
        });
        disturbing + answer
    }
}

/// What is asked of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request {
    /// Start the movement.
    Start,
    /// Pause on the path.
    Hold,
    /// Go on along the path.
    Resume,
    /// Stop for good.
    Stop,
    /// Back to Idle where the robot is.
    Reset,
    /// Go to another goal.
    Goal(Axes),
}

/// A controller of any number of axes.
trait Loop {
    fn step(&mut self, environment: &Environment, i: usize, pull: &Axes, request: Option<Request>);
    fn output(&self) -> (Output<f64, MAX_AXES>, usize);
    fn set(&mut self, environment: &Environment, settings: &Settings) -> Result<(), ConfigError>;
}

impl<const D: usize> Loop for Controller<f64, Vec<f64>, D> {
    fn step(&mut self, environment: &Environment, i: usize, pull: &Axes, request: Option<Request>) {
        let position = Controller::output(self).axes.map(|axis| axis.position);
        let request = request.map(|request| match request {
            Request::Start => controller::Request::Start,
            Request::Hold => controller::Request::Hold,
            Request::Resume => controller::Request::Resume,
            Request::Stop => controller::Request::Stop,
            Request::Reset => controller::Request::Reset(position),
            Request::Goal(goal) => controller::Request::Goal(array::from_fn(|axis| goal[axis])),
        });
        let force = |axis: usize| environment.force(axis, i, position[axis]) + pull[axis];
        let input = Input {
            measured_force: array::from_fn(force),
            force_age: 0,
            measured_position: Some(position),
            rate: 1.0,
            request,
        };
        self.update(&input, environment.dt);
    }

    fn output(&self) -> (Output<f64, MAX_AXES>, usize) {
        let Output { axes, phase, rate, energy, port_energy, mode, status } = Controller::output(self);
        let axes = array::from_fn(|axis| axes[axis.min(D - 1)]);
        (Output { axes, phase, rate, energy, port_energy, mode, status }, D)
    }

    fn set(&mut self, environment: &Environment, settings: &Settings) -> Result<(), ConfigError> {
        let settings = settings.controller(array::from_fn(|axis| environment.push(axis)), environment.dt)?;
        Controller::set(self, settings)
    }
}

/// A skill under the hand.
pub struct Touch {
    control: Box<dyn Loop>,
    environment: Environment,
    /// Steps made.
    made: usize,
    pull: Axes,
    request: Option<Request>,
}

impl Touch {
    /// The controller of `policy` with `settings` in `environment`, in Idle at the start.
    ///
    /// # Errors
    /// What the controller refuses.
    pub fn new(policy: &Policy, environment: Environment, settings: &Settings) -> Result<Self, ConfigError> {
        fn of<const D: usize>(
            policy: &Policy,
            environment: &Environment,
            settings: &Settings,
        ) -> Result<Box<dyn Loop>, ConfigError> {
            let settings = settings.controller(array::from_fn(|axis| environment.push(axis)), environment.dt)?;
            let starts = array::from_fn(|axis| environment.start(axis));
            Ok(Box::new(Controller::new(policy.to_hybrid::<D>()?, settings, starts)?))
        }
        let make = match policy.axes.len() {
            1 => of::<1>,
            2 => of::<2>,
            3 => of::<3>,
            4 => of::<4>,
            5 => of::<5>,
            6 => of::<6>,
            _ => of::<7>,
        };
        let control = make(policy, &environment, settings)?;
        Ok(Self { control, environment, made: 0, pull: [0.0; MAX_AXES], request: None })
    }

    /// Asks for `request` in the next step.
    pub fn ask(&mut self, request: Request) {
        self.request = Some(request);
    }

    /// Pulls with `pull` [N], one number per axis, from the next step on.
    pub fn pull(&mut self, pull: &[f64]) {
        self.pull = array::from_fn(|axis| pull.get(axis).copied().unwrap_or(0.0));
    }

    /// Makes `steps` steps.
    pub fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            let request = self.request.take();
            if request == Some(Request::Start) {
                // The environment begins with the movement.
                self.made = 0;
            }
            self.control.step(&self.environment, self.made, &self.pull, request);
            self.made += 1;
        }
    }

    /// The last output and the number of axes.
    pub fn output(&self) -> (Output<f64, MAX_AXES>, usize) {
        self.control.output()
    }
}

/// [`Touch`] for JavaScript.
#[wasm_bindgen]
pub struct WebTouch {
    touch: Touch,
    task: Task,
    notes: Vec<String>,
}

fn settings_of(text: &str, task: &Task) -> Result<Settings, JsError> {
    Settings::parse(text, &task.axis).map_err(refused)
}

/// The first numbers of `numbers`.
fn axes(numbers: &[f64]) -> Axes {
    array::from_fn(|axis| numbers.get(axis).copied().unwrap_or(0.0))
}

#[wasm_bindgen]
impl WebTouch {
    /// The controller of `policy` (JSON) in `task`, with `settings` (TOML, of the form of `hpf run --settings`).
    ///
    /// # Errors
    /// What is wrong with the policy or the settings.
    #[wasm_bindgen(constructor)]
    pub fn new(task: &WebTask, policy: &str, settings: &str) -> Result<WebTouch, JsError> {
        let policy = Policy::parse(policy).map_err(refused)?;
        let names = |names: Vec<&str>| names.join(", ");
        let of_policy = names(policy.axes.iter().map(|axis| axis.name.as_str()).collect());
        let of_task = names(task.task.axis.iter().map(|axis| axis.name.as_str()).collect());
        if of_policy != of_task {
            return Err(refused(format!("the policy moves the axes {of_policy}, the task has {of_task}")));
        }
        let settings = settings_of(settings, &task.task)?;
        let (environment, notes) = Environment::of(&task.task);
        let touch = Touch::new(&policy, environment, &settings).map_err(refused)?;
        Ok(Self { touch, task: task.task.clone(), notes })
    }

    /// What is left out of the environment.
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Other settings.
    ///
    /// # Errors
    /// What is wrong with them; then the old ones stay.
    pub fn set(&mut self, settings: &str) -> Result<(), JsError> {
        let settings = settings_of(settings, &self.task)?;
        self.touch.control.set(&self.touch.environment, &settings).map_err(refused)
    }

    /// Asks for `start`, `hold`, `resume`, `stop` or `reset` in the next step.
    ///
    /// # Errors
    /// For another word.
    pub fn ask(&mut self, request: &str) -> Result<(), JsError> {
        self.touch.ask(match request {
            "start" => Request::Start,
            "hold" => Request::Hold,
            "resume" => Request::Resume,
            "stop" => Request::Stop,
            "reset" => Request::Reset,
            other => return Err(refused(format!("`{other}` is no request"))),
        });
        Ok(())
    }

    /// Asks for the goal `goal`, one number per axis.
    pub fn goal(&mut self, goal: &[f64]) {
        self.touch.ask(Request::Goal(axes(goal)));
    }

    /// Pulls with `force` [N], one number per axis, until told otherwise.
    pub fn pull(&mut self, force: &[f64]) {
        self.touch.pull(force);
    }

    /// Makes `steps` steps of [`WebTouch::dt`].
    pub fn advance(&mut self, steps: u32) {
        self.touch.advance(steps);
    }

    /// Length of a step [s].
    pub fn dt(&self) -> f64 {
        self.touch.environment.dt
    }

    /// Time since the start [s], phase, rate, energy in the tank [J], mode (0 Idle, 1 Run, 2 Hold, 3 Stop, 4 Fault),
    /// events (1 ended, 2 refused, 4 force tripped, 8 energy short); then of each axis: position, reference, velocity,
    /// stiffness, damping, offset, force in the model, limits hit (1 force, 2 offset, 4 velocity, 8 acceleration,
    /// 16 position).
    pub fn state(&self) -> Vec<f64> {
        let (output, count) = self.touch.output();
        let bits = |flags: &[bool]| flags.iter().rev().fold(0.0, |sum, flag| 2.0 * sum + f64::from(u8::from(*flag)));
        let mode = match output.mode {
            Mode::Idle => 0.0,
            Mode::Run => 1.0,
            Mode::Hold => 2.0,
            Mode::Stop => 3.0,
            Mode::Fault => 4.0,
        };
        let status = &output.status;
        let events = bits(&[status.ended, status.refused, status.force_tripped, status.energy_short]);
        let mut state = Vec::with_capacity(BEFORE + PER_AXIS * count);
        let time = self.touch.made as f64 * self.dt();
        state.extend([time, output.phase, output.rate, output.energy, mode, events]);
        for axis in &output.axes[..count] {
            let reference = axis.position - axis.offset;
            let hits = bits(&Tally::of(&axis.hits));
            state.extend([axis.position, reference, axis.velocity, axis.stiffness, axis.damping]);
            state.extend([axis.offset, axis.force, hits]);
        }
        state
    }
}
