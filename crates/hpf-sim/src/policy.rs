//! The policy file: a learned skill, complete in itself.

mod basis;

use hpf_core::{AxisPrimitives, Basis, ConfigError, Damping, Gain, HybridPrimitive, Law, Movement, Phase, Real};
use serde::{Deserialize, Serialize};

pub use basis::{Family, PolicyBasis};

use crate::task::{self, MAX_AXES, NamedScaling, Scaling, Task, Unit};

/// The format name inside a policy file.
const FORMAT: &str = "hpf-policy";
/// The version this library writes, and the only one it reads.
const VERSION: u32 = 1;
/// Largest policy file read [bytes].
pub const MAX_POLICY_BYTES: usize = 16 << 20;

/// A skill: phase, admittance, and the three primitives of every axis.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Policy {
    /// Always "hpf-policy".
    pub format: String,
    /// Version of the format.
    pub version: u32,
    /// Name of the task it was learned for.
    pub task: String,
    /// Duration of the movement [s].
    pub duration_s: f64,
    /// The phase all primitives share.
    pub phase: PhasePolicy,
    /// The admittance law it was learned with.
    pub admittance: AdmittancePolicy,
    /// The primitives of each axis, in axis order.
    pub axes: Vec<AxisPolicy>,
    /// Where it comes from.
    pub provenance: Provenance,
}

/// The phase of a policy.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PhasePolicy {
    /// s(T) = exp(-decay).
    pub decay: f64,
}

/// The admittance law of a policy.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AdmittancePolicy {
    /// Order of the law, 1 or 2.
    pub order: u8,
    /// Virtual mass of each axis for the law of order 2 [kg or kg m^2].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<Vec<f64>>,
}

/// The primitives of one axis.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AxisPolicy {
    /// Name of the axis.
    pub name: String,
    /// Its unit.
    pub unit: Unit,
    /// Where the movement starts [unit].
    pub start: f64,
    /// Where it ends [unit].
    pub goal: f64,
    /// Where to go.
    pub movement: MovementPolicy,
    /// How stiffly to hold it.
    pub stiffness: GainPolicy,
    /// How much to damp it.
    pub damping: GainPolicy,
}

/// A movement primitive.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct MovementPolicy {
    /// Spring factor.
    pub alpha: f64,
    /// Always alpha/4: critically damped.
    pub beta: f64,
    /// Scale A of the forcing term [unit].
    pub forcing_scale: f64,
    /// What the basis functions are Gaussians of.
    #[serde(default, skip_serializing_if = "Family::is_phase")]
    pub family: Family,
    /// Centers of the basis, oldest phase first.
    pub centers: Vec<f64>,
    /// Widths h_i of the basis; of the time family, what a function has fallen to j spacings from its center.
    pub widths: Vec<f64>,
    /// One weight per basis function.
    pub weights: Vec<f64>,
}

/// A stiffness or damping primitive.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct GainPolicy {
    /// Smallest value [N/m or N s/m].
    pub min: f64,
    /// Largest value [N/m or N s/m].
    pub max: f64,
    /// What the basis functions are Gaussians of.
    #[serde(default, skip_serializing_if = "Family::is_phase")]
    pub family: Family,
    /// Centers of the basis, oldest phase first.
    pub centers: Vec<f64>,
    /// Widths h_i of the basis; of the time family, what a function has fallen to j spacings from its center.
    pub widths: Vec<f64>,
    /// One weight per basis function, within the bounds.
    pub weights: Vec<f64>,
}

/// Where a policy comes from.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Version of HPF that wrote it.
    pub hpf: String,
    /// SHA-256 of the task as run, in hexadecimal.
    pub task_sha256: String,
    /// Seed of the learning.
    pub seed: u64,
    /// Updates that led to it.
    pub updates: usize,
    /// Its cost.
    pub cost: f64,
}

/// Why a policy was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PolicyError {
    /// It is not JSON of the right shape.
    #[error("line {line}, column {column}: {message}")]
    Json {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// What the parser says.
        message: String,
    },
    /// It says to be something else.
    #[error("`{field}` is {found}, this version reads {expected}")]
    Format {
        /// `format` or `version`.
        field: &'static str,
        /// What it says.
        found: String,
        /// What is read.
        expected: String,
    },
    /// One of its numbers cannot be.
    #[error("{place}: {reason}")]
    Value {
        /// Where, such as `axes[0].stiffness.weights[3]`.
        place: String,
        /// What is wrong with it.
        reason: String,
    },
}

