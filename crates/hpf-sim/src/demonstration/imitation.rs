//! The policy of some demonstrations.

use hpf_core::phase::FADE;
use hpf_learn::fit;

use super::error::ImitationError;
use super::gains::{DampingFrom, StiffnessFrom};
use super::path::{Aligned, AlignedAxis, Alignment, Frame, mean};
use super::profile::Profile;
use super::signal::{Smoothing, differences};
use super::{Demonstration, Follow};
use crate::policy::Policy;
use crate::task::{MIN_GOAL_DISTANCE, NamedScaling, Scaling, Task, Unit};
use crate::trace::{AxisTrace, Trace};

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
    /// The path to follow.
    pub follow: Follow,
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
            follow: Follow::Position,
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

/// A recording that begins or ends faster than this share of its largest speed is said to.
const REST_SPEED: f64 = 0.05;

/// A policy, and what it was made of.
#[derive(Clone, Debug)]
pub struct Imitated {
    /// The policy.
    pub policy: Policy,
    /// Each demonstration as it was recorded, by axis at each sample of the policy [m].
    pub demonstrations: Vec<Vec<Vec<f64>>>,
    /// The same carried to the task's start and goal, as a movement primitive carries it [m].
    pub aligned: Vec<Vec<Vec<f64>>>,
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
        mean_of(&self.demonstrations, axis)
    }

    /// Root mean square of the distance between the reference of `trace` and the mean demonstration, by axis [m].
    pub fn errors(&self, trace: &Trace) -> Vec<f64> {
        errors(&self.demonstrations, trace)
    }

    /// The same against the demonstrations carried to the task's start and goal [m].
    pub fn aligned_errors(&self, trace: &Trace) -> Vec<f64> {
        errors(&self.aligned, trace)
    }

    /// Root mean square of the distance between the demonstrations and their mean, by axis [m].
    pub fn spread(&self) -> Vec<f64> {
        (0..self.policy.axes.len()).map(|axis| spread(&self.demonstrations, axis)).collect()
    }

    /// The same of the demonstrations carried to the task's start and goal [m].
    pub fn aligned_spread(&self) -> Vec<f64> {
        (0..self.policy.axes.len()).map(|axis| spread(&self.aligned, axis)).collect()
    }
}

fn mean_of(demonstrations: &[Vec<Vec<f64>>], axis: usize) -> Vec<f64> {
    mean(demonstrations.iter().map(|demonstration| demonstration[axis].as_slice()))
}

fn errors(demonstrations: &[Vec<Vec<f64>>], trace: &Trace) -> Vec<f64> {
    let movement = trace.steps();
    let error =
        |(a, axis): (usize, &AxisTrace)| distance(&axis.reference_position[..=movement], &mean_of(demonstrations, a));
    trace.axes.iter().enumerate().map(error).collect()
}

fn spread(demonstrations: &[Vec<Vec<f64>>], axis: usize) -> f64 {
    let middle = mean_of(demonstrations, axis);
    let squares = demonstrations.iter().map(|one| distance(&one[axis], &middle).powi(2));
    (squares.sum::<f64>() / demonstrations.len() as f64).sqrt()
}

/// Root mean square of the difference.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

