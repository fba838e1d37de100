//! Wrenches: force and torque at a point, moved between frames, and what a tool's own weight adds to them.
//!
//! ```text
//! another point        torque' = torque + a x f          a: from the new point to the old one
//! another frame        f' = R f,  torque' = R torque
//! weight of the tool   f = m R^T g,  torque = c x f      in the sensor's frame, R: sensor to base
//! ```
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | f | `force` of the environment ON the tool | N |
//! | torque | of the environment ON the tool, about a named point | N m |
//! | m, c | `mass` that hangs on the sensor, its `center` from the sensor's origin, in the sensor's frame | kg, m |
//! | g | gravity, in the base frame | m/s^2 |
//!
//! A wrench is of the environment on the tool, whatever point and frame it is given in. The tool's acceleration is not
//! compensated.

use crate::rotation::{Quaternion, add_scaled, cross};
use crate::{ConfigError, Real, error};

/// Force and torque at one point, in one frame.
///
/// ```
/// use hpf_core::wrench::Wrench;
/// let sensor = Wrench { force: [0.0, 0.0, 10.0], torque: [0.0; 3] };
/// // 10 N upwards act at the sensor; seen from a point 0.2 m behind it (-x), they turn about -y.
/// assert_eq!(sensor.about([0.2, 0.0, 0.0]).torque, [0.0, -2.0, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench<T> {
    /// Force of the environment on the tool [N].
    pub force: [T; 3],
    /// Torque of the environment on the tool [N m].
    pub torque: [T; 3],
}

impl<T: Real> Wrench<T> {
    /// No force and no torque.
    pub const NONE: Self = Self { force: [T::ZERO; 3], torque: [T::ZERO; 3] };

    /// A wrench of six numbers: force [N], then torque [N m].
    #[inline]
    pub fn of([fx, fy, fz, tx, ty, tz]: [T; 6]) -> Self {
        Self { force: [fx, fy, fz], torque: [tx, ty, tz] }
    }

    /// The six numbers: force [N], then torque [N m], as a [`TareWindow`](crate::conditioning::TareWindow) of six axes
    /// takes them.
    #[inline]
    pub fn numbers(&self) -> [T; 6] {
        let ([fx, fy, fz], [tx, ty, tz]) = (self.force, self.torque);
        [fx, fy, fz, tx, ty, tz]
    }

    /// The same wrench about another point; `arm` [m] leads from that point to the present one.
    #[inline]
    pub fn about(&self, arm: [T; 3]) -> Self {
        Self { force: self.force, torque: add_scaled(self.torque, cross(arm, self.force), T::ONE) }
    }

    /// The same wrench in the fixed frame, where this is in one turned by `orientation`.
    ///
    /// ```
    /// use hpf_core::{rotation::Quaternion, wrench::Wrench};
    /// let tool = Wrench { force: [1.0_f64, 0.0, 0.0], torque: [0.0, 2.0, 0.0] };
    /// let base = tool.turned(&Quaternion::exp([0.0, 0.0, core::f64::consts::FRAC_PI_2]));
    /// assert!((base.force[1] - 1.0).abs() < 1e-15 && (base.torque[0] + 2.0).abs() < 1e-15);
    /// ```
    #[inline]
    pub fn turned(&self, orientation: &Quaternion<T>) -> Self {
        Self { force: orientation.turn(self.force), torque: orientation.turn(self.torque) }
    }

    /// The same wrench in the frame turned by `orientation`, where this is in the fixed one.
    #[inline]
    pub fn turned_back(&self, orientation: &Quaternion<T>) -> Self {
        self.turned(&orientation.conjugate())
    }

    /// What is left of this without the other.
    #[inline]
    pub fn without(&self, other: &Self) -> Self {
        Self {
            force: add_scaled(self.force, other.force, -T::ONE),
            torque: add_scaled(self.torque, other.torque, -T::ONE),
        }
    }

    /// Work rate [W] on a tool that moves at `velocity` [m/s], of the point that the torque is about, and turns at
    /// `angular_velocity` [rad/s].
    #[inline]
    pub fn power(&self, velocity: [T; 3], angular_velocity: [T; 3]) -> T {
        crate::rotation::dot(self.force, velocity) + crate::rotation::dot(self.torque, angular_velocity)
    }
}

