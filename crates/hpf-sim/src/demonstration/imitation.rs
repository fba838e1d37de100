//! The policy of some demonstrations.

use hpf_core::{Basis, ConfigError};
use hpf_learn::fit::{self, FitError};

use super::Demonstration;
use super::gains::{self, Bounds, DampingFrom, Identified, StiffnessFrom};
use super::path::{Aligned, AlignedAxis, Alignment, Frame, mean};
use super::signal::{Smoothing, differences};
use crate::policy::{GainPolicy, Policy};
use crate::task::{MIN_GOAL_DISTANCE, NamedScaling, Scaling, Task, Unit};
use crate::trace::Trace;

/// How weights are fitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fit {
    /// All weights of a profile at once.
    #[default]
    Ridge,
    /// Each weight by its own neighbourhood: the paper's regression.
    LocallyWeighted,
}

/// How demonstrations become a policy. SI units, for an axis in rad those of rotation.
#[derive(Clone, Debug, PartialEq)]
pub struct Imitation {
    /// How weights are fitted.
    pub fit: Fit,
    /// Penalty on weights of the movement, relative to the square of the forcing scale.
    pub penalty: f64,
    /// What is done to positions before they are differentiated.
    pub smoothing: Smoothing,
    /// Where stiffness comes from; left out, the first of columns, muscle activity, spread that an axis has, else the
    /// initial value.
    pub stiffness: Option<StiffnessFrom>,
    /// Where damping comes from; left out, from columns where an axis has them, from force where its stiffness is, else
    /// the initial value.
    pub damping: Option<DampingFrom>,
    /// Cut-off of the muscle activity's envelope [Hz].
    pub emg_cut_off: f64,
    /// Window of [`StiffnessFrom::Force`] [s]; left out, a tenth of the duration.
    pub window: Option<f64>,
    /// Damping ratio of [`DampingFrom::Ratio`]; 1 is critical.
    pub damping_ratio: f64,
    /// Mass of [`DampingFrom::Ratio`] [kg].
    pub mass: f64,
}

impl Default for Imitation {
    fn default() -> Self {
        Self {
            fit: Fit::Ridge,
            penalty: 1e-9,
            smoothing: Smoothing::Basis,
            stiffness: None,
            damping: None,
            emg_cut_off: 3.0,
            window: None,
            damping_ratio: 1.0,
            mass: 1.0,
        }
    }
}

/// Penalty on weights of a gain, for features that sum to one at each sample: what no sample reaches becomes the mean.
const GAIN_PENALTY: f64 = 1e-6;

/// A recording that begins or ends faster than this share of its largest speed is said to.
const REST_SPEED: f64 = 0.05;

/// Why demonstrations were refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImitationError {
    /// A demonstration moves other axes.
    #[error("it moves the axes {found}, {expected} are wanted")]
    Axes {
        /// Which demonstration, counted from 0.
        demonstration: usize,
        /// Names and units in the demonstration.
        found: String,
        /// Names and units wanted.
        expected: String,
    },
    /// A signal that was asked for is missing.
    #[error("axis `{axis}` has no column {column}, which {purpose} needs")]
    Missing {
        /// Which demonstration, counted from 0.
        demonstration: usize,
        /// The axis.
        axis: String,
        /// The missing column.
        column: String,
        /// What it was wanted for.
        purpose: &'static str,
    },
    /// Goal scaling of a demonstration that ends where it starts.
    #[error(
        "axis `{axis}` ends within {MIN_GOAL_DISTANCE:e} of its start: goal scaling has nothing to scale by; \
         scale by unit or range"
    )]
    NoTravel {
        /// Which demonstration, counted from 0.
        demonstration: usize,
        /// The axis.
        axis: String,
    },
    /// The movement has fewer steps than weights.
    #[error("{steps} steps cannot determine {basis} basis functions; take fewer, or a higher rate")]
    TooFewSteps {
        /// Steps of the task.
        steps: usize,
        /// Basis functions of one primitive.
        basis: usize,
    },
    /// One demonstration has no spread.
    #[error("stiffness from spread needs at least two demonstrations, there is one")]
    OneDemonstration,
    /// The force of one demonstration says nothing without a reference.
    #[error("gains from force need a reference column, such as {axis}_reference_m, or at least two demonstrations")]
    NoReference {
        /// An axis without.
        axis: String,
    },
    /// The data say nothing about a gain.
    #[error("axis `{axis}`: {reason}")]
    Uninformative {
        /// The axis.
        axis: String,
        /// Why.
        reason: &'static str,
    },
    /// A profile could not be fitted.
    #[error("axis `{axis}`: {reason}")]
    Fit {
        /// The axis.
        axis: String,
        /// Why.
        reason: FitError,
    },
    /// The task's numbers are refused.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

