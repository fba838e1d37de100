//! The task file: what to learn, in which environment, at what price.
//!
//! [`Task::parse`] reads TOML and answers with every mistake at once, each with its place in the text. The structs
//! below are the file format: [`Task::schema`] and the checks are made from them, so that neither can fall behind.
//! SI units; a per-axis value is one number for all axes or an array in axis order.

mod basis;
mod keys;
mod learning;
mod mistakes;
mod outline;
mod per_axis;
mod process;
mod reading;
mod repair;
mod rules;
mod sizes;

use hpf_core::domain::{DECAY, LARGEST, SMALLEST};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::environment::{Actuator, Contact, Disturbance, Recording, Sensor};

pub(crate) use reading::read;

pub use basis::{BasisFamily, BasisFunctions, BasisTable};
pub(crate) use keys::plain;
pub use learning::{
    AnnealKind, CovarianceKind, CreditKind, ExplorationKind, InitialPath, Learning, Method, Noise, Preset, Safety,
    TemperatureKind,
};
pub use mistakes::{Diagnostic, Mistakes};
pub use per_axis::PerAxis;
pub use process::{Environment, Process};
pub use sizes::MAX_MEMORY;

/// Most axes a task may have.
pub const MAX_AXES: usize = 7;
/// Most basis functions of one primitive.
pub const MAX_BASIS: usize = 1000;
/// Most steps of one rollout.
pub const MAX_STEPS: usize = 1_000_000;
/// Most numbers of one table that learning works on, at 8 bytes each; all together need at most [`MAX_MEMORY`].
pub const MAX_NUMBERS: usize = 50_000_000;
/// How far from whole a number of steps may be that counts as whole, as a share of it.
const WHOLE_STEPS: f64 = 1e-6;
/// Largest task file read [bytes].
pub const MAX_TASK_BYTES: usize = 1 << 20;
/// Distance from the goal, as a share of that at the duration, to which the reference settles within the rest time.
pub const SETTLED: f64 = 0.01;
/// Longest rest time, in durations.
pub const MAX_REST: f64 = 2.0;
/// What a velocity is multiplied by in the cost of rest, in durations.
pub const REST_VELOCITY_TIME: f64 = 0.1;

/// `2 u` where `(1 + u) exp(-u)` is [`SETTLED`]: how a critically damped spring settles.
const SETTLING: f64 = 13.276_704_135_987_623;
/// Goal scaling needs a goal at least this far from the start [axis unit]: the forcing term is scaled by it.
pub const MIN_GOAL_DISTANCE: f64 = 1e-6;

/// A task, checked.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Task {
    /// Name of the task and of its run directory: letters, digits, `_`, `-` and `.`.
    pub name: String,
    /// Duration of the movement [s].
    #[schemars(range(min = SMALLEST, max = LARGEST))]
    pub duration: f64,
    /// Control and logging rate [Hz].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub rate: f64,
    /// One table per degree of freedom.
    #[schemars(length(min = 1, max = 7))]
    pub axis: Vec<Axis>,
    /// The phase all primitives share.
    #[serde(default)]
    pub phase: Phase,
    /// Movement primitive.
    #[serde(default)]
    pub movement: Movement,
    /// Stiffness primitive [N/m].
    pub stiffness: Gain,
    /// Damping primitive [N s/m].
    pub damping: Gain,
    /// Admittance law.
    #[serde(default)]
    pub admittance: Admittance,
    /// Who makes the rollouts; left out, hpf simulates them.
    pub environment: Option<Environment>,
    /// Forces on the tool.
    #[serde(default)]
    #[schemars(length(max = 100))]
    pub disturbance: Vec<Disturbance>,
    /// What the tool touches.
    pub contact: Option<Contact>,
    /// How force is measured; left out, it is known.
    pub sensor: Option<Sensor>,
    /// How the tool follows its command; left out, at once.
    pub actuator: Option<Actuator>,
    /// How motions are recorded; left out, as they are.
    pub recording: Option<Recording>,
    /// Positions to pass through.
    #[serde(default)]
    #[schemars(length(max = 100))]
    pub via_point: Vec<ViaPoint>,
    /// Weights of the cost terms.
    #[serde(default)]
    pub cost: CostWeights,
    /// How to learn.
    #[serde(default)]
    pub learning: Learning,
    /// What to keep.
    #[serde(default)]
    pub output: Output,
    /// Targets.
    #[serde(default)]
    pub accept: Accept,
    /// Whether motions end at the duration, without a rest time: those that a process makes do.
    #[serde(skip)]
    pub ends_at_duration: bool,
}