/// What hangs on the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolLoad<T> {
    mass: T,
    center: [T; 3],
}

impl<T: Real> ToolLoad<T> {
    /// A `mass` [kg] with its `center` [m], from the sensor's origin and in its frame.
    ///
    /// # Errors
    /// [`ConfigError`] for numbers outside their [domain](crate::domain); a mass may be zero.
    pub fn new(mass: T, center: [T; 3]) -> Result<Self, ConfigError> {
        error::not_negative("tool.mass", mass)?;
        center.iter().try_for_each(|&part| error::number("tool.center", part).map(drop))?;
        Ok(Self { mass, center })
    }

    /// The wrench of the weight at the sensor's origin, in the sensor's frame, whose axes `orientation` turns into those of
    /// the base; `gravity` [m/s^2] is in the base frame.
    ///
    /// ```
    /// use hpf_core::{rotation::Quaternion, wrench::ToolLoad};
    /// let tool = ToolLoad::new(2.0, [0.0, 0.0, 0.1])?; // 2 kg, 0.1 m in front of the sensor
    /// let level = Quaternion::exp([0.0, core::f64::consts::FRAC_PI_2, 0.0]); // its z is the base's x
    /// let weight = tool.weight(&level, [0.0, 0.0, -10.0]);
    /// assert!((weight.force[0] - 20.0_f64).abs() < 1e-14 && weight.force[2].abs() < 1e-14); // down is the sensor's x
    /// assert!((weight.torque[1] - 2.0).abs() < 1e-14);
    /// # Ok::<(), hpf_core::ConfigError>(())
    /// ```
    #[inline]
    pub fn weight(&self, orientation: &Quaternion<T>, gravity: [T; 3]) -> Wrench<T> {
        let force = orientation.turn_back(gravity).map(|part| self.mass * part);
        Wrench { force, torque: cross(self.center, force) }
    }
}

/// From the readings of a force and torque sensor to the wrench of the environment: weight and bias are taken away.
///
/// ```
/// use hpf_core::{rotation::Quaternion, wrench::{ToolLoad, Wrench, WrenchSensor}};
/// let down = [0.0, 0.0, -10.0];
/// let mut sensor = WrenchSensor { load: ToolLoad::new(1.0, [0.0; 3])?, bias: Wrench::NONE };
/// let upright = Quaternion::IDENTITY;
/// let reading = Wrench { force: [0.5, 0.0, -10.0], torque: [0.0, 0.2, 0.0] }; // nothing touches: weight and drift
/// sensor.tare(&sensor.compensated(&reading, &upright, down));
/// // Upside down the weight acts the other way along the sensor's z, and the drift is the same.
/// let over = Quaternion::exp([core::f64::consts::PI, 0.0, 0.0]);
/// let reading = Wrench { force: [0.5, 0.0, 10.0], torque: [0.0, 0.2, 0.0] };
/// let left = sensor.compensated(&reading, &over, down);
/// assert!(left.numbers().iter().all(|number: &f64| number.abs() < 1e-14));
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrenchSensor<T> {
    /// What hangs on the sensor.
    pub load: ToolLoad<T>,
    /// Reading without contact, beside the weight, in the sensor's frame [N, N m].
    pub bias: Wrench<T>,
}

impl<T: Real> WrenchSensor<T> {
    /// A reading at the sensor's origin, in its frame, without weight and bias; `orientation` turns the sensor's axes into
    /// those of the base, `gravity` [m/s^2] is in the base frame.
    #[inline]
    pub fn compensated(&self, reading: &Wrench<T>, orientation: &Quaternion<T>, gravity: [T; 3]) -> Wrench<T> {
        reading.without(&self.load.weight(orientation, gravity)).without(&self.bias)
    }

    /// Calls `still` zero: a compensated wrench that stands still while nothing touches the tool.
    #[inline]
    pub fn tare(&mut self, still: &Wrench<T>) {
        self.bias = self.bias.without(&Wrench::NONE.without(still));
    }
}
