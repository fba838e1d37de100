//! Compliance frames: along which axes a stiffness is stiff.
//!
//! ```text
//! K = C diag(k) C^T        base: C = I, given: C fixed, tool: C = R_ref, path: first axis of C along the velocity
//! ```
//!
//! | frame | turns with |
//! |---|---|
//! | base, given | nothing |
//! | tool | the reference orientation |
//! | path | the reference velocity: by the least rotation that keeps its first axis along it; held where the reference stops |
//!
//! [`Symmetric::turned`](crate::Symmetric::turned) is `C K C^T`. A frame that turns moves energy:
//! [`EnergyTank::stiffness_matrix`](crate::passivity::EnergyTank::stiffness_matrix) pays for it.

use crate::rotation::{Quaternion, cross, dot, length};
use crate::{ConfigError, Real, error};

/// A frame whose first axis follows a velocity.
///
/// ```
/// use hpf_core::frame::PathFrame;
/// let mut frame = PathFrame::new(1e-3_f64)?; // held below 1 mm/s
/// let [x, y, z] = frame.follow([0.0, 0.2, 0.0]).turn([1.0, 0.0, 0.0]);
/// assert!(x.abs() < 1e-15 && (y - 1.0).abs() < 1e-15 && z.abs() < 1e-15);
/// let held = frame.follow([1e-4, 0.0, 0.0]);
/// assert_eq!(held, frame.orientation());
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathFrame<T> {
    slowest: T,
    orientation: Quaternion<T>,
}

impl<T: Real + PartialOrd> PathFrame<T> {
    /// A frame that is held where the speed is below `slowest` [m/s]; at first it is the base frame.
    ///
    /// # Errors
    /// [`ConfigError`] for a speed outside its [domain](crate::domain).
    pub fn new(slowest: T) -> Result<Self, ConfigError> {
        error::size("frame.slowest", slowest)?;
        Ok(Self { slowest, orientation: Quaternion::IDENTITY })
    }

    /// The frame's orientation.
    pub fn orientation(&self) -> Quaternion<T> {
        self.orientation
    }

    /// Turns the first axis along `velocity` [m/s], by the least rotation; where that is a half turn, about the second axis.
    /// Returns the orientation.
    #[inline]
    pub fn follow(&mut self, velocity: [T; 3]) -> Quaternion<T> {
        let speed = length(velocity);
        if speed >= self.slowest && speed.is_finite() {
            let direction = velocity.map(|part| part / speed);
            let along = self.orientation.turn([T::ONE, T::ZERO, T::ZERO]);
            let axis = cross(along, direction);
            let (sine, cosine) = (length(axis), dot(along, direction));
            let angle = sine.atan2(cosine);
            let turn = if sine > T::of(1e-12) {
                axis.map(|part| part * (angle / sine))
            } else {
                self.orientation.turn([T::ZERO, angle, T::ZERO])
            };
            self.orientation = Quaternion::exp(turn) * self.orientation;
        }
        self.orientation
    }
}
