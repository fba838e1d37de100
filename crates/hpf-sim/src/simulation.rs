//! Rollouts: a skill in its environment.
//!
//! The phase is known in advance, so the bases are evaluated once per task, at every half step; all rollouts share
//! the tables. Each step goes through the kernels of `hpf-core` that a control loop runs: [`Transition`] for the
//! reference, [`relax`] for the tool. Known forces run linearly over a step and contacts are solved together with
//! the admittance law; where the tool meets or leaves a surface inside a step, the step is split there.

use hpf_core::admittance::{Instant, relax};
use hpf_core::{Basis, ConfigError, Movement, Transition};
use hpf_learn::{Block, Cost, Parameters, SignalModel};

use crate::cost::{CostModel, Term};
use crate::environment::disturbance::Side;
use crate::environment::{Disturbance, Surface};
use crate::policy::Policy;
use crate::task::{MAX_NUMBERS, Task};
use crate::trace::{AxisTrace, ContactTrace, Trace};

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
    duration: f64,
    /// `phi_i` at mid-steps: steps x n.
    movement: Table,
    /// `phi_i` at half steps: (2 steps + 1) x n.
    stiffness: Table,
    damping: Table,
    /// Phase at mid-steps.
    middle_phase: Vec<f64>,
    axes: Vec<AxisModel>,
    contact: Option<ContactModel>,
    cost: CostModel,
    pub(crate) signals: SignalModel,
}

/// Basis functions by row: one row per instant.
#[derive(Clone, Debug)]
struct Table {
    count: usize,
    rows: Vec<f64>,
}

impl Table {
    fn new(basis: &Basis<f64, Vec<f64>>, phases: impl Iterator<Item = f64>) -> Self {
        let mut table = Self { count: basis.count(), rows: Vec::new() };
        for phase in phases {
            let start = table.rows.len();
            table.rows.resize(start + table.count, 0.0);
            basis.features_into(phase, &mut table.rows[start..]);
        }
        table
    }

    /// The rows of whole steps.
    fn samples(&self) -> Vec<&[f64]> {
        self.rows.chunks_exact(self.count).step_by(2).collect()
    }

    #[inline]
    fn mix(&self, row: usize, weights: &[f64]) -> f64 {
        let features = &self.rows[row * self.count..(row + 1) * self.count];
        features.iter().zip(weights).map(|(phi, w)| phi * w).sum()
    }
}

/// What a rollout needs of one axis.
#[derive(Clone, Debug)]
struct AxisModel {
    movement: Movement<f64, [f64; 0]>,
    transition: Transition<f64>,
    /// Where its parameters start, and where each primitive's ends.
    parameters: [usize; 4],
    /// Disturbing force just after the start and just before the end of each step, and after the last.
    force: Vec<(f64, f64)>,
}

#[derive(Clone, Debug)]
struct ContactModel {
    axis: usize,
    initial_position: f64,
    /// At every half step.
    surfaces: Vec<Surface>,
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
        let phase = policy.phase()?;
        let half_steps: Vec<f64> = (0..=2 * steps).map(|h| phase.at(0.5 * dt * h as f64)).collect();
        let middle_phase: Vec<f64> = half_steps.iter().copied().skip(1).step_by(2).collect();
        let bases = policy.bases()?;
        let time: Vec<f64> = (0..=steps).map(|i| i as f64 * dt).collect();

        let mut parameters = 0;
        let mut axes = Vec::new();
        for axis in &policy.axes {
            let m = &axis.movement;
            let counts = [m.weights.len(), axis.stiffness.weights.len(), axis.damping.weights.len()];
            let mut ends = [parameters; 4];
            for (j, count) in counts.into_iter().enumerate() {
                ends[j + 1] = ends[j] + count;
            }
            parameters = ends[3];
            let acting: Vec<&Disturbance> = task.disturbance.iter().filter(|d| d.axis() == axis.name).collect();
            let force = |time: f64, side: Side| acting.iter().map(|d| d.force(time, side)).sum::<f64>();
            let after = |i: usize| force(time[i], Side::After);
            let steps_force = (0..steps).map(|i| (after(i), force(time[i + 1], Side::Before)));
            axes.push(AxisModel {
                movement: Movement::new(axis.start, axis.goal, m.alpha, m.forcing_scale, [])?,
                transition: Transition::new(m.alpha, dt / duration),
                parameters: ends,
                force: steps_force.chain([(after(steps), after(steps))]).collect(),
            });
        }

