//! Second-order admittance: a tool with inertia.
//!
//! Equation: `m e'' + d e' + k e = f`. Step (exact for k, d and f held over it), with `2a = d/m`, `w2 = k/m` and the
//! response `phi'' + 2a phi' + w2 phi = 0`, `phi(0) = 0`, `phi'(0) = 1`, `G2 = phi(h)`, `G1 = int_0^h phi`:
//! ```text
//! e+ = e + v G2 + (f/m - w2 e) G1
//! v+ = v + (f/m - w2 e - 2a v) G2 - w2 v G1
//! ```
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | e | `offset`: commanded minus reference position | m or rad |
//! | v | `velocity` of the offset | m/s or rad/s |
//! | f | `force` of the environment ON the tool | N or N m |
//! | m | `mass` | kg or kg m^2 |
//! | d | `damping` | N s/m or N m s/rad |
//! | k | `stiffness`, may be zero | N/m or N m/rad |
//! | h | `dt` | s |
//!
//! G1 and G2 come from the Taylor series of phi, which every damping regime shares, where `max(2a, sqrt(w2)) h <= 1/2`.
//! A longer step is halved `halvings` times first, then doubled as often; the count is fixed at construction, so every
//! step costs the same. The closed forms divide by the distance of two roots and lose digits where the roots meet.
//! Gains taken at mid-step make the step second order where they vary.

use crate::domain::flushed;
use crate::{ConfigError, Real, error};

/// The series serves up to this `max(2a, sqrt(w2)) h`.
const SERIES_UP_TO: f64 = 0.5;

/// Terms of the series; the first one left out is below `0.5^14/14!`, 1e-15 of the sum.
const TERMS: u32 = 14;

/// More halvings than this reach beyond the digits of a double.
const MOST_HALVINGS: u32 = 52;

/// State of an offset with inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetMotion<T> {
    /// Offset e: commanded minus reference position [axis unit].
    pub offset: T,
    /// Its velocity [axis unit/s].
    pub velocity: T,
}

/// The law of second order for one mass and the largest gains and step it will meet.
///
/// ```
/// use hpf_core::admittance::{Inertial, OffsetMotion};
/// let law = Inertial::new(2.0_f64, 400.0, 100.0, 0.01)?; // 2 kg, up to 400 N/m, 100 N s/m and 10 ms
/// let mut motion = OffsetMotion { offset: 0.0, velocity: 0.0 };
/// law.step(&mut motion, 0.0, 0.0, 10.0, 0.01); // 10 N on a free mass: a = 5 m/s^2
/// assert!((motion.velocity - 0.05).abs() < 1e-16);
/// assert!((motion.offset - 0.5 * 5.0 * 1e-4).abs() < 1e-18);
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertial<T> {
    mass: T,
    halvings: u32,
}

impl<T: Real> Inertial<T> {
    /// A law exact for stiffness up to `stiffness` [N/m], damping up to `damping` [N s/m] and steps up to `dt` [s].
    ///
    /// # Errors
    /// [`ConfigError`] for a mass [kg] outside its [domain](crate::domain), a dt that is not positive, gains that are
    /// negative or not finite, and where `max(d/m, sqrt(k/m)) dt` is above 1e15: no digit of such a step would be right.
    pub fn new(mass: T, stiffness: T, damping: T, dt: T) -> Result<Self, ConfigError> {
        error::size("mass", mass)?;
        error::positive("dt", dt)?;
        // Of a tool in contact: that of the environment is in them, which is bounded by the reach alone.
        error::within("stiffness", stiffness, 0.0, f64::INFINITY)?;
        error::within("damping", damping, 0.0, f64::INFINITY)?;
        Self::within_reach(mass, stiffness, damping, dt).ok_or_else(|| ConfigError::OutOfRange {
            field: "max(damping/mass, sqrt(stiffness/mass)) dt",
            value: reach(mass, stiffness, damping, dt),
            min: 0.0,
            max: libm::scalbn(SERIES_UP_TO, MOST_HALVINGS.cast_signed()),
        })
    }

    /// The same for numbers of a skill and a step that is not negative; none where the step reaches too far.
    pub(crate) fn within_reach(mass: T, stiffness: T, damping: T, dt: T) -> Option<Self> {
        let reach = reach(mass, stiffness, damping, dt) / SERIES_UP_TO;
        if !reach.is_finite() {
            return None;
        }
        // The least n of 2^n >= reach; a fraction lies in [0.5, 1).
        let (fraction, exponent) = libm::frexp(reach);
        let halvings = (exponent - i32::from(fraction <= 0.5)).max(0).cast_unsigned();
        (halvings <= MOST_HALVINGS).then_some(Self { mass, halvings })
    }

    /// Mass m [kg].
    pub fn mass(&self) -> T {
        self.mass
    }

    /// G1 and G2 of a step of `dt` for `2a` and `w2`.
    #[inline(always)]
    fn response(&self, double_a: T, w2: T, dt: T) -> (T, T) {
        let h = (0..self.halvings).fold(dt, |h, _| h * T::of(0.5));
        // term = y_j h^j/j! of phi's derivatives y_j, which obey y_{j+2} = -2a y_{j+1} - w2 y_j. Counted in T, so that
        // a compiler folds the reciprocals and a single-precision unit never meets a double.
        let (mut before, mut term) = (T::ZERO, h);
        let (mut g1, mut g2) = (T::ZERO, T::ZERO);
        let mut per_j = T::ONE;
        let mut j = T::ONE;
        for _ in 1..TERMS {
            j += T::ONE;
            let per_next = T::ONE / j;
            g2 += term;
            g1 += term * h * per_next;
            let after = -(double_a * term + w2 * h * before * per_j) * h * per_next;
            (before, term, per_j) = (term, after, per_next);
        }
        for _ in 0..self.halvings {
            (g1, g2) =
                (g1 + (T::ONE - w2 * g1) * g1 + g2 * g2, g2 - w2 * g2 * g1 + (T::ONE - double_a * g2 - w2 * g1) * g2);
        }
        (g1, g2)
    }

    /// One step of `m e'' + d e' + k e = f`, exact for k, d and f held over `dt` [s].
    #[inline(always)]
    pub fn step(&self, motion: &mut OffsetMotion<T>, stiffness: T, damping: T, force: T, dt: T) {
        let (double_a, w2) = (damping / self.mass, stiffness / self.mass);
        let (g1, g2) = self.response(double_a, w2, dt);
        let OffsetMotion { offset, velocity } = *motion;
        let pull = force / self.mass - w2 * offset;
        motion.offset = flushed(offset + velocity * g2 + pull * g1);
        motion.velocity = flushed(velocity + (pull - double_a * velocity) * g2 - w2 * velocity * g1);
    }
}

/// `max(d/m, sqrt(k/m)) h`: how far a step reaches in the time of the law [1].
fn reach<T: Real>(mass: T, stiffness: T, damping: T, dt: T) -> f64 {
    let m = mass.to_f64();
    (damping.to_f64() / m).max(libm::sqrt(stiffness.to_f64() / m)) * dt.to_f64()
}
