//! Rollouts: a skill in its environment.
//!
//! A rollout goes on after the duration, over [`Task::rest_time`]: the forcing term fades, forces follow their
//! definition, contact persists, and the tool settles. The phase is known in advance, so the bases are evaluated once per task, at every half step; all rollouts share
//! the tables. Each step goes through the kernels of `hpf-core`: [`PlannedReference`] for the
//! reference, [`relax`] for the tool. Known forces run linearly over a step and contacts are solved together with
//! the admittance law; where the tool meets or leaves a surface inside a step, the step is split there.
//!
//! There is one implementation, over [`Lanes`]: a batch is stepped in several, one rollout with a trace in one. Each
//! lane has the same bits in both.
//!
//! [`PlannedReference`]: hpf_core::PlannedReference
//! [`relax`]: hpf_core::admittance::relax
//! [`Lanes`]: hpf_core::Lanes

mod batch;
mod blocks;
mod controlled;
mod draws;
mod inertial;
mod measured;
mod motion;
mod planned;
mod plant;
mod profiles;
mod recorded;
mod scenario;
mod table;
mod tool;

use hpf_core::admittance::Inertial;
use hpf_core::{ConfigError, Lanes, Real as _};
use hpf_learn::instructions::Instructions;
use hpf_learn::{Block, Cost, Parameters, SignalModel};

use crate::cost::{CostModel, Term};
use crate::policy::Policy;
use crate::task::{MAX_NUMBERS, Task};
use crate::trace::{AxisTrace, ContactTrace, Trace};
use inertial::{FreeInertial, TouchingInertial};
use measured::Measured;
use motion::{Reference, Tool, roll};
use plant::Robot;
use profiles::{Profiles, Tables};
pub use scenario::disturbances;
use scenario::{AxisScenario, Scenario, Set};
use table::Table;
use tool::{ContactModel, Free, Touching};

pub(crate) use batch::LANES;
pub use batch::Workspace;
pub(crate) use motion::{Sample, Sink};
pub(crate) use planned::Planned;

/// Why a skill cannot be simulated in a task.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// The policy's numbers are refused.
    #[error("the policy is refused: {0}")]
    Policy(#[from] ConfigError),
    /// The policy was made for other axes.
    #[error("the policy moves the axes {policy}, the task has {task}")]
    Axes {
        /// Names in the policy.
        policy: String,
        /// Names in the task.
        task: String,
    },
    /// The tables would not fit into memory.
    #[error("{steps} steps of {parameters} parameters are too much, at most {MAX_NUMBERS} numbers fit: lower the rate")]
    TooLarge {
        /// Steps of one rollout.
        steps: usize,
        /// Parameters of the policy.
        parameters: usize,
    },
    /// The task is another program's to run.
    #[error("the environment of this task is a process, which only `hpf learn` talks to: there is nothing to simulate")]
    Process,
    /// The controller refuses the settings, or the skill with them.
    #[error("the controller refuses: {0}")]
    Controller(ConfigError),
    /// Nothing of the settings presses.
    #[error("`press` presses on nothing: no axis presses by `compliance`, or has a contact with a force in the task")]
    PressesNothing,
    /// The policy takes another time.
    #[error("the policy takes {policy} s, the task {task} s")]
    Duration {
        /// Of the policy [s].
        policy: f64,
        /// Of the task [s].
        task: f64,
    },
}

/// A task made ready for rollouts of one policy's structure: any weights, one environment, one rate.
#[derive(Clone, Debug)]
pub struct Simulation {
    pub(crate) blocks: Vec<Block>,
    pub(crate) task: Task,
    blank: Trace,
    dt: f64,
    tables: Tables,
    /// Gate of the forcing term at mid-steps, of movement and rest time.
    drive: Vec<f64>,
    steps: usize,
    /// Steps of a rollout that costs are taken of: with the rest time where rest costs something.
    priced_steps: usize,
    axes: Vec<AxisModel>,
    contact: Option<ContactModel>,
    cost: CostModel,
    pub(crate) signals: SignalModel,
    /// The first of the draws that policies are measured by: what a trace shows.
    shown: Scenario,
    pub(crate) is_random: bool,
    /// Whether forces last into the rest time, or differ from draw to draw: the tool then cannot rest at its goal.
    pub(crate) is_pushed_at_rest: bool,
    /// Where forces are measured.
    robot: Option<Robot>,
    instructions: Instructions,
}