impl ImitationError {
    /// The demonstration at fault, counted from 0, where it is one's.
    pub fn demonstration(&self) -> Option<usize> {
        match self {
            Self::Axes { demonstration, .. }
            | Self::Missing { demonstration, .. }
            | Self::NoTravel { demonstration, .. } => Some(*demonstration),
            _ => None,
        }
    }
}

/// A policy, and what it was made of.
#[derive(Clone, Debug)]
pub struct Imitated {
    /// The policy.
    pub policy: Policy,
    /// Each demonstration as it was recorded, by axis at each sample of the policy, carried to the task's start and
    /// goal where they are others [m].
    pub demonstrations: Vec<Vec<Vec<f64>>>,
    /// Where the stiffness of each axis comes from.
    pub stiffness: Vec<StiffnessFrom>,
    /// Where the damping of each axis comes from.
    pub damping: Vec<DampingFrom>,
    /// What the user should know.
    pub notes: Vec<String>,
}

impl Imitated {
    /// The mean demonstration of `axis` [m].
    pub fn mean(&self, axis: usize) -> Vec<f64> {
        mean(self.demonstrations.iter().map(|demonstration| demonstration[axis].as_slice()))
    }

    /// Root mean square of the distance between the reference of `trace` and the mean demonstration, by axis [m].
    pub fn errors(&self, trace: &Trace) -> Vec<f64> {
        let error = |(a, axis): (usize, &crate::AxisTrace)| distance(&axis.reference_position, &self.mean(a));
        trace.axes.iter().enumerate().map(error).collect()
    }

    /// Root mean square of the distance between the demonstrations and their mean, by axis [m].
    pub fn spread(&self) -> Vec<f64> {
        let spread = |a: usize| {
            let middle = self.mean(a);
            let squares = self.demonstrations.iter().map(|one| distance(&one[a], &middle).powi(2));
            (squares.sum::<f64>() / self.demonstrations.len() as f64).sqrt()
        };
        (0..self.policy.axes.len()).map(spread).collect()
    }
}

/// Root mean square of the difference.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

/// Features of a basis at some phases, and how profiles are fitted to them.
struct Profile {
    fit: Fit,
    count: usize,
    features: Vec<f64>,
    activations: Vec<f64>,
}

impl Profile {
    fn new(fit: Fit, basis: &Basis<f64, Vec<f64>>, phases: &[f64]) -> Self {
        let count = basis.count();
        let table = |write: &dyn Fn(f64, &mut [f64])| {
            let mut table = vec![0.0; phases.len() * count];
            table.chunks_exact_mut(count).zip(phases).for_each(|(row, phase)| write(*phase, row));
            table
        };
        let activations = match fit {
            Fit::Ridge => Vec::new(),
            Fit::LocallyWeighted => table(&|s, row| basis.activations_into(s, row)),
        };
        Self { fit, count, features: table(&|s, row| basis.features_into(s, row)), activations }
    }

    /// The weights of a forcing term `s sum w phi` that come nearest to `forcing`.
    fn movement(&self, phases: &[f64], forcing: &[f64], penalty: f64) -> Result<Vec<f64>, FitError> {
        match self.fit {
            Fit::Ridge => {
                let rows = self.features.chunks_exact(self.count).zip(phases);
                let features: Vec<f64> = rows.flat_map(|(row, s)| row.iter().map(move |phi| s * phi)).collect();
                fit::ridge(&features, self.count, forcing, penalty)
            }
            Fit::LocallyWeighted => fit::locally_weighted(&self.activations, self.count, phases, forcing, penalty),
        }
    }

