//! Normalised Gaussian basis functions of the phase.
//!
//! Equations: `psi_i(s) = exp(-h_i (s - c_i)^2)`, `phi_i = psi_i / sum_j psi_j` (the paper's Eq. 5-6).
//! Centers equally spaced in time: `c_i = exp(-alpha_s i/(n-1))`. Widths such that each function has fallen to
//! `overlap` at its neighbour's center: `h_i = -ln(overlap)/(c_{i+1} - c_i)^2`, `h_{n-1} = h_{n-2}`.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | c | `centers`, oldest phase (1) first | 1 |
//! | h | `widths` | 1 |
//! | n | number of functions, at least 2 | 1 |
//!
//! The phi_i are positive and sum to one, so a mixture of weights in `[lo, hi]` stays in `[lo, hi]`. The largest
//! exponent is subtracted before any exponential is taken: all psi underflowing to 0/0 cannot happen.

use core::marker::PhantomData;

use crate::{ConfigError, Real, error};

/// Overlap of neighbours where nothing else is asked for.
pub const DEFAULT_OVERLAP: f64 = 0.6;

/// Centers and widths of a basis; `S` holds them: `[T; N]` in firmware, `Vec<T>` on a host.
///
/// ```
/// use hpf_core::Basis;
/// let basis = Basis::equally_spaced(100.0_f64.ln(), 0.6, [0.0; 5], [0.0; 5])?;
/// let [mixed] = basis.mix(0.3, [&[7.0; 5]]);
/// assert!((mixed - 7.0).abs() < 1e-12); // a partition of unity leaves a constant alone
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis<T, S> {
    centers: S,
    widths: S,
    scalar: PhantomData<T>,
}

impl<T: Real, S: AsRef<[T]>> Basis<T, S> {
    /// A basis from stored `centers` (falling) and `widths` (positive), one each per function.
    ///
    /// # Errors
    /// [`ConfigError`] for fewer than two functions, lengths that differ, centers that do not fall, values that are
    /// not finite, widths that are not positive, and functions whose exponent is not finite over the whole phase.
    pub fn new(centers: S, widths: S) -> Result<Self, ConfigError> {
        let (c, h) = (centers.as_ref(), widths.as_ref());
        if c.len() < 2 {
            return Err(ConfigError::TooFew { field: "centers", count: c.len(), least: 2 });
        }
        error::finite_list("centers", c, c.len())?;
        error::finite_list("widths", h, c.len())?;
        for (&center, &width) in c.iter().zip(h) {
            error::positive("widths", width)?;
            // The largest exponent of a phase in [0, 1]: were it infinite, a mixture could be NaN.
            let reach = center.max(T::ONE - center);
            error::finite("widths times distance squared", width * reach * reach)?;
        }
        if c.iter().zip(c.iter().skip(1)).any(|(this, next)| this.to_f64() <= next.to_f64()) {
            return Err(ConfigError::NotDecreasing { field: "centers" });
        }
        Ok(Self { centers, widths, scalar: PhantomData })
    }

    /// The standard basis: centers equally spaced in time over a phase that falls by `decay`, neighbours meeting at
    /// `overlap` (in (0, 1)). Fills the storage it is given, whose length is the number of functions.
    ///
    /// # Errors
    /// [`ConfigError`] for fewer than two functions, a `decay` that is not positive, an `overlap` outside (0, 1).
    pub fn equally_spaced(decay: T, overlap: T, mut centers: S, mut widths: S) -> Result<Self, ConfigError>
    where
        S: AsMut<[T]>,
    {
        error::positive("decay", decay)?;
        if !(overlap.to_f64() > 0.0 && overlap.to_f64() < 1.0) {
            return Err(ConfigError::OutOfRange { field: "overlap", value: overlap.to_f64(), min: 0.0, max: 1.0 });
        }
        let count = centers.as_ref().len();
        if count < 2 {
            return Err(ConfigError::TooFew { field: "centers", count, least: 2 });
        }
        let last = T::of((count - 1) as f64);
        for (i, center) in centers.as_mut().iter_mut().enumerate() {
            *center = (-decay * T::of(i as f64) / last).exp();
        }
        let fall = T::of(-libm::log(overlap.to_f64()));
        let mut width = T::ONE;
        let c = centers.as_ref();
        for (slot, pair) in widths.as_mut().iter_mut().zip(c.windows(2).map(Some).chain([None])) {
            if let Some(&[this, next]) = pair {
                width = fall / ((next - this) * (next - this));
            }
            *slot = width;
        }
        Self::new(centers, widths)
    }