/// What a rollout needs of one axis.
#[derive(Clone, Debug)]
struct AxisModel {
    alone: Reference<1>,
    lanes: Reference<LANES>,
    /// Where its parameters start, and where each primitive's and the goal end.
    parameters: [usize; 5],
    /// The law of its tool, where it has inertia.
    inertial: Option<Inertial<f64>>,
    largest_stiffness: f64,
}

impl Simulation {
    /// Makes `task` ready for rollouts with the phase, bases, start, goal and bounds of `policy`.
    ///
    /// # Errors
    /// [`SimulationError`] where policy and task do not belong together.
    pub fn new(task: &Task, policy: &Policy) -> Result<Self, SimulationError> {
        if task.environment.is_some() {
            return Err(SimulationError::Process);
        }
        let names = |names: Vec<&str>| names.join(", ");
        let policy_names: Vec<&str> = policy.axes.iter().map(|axis| axis.name.as_str()).collect();
        let task_names: Vec<&str> = task.axis.iter().map(|axis| axis.name.as_str()).collect();
        if policy_names != task_names {
            return Err(SimulationError::Axes { policy: names(policy_names), task: names(task_names) });
        }
        if policy.duration_s != task.duration {
            return Err(SimulationError::Duration { policy: policy.duration_s, task: task.duration });
        }
        let steps = task.steps();
        let parameters = policy.weights().len();
        if steps.saturating_mul(parameters) > MAX_NUMBERS {
            return Err(SimulationError::TooLarge { steps, parameters });
        }
        let duration = policy.duration_s;
        let dt = duration / steps as f64;
        let rest_steps = task.rest_steps();
        let all_steps = steps + rest_steps;
        let phase = policy.phase()?;
        let half_steps: Vec<f64> = (0..=2 * all_steps).map(|h| phase.at(0.5 * dt * h as f64).s).collect();
        let middle_phase: Vec<f64> = half_steps.iter().copied().skip(1).step_by(2).collect();
        let bases = policy.bases()?;
        let time: Vec<f64> = (0..=all_steps).map(|i| i as f64 * dt).collect();

        let contact = task.contact.as_ref().and_then(|contact| {
            let axis = task.axis_index(contact.axis())?;
            let start = policy.axes[axis].start;
            let surface = |h: usize| contact.surface(h as f64 / (2 * steps) as f64, start);
            Some(ContactModel {
                axis,
                initial_position: contact.initial_position(start),
                surfaces: (0..=2 * all_steps).map(surface).collect(),
            })
        });
        let mut parameters = 0;
        let mut axes: Vec<AxisModel> = Vec::new();
        for axis in &policy.axes {
            let m = &axis.movement;
            let counts = [m.weights.len(), axis.stiffness.weights.len(), axis.damping.weights.len()];
            let counts = counts.into_iter().chain([usize::from(task.learns_goal())]);
            let mut ends = [parameters; 5];
            for (j, count) in counts.enumerate() {
                ends[j + 1] = ends[j] + count;
            }
            parameters = ends[4];
            let touched = contact.as_ref().filter(|contact| contact.axis == axes.len());
            // A controller starts its reference where the tool is.
            let start = touched.map_or(axis.start, |contact| contact.initial_position);
            let numbers = [start, axis.goal, m.alpha, m.forcing_scale];
            let most = axis.stiffness.max + touched.map_or(0.0, ContactModel::largest_stiffness);
            let mass = policy.admittance.mass.as_ref().map(|mass| mass[axes.len()]);
            let inertia = mass.map(|mass| [mass, most, axis.damping.max]);
            axes.push(AxisModel {
                alone: Reference::new(numbers, inertia, dt, duration)?,
                lanes: Reference::new(numbers, inertia, dt, duration)?,
                parameters: ends,
                inertial: inertia.map(|[mass, most, damping]| Inertial::new(mass, most, damping, dt)).transpose()?,
                largest_stiffness: axis.stiffness.max,
            });
        }
        let blank = Trace {
            phase: half_steps.iter().copied().step_by(2).collect(),
            rest_steps,
            axes: vec![AxisTrace::sized(all_steps + 1); axes.len()],
            contact: contact.as_ref().zip(task.contact.as_ref()).map(|(model, contact)| ContactTrace {
                axis: model.axis,
                travel: (0..=all_steps).map(|i| contact.travel(i as f64 / steps as f64)).collect(),
                deflection: model.surfaces.iter().step_by(2).map(|surface| surface.deflection).collect(),
                deviation: vec![0.0; all_steps + 1],
                force: vec![0.0; all_steps + 1],
                set_point: model.surfaces[0].set_point,
            }),
            time,
        };
        let cost = CostModel::new(task);
        let tables = Tables {
            movement: Table::new(&bases[0], middle_phase.iter().copied()),
            stiffness: Table::new(&bases[1], half_steps.iter().copied()),
            damping: Table::new(&bases[2], half_steps.iter().copied()),
        };
        let counts: Vec<usize> = axes.iter().map(|axis| axis.parameters[4] - axis.parameters[0]).collect();
        let prices = |a| {
            let [stiffness, damping] = [&tables.stiffness, &tables.damping].map(|table| table.samples(steps + 1));
            let [stiffness, damping] = cost.gain_prices(a, &stiffness, &damping, dt);
            let goal = task.learns_goal().then(Vec::new);
            [Vec::new(), stiffness, damping].into_iter().chain(goal)
        };
        let groups = cost.signal_groups(&counts, steps, contact.as_ref().map(|contact| contact.axis));
        let distances = cost.distances(&groups, steps);
        let price = (0..axes.len()).flat_map(prices).collect();
        let signals = draws::repeated(SignalModel { groups, price, distances }, task.draws());
        let mut evaluation = Scenario::of_set(task, Set::Evaluation, task.evaluation_draws());
        let shown = evaluation.next().expect("at least one draw");
        drop(evaluation);
        Ok(Self {
            blocks: blocks::blocks(task, policy, &bases, &middle_phase[..steps]),
            task: task.clone(),
            blank,
            dt,
            tables,
            drive: middle_phase.iter().map(|&s| phase.gate(s)).collect(),
            steps,
            priced_steps: if cost.weighs_rest() { all_steps } else { steps },
            axes,
            contact,
            cost,
            signals,
            is_random: task.is_random(),
            is_pushed_at_rest: task.is_random() || shown.lasts_beyond(steps),
            shown,
            robot: (task.sensor.is_some() || task.actuator.is_some()).then(|| Robot::of(task, dt)),
            instructions: Instructions::best(),
        })
    }