    /// The weights within `bounds` of the gain that comes nearest to `values`, where there are any.
    fn gain(&self, values: &[Option<f64>], bounds: Bounds) -> Result<Vec<f64>, FitError> {
        let known: Vec<f64> = values.iter().copied().flatten().collect();
        let rows = |table: &[f64]| -> Vec<f64> {
            let rows = table.chunks_exact(self.count).zip(values).filter(|(_, value)| value.is_some());
            rows.flat_map(|(row, _)| row).copied().collect()
        };
        let middle = known.iter().sum::<f64>() / known.len() as f64;
        match self.fit {
            Fit::Ridge => {
                let bounds = [bounds.min, bounds.max];
                fit::bounded_ridge(&rows(&self.features), self.count, &known, GAIN_PENALTY, middle, bounds)
            }
            Fit::LocallyWeighted => {
                let rest: Vec<f64> = known.iter().map(|value| value - middle).collect();
                let ones = vec![1.0; known.len()];
                let rows = rows(&self.activations);
                let weights = fit::locally_weighted(&rows, self.count, &ones, &rest, GAIN_PENALTY)?;
                Ok(weights.into_iter().map(|w| (middle + w).max(bounds.min).min(bounds.max)).collect())
            }
        }
    }
}

/// Everything that the axes of one imitation share.
struct Work<'w> {
    options: &'w Imitation,
    task: &'w Task,
    recordings: Vec<Aligned>,
    /// Stiffness and damping at the samples of the policy.
    profiles: [Profile; 2],
    notes: Vec<String>,
}

impl Imitation {
    /// The policy in the structure of `task` that imitates `demonstrations`, at least one.
    ///
    /// The policy takes duration, start and goal from the task. Where those of a demonstration are others, its path is
    /// fitted in its own and carried over, as a movement primitive carries it.
    ///
    /// # Errors
    /// [`ImitationError`] where the demonstrations do not have what is asked for.
    pub fn of(&self, demonstrations: &[Demonstration], task: &Task) -> Result<Imitated, ImitationError> {
        same_axes(demonstrations, task)?;
        let steps = task.steps();
        let basis = task.movement.basis.max(task.stiffness.basis).max(task.damping.basis);
        if steps < basis {
            return Err(ImitationError::TooFewSteps { steps, basis });
        }
        let mut policy = Policy::initial(task)?;
        let phase = policy.phase()?;
        let at = |share: f64| phase.at(share * task.duration);
        let middle: Vec<f64> = (0..steps).map(|i| at((i as f64 + 0.5) / steps as f64)).collect();
        let samples: Vec<f64> = (0..=steps).map(|i| at(i as f64 / steps as f64)).collect();
        let [movement, stiffness, damping] = policy.bases()?;
        let movement = Profile::new(self.fit, &movement, &middle);
        let alignment =
            Alignment { steps, basis: task.movement.basis, smoothing: self.smoothing, emg_cut_off: self.emg_cut_off };
        let names = || task.axis.iter().map(|axis| axis.name.as_str());
        let mut work = Work {
            options: self,
            task,
            recordings: demonstrations.iter().map(|one| alignment.of(one, names())).collect(),
            profiles: [&stiffness, &damping].map(|basis| Profile::new(self.fit, basis, &samples)),
            notes: Vec::new(),
        };
        let mut carried = vec![Vec::new(); demonstrations.len()];
        let (mut stiffness_from, mut damping_from) = (Vec::new(), Vec::new());
        for (a, axis) in policy.axes.iter_mut().enumerate() {
            let (alpha, scale) = (axis.movement.alpha, axis.movement.forcing_scale);
            let target = Frame { start: axis.start, goal: axis.goal, scale };
            let frames = work.frames(a, scale)?;
            let refused = |reason| ImitationError::Fit { axis: axis.name.clone(), reason };
            let forcing = work.forcing(a, &frames, alpha);
            axis.movement.weights = movement.movement(&middle, &forcing, self.penalty).map_err(refused)?;
            for ((carried, recording), frame) in carried.iter_mut().zip(&work.recordings).zip(&frames) {
                carried.push(frame.carry_to(&target, alpha, &recording.axes[a].recorded));
            }
            let identified = work.identified(a)?;
            stiffness_from.push(work.stiffness(a, identified.as_ref(), &mut axis.stiffness)?);
            damping_from.push(work.damping(a, identified.as_ref(), &axis.stiffness, &mut axis.damping)?);
            work.note_motion_at_ends(a);
        }
        Ok(Imitated {
            policy,
            demonstrations: carried,
            stiffness: stiffness_from,
            damping: damping_from,
            notes: work.notes,
        })
    }
}