fn value_error(place: impl Into<String>, reason: impl ToString) -> PolicyError {
    PolicyError::Value { place: place.into(), reason: reason.to_string() }
}

impl Policy {
    /// The policy before learning: the bare pull to the goal, with the task's initial stiffness and damping.
    ///
    /// # Errors
    /// [`ConfigError`] where the task's numbers overflow; a checked task's do not in any ordinary range.
    pub fn initial(task: &Task) -> Result<Self, ConfigError> {
        let decay = task.phase.decay;
        let lists = |functions: task::BasisFunctions, overlap: f64| {
            basis::spaced(functions.family(), functions.count(), overlap, decay)
        };
        let movement = lists(task.movement.basis, task.movement.overlap)?;
        let gain = |gain: &task::Gain, i: usize| -> Result<GainPolicy, ConfigError> {
            let (family, centers, widths) = lists(gain.basis, gain.overlap)?;
            let weights = vec![gain.initial.of(i); gain.basis.count()];
            Ok(GainPolicy { min: gain.min.of(i), max: gain.max.of(i), family, centers, widths, weights })
        };
        let axes = task.axis.iter().enumerate().map(|(i, axis)| {
            let alpha = task.movement.alpha.of(i);
            Ok(AxisPolicy {
                name: axis.name.clone(),
                unit: axis.unit,
                start: axis.start,
                goal: axis.goal,
                movement: MovementPolicy {
                    alpha,
                    beta: 0.25 * alpha,
                    forcing_scale: match &task.movement.scaling {
                        Scaling::Named(NamedScaling::Goal) => axis.goal - axis.start,
                        Scaling::Named(NamedScaling::Unit) => 1.0,
                        Scaling::Given(given) => given.amplitude.of(i),
                    },
                    family: movement.0,
                    centers: movement.1.clone(),
                    widths: movement.2.clone(),
                    weights: vec![0.0; task.movement.basis.count()],
                },
                stiffness: gain(&task.stiffness, i)?,
                damping: gain(&task.damping, i)?,
            })
        });
        Ok(Self {
            format: FORMAT.into(),
            version: VERSION,
            task: task.name.clone(),
            duration_s: task.duration,
            phase: PhasePolicy { decay },
            admittance: AdmittancePolicy {
                order: task.admittance.order,
                mass: task.admittance.mass.as_ref().map(|mass| (0..task.axis.len()).map(|i| mass.of(i)).collect()),
            },
            axes: axes.collect::<Result<_, _>>()?,
            provenance: Provenance {
                hpf: env!("CARGO_PKG_VERSION").into(),
                task_sha256: String::new(),
                seed: task.learning.seed,
                updates: 0,
                cost: 0.0,
            },
        })
    }

    /// Reads a policy file.
    ///
    /// # Errors
    /// [`PolicyError`] for anything but a policy of this version whose numbers all hold together.
    pub fn parse(text: &str) -> Result<Self, PolicyError> {
        let json = |error: serde_json::Error| {
            let message = error.to_string();
            let message = message.split(" at line ").next().unwrap_or_default().to_owned();
            PolicyError::Json { line: error.line(), column: error.column(), message }
        };
        // Format and version first: another version's fields would only be called unknown.
        let value: serde_json::Value = serde_json::from_str(text).map_err(json)?;
        let found = |field: &str| value.get(field).map_or("missing".to_owned(), ToString::to_string);
        if value.get("format").and_then(|format| format.as_str()) != Some(FORMAT) {
            let expected = format!("\"{FORMAT}\"");
            return Err(PolicyError::Format { field: "format", found: found("format"), expected });
        }
        if value.get("version").and_then(serde_json::Value::as_u64) != Some(VERSION.into()) {
            return Err(PolicyError::Format {
                field: "version",
                found: found("version"),
                expected: VERSION.to_string(),
            });
        }
        let policy: Self = serde_json::from_str(text).map_err(json)?;
        policy.check()?;
        Ok(policy)
    }