/// One degree of freedom.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Axis {
    /// Name: a letter, then up to 31 letters, digits or `_`.
    pub name: String,
    /// Unit of its position.
    #[serde(default)]
    pub unit: Unit,
    /// Where the movement starts, at rest [unit].
    pub start: f64,
    /// Where the movement ends [unit].
    pub goal: f64,
}

/// Unit of an axis.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Unit {
    /// Metre: forces in N, stiffness in N/m.
    #[default]
    M,
    /// Radian: torques in N m, stiffness in N m/rad.
    Rad,
}

impl Unit {
    /// As it is written behind a number.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::M => "m",
            Self::Rad => "rad",
        }
    }
}

/// The phase all primitives share: it falls from 1 to exp(-decay).
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Phase {
    /// Decay over the duration: s(T) = exp(-decay).
    #[schemars(range(min = DECAY[0], max = DECAY[1]))]
    pub decay: f64,
}

impl Default for Phase {
    fn default() -> Self {
        Self { decay: libm::log(100.0) }
    }
}

/// The movement primitive: where to go.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Movement {
    /// Basis functions: their number, or their family with it.
    pub basis: BasisFunctions,
    /// Value of a basis function at its neighbour's center.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub overlap: f64,
    /// Spring factor alpha; beta is alpha/4.
    pub alpha: PerAxis,
    /// Scale of the forcing term.
    pub scaling: Scaling,
}

impl Default for Movement {
    fn default() -> Self {
        Self {
            basis: BasisFunctions::default(),
            overlap: hpf_core::basis::DEFAULT_OVERLAP,
            alpha: PerAxis::All(hpf_core::movement::DEFAULT_ALPHA),
            scaling: Scaling::Named(NamedScaling::Goal),
        }
    }
}

/// Scale A of the forcing term.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Scaling {
    /// A named scale.
    Named(NamedScaling),
    /// A given amplitude.
    Given(Amplitude),
}

/// A named scale of the forcing term.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum NamedScaling {
    /// A = goal - start, as in the paper.
    Goal,
    /// A = 1.
    Unit,
}

/// A given scale of the forcing term.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Amplitude {
    /// A [axis unit].
    pub amplitude: PerAxis,
}

/// The stiffness and the damping primitive: how softly to hold the movement.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Gain {
    /// Basis functions: their number, or their family with it.
    #[serde(default)]
    pub basis: BasisFunctions,
    /// Value of a basis function at its neighbour's center.
    #[serde(default = "default_overlap")]
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub overlap: f64,
    /// Value before learning [N/m or N s/m].
    pub initial: PerAxis,
    /// Smallest value [N/m or N s/m], above 0.
    pub min: PerAxis,
    /// Largest value [N/m or N s/m].
    pub max: PerAxis,
}

fn default_overlap() -> f64 {
    hpf_core::basis::DEFAULT_OVERLAP
}

/// The law by which the tool gives way.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Admittance {
    /// Order of the law: 1, `d e' + k e = f`, or 2, `m e'' + d e' + k e = f`.
    #[schemars(range(min = 1, max = 2))]
    pub order: u8,
    /// Virtual mass m of the law of order 2 [kg or kg m^2], above 0.
    pub mass: Option<PerAxis>,
}

impl Default for Admittance {
    fn default() -> Self {
        Self { order: 1, mass: None }
    }
}

/// A position to pass through: at a time, or at any.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct ViaPoint {
    /// When to pass [s], after the start and no later than the duration. Left out: at any time.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub time: Option<f64>,
    /// Where to pass, one number per axis [axis unit].
    pub position: Vec<f64>,
    /// How near is near enough, where it is passed at any time [axis unit]; left out, zero.
    #[schemars(range(min = 0))]
    pub radius: Option<f64>,
}

