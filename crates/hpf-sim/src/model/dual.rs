//! Numbers with their slopes: what makes a kernel of `hpf-core` tell how its result answers to what goes in.
//!
//! `(a, a') (b, b') = (a b, a' b + a b')` and so on (forward-mode differentiation). Choices are made by the value.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use hpf_core::Real;

/// A number and its slopes by `N` others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Dual<const N: usize> {
    pub(super) value: f64,
    pub(super) slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The `i`th of the numbers that slopes are by.
    pub(super) fn input(value: f64, i: usize) -> Self {
        let mut slopes = [0.0; N];
        slopes[i] = 1.0;
        Self { value, slopes }
    }

    /// A function of this number with `value` and `slope` here.
    #[inline(always)]
    fn chained(self, value: f64, slope: f64) -> Self {
        Self { value, slopes: self.slopes.map(|own| slope * own) }
    }

    #[inline(always)]
    fn both(self, other: Self, value: f64, slopes: impl Fn(f64, f64) -> f64) -> Self {
        let mut all = [0.0; N];
        for ((slot, a), b) in all.iter_mut().zip(self.slopes).zip(other.slopes) {
            *slot = slopes(a, b);
        }
        Self { value, slopes: all }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.both(other, self.value + other.value, |a, b| a + b)
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.both(other, self.value - other.value, |a, b| a - b)
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "the slope of a product is a sum")]
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.both(other, self.value * other.value, |a, b| a * other.value + self.value * b)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let inverse = 1.0 / other.value;
        self.both(other, value, |a, b| (a - value * b) * inverse)
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chained(-self.value, -1.0)
    }
}

impl<const N: usize> AddAssign for Dual<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> Real for Dual<N> {
    const ZERO: Self = Self { value: 0.0, slopes: [0.0; N] };
    const ONE: Self = Self { value: 1.0, slopes: [0.0; N] };

    fn of(value: f64) -> Self {
        Self { value, slopes: [0.0; N] }
    }
    fn to_f64(self) -> f64 {
        self.value
    }
    fn exp(self) -> Self {
        let value = self.value.exp_of();
        self.chained(value, value)
    }
    fn exp_m1(self) -> Self {
        let value = Real::exp_m1(self.value);
        self.chained(value, value + 1.0)
    }
    fn ln(self) -> Self {
        self.chained(Real::ln(self.value), 1.0 / self.value)
    }
    fn sqrt(self) -> Self {
        let value = Real::sqrt(self.value);
        self.chained(value, 0.5 / value)
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = Real::sin_cos(self.value);
        (self.chained(sine, cosine), self.chained(cosine, -sine))
    }
    fn atan2(self, x: Self) -> Self {
        let angle = Real::atan2(self.value, x.value);
        let square = self.value * self.value + x.value * x.value;
        // d atan2(y, x) = (x dy - y dx)/(x^2 + y^2)
        let (of_y, of_x) = (x.value / square, -self.value / square);
        let mut out = Self::of(angle);
        for ((slot, y), x) in out.slopes.iter_mut().zip(self.slopes).zip(x.slopes) {
            *slot = of_y * y + of_x * x;
        }
        out
    }
    fn floor(self) -> Self {
        Self::of(Real::floor(self.value))
    }
    fn to_index(self) -> usize {
        self.value.to_index()
    }
    fn min(self, other: Self) -> Self {
        if self.value < other.value || other.value.is_nan() { self } else { other }
    }
    fn max(self, other: Self) -> Self {
        if self.value > other.value || other.value.is_nan() { self } else { other }
    }
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }
    fn select_below(self, bound: Self, below: Self, otherwise: Self) -> Self {
        if self.value < bound.value { below } else { otherwise }
    }
    fn choose_below(self, bound: Self, below: impl FnOnce() -> Self, otherwise: impl FnOnce() -> Self) -> Self {
        if self.value < bound.value { below() } else { otherwise() }
    }
    fn is_finite(self) -> bool {
        self.value.is_finite() && self.slopes.iter().all(|slope| slope.is_finite())
    }
}

/// The exponential of `Real` by another name, for `f64` has one of its own.
trait ExpOf {
    fn exp_of(self) -> f64;
}

impl ExpOf for f64 {
    fn exp_of(self) -> f64 {
        Real::exp(self)
    }
}

#[cfg(test)]
mod tests {
    use hpf_core::admittance::relax;

    use super::*;

    #[test]
    fn a_kernel_of_dual_numbers_has_the_value_and_the_slopes_of_small_differences() {
        for lambda in [1e-7, 0.3, 40.0] {
            let point = [0.3, 1.2, -0.4, lambda];
            let inputs: [Dual<4>; 4] = core::array::from_fn(|i| Dual::input(point[i], i));
            let found = relax(inputs[0], inputs[1], inputs[2], inputs[3]);
            let plain = |p: [f64; 4]| relax(p[0], p[1], p[2], p[3]);
            assert_eq!(found.value, plain(point));
            for i in 0..4 {
                let small = 1e-5 * point[i].abs();
                let moved = |way: f64| plain(core::array::from_fn(|j| point[j] + if i == j { way } else { 0.0 }));
                let slope = (moved(small) - moved(-small)) / (2.0 * small);
                // Rounding of the difference, 1e-16 / 1e-12 at the smallest lambda.
                let rounding = 1e-15 / small + 1e-7;
                assert!((found.slopes[i] - slope).abs() < rounding, "{lambda} {i}: {} {slope}", found.slopes[i]);
            }
        }
    }
}