/// Everything that the axes of one imitation share.
pub struct Work<'w> {
    pub options: &'w Imitation,
    pub task: &'w Task,
    pub recordings: Vec<Aligned>,
    /// Stiffness and damping at the samples of the policy.
    pub profiles: [Profile; 2],
    pub notes: Vec<String>,
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
        let bases = [task.movement.basis, task.stiffness.basis, task.damping.basis];
        let basis = bases.map(|basis| basis.count()).into_iter().fold(0, usize::max);
        if steps < basis {
            return Err(ImitationError::TooFewSteps { steps, basis });
        }
        let mut policy = Policy::initial(task)?;
        let phase = policy.phase()?;
        let at = |share: f64| phase.at(share * task.duration).s;
        // While the forcing term fades the recording is at rest at its goal: it asks for no forcing.
        let fading = (FADE * steps as f64).ceil() as usize;
        let middle: Vec<f64> = (0..steps + fading).map(|i| at((i as f64 + 0.5) / steps as f64)).collect();
        let gate: Vec<f64> = middle.iter().map(|&s| phase.gate(s)).collect();
        let samples: Vec<f64> = (0..=steps).map(|i| at(i as f64 / steps as f64)).collect();
        let [movement, stiffness, damping] = policy.bases()?;
        let movement = Profile::new(self.fit, &movement, &middle);
        let alignment = Alignment {
            steps,
            follow: self.follow,
            basis: task.movement.basis.count(),
            smoothing: self.smoothing,
            emg_cut_off: self.emg_cut_off,
        };
        let names = || task.axis.iter().map(|axis| axis.name.as_str());
        let mut work = Work {
            options: self,
            task,
            recordings: demonstrations.iter().map(|one| alignment.of(one, names())).collect(),
            profiles: [&stiffness, &damping].map(|basis| Profile::new(self.fit, basis, &samples)),
            notes: Vec::new(),
        };
        let mut carried = vec![Vec::new(); demonstrations.len()];
        let mut recorded = carried.clone();
        let (mut stiffness_from, mut damping_from) = (Vec::new(), Vec::new());
        for (a, axis) in policy.axes.iter_mut().enumerate() {
            let (alpha, scale) = (axis.movement.alpha, axis.movement.forcing_scale);
            let target = Frame { start: axis.start, goal: axis.goal, scale };
            if self.follow == Follow::Reference {
                let endings = ["reference_m", "reference_rad"];
                work.signal(a, |axis| axis.reference.as_deref(), endings, "following the reference")?;
            }
            let frames = work.frames(a, scale)?;
            let refused = |reason| ImitationError::Fit { axis: axis.name.clone(), reason };
            let mut forcing = work.forcing(a, &frames, alpha);
            forcing.resize(gate.len(), 0.0);
            axis.movement.weights = movement.movement(&gate, &forcing, self.penalty).map_err(refused)?;
            for (recorded, recording) in recorded.iter_mut().zip(&work.recordings) {
                recorded.push(recording.axes[a].recorded.clone());
            }
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
            demonstrations: recorded,
            aligned: carried,
            stiffness: stiffness_from,
            damping: damping_from,
            notes: work.notes,
        })
    }
}

/// An error unless every demonstration has the axes of the task.
fn same_axes(demonstrations: &[Demonstration], task: &Task) -> Result<(), ImitationError> {
    let list = |axes: &mut dyn Iterator<Item = (&str, Unit)>| {
        let mut names: Vec<String> = axes.map(|(name, of)| format!("{name} [{}]", of.symbol())).collect();
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
    pub fn name(&self, a: usize) -> String {
        self.task.axis[a].name.clone()
    }

    pub fn axes(&self, a: usize) -> impl Iterator<Item = &AlignedAxis> {
        self.recordings.iter().map(move |recording| &recording.axes[a])
    }

    /// Start, goal and forcing scale of axis `a` in each recording; `scale` is the policy's own.
    fn frames(&self, a: usize, scale: f64) -> Result<Vec<Frame>, ImitationError> {
        let by_goal = self.task.movement.scaling == Scaling::Named(NamedScaling::Goal);
        let frame = |(demonstration, axis): (usize, &AlignedAxis)| {
            let (start, goal) = (axis.path[0], axis.path[axis.path.len() - 1]);
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
            let forcing = fit::movement_forcing(&axis.path, frame.goal, alpha, 1.0 / steps as f64);
            sum.iter_mut().zip(forcing).for_each(|(sum, f)| *sum += frame.scale * f);
        }
        let squares: f64 = frames.iter().map(|frame| frame.scale * frame.scale).sum();
        sum.iter().map(|sum| sum / squares).collect()
    }

    /// Notes a recording that begins or ends in motion: a policy cannot.
    fn note_motion_at_ends(&mut self, a: usize) {
        let mut notes = Vec::new();
        for (number, (recording, axis)) in self.recordings.iter().zip(self.axes(a)).enumerate() {
            let velocity = differences(&axis.path, recording.dt);
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