/// Weights of the cost terms; each term but `via_distance` is half the weight times a square. Zero leaves a term out.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct CostWeights {
    /// Distance to the goal at the end [1/unit^2].
    pub goal: PerAxis,
    /// Velocity at the end [s^2/unit^2].
    pub end_velocity: PerAxis,
    /// Rest: distance to the goal, and a tenth of the duration times the velocity, integrated over the rest time after the
    /// duration [1/(unit^2 s)]. The preset `paper` leaves it out.
    pub rest: PerAxis,
    /// Distance to each via point at its time [1/unit^2].
    pub via_point: PerAxis,
    /// Distance of the nearest sample to each via point that has no time, beyond its radius; the weight times the
    /// distance itself, as part of the term `via_point` [1/unit].
    #[schemars(range(min = 0))]
    pub via_distance: f64,
    /// Deviation from the curve of the contact, integrated over time [1/(unit^2 s)].
    #[schemars(range(min = 0))]
    pub tracking: f64,
    /// Contact force away from its set-point, integrated over time [1/(N^2 s)].
    #[schemars(range(min = 0))]
    pub contact_force: f64,
    /// Acceleration, integrated over time [s^3/unit^2].
    pub acceleration: PerAxis,
    /// Stiffness, integrated over time [m^2/(N^2 s)].
    pub stiffness: PerAxis,
    /// Damping, integrated over time [m^2/(N^2 s^3)].
    pub damping: PerAxis,
}

/// What to keep.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Output {
    /// Updates whose trajectory is kept and drawn, as far as learning gets. Left out: the start, or nothing where a
    /// process makes the motions.
    #[schemars(length(max = 100))]
    pub snapshots: Option<Vec<usize>>,
}

/// Targets: the largest values that pass. `learn` and `run` exit with 3 on a miss. Where something is drawn, the worst of
/// `evaluation_draws` motions counts; of the cost, their mean.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Accept {
    /// Largest deviation from the curve of the contact [m].
    #[schemars(range(min = 0))]
    pub max_deviation: Option<f64>,
    /// Largest error of the contact force after `settling_time` [N].
    #[schemars(range(min = 0))]
    pub max_force_error: Option<f64>,
    /// Time from the start of the motion that `max_force_error` leaves out [s]; left out, 0.1. A shorter motion is judged
    /// at its end.
    #[schemars(range(min = 0))]
    pub settling_time: Option<f64>,
    /// Time without contact, all of it together [s].
    #[schemars(range(min = 0))]
    pub max_contact_loss: Option<f64>,
    /// Largest distance to a via point at its time, or at any beyond its radius [m].
    #[schemars(range(min = 0))]
    pub max_via_error: Option<f64>,
    /// Root of the mean square distance to the via points at their times, over all draws [m].
    #[schemars(range(min = 0))]
    pub rms_via_error: Option<f64>,
    /// Largest distance to the goal at the end [m].
    #[schemars(range(min = 0))]
    pub max_goal_error: Option<f64>,
    /// Largest distance to the goal in the rest time after the duration [m].
    #[schemars(range(min = 0))]
    pub max_rest_error: Option<f64>,
    /// Root of the mean square distance to the goal in the rest time, over all draws [m].
    #[schemars(range(min = 0))]
    pub rms_rest_error: Option<f64>,
    /// Largest speed at the end [m/s].
    #[schemars(range(min = 0))]
    pub max_end_speed: Option<f64>,
    /// Largest cost.
    #[schemars(range(min = 0))]
    pub max_cost: Option<f64>,
}

impl Task {
    /// Reads and checks a task file.
    ///
    /// # Errors
    /// [`Mistakes`]: every one found, in the order of the text.
    ///
    /// ```
    /// let mistakes = hpf_sim::Task::parse("name = 3\n").unwrap_err();
    /// assert_eq!(mistakes[0].message, "the task has no `duration`");
    /// assert!(mistakes.to_string().starts_with("line 1, column 1: the task has no `duration`; "));
    /// ```
    pub fn parse(text: &str) -> Result<Self, Mistakes> {
        if text.trim().is_empty() {
            let help = "a task needs at least name, duration, rate, one [[axis]], [stiffness] and [damping]";
            let empty = Diagnostic { span: 0..0, message: "the file is empty".into(), help: help.into() };
            return Err(Mistakes::new(text, vec![empty]));
        }
        reading::read_checked(text, &Self::schema(), "the task", &rules::check)
            .map_err(|found| Mistakes::new(text, found))
    }

