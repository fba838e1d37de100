//! The scalar that every kernel is written in.
//!
//! Exponentials and the like go through `libm` on every build, those of `f32` through a series of their own: the standard
//! library calls the platform's, which differs in the last bits, and host and firmware must agree. Kernels branch through
//! [`Real::select_below`] and its kin only, so that a pack of lanes can implement the trait too.

mod single;

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A real number: `f32` in firmware with a single-precision unit, `f64` on a host.
///
/// ```
/// use hpf_core::Real;
/// fn half<T: Real>(x: T) -> T { x * T::of(0.5) }
/// assert_eq!(half(3.0_f32), 1.5);
/// assert_eq!(half(3.0_f64), 1.5);
/// ```
pub trait Real:
    Copy
    + PartialEq
    + 'static
    + Debug
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;

    /// The nearest value to `value`.
    fn of(value: f64) -> Self;
    /// The value in double precision.
    fn to_f64(self) -> f64;
    /// `e^self`.
    fn exp(self) -> Self;
    /// `e^self - 1`, accurate near zero.
    fn exp_m1(self) -> Self;
    /// The natural logarithm.
    fn ln(self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians, accurate for angles of a few turns.
    fn sin_cos(self) -> (Self, Self);
    /// The angle in [-pi, pi] of the point (`x`, self), by both signs; 0 where both are zero.
    fn atan2(self, x: Self) -> Self;
    /// The largest integer not above.
    fn floor(self) -> Self;
    /// The integer part; zero for a negative number and for NaN.
    fn to_index(self) -> usize;
    /// The smaller of two; a NaN loses.
    fn min(self, other: Self) -> Self;
    /// The larger of two; a NaN loses.
    fn max(self, other: Self) -> Self;
    /// The magnitude.
    fn abs(self) -> Self;
    /// The smaller of this and a `bound` that is a number; NaN becomes the bound. One comparison, where [`min`](Self::min)
    /// needs two.
    #[inline]
    fn at_most(self, bound: Self) -> Self {
        self.select_below(bound, self, bound)
    }
    /// The larger of this and a `bound` that is a number; NaN becomes the bound.
    #[inline]
    fn at_least(self, bound: Self) -> Self {
        bound.select_below(self, self, bound)
    }
    /// `below` where `self < bound`, else `otherwise` (also for NaN).
    fn select_below(self, bound: Self, below: Self, otherwise: Self) -> Self;
    /// [`select_below`](Self::select_below) of which a single number computes the chosen value only.
    #[inline]
    fn choose_below(self, bound: Self, below: impl FnOnce() -> Self, otherwise: impl FnOnce() -> Self) -> Self {
        self.select_below(bound, below(), otherwise())
    }
    /// Whether the value is neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

macro_rules! impl_real {
    ($float:ident, $exp:path, $exp_m1:path, $sin_cos:path, $atan2:path, $ln:ident, $sqrt:ident, $floor:ident) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;

            #[inline]
            fn of(value: f64) -> Self {
                value as $float
            }
            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline]
            fn exp_m1(self) -> Self {
                $exp_m1(self)
            }
            #[inline]
            fn ln(self) -> Self {
                libm::$ln(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                libm::$sqrt(self)
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                $sin_cos(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            #[inline]
            fn floor(self) -> Self {
                libm::$floor(self)
            }
            #[inline]
            fn to_index(self) -> usize {
                self as usize
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                // Written out: without an instruction for it, as on a Cortex-M4F, the standard one is a call.
                if self < other || other.is_nan() { self } else { other }
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                if self > other || other.is_nan() { self } else { other }
            }
            #[inline]
            fn abs(self) -> Self {
                $float::abs(self)
            }
            #[inline]
            fn select_below(self, bound: Self, below: Self, otherwise: Self) -> Self {
                if self < bound { below } else { otherwise }
            }
            #[inline]
            fn choose_below(self, bound: Self, below: impl FnOnce() -> Self, otherwise: impl FnOnce() -> Self) -> Self {
                if self < bound { below() } else { otherwise() }
            }
            #[inline]
            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }
        }
    };
}

impl_real!(f32, single::exp, single::exp_m1, single::sin_cos, libm::atan2f, logf, sqrtf, floorf);
impl_real!(f64, libm::exp, libm::expm1, libm::sincos, libm::atan2, log, sqrt, floor);
