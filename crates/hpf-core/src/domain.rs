//! The domain: between which bounds every parameter lies, so that no step can leave the finite numbers.
//!
//! | parameter | bounds | unit |
//! |---|---|---|
//! | duration, stiffness, damping, mass, limits of force, offset, velocity and acceleration, trip levels, cut-off, tank | [`SMALLEST`] to [`LARGEST`] | SI |
//! | start, goal, forcing scale, weights of a movement, workspace, gravity | at most [`LARGEST`] either way | SI |
//! | forcing scale times a weight | at most [`LARGEST_FORCING`] either way | axis unit |
//! | `alpha` of a movement | [`ALPHA`] | 1 |
//! | `decay` of the phase | [`DECAY`], in single precision [`DECAY_SINGLE`] | 1 |
//! | widths of a basis | finite, as is the exponent of every function anywhere in the phase: in single precision that ends the phase family near a decay of 45 | 1 |
//! | longest step of a controller | [`SHORTEST_STEP`] to [`LONGEST_STEP`] | s |
//! | ramp of a controller | up to [`LONGEST_RAMP`] | s |
//! | time for which a bad input is bridged | 0 to [`LONGEST_HOLD`] | s |
//!
//! The bounds are those of single precision, and but for decay and widths the same in double precision: every product of a step
//! stays below 1e38. A constructor refuses what lies outside. What comes in at run
//! time is brought inside: a force beyond [`LARGEST`] counts as that much.
//!
//! Below [`TINY`] a state that dies away is zero: subnormal numbers would make a tool at rest the slowest of all.

use crate::Real;

/// No parameter, force or time may be larger.
pub const LARGEST: f64 = 1e9;

/// No parameter that must be positive may be smaller.
pub const SMALLEST: f64 = 1e-9;

/// Spring factors of a movement.
pub const ALPHA: [f64; 2] = [1e-3, 1e6];

/// The most that the forcing scale times a weight of a movement may be.
pub const LARGEST_FORCING: f64 = 1e12;

/// Decays of a phase over the duration.
pub const DECAY: [f64; 2] = [1e-3, 100.0];

/// Decays of a phase over the duration in single precision: the forcing term has faded before the phase is subnormal.
pub const DECAY_SINGLE: [f64; 2] = [1e-3, 60.0];

/// A shorter step of a controller is no step [s].
pub const SHORTEST_STEP: f64 = 1e-6;

/// The most that the longest step of a controller may be [s].
pub const LONGEST_STEP: f64 = 1.0;

/// The longest ramp of the rate [s]: a stop stands still within it.
pub const LONGEST_RAMP: f64 = 10.0;

/// The longest time for which a bad input may be bridged [s].
pub const LONGEST_HOLD: f64 = 1.0;

/// A state that dies away and has become smaller is zero; its square is still a normal number in single precision.
pub const TINY: f64 = 1e-18;

/// A phase below is zero: what a forcing term still is there is nothing.
const TINY_PHASE: [f64; 2] = [1e-60, 1e-30];

/// Whether `T` is single precision, as far as digits tell.
#[inline(always)]
pub(crate) fn single<T: Real>() -> bool {
    (T::ONE + T::of(1e-12)).to_f64() <= 1.0
}

/// The smallest phase that is not zero.
#[inline(always)]
pub(crate) fn tiny_phase<T: Real>() -> T {
    let [double_precision, single_precision] = TINY_PHASE;
    T::of(if single::<T>() { single_precision } else { double_precision })
}

/// `value`, or zero where it is below [`TINY`].
#[inline(always)]
pub(crate) fn flushed<T: Real>(value: T) -> T {
    value.abs().select_below(T::of(TINY), T::ZERO, value)
}
