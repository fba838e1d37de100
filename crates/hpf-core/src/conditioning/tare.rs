//! What a tare takes as bias: the mean of a force that is known to stand still.
//!
//! Readings are gathered in halves of [`TARE_TIME`]. Two halves that follow each other without a bad reading make a mean,
//! that of both, if
//! - no axis varies by more than [`TARE_SPREAD`] of its scale from least to most, over both and all readings since;
//! - the means of the two differ by at most [`TARE_DRIFT`] of it;
//! - the last [`TARE_RECENT`], by a first-order mean of gain a, differ from them by at most `TARE_DRIFT + TARE_SPREAD
//!   sqrt(a)/2` of it: the second term is more than twice the deviation of evenly spread noise of that width.
//!
//! A reading beyond that spread begins anew. Readings are taken before the filter, so nothing of what a filter has yet to
//! forget is in the mean.

use crate::Real;

/// How long a force must have stood still, and over how long it is averaged [s].
pub const TARE_TIME: f64 = 0.5;

/// The most that a force may vary meanwhile, from least to most, as a share of its scale.
pub const TARE_SPREAD: f64 = 0.05;

/// The most that the means of the two halves may differ, as a share of its scale.
pub const TARE_DRIFT: f64 = 0.01;

/// Over how long the newest readings are averaged, which must not have left the mean [s].
pub const TARE_RECENT: f64 = 0.02;

/// So many readings make a half at least.
const READINGS: f64 = 10.0;

/// What is known of one axis over some readings [N].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span<T> {
    mean: T,
    least: T,
    most: T,
}

impl<T: Real> Span<T> {
    const NONE: Self = Self { mean: T::ZERO, least: T::ZERO, most: T::ZERO };

    /// With one reading more, the `count`th.
    fn with(self, force: T, count: T) -> Self {
        if count.to_f64() <= 1.0 {
            return Self { mean: force, least: force, most: force };
        }
        Self {
            mean: self.mean + (force - self.mean) / count,
            least: self.least.at_most(force),
            most: self.most.at_least(force),
        }
    }
}

/// The readings of the last while.
///
/// ```
/// use hpf_core::conditioning::TareWindow;
/// let mut window = TareWindow::default();
/// for _ in 0..499 {
///     window.observe([8.0_f64], [50.0], 1e-3);
/// }
/// assert_eq!(window.mean(), None); // not yet half a second
/// window.observe([8.0], [50.0], 1e-3);
/// assert_eq!(window.mean(), Some([8.0]));
/// assert_eq!(window.mean_beside([11.0], [50.0]), None); // 3 N more are more than 5 % of 50 N
/// window.observe([11.0], [50.0], 1e-3);
/// assert_eq!(window.mean(), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TareWindow<T, const D: usize> {
    /// The half that is being gathered, its time [s] and number of readings.
    half: [Span<T>; D],
    time: T,
    count: T,
    /// The half before it, and the one before that.
    before: Option<[Span<T>; D]>,
    older: Option<[Span<T>; D]>,
    /// First-order mean of the newest readings.
    recent: [T; D],
    mean: Option<[T; D]>,
}

impl<T: Real, const D: usize> Default for TareWindow<T, D> {
    fn default() -> Self {
        let half = [Span::NONE; D];
        Self { half, time: T::ZERO, count: T::ZERO, before: None, older: None, recent: [T::ZERO; D], mean: None }
    }
}

impl<T: Real + PartialOrd, const D: usize> TareWindow<T, D> {
    /// Takes one more reading [N], finite, after `dt` [s]; `scale` [N] is what its variation is measured against.
    pub fn observe(&mut self, force: [T; D], scale: [T; D], dt: T) {
        if !self.is_near(force, scale) {
            *self = Self::default();
            return;
        }
        let is_first = self.count == T::ZERO && self.before.is_none();
        let gain = if is_first { T::ONE } else { dt / (dt + T::of(TARE_RECENT)) };
        self.count += T::ONE;
        self.time += dt;
        for ((span, recent), force) in self.half.iter_mut().zip(&mut self.recent).zip(force) {
            *span = span.with(force, self.count);
            *recent += gain * (force - *recent);
        }
        // A thousandth of a step is forgiven: sums of steps are rounded.
        if self.time + dt * T::of(1e-3) >= T::of(0.5 * TARE_TIME) && self.count >= T::of(READINGS) {
            (self.older, self.before) = (self.before, Some(self.half));
            (self.half, self.time, self.count) = ([Span::NONE; D], T::ZERO, T::ZERO);
        }
        self.mean = self.steady_mean(scale, gain);
    }

    /// The halves that there are.
    fn halves(&self) -> impl Iterator<Item = &[Span<T>; D]> {
        let begun = (self.count > T::ZERO).then_some(&self.half);
        begun.into_iter().chain(&self.before).chain(&self.older)
    }

    /// Whether `force` [N] is as near to all readings as it must be.
    fn is_near(&self, force: [T; D], scale: [T; D]) -> bool {
        let (mut least, mut most) = (force, force);
        for half in self.halves() {
            for ((least, most), span) in least.iter_mut().zip(&mut most).zip(half) {
                (*least, *most) = (least.at_most(span.least), most.at_least(span.most));
            }
        }
        least.iter().zip(most).zip(scale).all(|((&least, most), scale)| most - least <= scale * T::of(TARE_SPREAD))
    }

    /// The mean of the last two whole halves, where nothing has drifted.
    fn steady_mean(&self, scale: [T; D], gain: T) -> Option<[T; D]> {
        let (older, before) = (self.older.as_ref()?, self.before.as_ref()?);
        let noise = T::of(TARE_DRIFT) + T::of(0.5 * TARE_SPREAD) * gain.sqrt();
        let mut mean = [T::ZERO; D];
        let mut steady = true;
        let axes = mean.iter_mut().zip(older.iter().zip(before)).zip(self.recent).zip(scale);
        for (((mean, (older, before)), recent), scale) in axes {
            let drift = before.mean - older.mean;
            *mean = older.mean + drift * T::of(0.5);
            steady &= drift.abs() <= scale * T::of(TARE_DRIFT) && (recent - *mean).abs() <= scale * noise;
        }
        steady.then_some(mean)
    }

    /// The mean [N] of the last two whole halves; none where the force has not stood still since.
    pub fn mean(&self) -> Option<[T; D]> {
        self.mean
    }

    /// The same, none too where `force` [N] is no reading of a force that stands still.
    pub fn mean_beside(&self, force: [T; D], scale: [T; D]) -> Option<[T; D]> {
        self.mean.filter(|_| self.is_near(force, scale))
    }
}