    /// The same simulation in the instructions that every processor has, for comparison: it is slower, and every
    /// number is the same.
    #[must_use]
    pub fn portable(mut self) -> Self {
        self.instructions = Instructions::portable();
        self
    }

    /// Steps of the movement.
    pub fn step_count(&self) -> usize {
        self.steps
    }

    /// A trace of the right size, for [`Simulation::rollout_into`].
    pub fn blank_trace(&self) -> Trace {
        self.blank.clone()
    }

    /// The motion of the skill with `weights`, in the order of [`Simulation::parameters`]; where something is drawn, in
    /// the first of the draws that policies are measured by.
    pub fn rollout(&self, weights: &[f64]) -> Trace {
        let mut trace = self.blank_trace();
        self.rollout_into(Parameters::Constant(weights), &mut trace);
        trace
    }

    /// What `trace` costs, by term.
    pub fn cost(&self, trace: &Trace) -> Cost {
        let mut cost = Cost::default();
        self.cost_into(trace, &mut cost);
        cost
    }

    pub(crate) fn cost_into(&self, trace: &Trace, cost: &mut Cost) {
        self.cost.evaluate(trace, cost);
    }

    /// The weighted signals of `trace` whose half squares are its cost, without that of stiffness and damping, in the
    /// order of [`hpf_learn::Problem::signals`].
    pub fn signals_into(&self, trace: &Trace, signals: &mut Vec<f64>) {
        self.cost.signals(trace, signals);
    }

