//! Limits of one axis, applied last: whatever was asked for, a command keeps them.
//!
//! A command is a position p and the velocity v at which it got there, `v = (p - p_last)/h`. Of a velocity asked for:
//! ```text
//! velocity       |v| <= v_max
//! workspace      v <= 2 a d/(a h + sqrt(a^2 h^2 + 2 a d))   d: distance to the wall ahead, a: a_max
//! acceleration   |v - v_last| <= a h
//! ```
//! The second line is `v^2/(2 a) + v h <= d` solved for v: after the step there is still room to brake, whatever the
//! next steps' lengths. So `v_last - a h` never breaks it, the three never contradict each other, and only motion
//! towards a wall is cut.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | p, v | `position`, `velocity` | axis unit, axis unit/s |
//! | v_max, a | `velocity`, `acceleration` | axis unit/s, axis unit/s^2 |
//! | h | `dt` | s |

use crate::{ConfigError, Real, error};

/// The limits of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<T> {
    /// Largest force that enters the model [N].
    pub force: T,
    /// Largest offset from the reference [axis unit].
    pub offset: T,
    /// Largest commanded velocity [axis unit/s].
    pub velocity: T,
    /// Largest change of the commanded velocity [axis unit/s^2].
    pub acceleration: T,
    /// Smallest and largest commanded position [axis unit].
    pub position: [T; 2],
}

/// Which limits have cut a command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hits {
    /// The force into the model.
    pub force: bool,
    /// The offset from the reference.
    pub offset: bool,
    /// The velocity.
    pub velocity: bool,
    /// The acceleration.
    pub acceleration: bool,
    /// The workspace.
    pub position: bool,
}

impl Hits {
    /// Whether a limit of motion was hit: not that of force.
    pub fn any_motion(self) -> bool {
        self.offset || self.velocity || self.acceleration || self.position
    }
}

/// Whether `acceleration` can still stop a velocity `wanted` before a wall, `room` = distance to the wall below and above,
/// over a step of `dt`.
#[inline]
fn stops<T: Real + PartialOrd>(wanted: T, room: [T; 2], acceleration: T, dt: T) -> bool {
    let [below, above] = room;
    let (speed, distance) = (wanted.abs(), if wanted < T::ZERO { below } else { above });
    speed * (T::of(0.5) * speed + acceleration * dt) <= acceleration * distance
}

/// The part of the velocity `wanted` that can still be [stopped](stops), and whether it is less than all. The root is
/// taken only at a wall.
#[inline]
pub(crate) fn brake<T: Real + PartialOrd>(wanted: T, room: [T; 2], acceleration: T, dt: T) -> (T, bool) {
    if stops(wanted, room, acceleration, dt) {
        return (wanted, false);
    }
    let [below, above] = room;
    let (speed, distance) = (wanted.abs(), if wanted < T::ZERO { below } else { above });
    let (reach, change) = ((acceleration * distance).at_least(T::ZERO), acceleration * dt);
    let most = (reach + reach) / (change + (change * change + reach + reach).sqrt());
    (if wanted < T::ZERO { -most.min(speed) } else { most.min(speed) }, most < speed)
}

/// `value` brought into `[middle - most, middle + most]`, and whether it had to be.
#[inline]
pub(crate) fn cut<T: Real + PartialOrd>(value: T, middle: T, most: T) -> (T, bool) {
    let off = value - middle;
    if off.abs() <= most {
        return (value, false);
    }
    (if off < T::ZERO { middle - most } else { middle + most }, true)
}

impl<T: Real + PartialOrd> Limits<T> {
    /// Whether every value makes sense.
    ///
    /// # Errors
    /// [`ConfigError`] unless all lie in their [domain](crate::domain) and the workspace has a width.
    pub fn check(&self) -> Result<(), ConfigError> {
        for (field, value) in [
            ("limits.force", self.force),
            ("limits.offset", self.offset),
            ("limits.velocity", self.velocity),
            ("limits.acceleration", self.acceleration),
        ] {
            error::size(field, value)?;
        }
        let [min, max] = self.position;
        error::number("limits.position", min)?;
        error::number("limits.position", max)?;
        if min < max {
            Ok(())
        } else {
            Err(ConfigError::MinAboveMax { field: "limits.position", min: min.to_f64(), max: max.to_f64() })
        }
    }

    /// Whether an axis at `position` moving at `velocity` is within the limits, able to stop before the wall.
    ///
    /// # Errors
    /// [`ConfigError`] that names the limit it breaks.
    pub fn admit(&self, position: T, velocity: T) -> Result<(), ConfigError> {
        let [min, max] = self.position;
        error::within("position", position, min.to_f64(), max.to_f64())?;
        error::within("velocity", velocity, -self.velocity.to_f64(), self.velocity.to_f64())?;
        let wall = if velocity < T::ZERO { position - min } else { max - position };
        let stop = velocity * velocity / (self.acceleration + self.acceleration);
        error::within("stopping distance", stop, 0.0, wall.to_f64()).map(drop)
    }

    /// The velocity nearest to `wanted` that the limits allow an axis at `position` moving at `velocity` over `dt` [s].
    ///
    /// Keeps every limit if [`admit`](Self::admit) does and `dt` is positive; it then does so after the step too.
    ///
    /// ```
    /// use hpf_core::limits::{Hits, Limits};
    /// let limits = Limits { force: 50.0, offset: 0.1, velocity: 0.5, acceleration: 2.0, position: [0.0, 1.0] };
    /// let (velocity, hits) = limits.velocity(0.3, 0.0, 10.0, 0.01); // from rest, 10 m/s is asked for
    /// assert_eq!(velocity, 2.0 * 0.01);
    /// assert_eq!(hits, Hits { velocity: true, acceleration: true, ..Hits::default() });
    /// ```
    #[inline]
    pub fn velocity(&self, position: T, velocity: T, wanted: T, dt: T) -> (T, Hits) {
        let [min, max] = self.position;
        let room = [position - min, max - position];
        let change = self.acceleration * dt;
        let free = wanted.abs() <= self.velocity
            && stops(wanted, room, self.acceleration, dt)
            && (wanted - velocity).abs() <= change;
        if free {
            return (wanted, Hits::default());
        }
        let (found, too_fast) = cut(wanted, T::ZERO, self.velocity);
        let (found, walled) = brake(found, room, self.acceleration, dt);
        let (found, jerked) = cut(found, velocity, change);
        (found, Hits { velocity: too_fast, position: walled, acceleration: jerked, ..Hits::default() })
    }
}
