//! Rotations: unit quaternions, rotation vectors, and the Jacobian between their rates.
//!
//! ```text
//! Exp   q = (cos(th/2), r sin(th/2)/th)                                  th = |r|
//! Log   r = v 2 atan2(|v|, w)/|v|,  q = (w, v), of the two signs of q the one with w >= 0
//! J_l   w = J_l r',  J_l = I + (1 - cos th)/th^2 [r]x + (th - sin th)/th^3 [r]x^2
//! J_l^-1 = I - [r]x/2 + (1 - (th/2)/tan(th/2))/th^2 [r]x^2
//! ```
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | q | [`Quaternion`]: turns vectors of a turned frame into the fixed one | 1 |
//! | r | rotation vector: axis times angle | rad |
//! | th | angle | rad |
//! | w | angular velocity, in the fixed frame | rad/s |
//! | `[r]x` | the matrix of the cross product with r | rad |
//!
//! A product `a * b` turns by b first. Near th = 0 the coefficients are series: no form here loses digits, in either
//! precision. The angle comes from atan2, never from acos, which in single precision knows no angle below 3e-4 rad.
//! J_l has an inverse for `|r| < 2 pi`; at a whole turn it has none.
//!
//! Source: Sola, Deray, Atchuthan, A micro Lie theory for state estimation in robotics, arXiv:1812.01537, 2018.

mod quaternion;

pub use quaternion::{NORM_TOLERANCE, Quaternion, Wxyz};

use crate::Real;

/// A matrix by rows.
pub type Matrix<T> = [[T; 3]; 3];

