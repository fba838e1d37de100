//! The phase: one variable that drives every primitive of a skill, and the gate of the forcing term.
//!
//! Equation: `tau s' = -alpha_s s`, `s(0) = 1` (the paper's Eq. 4 prints no minus sign).
//! Step (exact): `s+ = s exp(-alpha_s r h / tau)`, in loops `s+ = s + s expm1(-alpha_s r h / tau)` with the rounding of
//! each sum carried to the next: a skill of an hour has millions of steps.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | s | phase value | 1 |
//! | gamma | `gate`, the factor of the forcing term | 1 |
//! | tau | `duration` | s |
//! | alpha_s | `decay` | 1 |
//! | r | `rate`, 1 = nominal, 0 = paused | 1 |
//!
//! Slowing the rate slows time along the path and leaves the path unchanged. Past `s(tau)` the phase goes on decaying.
//!
//! The gate of a decaying phase is s up to `s_T = s(tau)`, falls smoothly after it, and is exactly 0 from
//! `s_f = s(tau + FADE tau)` on:
//! ```text
//! gamma(s) = s u^2 (3 - 2 u),   u = (s - s_f)/(s_T - s_f), limited to [0, 1]
//! ```
//! Up to its duration a movement is the paper's; after it the reference settles at the goal by its own spring.

use crate::compensated::accumulate_phase;
use crate::domain::{DECAY, DECAY_SINGLE, single};
use crate::{ConfigError, Real, error};

/// Time over which the forcing term fades to exactly zero after the duration, as a share of the duration.
pub const FADE: f64 = 0.1;

/// Parameters of the phase, by its kind.
///
/// ```
/// use hpf_core::Phase;
/// let phase = Phase::new(2.0_f64, 100.0_f64.ln())?; // 2 s, s(2 s) = 0.01
/// let s = phase.step(1.0, 1.0, 1.0);
/// assert!((s - 0.1).abs() < 1e-15); // half the time, half the decades
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Phase<T> {
    /// Falls from 1 and ends: a discrete movement.
    Decay(Decay<T>),
}

/// Parameters of a decaying phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay<T> {
    duration: T,
    decay: T,
    /// Phase at the duration.
    end: T,
    /// Phase from which on the forcing term is zero.
    faded: T,
}

/// The phase at one instant, and how much of the forcing term acts there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhasePoint<T> {
    /// Phase s.
    pub s: T,
    /// Factor gamma of the forcing term.
    pub gate: T,
}

/// What half a step changes about a phase; the same as long as the length of the step and the rate of time are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HalfStep<T>(T);

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
        Ok(Self::Decay(Decay { duration, decay, end: (-decay).exp(), faded: (-faded).exp() }))
    }

    /// Duration of the movement at the nominal rate [s].
    #[inline]
    pub fn duration(&self) -> T {
        let Self::Decay(decay) = self;
        decay.duration
    }

    /// Decay alpha_s over the duration; `s(duration) = exp(-decay)`.
    #[inline]
    pub fn decay(&self) -> T {
        let Self::Decay(decay) = self;
        decay.decay
    }

    /// The phase at the start.
    #[inline]
    pub fn start(&self) -> T {
        let Self::Decay(_) = self;
        T::ONE
    }

    /// The gate at phase `s`, the factor of the forcing term: s up to the duration, then s times a fade that reaches
    /// exactly zero [`FADE`] durations later.
    ///
    /// ```
    /// use hpf_core::{Phase, phase::FADE};
    /// let phase = Phase::new(2.0_f64, 100.0_f64.ln())?;
    /// assert_eq!(phase.gate(0.5), 0.5);
    /// assert_eq!(phase.at(2.0 * (1.0 + FADE)).gate, 0.0);
    /// # Ok::<(), hpf_core::ConfigError>(())
    /// ```
    #[inline]
    pub fn gate(&self, s: T) -> T {
        let Self::Decay(Decay { end, faded, .. }) = *self;
        let fading = || {
            let left = ((s - faded) / (end - faded)).at_least(T::ZERO).at_most(T::ONE);
            s * (left * left * (T::of(3.0) - (left + left)))
        };
        s.choose_below(end, fading, || s)
    }

    /// The phase `dt` [s] later, time running at `rate`.
    #[inline]
    pub fn step(&self, phase: T, rate: T, dt: T) -> T {
        let Self::Decay(Decay { duration, decay, .. }) = *self;
        phase * (-decay * rate * dt / duration).exp()
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
        let Self::Decay(Decay { duration, decay, .. }) = *self;
        (-decay * rate * dt / duration).exp_m1()
    }

    /// Phase and gate `time` [s] after the start at the nominal rate.
    #[inline]
    pub fn at(&self, time: T) -> PhasePoint<T> {
        let s = self.step(self.start(), T::ONE, time);
        PhasePoint { s, gate: self.gate(s) }
    }

    /// Half a step of `dt` [s], time running at `rate`.
    #[inline]
    pub(crate) fn half_step(&self, rate: T, dt: T) -> HalfStep<T> {
        HalfStep(self.change(rate, dt * T::of(0.5)))
    }
}

impl<T: Real + PartialOrd> Phase<T> {
    /// Whether a movement at phase `s` has lasted for its duration.
    #[inline]
    pub fn has_ended(&self, s: T) -> bool {
        let Self::Decay(decay) = self;
        s <= decay.end
    }
}

impl<T: Real> HalfStep<T> {
    /// No step.
    pub const NONE: Self = Self(T::ZERO);

    /// The phase at the middle of the step that starts at `s`.
    #[inline(always)]
    pub fn middle(self, s: T) -> T {
        s + s * self.0
    }

    /// Advances `s` by the part `share` of the whole step with its `middle`; `remainder` carries what rounding takes.
    #[inline(always)]
    pub fn advance(self, s: &mut T, remainder: &mut T, middle: T, share: T) {
        accumulate_phase(s, remainder, share * ((*s + middle) * self.0));
    }
}
