//! Unit quaternions.

use core::ops::Mul;

use super::{Matrix, add_scaled, cross, dot, half_angle, series};
use crate::{ConfigError, Real, error};

/// How far the norm of four numbers may be from 1: beyond, they are no rotation.
pub const NORM_TOLERANCE: f64 = 1e-3;

/// A rotation within this of a half turn has two rotation vectors of the same length, as far as one can tell [rad].
const HALF_TURN: f64 = 1e-6;

/// Below this tan(th/2)^2 the series of the arc tangent serves; where the square of the vector part underflows too.
const SERIES_BELOW: f64 = 1e-3;

/// `atan(t)/t` in powers of t^2.
const ARC_TANGENT: [f64; 6] = [1.0, -1.0 / 3.0, 1.0 / 5.0, -1.0 / 7.0, 1.0 / 9.0, -1.0 / 11.0];

/// The numbers of a quaternion by name: other programs order them otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wxyz<T> {
    /// Scalar part, cos(th/2).
    pub w: T,
    /// Vector part along x.
    pub x: T,
    /// Vector part along y.
    pub y: T,
    /// Vector part along z.
    pub z: T,
}

/// A rotation as a unit quaternion: turns vectors of a turned frame into the fixed one.
///
/// A quaternion and its negative are the same rotation, and not equal.
///
/// ```
/// use hpf_core::rotation::Quaternion;
/// let quarter = Quaternion::exp([0.0, 0.0, core::f64::consts::FRAC_PI_2]); // about z
/// let [x, y, z] = quarter.turn([1.0, 0.0, 0.0]);
/// assert!(x.abs() < 1e-15 && (y - 1.0).abs() < 1e-15 && z == 0.0);
/// let half = quarter * quarter;
/// assert!((half.angle() - core::f64::consts::PI).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion<T> {
    w: T,
    v: [T; 3],
}

impl<T: Real> Quaternion<T> {
    /// No rotation.
    pub const IDENTITY: Self = Self { w: T::ONE, v: [T::ZERO; 3] };

    /// A rotation from its numbers, which are normalized.
    ///
    /// ```
    /// use hpf_core::rotation::{Quaternion, Wxyz};
    /// let found = Quaternion::new(Wxyz { w: 0.6003, x: 0.0, y: 0.8004, z: 0.0 })?; // of norm 1.0005
    /// assert!((found.numbers().w - 0.6_f64).abs() < 1e-15);
    /// assert!(Quaternion::new(Wxyz { w: 1.0, x: 0.1, y: 0.0, z: 0.0 }).is_err());
    /// # Ok::<(), hpf_core::ConfigError>(())
    /// ```
    ///
    /// # Errors
    /// [`ConfigError`] for numbers that are not finite, and a norm that is off by more than [`NORM_TOLERANCE`].
    pub fn new(numbers: Wxyz<T>) -> Result<Self, ConfigError> {
        let Wxyz { w, x, y, z } = numbers;
        error::finite_list("quaternion", &[w, x, y, z], 4)?;
        let norm = (w * w + dot([x, y, z], [x, y, z])).sqrt();
        error::within("norm of the quaternion", norm, 1.0 - NORM_TOLERANCE, 1.0 + NORM_TOLERANCE)?;
        Ok(Self { w: w / norm, v: [x / norm, y / norm, z / norm] })
    }

    /// The rotation by `angle` [rad] about an `axis` of any length.
    ///
    /// # Errors
    /// [`ConfigError`] for numbers that are not finite, and an axis that has no direction: shorter than 1e-9 or longer
    /// than 1e9.
    pub fn about(axis: [T; 3], angle: T) -> Result<Self, ConfigError> {
        error::finite_list("axis", &axis, 3)?;
        error::number("angle", angle)?;
        let length = error::size("length of the axis", super::length(axis))?;
        Ok(Self::exp(axis.map(|part| part / length * angle)))
    }

    /// The rotation by `roll`, then `pitch`, then `yaw` [rad] about the fixed axes x, y and z.
    ///
    /// ```
    /// use hpf_core::rotation::Quaternion;
    /// let quarter = core::f64::consts::FRAC_PI_2;
    /// let [x, y, z] = Quaternion::rpy([quarter, 0.0, quarter])?.turn([0.0, 1.0, 0.0]); // y to z, and z stays
    /// assert!(x.abs() < 1e-15 && y.abs() < 1e-15 && (z - 1.0).abs() < 1e-15);
    /// # Ok::<(), hpf_core::ConfigError>(())
    /// ```
    ///
    /// # Errors
    /// [`ConfigError`] for angles outside their [domain](crate::domain).
    pub fn rpy([roll, pitch, yaw]: [T; 3]) -> Result<Self, ConfigError> {
        for (field, angle) in [("roll", roll), ("pitch", pitch), ("yaw", yaw)] {
            error::number(field, angle)?;
        }
        let none = T::ZERO;
        Ok(Self::exp([none, none, yaw]) * Self::exp([none, pitch, none]) * Self::exp([roll, none, none]))
    }

    /// The rotation of a rotation vector [rad].
    #[inline]
    pub fn exp(r: [T; 3]) -> Self {
        let (w, half_sine) = half_angle(dot(r, r));
        Self { w, v: r.map(|part| part * half_sine) }
    }

