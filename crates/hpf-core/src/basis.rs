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
//! A second family is equally spaced in time itself: `psi_i = overlap^((t - i)^2)`, t = -ln(s) (n-1)/alpha_s counted in
//! spacings. With k the nearest center, `psi_{k+j} / psi_k = u^j overlap^(j^2)`, `u = overlap^(-2 (t - k))`: one logarithm
//! and one exponential per step instead of n exponentials, the powers of u from the nearest outwards. Before the first and past the last center t stands still. The
//! two families are not equal in numbers; weights belong to the family that they were learned with.
//!
//! The phi_i are positive and sum to one, so a mixture of weights in `[lo, hi]` stays in `[lo, hi]`. The largest
//! exponent is subtracted before any exponential is taken: all psi underflowing to 0/0 cannot happen.

use core::marker::PhantomData;

use crate::{ConfigError, Real, error};

/// Overlap of neighbours where nothing else is asked for.
pub const DEFAULT_OVERLAP: f64 = 0.6;

/// A function of the time family of which this share of the nearest's, at its largest, is lost in rounding counts as
/// zero: it would cost time, and its powers of u may overflow. The sum is above 2 there.
const SHARE_THAT_COUNTS: f64 = 0.25;

/// What the functions of a basis are Gaussians of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Family<T> {
    /// The phase; `shape` holds the widths.
    Phase,
    /// Time; `shape` holds what a function has fallen to j spacings from its center.
    Time {
        /// Spacings per unit of -ln(s): (n-1)/alpha_s.
        spacings: T,
        /// -ln(overlap).
        fall: T,
        overlap: T,
        /// The last center's number, n-1.
        last: T,
        /// Spacings up to which a function counts.
        reach: usize,
    },
}

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
    shape: S,
    family: Family<T>,
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
        at_least_two(c)?;
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
        Ok(Self { centers, shape: widths, family: Family::Phase, scalar: PhantomData })
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
        let fall = fall_to(overlap)?;
        place(decay, centers.as_mut())?;
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

    /// The basis of the time family: centers equally spaced in time over a phase that falls by `decay`, neighbours
    /// meeting at `overlap` (in (0, 1)). Fills the storage it is given, whose length is the number of functions.
    ///
    /// ```
    /// use hpf_core::Basis;
    /// let basis = Basis::equally_spaced_in_time(100.0_f64.ln(), 0.6, [0.0; 5], [0.0; 5])?;
    /// let [mixed] = basis.mix(0.1, [&[1.0, 2.0, 3.0, 4.0, 5.0]]);
    /// assert!((mixed - 3.0).abs() < 1e-12); // half the time: the middle, by symmetry
    /// # Ok::<(), hpf_core::ConfigError>(())
    /// ```
    ///
    /// # Errors
    /// As [`equally_spaced`](Self::equally_spaced), and for lengths that differ.
    pub fn equally_spaced_in_time(decay: T, overlap: T, mut centers: S, mut falls: S) -> Result<Self, ConfigError>
    where
        S: AsMut<[T]>,
    {
        let fall = fall_to(overlap)?;
        place(decay, centers.as_mut())?;
        error::finite_list("falls", falls.as_ref(), centers.as_ref().len())?;
        for (j, slot) in falls.as_mut().iter_mut().enumerate() {
            *slot = fallen(fall, j);
        }
        Self::in_time(decay, overlap, fall, centers, falls)
    }

    /// The basis of the time family over lists that are stored, in flash or a file: each number must be the one that
    /// [`equally_spaced_in_time`](Self::equally_spaced_in_time) writes for this `decay` and `overlap`.
    ///
    /// # Errors
    /// As [`equally_spaced_in_time`](Self::equally_spaced_in_time), and for a number that is another one.
    pub fn stored_in_time(decay: T, overlap: T, centers: S, falls: S) -> Result<Self, ConfigError> {
        let fall = fall_to(overlap)?;
        error::positive("decay", decay)?;
        at_least_two(centers.as_ref())?;
        error::finite_list("falls", falls.as_ref(), centers.as_ref().len())?;
        let last = T::of(centers.as_ref().len().saturating_sub(1) as f64);
        let pairs = centers.as_ref().iter().zip(falls.as_ref()).enumerate();
        for (i, (found, fall_found)) in pairs {
            let (center, fallen) = (center(decay, last, i).to_f64(), fallen(fall, i).to_f64());
            error::within("centers", *found, center, center)?;
            error::within("falls", *fall_found, fallen, fallen)?;
        }
        Self::in_time(decay, overlap, fall, centers, falls)
    }

    /// The time family over lists known to be its own.
    fn in_time(decay: T, overlap: T, fall: T, centers: S, falls: S) -> Result<Self, ConfigError> {
        let last = T::of(centers.as_ref().len().saturating_sub(1) as f64);
        let reach = falls.as_ref().iter().skip(1).filter(|fallen| fallen.to_f64() > 0.0).count();
        let spacings = last / decay;
        error::finite("functions over decay", spacings)?;
        // The largest power of u there will be.
        error::finite("overlap to the power of minus its reach", T::ONE / (-fall * T::of(reach as f64)).exp())?;
        let family = Family::Time { spacings, fall, overlap, last, reach };
        Ok(Self { centers, shape: falls, family, scalar: PhantomData })
    }

    /// The same basis over other storage, for lists that lie in flash.
    ///
    /// # Errors
    /// [`ConfigError`] unless the stored numbers are those of this basis.
    pub fn stored<R: AsRef<[T]>>(&self, centers: R, shape: R) -> Result<Basis<T, R>, ConfigError> {
        for (field, ours, theirs) in
            [("centers", self.centers(), centers.as_ref()), ("shape", self.shape.as_ref(), shape.as_ref())]
        {
            error::finite_list(field, theirs, ours.len())?;
            for (ours, theirs) in ours.iter().zip(theirs) {
                let value = ours.to_f64();
                error::within(field, *theirs, value, value)?;
            }
        }
        Ok(Basis { centers, shape, family: self.family, scalar: PhantomData })
    }

    /// Number of functions.
    pub fn count(&self) -> usize {
        self.centers.as_ref().len()
    }

    /// Centers c_i in phase, oldest first.
    pub fn centers(&self) -> &[T] {
        self.centers.as_ref()
    }

    /// Widths h_i; of the time family, what a function has fallen to j spacings from its center.
    pub fn widths(&self) -> &[T] {
        self.shape.as_ref()
    }

    /// Overlap of neighbors, of the time family.
    pub fn overlap(&self) -> Option<T> {
        match self.family {
            Family::Phase => None,
            Family::Time { overlap, .. } => Some(overlap),
        }
    }

    /// Whether the other basis is this one, bit by bit.
    pub(crate) fn same(&self, other: &Self) -> bool {
        let equal = |a: &[T], b: &[T]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_f64() == b.to_f64());
        let family = match (self.family, other.family) {
            (Family::Phase, Family::Phase) => true,
            (Family::Time { spacings, fall, .. }, Family::Time { spacings: others, fall: other, .. }) => {
                equal(&[spacings, fall], &[others, other])
            }
            (Family::Phase, Family::Time { .. }) | (Family::Time { .. }, Family::Phase) => false,
        };
        family && equal(self.centers(), other.centers()) && equal(self.widths(), other.widths())
    }

    /// `-h_i (s - c_i)^2` of each function of the phase family.
    #[inline]
    fn exponents(&self, s: T) -> impl Iterator<Item = T> {
        self.centers.as_ref().iter().zip(self.shape.as_ref()).map(move |(&c, &h)| -h * (s - c) * (s - c))
    }

    /// Hands the activations at `s` to `sink`, all over one of them, which cancels in every normalised quantity; functions
    /// that are left out count as zero. Returns the sum.
    #[inline(always)]
    fn scan(&self, s: T, sink: &mut impl Sink<T>) -> T {
        match self.family {
            Family::Phase => self.scan_phase(s, sink),
            Family::Time { spacings, fall, last, reach, .. } => {
                let (k, distance) = nearest(s, spacings, last);
                self.scan_time(k, (fall + fall) * distance, reach, sink)
            }
        }
    }

    /// [`scan`](Self::scan) of the phase family: over the largest.
    #[inline(always)]
    fn scan_phase(&self, s: T, sink: &mut impl Sink<T>) -> T {
        let floor = T::of(f64::NEG_INFINITY);
        let largest = self.exponents(s).fold(floor, |largest, e| largest.select_below(e, e, largest));
        let (centers, rest) = self.centers.as_ref().as_chunks::<GROUP>();
        let (widths, rest_widths) = self.shape.as_ref().as_chunks::<GROUP>();
        let activation = |(&c, &h): (&T, &T)| (-h * (s - c) * (s - c) - largest).exp();
        let mut sum = T::ZERO;
        let mut first = 0;
        for (centers, widths) in centers.iter().zip(widths) {
            let mut group = [T::ZERO; GROUP];
            for (slot, function) in group.iter_mut().zip(centers.iter().zip(widths)) {
                *slot = activation(function);
            }
            sum = add(sum, group);
            sink.take(first, group);
            first += GROUP;
        }
        for function in rest.iter().zip(rest_widths) {
            let activation = activation(function);
            sum += activation;
            sink.take(first, [activation]);
            first += 1;
        }
        sum
    }

    /// [`scan`](Self::scan) of the time family: over the nearest, `k`, from it outwards.
    #[inline(always)]
    fn scan_time(&self, k: usize, slope: T, reach: usize, sink: &mut impl Sink<T>) -> T {
        let up = slope.exp();
        let falls = self.shape.as_ref().get(1..).unwrap_or_default();
        let above = falls.get(..self.count().saturating_sub(k + 1).min(reach)).unwrap_or_default();
        let below = falls.get(..k.min(reach)).unwrap_or_default();
        sink.start(k);
        let above = Arm { falls: above, at: k + 1, factor: up, power: T::ONE, sum: T::ONE };
        let above = above.go::<GROUP>(sink, true).go::<2>(sink, true).go::<1>(sink, true);
        let below = Arm { falls: below, at: k, factor: T::ONE / up, power: T::ONE, sum: above.sum };
        below.go::<GROUP>(sink, false).go::<2>(sink, false).go::<1>(sink, false).sum
    }

    /// The mixtures `sum_i w_i phi_i(s)` of `M` weight lists, the basis evaluated once for all of them.
    ///
    /// Each list holds one weight per function; one of another length is not refused, but mixes wrongly.
    #[inline]
    pub fn mix<const M: usize>(&self, s: T, weights: [&[T]; M]) -> [T; M] {
        self.mix_sets(s, weights.map(|list| [list])).map(|[mixed]| mixed)
    }

    /// [`mix`](Self::mix) of `M` sets of `K` weight lists each, the basis evaluated once for all of them.
    #[inline]
    pub fn mix_sets<const K: usize, const M: usize>(&self, s: T, weights: [[&[T]; K]; M]) -> [[T; K]; M] {
        let mut mixer = Mixer { weights, mixed: [[T::ZERO; K]; M] };
        let per_sum = T::ONE / self.scan(s, &mut mixer);
        // In place: a map of arrays as long as those of six axes becomes copies upon copies.
        mixer.mixed.as_flattened_mut().iter_mut().for_each(|mixed| *mixed = *mixed * per_sum);
        mixer.mixed
    }

    /// Writes `phi_i(s)` into `out`, one entry per function.
    pub fn features_into(&self, s: T, out: &mut [T]) {
        out.fill(T::ZERO);
        let per_sum = T::ONE / self.scan(s, &mut Listed(out));
        out.iter_mut().for_each(|slot| *slot = *slot * per_sum);
    }

    /// Writes `psi_i(s)` into `out`, one entry per function: the activations without normalisation.
    pub fn activations_into(&self, s: T, out: &mut [T]) {
        match self.family {
            Family::Phase => {
                for (slot, exponent) in out.iter_mut().zip(self.exponents(s)) {
                    *slot = exponent.exp();
                }
            }
            Family::Time { spacings, fall, last, .. } => {
                let (k, distance) = nearest(s, spacings, last);
                for (i, slot) in out.iter_mut().enumerate().take(self.count()) {
                    let away = T::of(k as f64 - i as f64) + distance;
                    *slot = (-fall * away * away).exp();
                }
            }
        }
    }
}

