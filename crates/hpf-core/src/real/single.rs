//! Exponentials, sine and cosine in single precision, short enough to stand in a loop of a microcontroller.
//!
//! `x = n ln 2 + r`, n whole, `|r| <= ln(2)/2`; `e^r - 1 = r + r^2 (1/2 + r/6 + ... + r^5/5040)`, the first term left
//! out below 2e-8 of the sum; `e^x = 2^n (1 + (e^r - 1))`, `e^x - 1 = 2^n (e^r - 1) + (2^n - 1)`. Within 2 units in the
//! last place of the exact value, the same bits on every machine. Above 87, near overflow, libm answers; below -87, near
//! subnormal numbers, `e^x` is zero.
//!
//! `x = n pi/2 + r`, n whole, `|r| <= pi/4`; sine and cosine of r are the polynomials of Moshier's Cephes library, within
//! 2 units in the last place of 1. Where n has too many digits for the parts of pi/2, libm answers: in double precision,
//! which a single-precision unit computes slowly.

use core::f32::consts::{FRAC_2_PI, LOG2_E};

/// The largest magnitude for which 2^n and the result are normal numbers.
const LARGEST: f32 = 87.0;

/// Added and taken away again, it rounds to a whole number, which then stands in the lowest bits.
const ROUND: f32 = 12_582_912.0;

/// ln 2 in two parts: times any n the first is exact.
const LN_2: [f32; 2] = [355.0 / 512.0, -2.121_944_4e-4];

/// Below this magnitude n is zero.
const SMALL: f32 = 0.34;

/// `e^r - 1` of a small `r`.
#[inline]
fn series(r: f32) -> f32 {
    let sum = ((((r * (1.0 / 5040.0) + 1.0 / 720.0) * r + 1.0 / 120.0) * r + 1.0 / 24.0) * r + 1.0 / 6.0) * r + 0.5;
    r + r * r * sum
}

/// `2^n` and `e^r - 1` of an `x` of at most [`LARGEST`].
#[inline]
fn parts(x: f32) -> (f32, f32) {
    let shifted = x * LOG2_E + ROUND;
    let n = shifted - ROUND;
    let [high, low] = LN_2;
    let r = x - n * high - n * low;
    let power = f32::from_bits((shifted.to_bits() << 23).wrapping_add(1.0_f32.to_bits()));
    (power, series(r))
}

/// `e^x`.
#[inline]
pub(super) fn exp(x: f32) -> f32 {
    if x.abs() < SMALL {
        1.0 + series(x)
    } else if x.abs() <= LARGEST {
        let (power, rest) = parts(x);
        power * (1.0 + rest)
    } else if x < 0.0 {
        0.0
    } else {
        libm::expf(x)
    }
}

/// `e^x - 1`.
#[inline]
pub(super) fn exp_m1(x: f32) -> f32 {
    if x.abs() < SMALL {
        series(x)
    } else if x.abs() <= LARGEST {
        let (power, rest) = parts(x);
        power * rest + (power - 1.0)
    } else if x < 0.0 {
        -1.0
    } else {
        libm::expm1f(x)
    }
}

/// The largest magnitude of an angle that is reduced in single precision: n has 11 bits, so that its product with the
/// first two parts of pi/2 is exact.
const LARGEST_ANGLE: f32 = 3000.0;

/// pi/2 in three parts.
const HALF_PI: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];

/// Coefficients of `(sin r - r)/r^3` and `(cos r - 1 + r^2/2)/r^4` in powers of r^2, highest first.
const SINE: [f32; 3] = [-1.951_529_6e-4, 8.332_161e-3, -1.666_665_5e-1];
const COSINE: [f32; 3] = [2.443_315_7e-5, -1.388_731_6e-3, 4.166_664_6e-2];

/// Sine and cosine of `x` [rad].
#[inline]
pub(super) fn sin_cos(x: f32) -> (f32, f32) {
    // A NaN goes to libm too.
    if x.abs() <= LARGEST_ANGLE {
        let shifted = x * FRAC_2_PI + ROUND;
        let n = shifted - ROUND;
        let [high, middle, low] = HALF_PI;
        let r = ((x - n * high) - n * middle) - n * low;
        let r2 = r * r;
        let ([s0, s1, s2], [c0, c1, c2]) = (SINE, COSINE);
        let sine = r + r * r2 * ((s0 * r2 + s1) * r2 + s2);
        let cosine = 1.0 - 0.5 * r2 + r2 * r2 * ((c0 * r2 + c1) * r2 + c2);
        match shifted.to_bits() & 3 {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    } else {
        libm::sincosf(x)
    }
}