    /// The rotation vector [rad], the short way round: of length pi at most. Which of two opposite ones a half turn has is
    /// decided by the sign of its vector part.
    ///
    /// ```
    /// use hpf_core::rotation::Quaternion;
    /// let [x, y, z] = Quaternion::exp([0.0, 4.0_f64, 0.0]).log(); // 4 rad one way is 2.28 the other
    /// assert!((y - (4.0 - 2.0 * core::f64::consts::PI)).abs() < 1e-15 && x == 0.0 && z == 0.0);
    /// ```
    #[inline]
    pub fn log(&self) -> [T; 3] {
        let Self { w, v } = *self;
        let sign = w.select_below(T::ZERO, -T::ONE, T::ONE);
        let w = sign * w;
        let square = dot(v, v);
        let size = square.sqrt();
        let tangent_square = square / (w * w);
        let near = || series(&ARC_TANGENT, tangent_square) / w;
        let per_size = square.choose_below(T::of(SERIES_BELOW), near, || size.atan2(w) / size);
        v.map(|part| part * (sign * (per_size + per_size)))
    }

    /// The rotation vector [rad] the long way round: of length pi at least, shorter than 2 pi. Of no rotation it is zero,
    /// for a whole turn may be about any axis.
    ///
    /// ```
    /// use hpf_core::rotation::Quaternion;
    /// let [_, y, _] = Quaternion::exp([0.0, 1.0_f64, 0.0]).log_long();
    /// assert!((y - (1.0 - 2.0 * core::f64::consts::PI)).abs() < 1e-15);
    /// ```
    #[inline]
    pub fn log_long(&self) -> [T; 3] {
        let short = self.log();
        let angle = super::length(short);
        let factor = T::ZERO.choose_below(angle, || T::ONE - T::of(core::f64::consts::TAU) / angle, || T::ZERO);
        short.map(|part| part * factor)
    }

    /// The angle by which this turns, in [0, pi] [rad].
    #[inline]
    pub fn angle(&self) -> T {
        let half = super::length(self.v).atan2(self.w.abs());
        half + half
    }

    /// The angle between two orientations, in [0, pi] [rad]: the geodesic distance.
    ///
    /// ```
    /// use hpf_core::rotation::Quaternion;
    /// let [a, b] = [0.4_f32, 0.4001].map(|angle| Quaternion::exp([angle, 0.0, 0.0]));
    /// assert!((a.distance(&b) - 1e-4).abs() < 1e-7); // an acos of single precision says 0 or 3.5e-4
    /// ```
    #[inline]
    pub fn distance(&self, other: &Self) -> T {
        (self.conjugate() * *other).angle()
    }

    /// Whether the angle is within 1e-6 rad of a half turn, so that rounding decides which way is the short one.
    #[inline]
    pub fn is_half_turn(&self) -> bool {
        (T::of(core::f64::consts::PI) - self.angle()).to_f64() < HALF_TURN
    }

    /// The rotation back.
    #[inline]
    pub fn conjugate(&self) -> Self {
        Self { w: self.w, v: self.v.map(|part| -part) }
    }

    /// Of the two quaternions of this rotation the one nearer to `other`: what is written one after the other does not
    /// jump.
    #[inline]
    pub fn near(&self, other: &Self) -> Self {
        let product = self.w * other.w + dot(self.v, other.v);
        let sign = product.select_below(T::ZERO, -T::ONE, T::ONE);
        Self { w: sign * self.w, v: self.v.map(|part| sign * part) }
    }

    /// A vector of the turned frame in the fixed one.
    #[inline]
    pub fn turn(&self, vector: [T; 3]) -> [T; 3] {
        let across = cross(self.v, vector);
        let twice = across.map(|part| part + part);
        add_scaled(cross(self.v, twice), add_scaled(vector, twice, self.w), T::ONE)
    }

    /// A vector of the fixed frame in the turned one.
    #[inline]
    pub fn turn_back(&self, vector: [T; 3]) -> [T; 3] {
        self.conjugate().turn(vector)
    }

    /// The rotation matrix, by rows: its columns are the axes of the turned frame.
    #[inline]
    pub fn matrix(&self) -> Matrix<T> {
        let (w, [x, y, z]) = (self.w, self.v);
        let [xx, yy, zz] = [x * x, y * y, z * z].map(|square| square + square);
        let [xy, xz, yz] = [x * y, x * z, y * z].map(|product| product + product);
        let [wx, wy, wz] = [w * x, w * y, w * z].map(|product| product + product);
        [
            [T::ONE - (yy + zz), xy - wz, xz + wy],
            [xy + wz, T::ONE - (xx + zz), yz - wx],
            [xz - wy, yz + wx, T::ONE - (xx + yy)],
        ]
    }

    /// The four numbers.
    #[inline]
    pub fn numbers(&self) -> Wxyz<T> {
        let [x, y, z] = self.v;
        Wxyz { w: self.w, x, y, z }
    }
}

impl<T: Real> Mul for Quaternion<T> {
    type Output = Self;

    /// The rotation by `other`, then by this. Its norm is brought back to 1, so that rounding does not add up.
    #[inline]
    fn mul(self, other: Self) -> Self {
        let w = self.w * other.w - dot(self.v, other.v);
        let v = add_scaled(add_scaled(cross(self.v, other.v), other.v, self.w), self.v, other.w);
        // One step of Newton's method towards 1/|q|, which is exact to the square of what is off.
        let scale = T::of(1.5) - T::of(0.5) * (w * w + dot(v, v));
        Self { w: w * scale, v: v.map(|part| part * scale) }
    }
}
