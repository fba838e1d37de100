//! Demonstrations: recorded motions, and the policies that imitate them.
//!
//! A [`Demonstration`] is one recording, which the crate `hpf-recordings` reads; [`Outline`] writes the task that a policy of some belongs to;
//! [`Imitation::of`] fits the policy. The path is fitted by its forcing term
//! `f_t = tau^2 x'' - alpha (beta (g - x) - tau x')`, each recording in its own start, goal and scale, all in one
//! regression over normalised time; gains are fitted as profiles over the phase ([`hpf_learn::fit`]).
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | x | `position` | m or rad |
//! | x_r | `reference`, where the tool would be without force | m or rad |
//! | f | `force` of the environment on the tool | N or N m |
//! | k, d | `stiffness`, `damping` | N/m and N s/m, or N m/rad and N m s/rad |
//!
//! A movement primitive starts and ends at rest, and so does the imitation of a recording that does not.
//!
//! Source: Ijspeert et al., Neural Computation 25(2):328, 2013, doi 10.1162/NECO_a_00393 (the forcing term, locally
//! weighted regression); Calinon, Sardellitti, Caldwell, IROS 2010, doi 10.1109/IROS.2010.5648931 (stiffness from the
//! spread of demonstrations).

mod error;
mod force;
mod gains;
mod imitation;
mod outline;
mod path;
mod profile;
mod signal;
mod sources;

use crate::task::Unit;

pub use error::ImitationError;
pub use gains::{DampingFrom, StiffnessFrom};
pub use imitation::{Fit, Imitated, Imitation};
pub use outline::{DurationFrom, Outline, ScaleBy};
pub use signal::Smoothing;

/// Which recorded path a policy follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Follow {
    /// Where the tool went.
    #[default]
    Position,
    /// Where it would have been without force: what a policy is that gives way by itself.
    Reference,
}

/// One recorded motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Demonstration {
    /// Time since the first sample [s], rising.
    pub time: Vec<f64>,
    /// The axes, in the order of their position columns.
    pub axes: Vec<RecordedAxis>,
}

/// What was recorded of one axis: one number per sample in each signal that is there.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedAxis {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: Unit,
    /// Position of the tool [m].
    pub position: Vec<f64>,
    /// Where the tool would be without force [m].
    pub reference: Option<Vec<f64>>,
    /// Stiffness [N/m].
    pub stiffness: Option<Vec<f64>>,
    /// Damping [N s/m].
    pub damping: Option<Vec<f64>>,
    /// Force of the environment on the tool [N].
    pub force: Option<Vec<f64>>,
    /// Muscle activity, in any unit, rectified or not.
    pub emg: Option<Vec<f64>>,
}

impl RecordedAxis {
    /// The path to follow; the position where there is no other.
    fn path(&self, follow: Follow) -> &[f64] {
        self.reference.as_ref().filter(|_| follow == Follow::Reference).unwrap_or(&self.position)
    }
}

impl Demonstration {
    /// Drops what comes later than `duration` [s] after the start, but for rounding.
    pub fn cut(&mut self, duration: f64) {
        let end = self.time[0] + duration * (1.0 + 1e-9);
        let kept = self.time.partition_point(|&time| time <= end);
        self.time.truncate(kept);
        for axis in &mut self.axes {
            axis.position.truncate(kept);
            let RecordedAxis { reference, stiffness, damping, force, emg, .. } = axis;
            [reference, stiffness, damping, force, emg].into_iter().flatten().for_each(|signal| signal.truncate(kept));
        }
    }

    /// How long it took [s].
    pub fn duration(&self) -> f64 {
        self.time.last().copied().unwrap_or_default()
    }
}