/// Activations that are weighed at once.
const GROUP: usize = 5;

/// What activations are handed to.
trait Sink<T> {
    /// Starts with function `at`, of activation 1.
    fn start(&mut self, at: usize);
    /// Takes the activations of the functions from `first` on.
    fn take<const L: usize>(&mut self, first: usize, activations: [T; L]);
}

/// Writes each activation down.
struct Listed<'a, T>(&'a mut [T]);

impl<T: Real> Sink<T> for Listed<'_, T> {
    #[inline(always)]
    fn start(&mut self, at: usize) {
        self.0.iter_mut().skip(at).take(1).for_each(|slot| *slot = T::ONE);
    }

    #[inline(always)]
    fn take<const L: usize>(&mut self, first: usize, activations: [T; L]) {
        self.0.iter_mut().skip(first).zip(activations).for_each(|(slot, activation)| *slot = activation);
    }
}

/// Weighs `M` sets of `K` lists by the activations.
struct Mixer<'a, T, const K: usize, const M: usize> {
    weights: [[&'a [T]; K]; M],
    mixed: [[T; K]; M],
}

impl<T: Real, const K: usize, const M: usize> Sink<T> for Mixer<'_, T, K, M> {
    #[inline(always)]
    fn start(&mut self, at: usize) {
        for (mixed, list) in self.mixed.as_flattened_mut().iter_mut().zip(self.weights.as_flattened()) {
            *mixed = list.get(at).copied().unwrap_or(T::ZERO);
        }
    }

    #[inline(always)]
    fn take<const L: usize>(&mut self, first: usize, activations: [T; L]) {
        for (mixed, list) in self.mixed.as_flattened_mut().iter_mut().zip(self.weights.as_flattened()) {
            if let Some(weights) = list.get(first..).unwrap_or_default().first_chunk::<L>() {
                *mixed = weights.iter().zip(activations).fold(*mixed, |sum, (&w, a)| sum + a * w);
            }
        }
    }
}

