//! Basis functions of a phase that repeats.

use core::f64::consts::TAU;
use core::marker::PhantomData;

use crate::{ConfigError, Real, error};

/// Functions `psi_i = exp(h (cos(phi - c_i) - 1))`, equally spaced over a period; `S` holds sine and cosine of each center.
///
/// The `psi_i/sum psi` are positive and sum to one, so a mixture of weights in `[lo, hi]` stays in `[lo, hi]`.
///
/// ```
/// use hpf_core::rhythm::PeriodicBasis;
/// let basis = PeriodicBasis::new(0.6, [0.0; 5], [0.0; 5])?;
/// let weights: &[f64] = &[3.5, 2.0, 3.0, 4.0, 5.0];
/// let [start, end, middle] = [0.0, 1.0, 0.5].map(|part| basis.mix(part, [weights])[0]);
/// assert!((start - end).abs() < 1e-14); // a period later all is the same
/// assert!((middle - 3.5).abs() < 1e-14); // between the centers of 3 and 4, by symmetry
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeriodicBasis<T, S> {
    sines: S,
    cosines: S,
    sharpness: T,
    overlap: T,
    scalar: PhantomData<T>,
}

impl<T: Real, S: AsRef<[T]>> PeriodicBasis<T, S> {
    /// A basis whose neighbors meet at `overlap` (in (0, 1)). Fills the storage it is given, whose length is the number of
    /// functions.
    ///
    /// # Errors
    /// [`ConfigError`] for fewer than three functions, lists of different lengths, an `overlap` outside (0, 1), and where a
    /// function would be narrower than the scalar can tell.
    pub fn new(overlap: T, mut sines: S, mut cosines: S) -> Result<Self, ConfigError>
    where
        S: AsMut<[T]>,
    {
        let value = error::finite("overlap", overlap)?.to_f64();
        if !(value > 0.0 && value < 1.0) {
            return Err(ConfigError::OutOfRange { field: "overlap", value, min: 0.0, max: 1.0 });
        }
        let count = sines.as_ref().len();
        if count < 3 {
            return Err(ConfigError::TooFew { field: "functions", count, least: 3 });
        }
        if cosines.as_ref().len() != count {
            return Err(ConfigError::LengthMismatch {
                field: "cosines",
                found: cosines.as_ref().len(),
                expected: count,
            });
        }
        for (i, (sine, cosine)) in sines.as_mut().iter_mut().zip(cosines.as_mut()).enumerate() {
            let (s, c) = Real::sin_cos(TAU * i as f64 / count as f64);
            (*sine, *cosine) = (T::of(s), T::of(c));
        }
        // 1 - cos a = 2 sin(a/2)^2 keeps its digits where there are many functions.
        let (half, _) = Real::sin_cos(0.5 * TAU / count as f64);
        let sharpness = -Real::ln(value) / (2.0 * half * half);
        // Rounding of the cosine, times the sharpness, is what the exponent is off by.
        error::within("sharpness of the functions", T::of(sharpness), 0.0, 1e5)?;
        Ok(Self { sines, cosines, sharpness: T::of(sharpness), overlap, scalar: PhantomData })
    }

    /// Number of functions.
    pub fn count(&self) -> usize {
        self.sines.as_ref().len()
    }

    /// Overlap of neighbors.
    pub fn overlap(&self) -> T {
        self.overlap
    }

    /// Sharpness h of the functions.
    pub fn sharpness(&self) -> T {
        self.sharpness
    }

    /// psi of each function at the part `u` of a period.
    #[inline]
    fn activations(&self, u: T) -> impl Iterator<Item = T> + '_ {
        let (sine, cosine) = (u * T::of(TAU)).sin_cos();
        let centers = self.sines.as_ref().iter().zip(self.cosines.as_ref());
        // The nearest function is at least the fourth root of the overlap: the sum is never zero.
        centers.map(move |(&s, &c)| (self.sharpness * (cosine * c + sine * s - T::ONE)).exp())
    }

    /// The mixtures `sum_i w_i psi_i/sum psi_i` of `M` weight lists at the part `u` of a period, the basis evaluated once for
    /// all of them.
    ///
    /// Each list holds one weight per function; one of another length is not refused, but mixes wrongly.
    #[inline]
    pub fn mix<const M: usize>(&self, u: T, weights: [&[T]; M]) -> [T; M] {
        let (mut mixed, mut sum) = ([T::ZERO; M], T::ZERO);
        for (i, psi) in self.activations(u).enumerate() {
            sum += psi;
            for (slot, list) in mixed.iter_mut().zip(weights) {
                *slot += psi * list.get(i).copied().unwrap_or(T::ZERO);
            }
        }
        let per_sum = T::ONE / sum;
        mixed.map(|mixed| mixed * per_sum)
    }

    /// Writes `psi_i/sum psi_i` at the part `u` of a period into `out`, one entry per function.
    pub fn features_into(&self, u: T, out: &mut [T]) {
        let mut sum = T::ZERO;
        for (slot, psi) in out.iter_mut().zip(self.activations(u)) {
            *slot = psi;
            sum += psi;
        }
        let per_sum = T::ONE / sum;
        out.iter_mut().take(self.count()).for_each(|slot| *slot = *slot * per_sum);
    }
}