/// The cross product of two vectors.
///
/// ```
/// assert_eq!(hpf_core::rotation::cross([1.0, 0.0, 0.0], [0.0, 2.0, 0.0]), [0.0, 0.0, 2.0]);
/// ```
#[inline]
pub fn cross<T: Real>([ax, ay, az]: [T; 3], [bx, by, bz]: [T; 3]) -> [T; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

/// The scalar product of two vectors.
///
/// ```
/// assert_eq!(hpf_core::rotation::dot([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]), 32.0);
/// ```
#[inline]
pub fn dot<T: Real>([ax, ay, az]: [T; 3], [bx, by, bz]: [T; 3]) -> T {
    ax * bx + ay * by + az * bz
}

/// The length of a vector.
///
/// ```
/// assert_eq!(hpf_core::rotation::length([2.0, 3.0, 6.0]), 7.0);
/// ```
#[inline]
pub fn length<T: Real>(vector: [T; 3]) -> T {
    dot(vector, vector).sqrt()
}

/// `a + b factor`.
#[inline]
pub(crate) fn add_scaled<T: Real>([ax, ay, az]: [T; 3], [bx, by, bz]: [T; 3], factor: T) -> [T; 3] {
    [ax + bx * factor, ay + by * factor, az + bz * factor]
}

/// A matrix times a vector.
///
/// ```
/// use hpf_core::rotation::times;
/// assert_eq!(times(&[[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 3.0]], [1.0, 1.0, 1.0]), [3.0, 1.0, 3.0]);
/// ```
#[inline]
pub fn times<T: Real>([x, y, z]: &Matrix<T>, vector: [T; 3]) -> [T; 3] {
    [dot(*x, vector), dot(*y, vector), dot(*z, vector)]
}

/// The transpose of a matrix times a vector.
///
/// ```
/// use hpf_core::rotation::transposed_times;
/// assert_eq!(transposed_times(&[[1.0, 2.0, 0.0], [0.0; 3], [0.0; 3]], [1.0, 5.0, 7.0]), [1.0, 2.0, 0.0]);
/// ```
#[inline]
pub fn transposed_times<T: Real>([x, y, z]: &Matrix<T>, [vx, vy, vz]: [T; 3]) -> [T; 3] {
    let none = [T::ZERO; 3];
    add_scaled(add_scaled(add_scaled(none, *x, vx), *y, vy), *z, vz)
}

/// Below this th^2 the short series serve: their first missing terms are below 1e-16 of the sum.
const SERIES_BELOW: f64 = 0.01;

/// Below this th^2 `th - sin th` loses digits, and its series serves.
const SINE_SERIES_BELOW: f64 = 1.0;

/// `sin(th/2)/th` in powers of th^2.
const HALF_SINE: [f64; 5] = [0.5, -1.0 / 48.0, 1.0 / 3_840.0, -1.0 / 645_120.0, 1.0 / 185_794_560.0];

/// `(th - sin th)/th^3` in powers of th^2.
const SINE_GAP: [f64; 9] = [
    1.0 / 6.0,
    -1.0 / 120.0,
    1.0 / 5_040.0,
    -1.0 / 362_880.0,
    1.0 / 39_916_800.0,
    -1.0 / 6_227_020_800.0,
    1.0 / 1_307_674_368_000.0,
    -1.0 / 355_687_428_096_000.0,
    1.0 / 121_645_100_408_832_000.0,
];

/// `(1 - (th/2)/tan(th/2))/th^2` in powers of th^2.
const COTANGENT_GAP: [f64; 6] =
    [1.0 / 12.0, 1.0 / 720.0, 1.0 / 30_240.0, 1.0 / 1_209_600.0, 1.0 / 47_900_160.0, 691.0 / 1_307_674_368_000.0];

/// The sum of a series in powers of `x`.
#[inline]
fn series<T: Real>(coefficients: &[f64], x: T) -> T {
    coefficients.iter().rev().fold(T::ZERO, |sum, &coefficient| sum * x + T::of(coefficient))
}

/// `cos(th/2)` and `sin(th/2)/th` of the square of th.
#[inline]
fn half_angle<T: Real>(square: T) -> (T, T) {
    let angle = square.sqrt();
    let (sine, cosine) = (angle * T::of(0.5)).sin_cos();
    (cosine, square.choose_below(T::of(SERIES_BELOW), || series(&HALF_SINE, square), || sine / angle))
}

/// `a I + b [r]x + c [r]x^2`.
#[inline]
fn of_powers<T: Real>(r: [T; 3], b: T, c: T) -> Matrix<T> {
    let [x, y, z] = r;
    // [r]x^2 = r r^T - th^2 I
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let (xy, xz, yz) = (c * (x * y), c * (x * z), c * (y * z));
    let (bx, by, bz) = (b * x, b * y, b * z);
    [
        [T::ONE - c * (yy + zz), xy - bz, xz + by],
        [xy + bz, T::ONE - c * (xx + zz), yz - bx],
        [xz - by, yz + bx, T::ONE - c * (xx + yy)],
    ]
}

/// The left Jacobian J_l of a rotation vector [rad]: angular velocity = J_l times the rate of the vector.
///
/// ```
/// use hpf_core::rotation::{left_jacobian, times};
/// // A quarter turn about z that grows along its own axis turns at just that rate,
/// let jacobian = left_jacobian([0.0, 0.0, core::f64::consts::FRAC_PI_2]);
/// assert_eq!(times(&jacobian, [0.0, 0.0, 3.0]), [0.0, 0.0, 3.0]);
/// // one that grows across it does not: (sin th/th, (1 - cos th)/th, 0).
/// let [x, y, z] = times(&jacobian, [1.0, 0.0, 0.0]);
/// assert!((x - core::f64::consts::FRAC_2_PI).abs() < 1e-15 && (y - x).abs() < 1e-15 && z == 0.0);
/// ```
#[inline]
pub fn left_jacobian<T: Real>(r: [T; 3]) -> Matrix<T> {
    let square = dot(r, r);
    let (cosine, half_sine) = half_angle(square);
    // sin th = 2 sin(th/2) cos(th/2), 1 - cos th = 2 sin(th/2)^2
    let closed = || (T::ONE - (half_sine + half_sine) * cosine) / square;
    let gap = square.choose_below(T::of(SINE_SERIES_BELOW), || series(&SINE_GAP, square), closed);
    of_powers(r, (half_sine + half_sine) * half_sine, gap)
}

/// The inverse of the [left Jacobian](left_jacobian) of a rotation vector shorter than 2 pi [rad]: rate of the vector =
/// J_l^-1 times angular velocity.
///
/// ```
/// use hpf_core::rotation::{left_jacobian, left_jacobian_inverse, times};
/// let r = [0.3, -1.2, 2.0];
/// let [x, y, z] = times(&left_jacobian_inverse(r), times(&left_jacobian(r), [1.0, 2.0, 3.0]));
/// assert!((x - 1.0_f64).abs() + (y - 2.0).abs() + (z - 3.0).abs() < 1e-14);
/// ```
#[inline]
pub fn left_jacobian_inverse<T: Real>(r: [T; 3]) -> Matrix<T> {
    let square = dot(r, r);
    let (cosine, half_sine) = half_angle(square);
    // (th/2)/tan(th/2) = cos(th/2)/(2 sin(th/2)/th)
    let closed = || (T::ONE - cosine / (half_sine + half_sine)) / square;
    let gap = square.choose_below(T::of(SERIES_BELOW), || series(&COTANGENT_GAP, square), closed);
    of_powers(r, T::of(-0.5), gap)
}