        let contact = task.contact.as_ref().and_then(|contact| {
            let axis = task.axis_index(contact.axis())?;
            let start = policy.axes[axis].start;
            let surface = |h: usize| contact.surface(h as f64 / (2 * steps) as f64, start);
            Some(ContactModel {
                axis,
                initial_position: contact.initial_position(start),
                surfaces: (0..=2 * steps).map(surface).collect(),
            })
        });
        let blank = Trace {
            phase: half_steps.iter().copied().step_by(2).collect(),
            axes: vec![AxisTrace::sized(steps + 1); axes.len()],
            contact: contact.as_ref().zip(task.contact.as_ref()).map(|(model, contact)| ContactTrace {
                axis: model.axis,
                travel: (0..=steps).map(|i| contact.travel(i as f64 / steps as f64)).collect(),
                deflection: model.surfaces.iter().step_by(2).map(|surface| surface.deflection).collect(),
                deviation: vec![0.0; steps + 1],
                force: vec![0.0; steps + 1],
                set_point: model.surfaces[0].set_point,
            }),
            time,
        };
        let cost = CostModel::new(task);
        let stiffness = Table::new(&bases[1], half_steps.iter().copied());
        let damping = Table::new(&bases[2], half_steps.iter().copied());
        let counts: Vec<usize> = axes.iter().map(|axis| axis.parameters[3] - axis.parameters[0]).collect();
        let prices = |a| {
            let [stiffness, damping] = cost.gain_prices(a, &stiffness.samples(), &damping.samples(), dt);
            [Vec::new(), stiffness, damping]
        };
        let signals = SignalModel {
            groups: cost.signal_groups(&counts, steps, contact.as_ref().map(|contact| contact.axis)),
            price: (0..axes.len()).flat_map(prices).collect(),
        };
        Ok(Self {
            blocks: blocks(task, policy, &bases, &middle_phase),
            task: task.clone(),
            blank,
            dt,
            duration,
            movement: Table::new(&bases[0], middle_phase.iter().copied()),
            stiffness,
            damping,
            middle_phase,
            axes,
            contact,
            cost,
            signals,
        })
    }

    /// Steps of one rollout.
    pub fn step_count(&self) -> usize {
        self.middle_phase.len()
    }

    /// A trace of the right size, for [`Simulation::rollout_into`].
    pub fn blank_trace(&self) -> Trace {
        self.blank.clone()
    }

    /// The motion of the skill with `weights`, in the order of [`Policy::weights`].
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

    /// The names of the cost's terms, in the order of its columns.
    pub fn term_names(&self) -> &'static [&'static str] {
        &Term::NAMES
    }

    /// Writes the motion of the skill with `parameters` into `trace`.
    pub fn rollout_into(&self, parameters: Parameters<'_>, trace: &mut Trace) {
        for (a, (model, axis)) in self.axes.iter().zip(&mut trace.axes).enumerate() {
            let [start, movement_end, stiffness_end, end] = model.parameters;
            let steps = self.step_count();
            for i in 0..=steps {
                let row = parameters.at(i);
                axis.stiffness[i] = self.stiffness.mix(2 * i, &row[movement_end..stiffness_end]);
                axis.damping[i] = self.damping.mix(2 * i, &row[stiffness_end..end]);
            }
            self.roll_reference(model, |i| &parameters.at(i)[start..movement_end], axis);
            let middle = |i: usize| {
                let row = parameters.at(i);
                let stiffness = self.stiffness.mix(2 * i + 1, &row[movement_end..stiffness_end]);
                (stiffness, self.damping.mix(2 * i + 1, &row[stiffness_end..end]))
            };
            match (&self.contact, &mut trace.contact) {
                (Some(contact), Some(signals)) if contact.axis == a => {
                    self.roll_contact(model, contact, middle, axis, signals);
                }
                _ => self.roll_offset(model, middle, axis),
            }
        }
    }

    /// The reference motion of one axis.
    fn roll_reference<'p>(&self, model: &AxisModel, weights: impl Fn(usize) -> &'p [f64], axis: &mut AxisTrace) {
        let mut state = model.movement.initial_state();
        axis.reference_position[0] = state.position;
        axis.reference_velocity[0] = state.scaled_velocity / self.duration;
        for (i, &phase) in self.middle_phase.iter().enumerate() {
            let forcing = model.movement.forcing(phase, self.movement.mix(i, weights(i)));
            model.transition.apply(&mut state, model.movement.goal(), forcing);
            axis.reference_position[i + 1] = state.position;
            axis.reference_velocity[i + 1] = state.scaled_velocity / self.duration;
        }
    }

    /// The tool of an axis that touches nothing: the law of the offset, the reference being exact.
    fn roll_offset(&self, model: &AxisModel, middle: impl Fn(usize) -> (f64, f64), axis: &mut AxisTrace) {
        let instant = |axis: &AxisTrace, i: usize, force: f64| Instant {
            stiffness: axis.stiffness[i],
            damping: axis.damping[i],
            reference_position: 0.0,
            reference_velocity: 0.0,
            load_force: force,
            load_stiffness: 0.0,
        };
        let mut offset = 0.0;
        for i in 0..=self.step_count() {
            let (after, before_next) = model.force[i];
            let now = instant(axis, i, after);
            axis.force[i] = after;
            axis.position[i] = axis.reference_position[i] + offset;
            axis.velocity[i] = axis.reference_velocity[i] + now.velocity(offset);
            if i < self.step_count() {
                let next = instant(axis, i + 1, before_next);
                let (stiffness, damping) = middle(i);
                offset = relax(offset, now.target(), next.target(), stiffness / damping * self.dt);
            }
        }
    }

    /// The tool of an axis in contact: the coupled law of its position, split where it meets or leaves the surface.
    fn roll_contact(
        &self,
        model: &AxisModel,
        contact: &ContactModel,
        middle: impl Fn(usize) -> (f64, f64),
        axis: &mut AxisTrace,
        signals: &mut ContactTrace,
    ) {
        let instant = |axis: &AxisTrace, i: usize, force: f64, touching: bool| {
            let surface = &contact.surfaces[2 * i];
            let load_stiffness = if touching { surface.stiffness } else { 0.0 };
            Instant {
                stiffness: axis.stiffness[i],
                damping: axis.damping[i],
                reference_position: axis.reference_position[i],
                reference_velocity: axis.reference_velocity[i],
                load_force: force + surface.direction * surface.set_point + load_stiffness * surface.position,
                load_stiffness,
            }
        };
        let mut position = contact.initial_position;
        for i in 0..=self.step_count() {
            let surface = &contact.surfaces[2 * i];
            let (after, before_next) = model.force[i];
            let touching = surface.depth(position) >= 0.0;
            let now = instant(axis, i, after, touching);
            axis.force[i] = now.force(position);
            axis.position[i] = position;
            axis.velocity[i] = now.velocity(position);
            signals.deviation[i] = surface.deviation(position);
            signals.force[i] = surface.contact_force(position);
            if i < self.step_count() {
                let (stiffness, damping) = middle(i);
                position = cross(position, touching, surface, |touching| {
                    let ends = [instant(axis, i, after, touching), instant(axis, i + 1, before_next, touching)];
                    let load_stiffness = if touching { contact.surfaces[2 * i + 1].stiffness } else { 0.0 };
                    let lambda = (stiffness + load_stiffness) / damping;
                    Segment { start: ends[0].target(), end: ends[1].target(), lambda_dt: lambda * self.dt }
                });
            }
        }
    }
}

