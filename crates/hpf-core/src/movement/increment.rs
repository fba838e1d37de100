//! The same exact step as [`Transition`](super::Transition), as what it changes: for loops that add up millions of steps.

use super::{MovementState, Response};
use crate::Real;

/// What one exact step of the critically damped system adds to position and velocity.
///
/// With the symbols of [`Transition`](super::Transition):
/// ```text
/// a = F - p^2 y
/// x+ - x = dth E z + G1 a
/// z+ - z = ((1-u) E - 1) z + G2 a
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Increment<T> {
    /// p^2.
    spring: T,
    /// dth E: position from velocity, and velocity from pull.
    advance: T,
    /// (1-u) E - 1.
    drag: T,
    /// G1: position from pull.
    give: T,
}

impl<T: Real> Increment<T> {
    /// A step in which nothing moves.
    pub const NONE: Self = Self { spring: T::ZERO, advance: T::ZERO, drag: T::ZERO, give: T::ZERO };

    /// The step for spring factor `alpha` over `normalised_dt = rate dt / duration`.
    #[inline]
    pub fn new(alpha: T, normalised_dt: T) -> Self {
        let Response { dth, p, u, settled, decay, g1 } = Response::new(alpha, normalised_dt);
        Self { spring: p * p, advance: decay * dth, drag: -(settled + u * decay), give: g1 }
    }

    /// What the step adds to a motion at `distance` from its goal that moves at `scaled_velocity`.
    #[inline(always)]
    pub fn of(&self, distance: T, scaled_velocity: T, forcing: T) -> MovementState<T> {
        let pull = forcing - self.spring * distance;
        MovementState {
            position: self.advance * scaled_velocity + self.give * pull,
            scaled_velocity: self.drag * scaled_velocity + self.advance * pull,
        }
    }
}
