//! Several numbers at a time: what a batch of rollouts is stepped in.
//!
//! [`Lanes`] is a [`Real`], so every kernel runs over it unchanged; compiled for a processor with vector registers, an
//! operation on all lanes is one instruction. Each lane gets the bits that it would get alone, for any number of lanes
//! and any instruction set: only additions, products, divisions and choices, each rounded by itself, never fused.
//!
//! The kernels of this crate that batches step in vector registers are always inlined: one that is called would be
//! compiled for what every processor has, whatever instructions the batch around it is compiled for.
//!
//! Exponentials have no branch and no table. With `x = k ln 2 + r`, `|r| <= ln(2)/2`:
//! ```text
//! e^r - 1 = r + r^2 (1/2! + r/3! + .. + r^11/13!)        rest below 1.3e-17 of it
//! e^x     = 2^k (1 + (e^r - 1))
//! e^x - 1 = 2^k (e^r - 1) + (2^k - 1)
//! ```
//! Both are within 2 units in the last place of the true value, subnormal results within one step of it (a test
//! measures 1.0 and 1.6 units). They are not the bits of `libm`, which `f64` takes its exponentials from.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use crate::Real;

/// `N` numbers on which every operation acts alike; aligned so that no load straddles two lines of the cache.
///
/// As a [`Real`], it is one value per rollout: [`to_f64`](Real::to_f64) and [`to_index`](Real::to_index) are of the
/// first lane, [`is_finite`](Real::is_finite) is of all. Logarithm, root, floor
/// and the functions of angles are those of `f64`, one by one.
///
/// ```
/// use hpf_core::{Lanes, Real, admittance::step_offset};
/// let forces = Lanes([0.0, 10.0, -20.0, 5.0]);
/// let all = |value| Lanes::of(value);
/// let Lanes(offsets) = step_offset(all(0.0), all(100.0), all(50.0), forces, all(1e3)); // a long push each
/// assert_eq!(offsets, [0.0, 0.1, -0.2, 0.05]); // each settles at its f/k
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes<const N: usize>(pub [f64; N]);

impl<const N: usize> Lanes<N> {
    /// The result of `f` on each lane.
    #[inline(always)]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        self.zip(self, |value, _| f(value))
    }

    /// The result of `f` on each lane of both.
    #[inline(always)]
    pub fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = [0.0; N];
        for ((slot, a), b) in out.iter_mut().zip(self.0).zip(other.0) {
            *slot = f(a, b);
        }
        Self(out)
    }
}

macro_rules! impl_operator {
    ($($operator:ident, $method:ident, $symbol:tt;)*) => {$(
        impl<const N: usize> $operator for Lanes<N> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $symbol b)
            }
        }
    )*};
}

impl_operator! {
    Add, add, +;
    Sub, sub, -;
    Mul, mul, *;
    Div, div, /;
}

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl<const N: usize> AddAssign for Lanes<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> Real for Lanes<N> {
    const ZERO: Self = Self([0.0; N]);
    const ONE: Self = Self([1.0; N]);

    #[inline(always)]
    fn of(value: f64) -> Self {
        Self([value; N])
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.0.first().copied().unwrap_or(0.0)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        self.map(exp)
    }
    #[inline(always)]
    fn exp_m1(self) -> Self {
        self.map(exp_m1)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.map(Real::ln)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(Real::sqrt)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        (self.map(|angle| Real::sin_cos(angle).0), self.map(|angle| Real::sin_cos(angle).1))
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        self.zip(x, Real::atan2)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.map(Real::floor)
    }
    #[inline(always)]
    fn to_index(self) -> usize {
        self.to_f64() as usize
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, Real::min)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, Real::max)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f64::abs)
    }
    #[inline(always)]
    fn select_below(self, bound: Self, below: Self, otherwise: Self) -> Self {
        let mut out = otherwise.0;
        for (((slot, value), bound), below) in out.iter_mut().zip(self.0).zip(bound.0).zip(below.0) {
            *slot = if value < bound { below } else { *slot };
        }
        Self(out)
    }
    #[inline(always)]
    fn choose_below(self, bound: Self, below: impl FnOnce() -> Self, otherwise: impl FnOnce() -> Self) -> Self {
        self.select_below(bound, below(), otherwise())
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.0.iter().fold(true, |all, value| all & value.is_finite())
    }
}

/// Added to a number below 2^51 in magnitude, it rounds it to an integer, which then stands in the lowest bits.
const ROUNDER: f64 = 6_755_399_441_055_744.0;
/// ln 2 in two parts; 21 zero bits at the end of the first make its product with any k below exact.
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];
/// 1/2!, .., 1/13!
const FACTORIALS: [f64; 12] = [
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];
/// Beyond it every exponential is infinite.
const LARGEST: f64 = 710.0;
/// Below it `e^x` is zero.
const SMALLEST: f64 = -746.0;
/// Below it `e^x - 1` is -1.
const SMALLEST_M1: f64 = -700.0;

/// `value`, not below `least` nor above [`LARGEST`]; NaN stays.
#[inline(always)]
fn limit(value: f64, least: f64) -> f64 {
    let value = if value < least { least } else { value };
    if value > LARGEST { LARGEST } else { value }
}

/// k, and `e^r - 1`.
#[inline(always)]
fn reduce(x: f64) -> (f64, f64) {
    let k = (x * core::f64::consts::LOG2_E + ROUNDER) - ROUNDER;
    let high = x - k * LN_2[0];
    let low = k * LN_2[1];
    let r = high - low;
    let rest = (high - r) - low;
    // Estrin's scheme: sums that need not wait for each other.
    let [c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, c10, c11] = FACTORIALS;
    let (r2, r4) = (r * r, (r * r) * (r * r));
    let first = (c0 + c1 * r) + (c2 + c3 * r) * r2;
    let second = (c4 + c5 * r) + (c6 + c7 * r) * r2;
    let third = (c8 + c9 * r) + (c10 + c11 * r) * r2;
    (k, r + (r2 * (first + (second + third * r4) * r4) + rest))
}

/// `2^k` for an integer k from -1022 to 1023.
#[inline(always)]
fn power_of_two(k: f64) -> f64 {
    f64::from_bits(((k + ROUNDER).to_bits() << 52).wrapping_add(1023 << 52))
}

#[inline(always)]
fn exp(x: f64) -> f64 {
    let (k, power) = reduce(limit(x, SMALLEST));
    // In two halves: 2^k itself may be too large or too small a number.
    let half = (0.5 * k + ROUNDER) - ROUNDER;
    (1.0 + power) * power_of_two(half) * power_of_two(k - half)
}

#[inline(always)]
fn exp_m1(x: f64) -> f64 {
    let (k, power) = reduce(limit(x, SMALLEST_M1));
    // Of half the result: 2^1024 is too large a number.
    let scale = power_of_two(k - 1.0);
    2.0 * (scale * power + (scale - 0.5))
}