/// `sum` and some activations.
#[inline(always)]
fn add<T: Real, const L: usize>(sum: T, activations: [T; L]) -> T {
    activations.into_iter().fold(sum, |sum, activation| sum + activation)
}

/// What is left of the functions of the time family on one side of the nearest, nearer ones first.
struct Arm<'a, T> {
    falls: &'a [T],
    /// Above: the next function. Below: the last one.
    at: usize,
    factor: T,
    /// u^j of the last one.
    power: T,
    sum: T,
}

impl<T: Real> Arm<'_, T> {
    /// Hands over as many groups of `L` as there are.
    #[inline(always)]
    fn go<const L: usize>(mut self, sink: &mut impl Sink<T>, above: bool) -> Self {
        while let Some((falls, rest)) = self.falls.split_first_chunk::<L>() {
            self.falls = rest;
            let mut group = falls.map(|fallen| {
                self.power = self.power * self.factor;
                self.power * fallen
            });
            self.sum = add(self.sum, group);
            if above {
                sink.take(self.at, group);
                self.at += L;
            } else {
                group.reverse();
                self.at = self.at.saturating_sub(L);
                sink.take(self.at, group);
            }
        }
        self
    }
}

/// An error unless there are at least two functions.
fn at_least_two<T>(centers: &[T]) -> Result<(), ConfigError> {
    if centers.len() < 2 {
        return Err(ConfigError::TooFew { field: "centers", count: centers.len(), least: 2 });
    }
    Ok(())
}