/// One step in one mode, touching or free: the target at both ends and lambda times the step.
#[derive(Clone, Copy)]
struct Segment {
    start: f64,
    end: f64,
    lambda_dt: f64,
}

impl Segment {
    /// The position at share `to` of the step, from `position` at share `from`.
    fn advance(&self, position: f64, from: f64, to: f64) -> f64 {
        let target = |share: f64| self.start + share * (self.end - self.start);
        relax(position, target(from), target(to), self.lambda_dt * (to - from))
    }
}

/// A step may meet or leave the surface this often; a motion that does so more often within one step is not resolved.
const MOST_CROSSINGS: usize = 8;

/// Advances `position` by one step, changing between touching and free where the surface is crossed.
fn cross(mut position: f64, mut touching: bool, surface: &Surface, segment: impl Fn(bool) -> Segment) -> f64 {
    let mut done = 0.0;
    for _ in 0..MOST_CROSSINGS {
        let mode = segment(touching);
        let end = mode.advance(position, done, 1.0);
        let inside = surface.depth(end) >= 0.0;
        if inside == touching || done >= 1.0 {
            return end;
        }
        let (mut before, mut after) = (done, 1.0);
        // Halving an interval of at most 1 this often leaves nothing between its ends.
        for _ in 0..f64::MANTISSA_DIGITS {
            let share = 0.5 * (before + after);
            if (surface.depth(mode.advance(position, done, share)) >= 0.0) == touching {
                before = share;
            } else {
                after = share;
            }
        }
        (position, done, touching) = (surface.position, after, !touching);
    }
    segment(touching).advance(position, done, 1.0)
}

/// The parameters of `policy` as the learner sees them: three blocks per axis.
fn blocks(task: &Task, policy: &Policy, bases: &[Basis<f64, Vec<f64>>; 3], phases: &[f64]) -> Vec<Block> {
    let tables = bases.each_ref().map(|basis| {
        let mut features = vec![0.0; phases.len() * basis.count()];
        let mut activations = features.clone();
        let rows = features.chunks_exact_mut(basis.count()).zip(activations.chunks_exact_mut(basis.count()));
        for ((features, activations), &phase) in rows.zip(phases) {
            basis.features_into(phase, features);
            basis.activations_into(phase, activations);
        }
        (features, activations)
    });
    let noise = &task.learning.noise;
    let mut blocks = Vec::new();
    for (a, axis) in policy.axes.iter().enumerate() {
        let unbounded = (f64::NEG_INFINITY, f64::INFINITY);
        let primitives = [
            ("movement", unbounded, &noise.movement),
            ("stiffness", (axis.stiffness.min, axis.stiffness.max), &noise.stiffness),
            ("damping", (axis.damping.min, axis.damping.max), &noise.damping),
        ];
        for ((name, (min, max), noise), (basis, (features, activations))) in
            primitives.into_iter().zip(bases.iter().zip(&tables))
        {
            blocks.push(Block {
                name: format!("{}.{name}", axis.name),
                count: basis.count(),
                features: features.clone(),
                activations: activations.clone(),
                min,
                max,
                noise: noise.of(a),
            });
        }
    }
    blocks
}
