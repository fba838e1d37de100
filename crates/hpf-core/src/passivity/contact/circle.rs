//! The unit circle, on which a sampled loop is looked at.

use core::ops::{Add, Div, Mul};

/// A point of the unit circle.
pub(super) struct Angle {
    pub(super) angle: f64,
    pub(super) z: Complex,
    /// z - 1, to all its digits near 1.
    pub(super) less_one: Complex,
}

impl Angle {
    pub(super) fn new(angle: f64) -> Self {
        let (half, im) = (libm::sin(0.5 * angle), libm::sin(angle));
        let less = -2.0 * half * half;
        Self { angle, z: Complex { re: 1.0 + less, im }, less_one: Complex { re: less, im } }
    }
}

/// A complex number.
#[derive(Clone, Copy)]
pub(super) struct Complex {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Complex {
    pub(super) const ONE: Self = Self::real(1.0);

    pub(super) const fn real(re: f64) -> Self {
        Self { re, im: 0.0 }
    }

    pub(super) fn conjugate(self) -> Self {
        Self { im: -self.im, ..self }
    }

    pub(super) fn square(self) -> f64 {
        self.re * self.re + self.im * self.im
    }
}

impl Add for Complex {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Mul for Complex {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

impl Div for Complex {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let per = other.square().recip();
        let Self { re, im } = self * other.conjugate();
        Self { re: re * per, im: im * per }
    }
}