    /// What of `trace` a model of the environment reads: position and force of each axis, deviation and force of the
    /// contact, each at every sample.
    pub fn motion_into(&self, trace: &Trace, motion: &mut Vec<f64>) {
        motion.clear();
        let contact = trace.contact.as_ref().map(|contact| [&contact.deviation, &contact.force]);
        let signals = trace.axes.iter().map(|axis| [&axis.position, &axis.force]).chain(contact);
        signals.flatten().for_each(|signal| motion.extend(&signal[..self.priced_samples()]));
    }

    /// The names of the cost's terms, in the order of its columns.
    pub fn term_names(&self) -> &'static [&'static str] {
        &Term::NAMES
    }

    /// Writes the motion of the skill with `parameters` into `trace`, as [`Simulation::rollout`].
    pub fn rollout_into(&self, parameters: Parameters<'_>, trace: &mut Trace) {
        self.rollout_in(&self.shown, parameters, trace);
    }

    /// Writes the motion of the skill in `scenario` into `trace`.
    fn rollout_in(&self, scenario: &Scenario, parameters: Parameters<'_>, trace: &mut Trace) {
        for (a, (model, axis)) in self.axes.iter().zip(&mut trace.axes).enumerate() {
            let contact = trace.contact.as_mut().filter(|contact| contact.axis == a);
            let profiles = self.rowwise(model, parameters);
            self.roll_axis(a, self.drive.len(), &model.alone, &profiles, &scenario.axes[a], Recorder { axis, contact });
        }
    }

    /// Number of parameters of all axes.
    fn parameter_count(&self) -> usize {
        self.axes.last().map_or(0, |axis| axis.parameters[4])
    }

    /// The motion of axis `a` over `steps`, each sample handed to `sink`.
    #[inline(always)]
    fn roll_axis<const N: usize>(
        &self,
        a: usize,
        steps: usize,
        reference: &Reference<N>,
        profiles: &impl Profiles<N>,
        scenario: &AxisScenario,
        sink: impl Sink<N>,
    ) {
        let (dt, drive, forces) = (self.dt, &self.drive[..steps], &scenario.forces);
        let contact = self.contact.as_ref().filter(|contact| contact.axis == a);
        if let Some(robot) = self.robot {
            let tool = Measured::new(dt, robot, scenario, contact, reference.inertial, reference.start());
            return roll_rarely(reference, drive, profiles, tool, sink);
        }
        match (contact, reference.inertial, self.axes[a].inertial) {
            (Some(contact), _, Some(law)) => {
                let held = [self.axes[a].largest_stiffness, reference.start().to_f64()];
                let tool = TouchingInertial::new(dt, forces, contact, law, held);
                roll_rarely(reference, drive, profiles, tool, sink);
            }
            (Some(contact), ..) => roll(reference, drive, profiles, Touching::new(dt, forces, contact), sink),
            (None, Some(law), _) => roll(reference, drive, profiles, FreeInertial::new(dt, forces, law), sink),
            (None, None, _) => roll(reference, drive, profiles, Free::new(dt, forces), sink),
        }
    }
}

/// [`roll`] for tools that gain nothing from vector registers, compiled once.
#[inline(never)]
fn roll_rarely<const N: usize>(
    reference: &Reference<N>,
    drive: &[f64],
    profiles: &impl Profiles<N>,
    tool: impl Tool<N>,
    sink: impl Sink<N>,
) {
    roll(reference, drive, profiles, tool, sink);
}

/// Writes the samples of one axis into its trace.
struct Recorder<'a> {
    axis: &'a mut AxisTrace,
    contact: Option<&'a mut ContactTrace>,
}

impl Sink<1> for Recorder<'_> {
    fn take(&mut self, i: usize, sample: &Sample<1>) {
        let axis = &mut *self.axis;
        for (signal, Lanes([value])) in [
            (&mut axis.reference_position, sample.reference_position),
            (&mut axis.reference_velocity, sample.reference_velocity),
            (&mut axis.position, sample.position),
            (&mut axis.velocity, sample.velocity),
            (&mut axis.force, sample.force),
            (&mut axis.stiffness, sample.stiffness),
            (&mut axis.damping, sample.damping),
        ] {
            signal[i] = value;
        }
        if let (Some(contact), Some([deviation, force])) = (&mut self.contact, sample.contact) {
            [contact.deviation[i], contact.force[i]] = [deviation.0[0], force.0[0]];
        }
    }
}
