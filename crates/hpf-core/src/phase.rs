//! The phase: one variable that falls from 1 and drives every primitive of a skill.
//!
//! Equation: `tau s' = -alpha_s s`, `s(0) = 1` (the paper's Eq. 4 prints no minus sign).
//! Step (exact): `s+ = s exp(-alpha_s r h / tau)`, in loops `s+ = s + s expm1(-alpha_s r h / tau)` with the rounding of
//! each sum carried to the next: a skill of an hour has millions of steps.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | s | phase value | 1 |
//! | tau | `duration` | s |
//! | alpha_s | `decay` | 1 |
//! | r | `rate`, 1 = nominal, 0 = paused | 1 |
//!
//! Slowing the rate slows time along the path and leaves the path unchanged. Past `s(tau)` the phase goes on decaying.
//!
//! The forcing term of a movement is driven by `s gate(s)`. The gate is 1 up to `s_T = s(tau)`, falls smoothly, and is
//! exactly 0 from `s_f = s(tau + FADE tau)` on:
//! ```text
//! gate(s) = u^2 (3 - 2 u),   u = (s - s_f)/(s_T - s_f), limited to [0, 1]
//! ```
//! Up to its duration a movement is the paper's; after it the reference settles at the goal by its own spring.

use crate::domain::{DECAY, DECAY_SINGLE, single};
use crate::{ConfigError, Real, error};

/// Time over which the forcing term fades to exactly zero after the duration, as a share of the duration.
pub const FADE: f64 = 0.1;

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
    /// Phase at the duration.
    end: T,
    /// Phase from which on the forcing term is zero.
    faded: T,
}

impl<T: Real> Phase<T> {
    /// A phase that reaches `exp(-decay)` after `duration` [s] at the nominal rate.
    ///
    /// # Errors
    /// [`ConfigError`] unless both lie in their [domain](crate::domain).
    pub fn new(duration: T, decay: T) -> Result<Self, ConfigError> {
        error::size("duration", duration)?;
        error::positive("decay", decay)?;
        let [least, most] = if single::<T>() { DECAY_SINGLE } else { DECAY };
        error::within("decay", decay, least, most)?;
        let faded = decay * T::of(1.0 + FADE);
        Ok(Self { duration, decay, end: (-decay).exp(), faded: (-faded).exp() })
    }

    /// Duration of the movement at the nominal rate [s].
    pub fn duration(&self) -> T {
        self.duration
    }

    /// Decay alpha_s over the duration; `s(duration) = exp(-decay)`.
    pub fn decay(&self) -> T {
        self.decay
    }

    /// What drives the forcing term at phase `s`: s up to the duration, then s times a gate that reaches exactly zero
    /// [`FADE`] durations later.
    ///
    /// ```
    /// use hpf_core::{Phase, phase::FADE};
    /// let phase = Phase::new(2.0_f64, 100.0_f64.ln())?;
    /// assert_eq!(phase.drive(0.5), 0.5);
    /// assert_eq!(phase.drive(phase.at(2.0 * (1.0 + FADE))), 0.0);
    /// # Ok::<(), hpf_core::ConfigError>(())
    /// ```
    #[inline]
    pub fn drive(&self, s: T) -> T {
        let gate = || {
            let left = ((s - self.faded) / (self.end - self.faded)).at_least(T::ZERO).at_most(T::ONE);
            s * (left * left * (T::of(3.0) - (left + left)))
        };
        s.choose_below(self.end, gate, || s)
    }

    /// The phase at the duration, `exp(-decay)`.
    pub fn end(&self) -> T {
        self.end
    }

    /// The phase `dt` [s] later, time running at `rate`.
    #[inline]
    pub fn step(&self, phase: T, rate: T, dt: T) -> T {
        phase * (-self.decay * rate * dt / self.duration).exp()
    }

    /// By what share of itself the phase changes in `dt` [s], time running at `rate`: at most 0, accurate for short
    /// steps of long movements.
    ///
    /// ```
    /// use hpf_core::Phase;
    /// let hour = Phase::new(3600.0_f32, 100.0_f32.ln())?;
    /// let change = hour.change(1.0, 1e-3); // ln(100) of 3.6 million steps, less half of its square
    /// assert!((change / -1.279_212e-6 - 1.0).abs() < 1e-6);
    /// # Ok::<(), hpf_core::ConfigError>(())
    /// ```
    #[inline]
    pub fn change(&self, rate: T, dt: T) -> T {
        (-self.decay * rate * dt / self.duration).exp_m1()
    }

    /// The phase `time` [s] after the start at the nominal rate.
    #[inline]
    pub fn at(&self, time: T) -> T {
        self.step(T::ONE, T::ONE, time)
    }
}
