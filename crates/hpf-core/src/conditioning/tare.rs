//! What a tare takes as bias: the mean of a force that is known to stand still.
//!
//! Readings are gathered in halves of [`TARE_TIME`]. Two halves that follow each other without a bad reading make a mean,
//! that of both, if over the two of them no axis varies by more than [`TARE_SPREAD`] of its scale from least to most, and
//! the means of the two differ by at most [`TARE_DRIFT`] of it. A reading beyond that spread begins anew. Readings are
//! taken before the filter, so nothing of what a filter has yet to forget is in the mean.

use crate::Real;

/// How long a force must have stood still, and over how long it is averaged [s].
pub const TARE_TIME: f64 = 0.5;

/// The most that a force may vary meanwhile, from least to most, as a share of its scale.
pub const TARE_SPREAD: f64 = 0.05;

/// The most that the means of the two halves may differ, as a share of its scale.
pub const TARE_DRIFT: f64 = 0.01;

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
/// window.observe([11.0], [50.0], 1e-3); // 3 N more are more than 5 % of 50 N
/// assert_eq!(window.mean(), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TareWindow<T, const D: usize> {
    /// The half that is being gathered, its time [s] and number of readings.
    half: [Span<T>; D],
    time: T,
    count: T,
    /// The half before it.
    before: Option<[Span<T>; D]>,
    mean: Option<[T; D]>,
}

impl<T: Real, const D: usize> Default for TareWindow<T, D> {
    fn default() -> Self {
        Self { half: [Span::NONE; D], time: T::ZERO, count: T::ZERO, before: None, mean: None }
    }
}

impl<T: Real + PartialOrd, const D: usize> TareWindow<T, D> {
    /// Takes one more reading [N], finite, after `dt` [s]; `scale` [N] is what its variation is measured against.
    pub fn observe(&mut self, force: [T; D], scale: [T; D], dt: T) {
        self.count += T::ONE;
        self.time += dt;
        let mut still = true;
        for ((i, span), (force, scale)) in self.half.iter_mut().enumerate().zip(force.into_iter().zip(scale)) {
            *span = span.with(force, self.count);
            let [least, most] = match self.before.as_ref().and_then(|before| before.get(i)) {
                Some(before) => [span.least.at_most(before.least), span.most.at_least(before.most)],
                None => [span.least, span.most],
            };
            still &= most - least <= scale * T::of(TARE_SPREAD);
        }
        if !still {
            *self = Self::default();
            return;
        }
        // A thousandth of a step is forgiven: sums of steps are rounded.
        if self.time + dt * T::of(1e-3) < T::of(0.5 * TARE_TIME) || self.count < T::of(READINGS) {
            return;
        }
        self.mean = self.before.as_ref().and_then(|before| {
            let mut mean = [T::ZERO; D];
            let mut steady = true;
            for ((mean, (before, now)), scale) in mean.iter_mut().zip(before.iter().zip(&self.half)).zip(scale) {
                let drift = now.mean - before.mean;
                steady &= drift.abs() <= scale * T::of(TARE_DRIFT);
                *mean = before.mean + drift * T::of(0.5);
            }
            steady.then_some(mean)
        });
        self.before = Some(self.half);
        (self.half, self.time, self.count) = ([Span::NONE; D], T::ZERO, T::ZERO);
    }

    /// The mean [N] of the last two whole halves; none where the force has not stood still.
    pub fn mean(&self) -> Option<[T; D]> {
        self.mean
    }
}
