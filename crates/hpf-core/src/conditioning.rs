//! From a sensor's reading to the force that an admittance sees.
//!
//! ```text
//! compensated   f_c = f - bias - m g                      m, g: the tool's mass and gravity along each axis
//! filtered      y+ = y + (1 - exp(-2 pi c h)) (f_c - y)   one pole at c, exact for a reading held over the step
//! dead zone     z(y) = y - min(max(y, -w), w)             continuous: no jump where it opens
//! ```
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | f, y, z | force of the environment ON the tool | N or N m |
//! | c | `cutoff` | Hz |
//! | w | `dead_zone` | N or N m |
//! | h | `dt` | s |
//!
//! A force that stands still is called zero by a tare: [`TareWindow`] tells whether it does, and what it is.
//!
//! The filter settles by the same share per second at every loop rate. All axes are read in one frame in which gravity
//! stands still (the base frame): turning a reading of the sensor's frame into it takes the robot's kinematics, which
//! are not here.

mod tare;

pub use tare::{TARE_DRIFT, TARE_RECENT, TARE_SPREAD, TARE_TIME, TareWindow};

use core::f64::consts::TAU;

use crate::domain::flushed;
use crate::{ConfigError, Real, error};

/// What of `force` lies outside `[-width, width]`.
///
/// ```
/// use hpf_core::conditioning::dead_zone;
/// assert_eq!([-5.0, -2.0, 1.0, 3.5].map(|force| dead_zone(force, 2.0)), [-3.0, 0.0, 0.0, 1.5]);
/// ```
#[inline]
pub fn dead_zone<T: Real>(force: T, width: T) -> T {
    force - force.at_least(-width).at_most(width)
}

/// The share of a change that a filter of `cutoff` [Hz] lets through in `dt` [s]: all of it where there is none.
#[inline]
pub(crate) fn settled<T: Real>(cutoff: Option<T>, dt: T) -> T {
    cutoff.map_or(T::ONE, |cutoff| -(-T::of(TAU) * cutoff * dt).exp_m1())
}

/// How a force is conditioned, `D` axes in one frame.
///
/// ```
/// use hpf_core::conditioning::{ForceConditioning, ForceState};
/// let conditioning = ForceConditioning { tool_mass: 0.5, gravity: [0.0, -10.0], cutoff: None, dead_zone: [1.0; 2] };
/// let mut state = ForceState::default();
/// // The tool hangs on the sensor: -5 N are its weight, 3 N of the 8 N along x remain after tare and dead zone.
/// conditioning.step(&mut state, [4.0, -5.0], 1e-3);
/// state.tare([4.0, 0.0]); // the mean of [`TareWindow`], say
/// assert_eq!(conditioning.step(&mut state, [8.0, -5.0], 1e-3), [3.0, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceConditioning<T, const D: usize> {
    /// Mass that hangs on the sensor [kg].
    pub tool_mass: T,
    /// Gravity along each axis [m/s^2], zero for a rotary one.
    pub gravity: [T; D],
    /// Cut-off of the low-pass filter [Hz], if there is one.
    pub cutoff: Option<T>,
    /// Half width of the dead zone of each axis [N].
    pub dead_zone: [T; D],
}

/// What conditioning remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceState<T, const D: usize> {
    /// Reading without contact, beside the tool's weight [N].
    pub bias: [T; D],
    /// Compensated and filtered force [N].
    pub filtered: [T; D],
}

impl<T: Real, const D: usize> Default for ForceState<T, D> {
    fn default() -> Self {
        Self { bias: [T::ZERO; D], filtered: [T::ZERO; D] }
    }
}

impl<T: Real, const D: usize> ForceState<T, D> {
    /// Calls `still` zero: a compensated force [N] that has stood still, see [`TareWindow`]. The filter has settled on it.
    pub fn tare(&mut self, still: [T; D]) {
        for ((bias, filtered), still) in self.bias.iter_mut().zip(&mut self.filtered).zip(still) {
            *bias += still;
            *filtered = T::ZERO;
        }
    }
}

impl<T: Real, const D: usize> ForceConditioning<T, D> {
    /// Whether every value makes sense.
    ///
    /// # Errors
    /// [`ConfigError`] for values outside their [domain](crate::domain): a mass or dead zone may be zero.
    pub fn check(&self) -> Result<(), ConfigError> {
        error::not_negative("conditioning.tool_mass", self.tool_mass)?;
        self.gravity.iter().try_for_each(|&gravity| error::number("conditioning.gravity", gravity).map(drop))?;
        self.cutoff.map_or(Ok(T::ONE), |cutoff| error::size("conditioning.cutoff", cutoff))?;
        self.dead_zone.iter().try_for_each(|&width| error::not_negative("conditioning.dead_zone", width).map(drop))
    }

    /// The reading without bias and the tool's weight [N].
    #[inline]
    pub fn compensated(&self, state: &ForceState<T, D>, measured_force: [T; D]) -> [T; D] {
        let mut force = measured_force;
        for ((force, &bias), &gravity) in force.iter_mut().zip(&state.bias).zip(&self.gravity) {
            *force = *force - bias - self.tool_mass * gravity;
        }
        force
    }

    /// The force that the admittance sees after `dt` [s] of `measured_force` [N], which must be finite.
    #[inline]
    pub fn step(&self, state: &mut ForceState<T, D>, measured_force: [T; D], dt: T) -> [T; D] {
        self.settle(state, self.compensated(state, measured_force), self.settled(dt))
    }

    /// The share of a change of force that the filter lets through in `dt` [s].
    #[inline]
    pub(crate) fn settled(&self, dt: T) -> T {
        settled(self.cutoff, dt)
    }

    /// [`step`](Self::step) of a compensated force, given what [`settled`](Self::settled) says.
    #[inline]
    pub(crate) fn settle(&self, state: &mut ForceState<T, D>, mut force: [T; D], settled: T) -> [T; D] {
        for ((force, filtered), &width) in force.iter_mut().zip(&mut state.filtered).zip(&self.dead_zone) {
            *filtered = flushed(*filtered + settled * (*force - *filtered));
            *force = dead_zone(*filtered, width);
        }
        force
    }
}