/// An error unless every demonstration has the axes of the task.
fn same_axes(demonstrations: &[Demonstration], task: &Task) -> Result<(), ImitationError> {
    let list = |axes: &mut dyn Iterator<Item = (&str, Unit)>| {
        let unit = |unit| if unit == Unit::M { "m" } else { "rad" };
        let mut names: Vec<String> = axes.map(|(name, of)| format!("{name} [{}]", unit(of))).collect();
        names.sort();
        names.join(", ")
    };
    let expected = list(&mut task.axis.iter().map(|axis| (axis.name.as_str(), axis.unit)));
    for (demonstration, one) in demonstrations.iter().enumerate() {
        let found = list(&mut one.axes.iter().map(|axis| (axis.name.as_str(), axis.unit)));
        if found != expected {
            return Err(ImitationError::Axes { demonstration, found, expected });
        }
    }
    Ok(())
}

impl Work<'_> {
    fn name(&self, a: usize) -> String {
        self.task.axis[a].name.clone()
    }

    fn axes(&self, a: usize) -> impl Iterator<Item = &AlignedAxis> {
        self.recordings.iter().map(move |recording| &recording.axes[a])
    }

    /// Start, goal and forcing scale of axis `a` in each recording; `scale` is the policy's own.
    fn frames(&self, a: usize, scale: f64) -> Result<Vec<Frame>, ImitationError> {
        let by_goal = self.task.movement.scaling == Scaling::Named(NamedScaling::Goal);
        let frame = |(demonstration, axis): (usize, &AlignedAxis)| {
            let (start, goal) = (axis.position[0], axis.position[axis.position.len() - 1]);
            if by_goal && (goal - start).abs() < MIN_GOAL_DISTANCE {
                return Err(ImitationError::NoTravel { demonstration, axis: self.name(a) });
            }
            Ok(Frame { start, goal, scale: if by_goal { goal - start } else { scale } })
        };
        self.axes(a).enumerate().map(frame).collect()
    }

    /// The forcing, in units of its scale, that serves all recordings best: `sum A f / sum A^2`. Its regression on
    /// `s phi` is theirs, each on `s A phi`, in one.
    fn forcing(&self, a: usize, frames: &[Frame], alpha: f64) -> Vec<f64> {
        let steps = self.task.steps();
        let mut sum = vec![0.0; steps];
        for (axis, frame) in self.axes(a).zip(frames) {
            let forcing = fit::movement_forcing(&axis.position, frame.goal, alpha, 1.0 / steps as f64);
            sum.iter_mut().zip(forcing).for_each(|(sum, f)| *sum += frame.scale * f);
        }
        let squares: f64 = frames.iter().map(|frame| frame.scale * frame.scale).sum();
        sum.iter().map(|sum| sum / squares).collect()
    }

    /// The signal that `pick` takes of axis `a` in every recording.
    fn signal<'s>(
        &'s self,
        a: usize,
        pick: impl Fn(&'s AlignedAxis) -> Option<&'s [f64]>,
        endings: [&str; 2],
        purpose: &'static str,
    ) -> Result<Vec<&'s [f64]>, ImitationError> {
        let of = |(demonstration, axis)| {
            pick(axis).ok_or_else(|| {
                let ending = endings[usize::from(self.task.axis[a].unit == Unit::Rad)];
                let column = format!("{}_{ending}", self.name(a));
                ImitationError::Missing { demonstration, axis: self.name(a), column, purpose }
            })
        };
        self.axes(a).enumerate().map(of).collect()
    }

    /// Where the stiffness of axis `a` comes from, by what it has.
    fn stiffness_source(&self, a: usize) -> StiffnessFrom {
        self.options.stiffness.unwrap_or_else(|| {
            if self.axes(a).all(|axis| axis.stiffness.is_some()) {
                StiffnessFrom::Columns
            } else if self.axes(a).all(|axis| axis.emg.is_some()) {
                StiffnessFrom::Emg
            } else if self.recordings.len() > 1 {
                StiffnessFrom::Spread
            } else {
                StiffnessFrom::Constant
            }
        })
    }

    /// Where the damping of axis `a` comes from, by what it has.
    fn damping_source(&self, a: usize) -> DampingFrom {
        self.options.damping.unwrap_or_else(|| {
            if self.axes(a).all(|axis| axis.damping.is_some()) {
                DampingFrom::Columns
            } else if self.stiffness_source(a) == StiffnessFrom::Force {
                DampingFrom::Force
            } else {
                DampingFrom::Constant
            }
        })
    }

    fn bounds(&self, a: usize) -> [Bounds; 2] {
        [&self.task.stiffness, &self.task.damping].map(|gain| Bounds { min: gain.min.of(a), max: gain.max.of(a) })
    }

    /// What the force of axis `a` says, where it is asked.
    fn identified(&mut self, a: usize) -> Result<Option<Identified>, ImitationError> {
        if self.stiffness_source(a) != StiffnessFrom::Force && self.damping_source(a) != DampingFrom::Force {
            return Ok(None);
        }
        self.signal(a, |axis| axis.force.as_deref(), ["force_n", "torque_nm"], "gains from force")?;
        if self.recordings.len() < 2 && self.axes(a).any(|axis| axis.reference.is_none()) {
            return Err(ImitationError::NoReference { axis: self.name(a) });
        }
        let steps = self.task.steps();
        let window = self.options.window.map_or(0.1, |window| window / self.task.duration);
        let half = ((0.5 * window * steps as f64).round() as usize).max(1);
        let [stiffness, damping] = self.bounds(a);
        let found = gains::from_force(&self.recordings, a, half, stiffness, damping);
        let says = found.iter().flatten().count();
        if says == 0 {
            let reason = "the recorded force determines no stiffness and damping: the tool has to leave its reference, \
                          and at changing speed";
            return Err(ImitationError::Uninformative { axis: self.name(a), reason });
        }
        if says < found.len() {
            let share = 100.0 * says as f64 / found.len() as f64;
            let name = self.name(a);
            self.notes.push(format!(
                "axis `{name}`: the force determines the gains over {share:.0} % of the movement; elsewhere they go on from there"
            ));
        }
        Ok(Some(found))
    }

    /// Fits the stiffness of axis `a` into `gain`.
    fn stiffness(
        &mut self,
        a: usize,
        identified: Option<&Identified>,
        gain: &mut GainPolicy,
    ) -> Result<StiffnessFrom, ImitationError> {
        let source = self.stiffness_source(a);
        let bounds = self.bounds(a)[0];
        let uninformative = |reason| ImitationError::Uninformative { axis: self.name(a), reason };
        let profile = match source {
            StiffnessFrom::Constant => return Ok(source),
            StiffnessFrom::Columns => {
                let endings = ["stiffness_n_m", "stiffness_nm_rad"];
                let recorded = self.signal(a, |axis| axis.stiffness.as_deref(), endings, "stiffness from columns")?;
                let profile = all(&mean(recorded.iter().copied()));
                let note = outside(&self.name(a), "stiffness", &recorded, bounds);
                self.notes.extend(note);
                profile
            }
            StiffnessFrom::Spread => {
                if self.recordings.len() < 2 {
                    return Err(ImitationError::OneDemonstration);
                }
                let paths: Vec<&[f64]> = self.axes(a).map(|axis| axis.position.as_slice()).collect();
                let reason = "the demonstrations spread alike everywhere, which says nothing about stiffness; \
                              take it from elsewhere, such as constant";
                all(&gains::from_spread(&paths, bounds).ok_or_else(|| uninformative(reason))?)
            }
            StiffnessFrom::Emg => {
                let activity = self.signal(a, |axis| axis.emg.as_deref(), ["emg"; 2], "stiffness from emg")?;
                let reason = "the muscle activity is nought throughout";
                all(&gains::from_emg(&activity, bounds).ok_or_else(|| uninformative(reason))?)
            }
            StiffnessFrom::Force => {
                let identified = identified.expect("force was asked before stiffness");
                identified.iter().map(|found| found.map(|(k, _)| k)).collect()
            }
        };
        gain.weights = self.fit(a, 0, &profile, bounds)?;
        Ok(source)
    }

    /// Fits the damping of axis `a` into `gain`, `stiffness` being fitted.
    fn damping(
        &mut self,
        a: usize,
        identified: Option<&Identified>,
        stiffness: &GainPolicy,
        gain: &mut GainPolicy,
    ) -> Result<DampingFrom, ImitationError> {
        let source = self.damping_source(a);
        let bounds = self.bounds(a)[1];
        let profile = match source {
            DampingFrom::Constant => return Ok(source),
            DampingFrom::Columns => {
                let endings = ["damping_n_s_m", "damping_nm_s_rad"];
                let recorded = self.signal(a, |axis| axis.damping.as_deref(), endings, "damping from columns")?;
                let profile = all(&mean(recorded.iter().copied()));
                let note = outside(&self.name(a), "damping", &recorded, bounds);
                self.notes.extend(note);
                profile
            }
            DampingFrom::Force => {
                let identified = identified.expect("force was asked before damping");
                identified.iter().map(|found| found.map(|(_, d)| d)).collect()
            }
            DampingFrom::Ratio => {
                let table = &self.profiles[0];
                let mix = |row: &[f64]| row.iter().zip(&stiffness.weights).map(|(phi, w)| phi * w).sum();
                let profile: Vec<f64> = table.features.chunks_exact(table.count).map(mix).collect();
                let critical = gains::from_ratio(&profile, self.options.damping_ratio, self.options.mass);
                let note = outside(&self.name(a), "damping", &[&critical], bounds);
                self.notes.extend(note);
                all(&critical)
            }
        };
        gain.weights = self.fit(a, 1, &profile, bounds)?;
        Ok(source)
    }

    fn fit(&self, a: usize, which: usize, profile: &[Option<f64>], bounds: Bounds) -> Result<Vec<f64>, ImitationError> {
        let fitted = self.profiles[which].gain(profile, bounds);
        fitted.map_err(|reason| ImitationError::Fit { axis: self.name(a), reason })
    }

    /// Notes a recording that begins or ends in motion: a policy cannot.
    fn note_motion_at_ends(&mut self, a: usize) {
        let mut notes = Vec::new();
        for (number, (recording, axis)) in self.recordings.iter().zip(self.axes(a)).enumerate() {
            let velocity = differences(&axis.position, recording.dt);
            let most = velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
            let unit = if self.task.axis[a].unit == Unit::M { "m/s" } else { "rad/s" };
            for (when, speed) in [("begins", velocity[0]), ("ends", velocity[velocity.len() - 1])] {
                if speed.abs() > REST_SPEED * most {
                    notes.push(format!(
                        "demonstration {} {when} at {speed:.3} {unit} on axis `{}`; a policy starts and ends at rest",
                        number + 1,
                        self.name(a)
                    ));
                }
            }
        }
        self.notes.extend(notes);
    }
}

fn all(values: &[f64]) -> Vec<Option<f64>> {
    values.iter().copied().map(Some).collect()
}

/// A note of a profile that leaves its bounds.
fn outside(axis: &str, name: &str, profiles: &[&[f64]], bounds: Bounds) -> Option<String> {
    let values = profiles.iter().copied().flatten();
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    // A mixture of weights at a bound may pass it by a rounding.
    let margin = 1e-9 * bounds.max;
    let is_outside = low < bounds.min - margin || high > bounds.max + margin;
    let Bounds { min, max } = bounds;
    is_outside
        .then(|| format!("axis `{axis}`: {name} from {low:.4} to {high:.4} is held within its bounds, {min} to {max}"))
}