    /// The JSON schema of the task file.
    pub fn schema() -> serde_json::Value {
        serde_json::Value::from(schemars::schema_for!(Self))
    }

    /// Steps of one rollout: duration times rate.
    pub fn steps(&self) -> usize {
        (self.duration * self.rate).round() as usize
    }

    /// Whether the duration is a whole number of steps at `rate` [Hz], and no more than a rollout may have.
    pub fn has_steps_at(&self, rate: f64) -> bool {
        let steps = self.duration * rate;
        (2.0..=MAX_STEPS as f64).contains(&steps.round()) && (steps - steps.round()).abs() <= WHOLE_STEPS * steps
    }

    /// Time [s] that a rollout goes on after the duration: the forcing term fades, then the reference settles to
    /// [`SETTLED`] of its distance from the goal, on the slowest axis; at most [`MAX_REST`] durations, a whole number of
    /// steps. No time where motions end at the duration.
    pub fn rest_time(&self) -> f64 {
        self.rest_steps() as f64 * (self.duration / self.steps() as f64)
    }

    /// Steps of [`Task::rest_time`].
    pub fn rest_steps(&self) -> usize {
        if self.environment.is_some() || self.ends_at_duration {
            return 0;
        }
        let alpha = self.movement.alpha.values().iter().copied().fold(f64::INFINITY, f64::min);
        let durations = (hpf_core::phase::FADE + SETTLING / alpha).min(MAX_REST);
        (durations * self.steps() as f64).ceil() as usize
    }

    /// Weight of the cost of rest on axis `index` that counts: zero where motions end at the duration.
    pub(crate) fn rest_weight(&self, index: usize) -> f64 {
        let is_left_out = self.rest_steps() == 0 || self.learning.preset == Preset::Paper;
        if is_left_out { 0.0 } else { self.cost.rest.of(index) }
    }

    /// Whether motions differ by more than their policy: something is drawn.
    pub fn is_random(&self) -> bool {
        let is_drawn =
            |disturbance: &Disturbance| disturbance.quantities().iter().any(|(_, number)| !number.is_fixed());
        self.disturbance.iter().any(is_drawn) || self.sensor.as_ref().is_some_and(Sensor::is_random)
    }

    /// Motions of one rollout in learning: its draws, one where nothing is drawn.
    pub fn draws(&self) -> usize {
        if self.is_random() { self.learning.draws } else { 1 }
    }

    /// Updates whose trajectory is kept: the start, where the task names none and its motions are simulated.
    pub fn snapshots(&self) -> &[usize] {
        match &self.output.snapshots {
            Some(named) => named,
            None if self.environment.is_none() => &[0],
            None => &[],
        }
    }

    /// Motions that the measures of a policy are taken over, one where nothing is drawn.
    pub fn evaluation_draws(&self) -> usize {
        if self.is_random() { self.learning.evaluation_draws } else { 1 }
    }

    /// Whether `primitive` (movement, stiffness, damping or goal) of axis `axis` is learned.
    pub fn learns(&self, axis: usize, primitive: &str) -> bool {
        self.learning.learn.iter().any(|part| match part.split_once('.') {
            Some((name, part)) => part == primitive && self.axis[axis].name == name,
            None => part == primitive,
        })
    }

    /// Whether the goal of some axis is learned: parameters then hold the goal of every axis.
    pub fn learns_goal(&self) -> bool {
        (0..self.axis.len()).any(|axis| self.learns(axis, "goal"))
    }

    /// The position of axis `name` in the list of axes.
    pub fn axis_index(&self, name: &str) -> Option<usize> {
        self.axis.iter().position(|axis| axis.name == name)
    }
}
