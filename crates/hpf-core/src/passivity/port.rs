//! The physical port: books on what was measured, where robot and sensor are not what the model takes them for.
//!
//! A tank on commands is blind to a robot that lags, a sensor that is late and a bias. At the port every measured
//! displacement is booked at the least work that its force can have done, once the readings have come that can belong to
//! it, and the command is kept so near the measured position that what may still come can be paid for:
//! ```text
//! booked      E+ = min(E_max, E + W),  W = u min f - b u  (u >= 0)  or  u max f + b u  (u < 0)
//!             over the readings f from one before the displacement u to n after it
//! at risk     (f_trip + b) (sum |u| not yet booked + |x_c - x_m|) <= E/D
//! spending    s (sum |u| not yet booked + |x_c - x_m|) <= (E - E_min)/D   where s > 0
//!             upwards s = b + r - f, downwards s = b + r + f,  r: range of the readings above
//! ```
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | E, E_max, E_min | energy at the port, the tank's capacity and reserve | J |
//! | n | `force_delay` | steps |
//! | b | `force_bias` | N or N m |
//! | f_trip | the axis' `trip_force` | N or N m |
//! | x_c, x_m | commanded and measured position | axis unit |
//! | D | number of axes | 1 |
//!
//! So `sum F dx >= -E_max`, F and dx the true ones, for every environment of up to `f_trip` and every robot that moves
//! towards its command and not beyond: a step moves it by `|x_c - x_m|` at most, which was paid for. The reserve is what
//! a tool that must not spend may still give way on: with none it grows rigid.

use crate::{ConfigError, Real, error};

/// The longest delay of a force that can be declared [steps].
pub const LONGEST_DELAY: u32 = 6;

/// Readings from one before a displacement to [`LONGEST_DELAY`] after it.
const SAMPLES: usize = 8;

/// What is known of the sensor and the robot at the physical port, `D` axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Port<T, const D: usize> {
    /// How many steps a fresh reading may be late, 0 to [`LONGEST_DELAY`].
    pub force_delay: u32,
    /// The most a reading may be off, after tare [N].
    pub force_bias: [T; D],
}

/// A reading and how far the robot has moved since the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample<T> {
    force: T,
    travel: T,
}

/// The books of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PortAxis<T> {
    /// Measured position at the last reading [axis unit].
    at: T,
    /// The youngest first.
    samples: [Sample<T>; SAMPLES],
    /// Between which positions the command has to stay [axis unit].
    pub walls: [T; 2],
}

/// What the readings that belong to the displacement to be booked say.
struct Window<T> {
    least: T,
    most: T,
    /// That displacement [axis unit].
    travel: T,
    /// What has been travelled since [axis unit].
    pending: T,
}

impl<T: Real, const D: usize> Port<T, D> {
    /// Whether every value makes sense.
    ///
    /// # Errors
    /// [`ConfigError`] for a delay above [`LONGEST_DELAY`] and a bias that is negative, not finite or above 1e9.
    pub fn check(&self) -> Result<(), ConfigError> {
        let longest = f64::from(LONGEST_DELAY);
        error::within("port.force_delay", T::of(f64::from(self.force_delay)), 0.0, longest)?;
        self.force_bias
            .iter()
            .try_for_each(|&bias| error::within("port.force_bias", bias, 0.0, crate::domain::LARGEST).map(drop))
    }
}

impl<T: Real + PartialOrd> PortAxis<T> {
    /// A robot at rest at `position`, `force` the reading there.
    pub fn at_rest(position: T, force: T) -> Self {
        let sample = Sample { force, travel: T::ZERO };
        Self { at: position, samples: [sample; SAMPLES], walls: [position; 2] }
    }

    /// The readings that belong to the displacement of `delay` steps ago.
    fn window(&self, delay: u32) -> Window<T> {
        let mut window = Window { least: T::of(f64::MAX), most: T::of(f64::MIN), travel: T::ZERO, pending: T::ZERO };
        for (age, sample) in (0..=delay + 1).zip(&self.samples) {
            window.least = window.least.at_most(sample.force);
            window.most = window.most.at_least(sample.force);
            if age < delay {
                window.pending += sample.travel.abs();
            } else if age == delay {
                window.travel = sample.travel;
            }
        }
        window
    }

    /// Takes a reading at `position`; returns the least work that the environment can have done in the step that can be
    /// booked now [J].
    pub fn read(&mut self, position: T, force: T, delay: u32, bias: T) -> T {
        let mut carried = Sample { force, travel: position - self.at };
        self.at = position;
        for sample in &mut self.samples {
            carried = core::mem::replace(sample, carried);
        }
        let Window { least, most, travel, .. } = self.window(delay);
        travel.select_below(T::ZERO, travel * (most + bias), travel * (least - bias))
    }

    /// Sets the walls: `energy` [J] is all that this axis may lose to forces of up to `trip` [N], `left` [J] what it may
    /// spend.
    pub fn confine(&mut self, energy: T, left: T, trip: T, delay: u32, bias: T) {
        let Window { least, most, pending, .. } = self.window(delay);
        let at_risk = energy / (trip + bias) - pending;
        let force = self.samples.first().map_or(T::ZERO, |sample| sample.force);
        let room = |spent: T| {
            let room = if spent > T::ZERO { at_risk.at_most(left / spent - pending) } else { at_risk };
            room.at_least(T::ZERO)
        };
        let doubt = bias + (most - least);
        self.walls = [self.at - room(doubt + force), self.at + room(doubt - force)];
    }
}