    /// Number of functions.
    pub fn count(&self) -> usize {
        self.centers.as_ref().len()
    }

    /// Centers c_i, oldest phase first.
    pub fn centers(&self) -> &[T] {
        self.centers.as_ref()
    }

    /// Widths h_i.
    pub fn widths(&self) -> &[T] {
        self.widths.as_ref()
    }

    /// Whether the other basis is this one, bit by bit.
    pub(crate) fn same(&self, other: &Self) -> bool {
        let equal = |a: &[T], b: &[T]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_f64() == b.to_f64());
        equal(self.centers(), other.centers()) && equal(self.widths(), other.widths())
    }

    /// `-h_i (s - c_i)^2` of each function.
    #[inline]
    fn exponents(&self, s: T) -> impl Iterator<Item = T> {
        self.centers.as_ref().iter().zip(self.widths.as_ref()).map(move |(&c, &h)| -h * (s - c) * (s - c))
    }

    /// The largest exponent at `s`: it cancels in every normalised quantity.
    #[inline]
    fn largest_exponent(&self, s: T) -> T {
        self.exponents(s).fold(T::of(f64::NEG_INFINITY), T::max)
    }

    /// The mixtures `sum_i w_i phi_i(s)` of `M` weight lists, the basis evaluated once for all of them.
    ///
    /// Each list holds one weight per function; what it lacks counts as nought.
    #[inline]
    pub fn mix<const M: usize>(&self, s: T, weights: [&[T]; M]) -> [T; M] {
        self.mix_sets(s, weights.map(|list| [list])).map(|[mixed]| mixed)
    }

    /// [`mix`](Self::mix) of `M` sets of `K` weight lists each, the basis evaluated once for all of them.
    #[inline]
    pub fn mix_sets<const K: usize, const M: usize>(&self, s: T, weights: [[&[T]; K]; M]) -> [[T; K]; M] {
        let largest = self.largest_exponent(s);
        let mut sets = weights.map(|set| set.map(<[T]>::iter));
        let mut mixed = [[T::ZERO; K]; M];
        let mut sum = T::ZERO;
        for exponent in self.exponents(s) {
            let psi = (exponent - largest).exp();
            sum += psi;
            for (total, list) in mixed.as_flattened_mut().iter_mut().zip(sets.as_flattened_mut()) {
                if let Some(&weight) = list.next() {
                    *total += psi * weight;
                }
            }
        }
        mixed.map(|set| set.map(|total| total / sum))
    }

    /// Writes `phi_i(s)` into `out`, one entry per function.
    pub fn features_into(&self, s: T, out: &mut [T]) {
        let largest = self.largest_exponent(s);
        let mut sum = T::ZERO;
        for (slot, exponent) in out.iter_mut().zip(self.exponents(s)) {
            *slot = (exponent - largest).exp();
            sum += *slot;
        }
        for slot in out {
            *slot = *slot / sum;
        }
    }

    /// Writes `psi_i(s)` into `out`, one entry per function: the activations without normalisation.
    pub fn activations_into(&self, s: T, out: &mut [T]) {
        for (slot, exponent) in out.iter_mut().zip(self.exponents(s)) {
            *slot = exponent.exp();
        }
    }
}
