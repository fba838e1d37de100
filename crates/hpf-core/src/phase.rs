//! The phase: one variable that falls from 1 and drives every primitive of a skill.
//!
//! Equation: `tau s' = -alpha_s s`, `s(0) = 1` (the paper's Eq. 4 prints no minus sign).
//! Step (exact): `s+ = s exp(-alpha_s r h / tau)`.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | s | phase value | 1 |
//! | tau | `duration` | s |
//! | alpha_s | `decay` | 1 |
//! | r | `rate`, 1 = nominal, 0 = paused | 1 |
//!
//! Slowing the rate slows time along the path and leaves the path unchanged. Past `s(tau)` the phase goes on
//! decaying: the end of a movement is a status, not an event in the equations.

use crate::{ConfigError, Real, error};

/// Parameters of the phase.
///
/// ```
/// use hpf_core::Phase;
/// let phase = Phase::new(2.0_f64, 100.0_f64.ln())?; // 2 s, s(2 s) = 0.01
/// let s = phase.step(1.0, 1.0, 1.0);
/// assert!((s - 0.1).abs() < 1e-15); // half the time, half the decades
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase<T> {
    duration: T,
    decay: T,
}

impl<T: Real> Phase<T> {
    /// A phase that reaches `exp(-decay)` after `duration` [s] at the nominal rate.
    ///
    /// # Errors
    /// [`ConfigError`] unless both are finite and positive.
    pub fn new(duration: T, decay: T) -> Result<Self, ConfigError> {
        Ok(Self { duration: error::positive("duration", duration)?, decay: error::positive("decay", decay)? })
    }

    /// Duration of the movement at the nominal rate [s].
    pub fn duration(&self) -> T {
        self.duration
    }

    /// Decay alpha_s over the duration; `s(duration) = exp(-decay)`.
    pub fn decay(&self) -> T {
        self.decay
    }

    /// The phase `dt` [s] later, time running at `rate`.
    #[inline]
    pub fn step(&self, phase: T, rate: T, dt: T) -> T {
        phase * self.fall(rate, dt)
    }

    /// The factor by which the phase falls in `dt` [s], time running at `rate`.
    #[inline]
    pub fn fall(&self, rate: T, dt: T) -> T {
        (-self.decay * rate * dt / self.duration).exp()
    }

    /// The phase `time` [s] after the start at the nominal rate.
    #[inline]
    pub fn at(&self, time: T) -> T {
        self.step(T::ONE, T::ONE, time)
    }
}
