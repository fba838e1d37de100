//! Stiffness and damping primitives: a bounded gain over the phase.
//!
//! Equation: `k(s) = sum_i w_i phi_i(s)`, and the same for d (the paper's Eq. 8-9).
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | k | stiffness | N/m or N m/rad |
//! | d | damping | N s/m or N m s/rad |
//! | w | `weights`, one per basis function, oldest phase first | as the gain |
//!
//! The weights are bounded, and the basis is a partition of unity: the profile is within its bounds with no clip at
//! run time.

mod matrix;

pub use matrix::MatrixGain;

use crate::{ConfigError, Real, error};

/// A stiffness or damping primitive of one axis; `S` holds the weights.
///
/// ```
/// use hpf_core::Gain;
/// assert!(Gain::new(30.0, 400.0, [100.0, 200.0]).is_ok());
/// assert!(Gain::new(30.0, 400.0, [100.0, 500.0]).is_err()); // a weight outside the bounds
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain<T, S> {
    min: T,
    max: T,
    weights: S,
}

impl<T: Real, S: AsRef<[T]>> Gain<T, S> {
    /// A gain with every weight in `[min, max]`, `min` above zero.
    ///
    /// # Errors
    /// [`ConfigError`] for bounds outside their [domain](crate::domain) or out of order, and for a weight outside them.
    pub fn new(min: T, max: T, weights: S) -> Result<Self, ConfigError> {
        error::size("min", min)?;
        error::finite("max", max)?;
        let (lo, hi) = (min.to_f64(), max.to_f64());
        if lo > hi {
            return Err(ConfigError::MinAboveMax { field: "gain", min: lo, max: hi });
        }
        error::size("max", max)?;
        for &weight in weights.as_ref() {
            let value = error::finite("weights", weight)?.to_f64();
            if value < lo || value > hi {
                return Err(ConfigError::OutOfRange { field: "weights", value, min: lo, max: hi });
            }
        }
        Ok(Self { min, max, weights })
    }

    /// Smallest value of the gain [N/m or N s/m].
    pub fn min(&self) -> T {
        self.min
    }

    /// Largest value of the gain [N/m or N s/m].
    pub fn max(&self) -> T {
        self.max
    }

    /// Weights, one per basis function, oldest phase first.
    pub fn weights(&self) -> &[T] {
        self.weights.as_ref()
    }
}
