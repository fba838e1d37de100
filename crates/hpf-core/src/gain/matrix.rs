//! Stiffness and damping primitives with directions: a mixture of positive definite matrices over the phase.
//!
//! Equation: `K(s) = sum_i phi_i(s) K_i`, every K_i symmetric with eigenvalues in `[min, max]`, and the same for D.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | K | stiffness | N/m or N m/rad |
//! | D | damping | N s/m or N m s/rad |
//! | K_i | `weights`, six lists, one entry per basis function, oldest phase first | as the gain |
//!
//! The basis is a partition of unity and the set of such matrices is convex: the mixture is within its bounds with no clip
//! at run time.

use crate::{Basis, ConfigError, Real, Symmetric, error};

/// By how much of the larger bound an eigenvalue of a weight may lie outside: what rounding makes of it in single
/// precision.
const TOLERANCE: f64 = 1e-6;

/// A stiffness or damping primitive of three coupled axes; `S` holds each of its six lists of weights.
///
/// ```
/// use hpf_core::{Basis, MatrixGain, Symmetric};
/// let basis = Basis::equally_spaced(100.0_f64.ln(), 0.6, [0.0; 2], [0.0; 2])?;
/// // From stiff along x to stiff along y: xx, xy, xz, yy, yz, zz, each at both ends.
/// let lists = [[400.0, 30.0], [0.0; 2], [0.0; 2], [30.0, 400.0], [0.0; 2], [30.0; 2]];
/// let gain = MatrixGain::new(30.0, 400.0, lists)?;
/// let stiffness = gain.at(&basis, 0.1);
/// assert!((stiffness.xx + stiffness.yy - 430.0).abs() < 1e-12 && (stiffness.zz - 30.0).abs() < 1e-12);
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatrixGain<T, S> {
    min: T,
    max: T,
    weights: [S; 6],
}

impl<T: Real, S: AsRef<[T]>> MatrixGain<T, S> {
    /// A gain of six lists of weights, in the order xx, xy, xz, yy, yz, zz: entry i of each makes K_i, whose eigenvalues lie
    /// in `[min, max]`, `min` above zero.
    ///
    /// # Errors
    /// [`ConfigError`] for bounds outside their [domain](crate::domain) or out of order, lists of different lengths,
    /// numbers that are not finite, and a matrix with an eigenvalue outside the bounds by more than rounding.
    pub fn new(min: T, max: T, weights: [S; 6]) -> Result<Self, ConfigError> {
        error::size("min", min)?;
        error::size("max", max)?;
        let (lo, hi) = (min.to_f64(), max.to_f64());
        if lo > hi {
            return Err(ConfigError::MinAboveMax { field: "gain", min: lo, max: hi });
        }
        let count = weights.first().map_or(0, |list| list.as_ref().len());
        for list in &weights {
            error::finite_list("weights", list.as_ref(), count)?;
        }
        let gain = Self { min, max, weights };
        let slack = hi * TOLERANCE;
        for matrix in gain.matrices() {
            for value in matrix.eigen().values {
                let value = value.to_f64();
                if !(value >= lo - slack && value <= hi + slack && value > 0.0) {
                    return Err(ConfigError::OutOfRange { field: "eigenvalue of weights", value, min: lo, max: hi });
                }
            }
        }
        Ok(gain)
    }

    /// Smallest eigenvalue of the gain [N/m or N s/m].
    pub fn min(&self) -> T {
        self.min
    }

    /// Largest eigenvalue of the gain [N/m or N s/m].
    pub fn max(&self) -> T {
        self.max
    }

    /// The six lists of weights, in the order xx, xy, xz, yy, yz, zz.
    pub fn weights(&self) -> [&[T]; 6] {
        self.weights.each_ref().map(AsRef::as_ref)
    }

    /// The matrices K_i, one per basis function, oldest phase first.
    pub fn matrices(&self) -> impl Iterator<Item = Symmetric<T>> + '_ {
        let lists = self.weights();
        let count = lists.first().map_or(0, |list| list.len());
        (0..count).map(move |i| Symmetric::of(lists.map(|list| list.get(i).copied().unwrap_or(T::ZERO))))
    }

    /// The gain at phase `s`, of a `basis` with as many functions as there are weights.
    #[inline]
    pub fn at<B: AsRef<[T]>>(&self, basis: &Basis<T, B>, s: T) -> Symmetric<T> {
        Symmetric::of(basis.mix(s, self.weights()))
    }
}