    /// The policy as the text of its file: numbers read back to the same bits.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).expect("a policy has no map with keys other than text");
        text.push('\n');
        text
    }

    fn check(&self) -> Result<(), PolicyError> {
        Phase::new(self.duration_s, self.phase.decay)
            .map_err(|reason| value_error("duration_s, phase.decay", reason))?;
        if !(1..=MAX_AXES).contains(&self.axes.len()) {
            return Err(value_error("axes", format!("1 to {MAX_AXES} are allowed, not {}", self.axes.len())));
        }
        self.admittance.check(self.axes.len())?;
        for (i, axis) in self.axes.iter().enumerate() {
            let place = format!("axes[{i}]");
            if self.axes[..i].iter().any(|other| other.name == axis.name) {
                return Err(value_error(format!("{place}.name"), format!("two axes are called `{}`", axis.name)));
            }
            let movement = &axis.movement;
            let decay = self.phase.decay;
            movement.basis().check(&format!("{place}.movement"), decay, &movement.weights)?;
            if (movement.beta - 0.25 * movement.alpha).abs() > 1e-12 * movement.alpha.abs() {
                let reason = format!("must be alpha/4 = {}, not {}", 0.25 * movement.alpha, movement.beta);
                return Err(value_error(format!("{place}.movement.beta"), reason));
            }
            let weights = movement.weights.as_slice();
            Movement::new(axis.start, axis.goal, movement.alpha, movement.forcing_scale, weights)
                .map_err(|reason| value_error(&place, reason))?;
            for (name, gain) in [("stiffness", &axis.stiffness), ("damping", &axis.damping)] {
                let place = format!("{place}.{name}");
                gain.basis().check(&place, decay, &gain.weights)?;
                Gain::new(gain.min, gain.max, []).map_err(|reason| value_error(&place, reason))?;
                for (j, &weight) in gain.weights.iter().enumerate() {
                    Gain::new(gain.min, gain.max, [weight])
                        .map_err(|reason| value_error(format!("{place}.weights[{j}]"), reason))?;
                }
            }
            for (name, mine, first) in [
                ("movement", movement.basis(), self.axes[0].movement.basis()),
                ("stiffness", axis.stiffness.basis(), self.axes[0].stiffness.basis()),
                ("damping", axis.damping.basis(), self.axes[0].damping.basis()),
            ] {
                if mine != first {
                    let reason =
                        "family, centers or widths differ from those of axes[0]: axes share one basis per primitive";
                    return Err(value_error(format!("{place}.{name}"), reason));
                }
            }
        }
        Ok(())
    }

    /// The phase in the scalar `T`.
    ///
    /// # Errors
    /// [`ConfigError`] where a number cannot be in `T`.
    pub fn phase<T: Real>(&self) -> Result<Phase<T>, ConfigError> {
        Phase::new(T::of(self.duration_s), T::of(self.phase.decay))
    }

    /// The bases of movement, stiffness and damping in the scalar `T`.
    ///
    /// # Errors
    /// [`ConfigError`] for a policy without axes, and where a number cannot be in `T`.
    pub fn bases<T: Real>(&self) -> Result<[Basis<T, Vec<T>>; 3], ConfigError> {
        let axis = self.axes.first().ok_or(ConfigError::TooFew { field: "axes", count: 0, least: 1 })?;
        let bases = [axis.movement.basis(), axis.stiffness.basis(), axis.damping.basis()];
        let [movement, stiffness, damping] = bases.map(|basis| basis.to_basis(self.phase.decay));
        Ok([movement?, stiffness?, damping?])
    }

    /// The skill that a control loop steps, with `D` axes.
    ///
    /// # Errors
    /// [`ConfigError`] where the policy has another number of axes.
    pub fn to_hybrid<const D: usize>(&self) -> Result<HybridPrimitive<f64, Vec<f64>, D>, ConfigError> {
        self.to_hybrid_of()
    }

    /// The skill that a control loop steps in the scalar `T`, with `D` axes.
    ///
    /// # Errors
    /// [`ConfigError`] where the policy has another number of axes, and where one of its numbers cannot be in `T`.
    pub fn to_hybrid_of<T: Real, const D: usize>(&self) -> Result<HybridPrimitive<T, Vec<T>, D>, ConfigError> {
        let axes = self.primitives()?;
        let found = axes.len();
        let axes = axes.try_into().map_err(|_| ConfigError::LengthMismatch { field: "axes", found, expected: D })?;
        HybridPrimitive::new(self.phase()?, self.bases()?, axes)
    }

    /// The primitives and the law of each axis in the scalar `T`.
    ///
    /// # Errors
    /// [`ConfigError`] where a number cannot be in `T`.
    pub fn primitives<T: Real>(&self) -> Result<Vec<AxisPrimitives<T, Vec<T>>>, ConfigError> {
        let list = |numbers: &[f64]| -> Vec<T> { numbers.iter().map(|&number| T::of(number)).collect() };
        let gain = |gain: &GainPolicy| Gain::new(T::of(gain.min), T::of(gain.max), list(&gain.weights));
        let axes = self.axes.iter().enumerate().map(|(i, axis)| {
            let movement = &axis.movement;
            let [start, goal, alpha, scale] =
                [axis.start, axis.goal, movement.alpha, movement.forcing_scale].map(T::of);
            Ok(AxisPrimitives {
                movement: Movement::new(start, goal, alpha, scale, list(&movement.weights))?,
                stiffness: gain(&axis.stiffness)?,
                damping: gain(&axis.damping)?,
                law: self.admittance.law(i),
            })
        });
        axes.collect()
    }

    /// The same policy with one of its axes alone.
    ///
    /// # Panics
    /// If there is no such axis.
    pub fn axis(&self, axis: usize) -> Self {
        let mass = self.admittance.mass.as_ref().map(|mass| vec![mass[axis]]);
        Self {
            admittance: AdmittancePolicy { order: self.admittance.order, mass },
            axes: vec![self.axes[axis].clone()],
            ..self.clone()
        }
    }

    /// All weights, axis by axis: movement, stiffness, damping.
    pub fn weights(&self) -> Vec<f64> {
        let lists = self.axes.iter().flat_map(|a| [&a.movement.weights, &a.stiffness.weights, &a.damping.weights]);
        lists.flatten().copied().collect()
    }

    /// The same policy with other weights, in the order of [`Policy::weights`]. Where there is a number more for each
    /// axis, it is the axis' goal and comes after its weights, as in [`Simulation::parameters`](crate::Simulation::parameters).
    ///
    /// # Errors
    /// [`PolicyError::Value`] for any other number of weights.
    pub fn with_weights(mut self, weights: &[f64]) -> Result<Self, PolicyError> {
        let (count, goals) = (self.weights().len(), self.axes.len());
        let has_goals = weights.len() == count + goals;
        if weights.len() != count && !has_goals {
            let reason = format!("{} numbers, where {count} belong, or {} with goals", weights.len(), count + goals);
            return Err(value_error("weights", reason));
        }
        let mut next = weights.iter().copied();
        for axis in &mut self.axes {
            let lists = [&mut axis.movement.weights, &mut axis.stiffness.weights, &mut axis.damping.weights];
            let goal = has_goals.then_some(&mut axis.goal);
            for (slot, weight) in lists.into_iter().flatten().chain(goal).zip(&mut next) {
                *slot = weight;
            }
        }
        Ok(self)
    }
}

