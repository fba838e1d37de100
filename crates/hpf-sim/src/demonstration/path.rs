//! Recordings brought onto the steps of one policy, in normalised time.

use super::signal::{Smoothing, grid, low_pass, resample, resample_linear};
use super::{Demonstration, Follow, RecordedAxis};

/// A recording at the samples of a policy: steps + 1 numbers per signal.
pub struct Aligned {
    /// Time of one step at the speed of the recording [s].
    pub dt: f64,
    /// In the order of the task's axes.
    pub axes: Vec<AlignedAxis>,
}

/// One axis of it.
pub struct AlignedAxis {
    /// The path to follow as recorded [m].
    pub recorded: Vec<f64>,
    /// The same, smoothed [m].
    pub path: Vec<f64>,
    /// Where the tool went, smoothed [m].
    pub position: Vec<f64>,
    /// Where it would have been without force, smoothed [m].
    pub reference: Option<Vec<f64>>,
    /// [N/m].
    pub stiffness: Option<Vec<f64>>,
    /// [N s/m].
    pub damping: Option<Vec<f64>>,
    /// [N].
    pub force: Option<Vec<f64>>,
    /// Muscle activity, rectified and low-passed, in the unit of the recording.
    pub emg: Option<Vec<f64>>,
}

/// How recordings are aligned.
pub struct Alignment {
    /// Steps of the policy.
    pub steps: usize,
    /// The path to follow.
    pub follow: Follow,
    /// Basis functions of the movement.
    pub basis: usize,
    /// What is done to positions.
    pub smoothing: Smoothing,
    /// Cut-off of the muscle activity's envelope [Hz].
    pub emg_cut_off: f64,
}

impl Alignment {
    /// `demonstration` on the steps of the policy, its axes in the order of `names`, all of which it has.
    pub fn of<'n>(&self, demonstration: &Demonstration, names: impl Iterator<Item = &'n str>) -> Aligned {
        let own = |name: &str| demonstration.axes.iter().find(|axis| axis.name == name);
        let axes = names.filter_map(own).map(|axis| self.axis(demonstration, axis));
        Aligned { dt: demonstration.duration() / self.steps as f64, axes: axes.collect() }
    }

    fn axis(&self, demonstration: &Demonstration, axis: &RecordedAxis) -> AlignedAxis {
        let (time, duration) = (&demonstration.time, demonstration.duration());
        // Filters work at the recording's own rate: a coarser policy would fold fast noise into the path.
        let own = time.len() - 1;
        let dt = duration / own as f64;
        let onto_policy = |values: &[f64]| {
            let even: Vec<f64> = grid(own, duration).collect();
            resample(&even, values, grid(self.steps, duration))
        };
        let cut_off = match self.smoothing {
            Smoothing::Off => f64::INFINITY,
            Smoothing::CutOff(hertz) => hertz * dt,
            Smoothing::Basis => 2.0 * (self.basis - 1) as f64 / own as f64,
        };
        let smooth = |values: &[f64]| onto_policy(&low_pass(&resample(time, values, grid(own, duration)), cut_off));
        let profile = |values: &Vec<f64>| resample_linear(time, values, grid(self.steps, duration));
        let envelope = |values: &Vec<f64>| {
            let rectified: Vec<f64> = values.iter().map(|value| value.abs()).collect();
            let even = resample_linear(time, &rectified, grid(own, duration));
            let smooth = low_pass(&even, self.emg_cut_off * dt);
            // The filter becomes negative after a burst; activity does not.
            onto_policy(&smooth).into_iter().map(|value| value.max(0.0)).collect()
        };
        AlignedAxis {
            recorded: onto_policy(&resample(time, axis.path(self.follow), grid(own, duration))),
            path: smooth(axis.path(self.follow)),
            position: smooth(&axis.position),
            reference: axis.reference.as_deref().map(smooth),
            stiffness: axis.stiffness.as_ref().map(profile),
            damping: axis.damping.as_ref().map(profile),
            force: axis.force.as_ref().map(profile),
            emg: axis.emg.as_ref().map(envelope),
        }
    }
}

/// Start, goal and forcing scale: where a movement's weights act.
#[derive(Clone, Copy)]
pub struct Frame {
    /// [m].
    pub start: f64,
    /// [m].
    pub goal: f64,
    /// A [m].
    pub scale: f64,
}

impl Frame {
    /// The movement without forcing at sample `i` of `steps`: `g + (1 + u) exp(-u) (x_0 - g)`, `u = alpha t/(2 T)`.
    fn pull(&self, alpha: f64, i: usize, steps: usize) -> f64 {
        let u = 0.5 * alpha * i as f64 / steps as f64;
        self.goal + (1.0 + u) * libm::exp(-u) * (self.start - self.goal)
    }

    /// The path that the weights of `path`, a path in this frame, make in another: exact, since a movement is the pull
    /// and what the forcing, proportional to its scale, adds to it.
    pub fn carry_to(&self, other: &Self, alpha: f64, path: &[f64]) -> Vec<f64> {
        let steps = path.len() - 1;
        let share = other.scale / self.scale;
        let carried = |(i, x): (usize, &f64)| other.pull(alpha, i, steps) + share * (x - self.pull(alpha, i, steps));
        path.iter().enumerate().map(carried).collect()
    }
}

/// The mean of some lists of one length.
pub fn mean<'l>(lists: impl Iterator<Item = &'l [f64]>) -> Vec<f64> {
    let mut sum: Vec<f64> = Vec::new();
    let mut count = 0.0;
    for list in lists {
        sum.resize(list.len(), 0.0);
        sum.iter_mut().zip(list).for_each(|(sum, value)| *sum += value);
        count += 1.0;
    }
    sum.iter().map(|sum| sum / count).collect()
}