/// `-ln(overlap)` of an overlap in (0, 1).
fn fall_to<T: Real>(overlap: T) -> Result<T, ConfigError> {
    let value = overlap.to_f64();
    if !(value > 0.0 && value < 1.0) {
        return Err(ConfigError::OutOfRange { field: "overlap", value, min: 0.0, max: 1.0 });
    }
    Ok(T::of(-libm::log(value)))
}

/// What a function of the time family has fallen to, `j` spacings from its center; zero where it does not count.
fn fallen<T: Real>(fall: T, j: usize) -> T {
    let j = j as f64;
    let fallen = libm::exp(-fall.to_f64() * (j * j));
    // Half way to the next center, where the nearest two are equal.
    let most = libm::exp(-fall.to_f64() * (j * (j - 1.0).max(0.0)));
    let counts = (T::ONE + T::of(SHARE_THAT_COUNTS * most)).to_f64() > 1.0;
    if counts { T::of(fallen) } else { T::ZERO }
}

/// Center `i` of those equally spaced in time over a phase that falls by `decay`, the last one's number being `last`.
fn center<T: Real>(decay: T, last: T, i: usize) -> T {
    (-decay * T::of(i as f64) / last).exp()
}

/// Places centers equally in time over a phase that falls by `decay`.
fn place<T: Real>(decay: T, centers: &mut [T]) -> Result<(), ConfigError> {
    error::positive("decay", decay)?;
    at_least_two(centers)?;
    let last = T::of((centers.len() - 1) as f64);
    for (i, slot) in centers.iter_mut().enumerate() {
        *slot = center(decay, last, i);
    }
    Ok(())
}

/// The nearest center k of the time family and the distance to it in spacings.
#[inline]
fn nearest<T: Real>(s: T, spacings: T, last: T) -> (usize, T) {
    let t = (-s.ln() * spacings).at_least(T::ZERO).at_most(last);
    let k = (t + T::of(0.5)).to_index();
    (k, t - T::of(k as f64))
}