impl AdmittancePolicy {
    /// The law of axis `axis`.
    pub fn law<T: Real>(&self, axis: usize) -> Law<T> {
        match self.mass.as_ref().and_then(|mass| mass.get(axis)) {
            None => Law::FirstOrder,
            Some(&mass) => Law::SecondOrder { mass: T::of(mass), damping: Damping::Primitive },
        }
    }

    fn check(&self, axes: usize) -> Result<(), PolicyError> {
        let refuse = |reason: String| Err(value_error("admittance.mass", reason));
        match (self.order, &self.mass) {
            (1, None) => Ok(()),
            (1, Some(_)) => refuse("a law of order 1 has none".into()),
            (2, None) => refuse("missing: a law of order 2 has one".into()),
            (2, Some(mass)) if mass.len() != axes => refuse(format!("{} numbers for {axes} axes", mass.len())),
            (2, Some(mass)) => match mass.iter().find(|mass| !(mass.is_finite() && **mass > 0.0)) {
                Some(mass) => refuse(format!("must be above 0 and finite, not {mass}")),
                None => Ok(()),
            },
            (order, _) => Err(value_error("admittance.order", format!("must be 1 or 2, not {order}"))),
        }
    }
}

impl MovementPolicy {
    /// Its basis.
    pub fn basis(&self) -> PolicyBasis<'_> {
        PolicyBasis { family: self.family, centers: &self.centers, widths: &self.widths }
    }
}

impl GainPolicy {
    /// Its basis.
    pub fn basis(&self) -> PolicyBasis<'_> {
        PolicyBasis { family: self.family, centers: &self.centers, widths: &self.widths }
    }
}
