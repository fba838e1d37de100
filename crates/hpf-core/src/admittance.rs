//! Admittance: how a tool gives way to force.
//!
//! Equation: `d e' + k e = f` (the paper's Eq. 1-2), `e = x_e - x_r`; with inertia, `m e'' + d e' + k e = f`, see
//! [`Inertial`]; which of the two an axis has is its [`Law`].
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | e | `offset`: commanded minus reference position | m or rad |
//! | f | `force` of the environment ON the tool | N or N m |
//! | k | `stiffness` | N/m or N m/rad |
//! | d | `damping` | N s/m or N m s/rad |
//! | h | `dt` | s |
//!
//! Two exact steps of the first-order law, the one relaxation `y' = -lambda (y - q)`:
//! - a **measured** force is held over the step ([`step_offset`]): exact, monotone, stable for every dt > 0;
//! - a **known** load `f = b - K_e y` is solved together with the law ([`Instant`], [`relax`]): the target q runs
//!   linearly from its value at the start of the step to its value at the end, lambda is taken at mid-step. Second
//!   order, right in the stiff limit (`y -> q`), where holding the force would be off by v h.
//!
//! Explicit Euler needs `h < 2 d/k` and blows up in contact; it is not here.

mod coupled;
mod inertial;
mod law;

pub use coupled::{CoupledInertia, CoupledMotion, coupled_velocity, step_coupled};
pub use inertial::{Inertial, OffsetMotion};
pub use law::{Damping, Law};

use crate::Real;
use crate::domain::flushed;

/// Below this lambda h, `(1 - exp(-x))/x` is taken from its series: 0/0 at zero, a relative error of x^3/24 here.
const SERIES_BELOW: f64 = 1e-5;

/// `(1 - exp(-x))/x` given `settled = 1 - exp(-x)`: the mean of exp(-x) over the step.
#[inline(always)]
fn mean_decay<T: Real>(x: T, settled: T) -> T {
    x.choose_below(T::of(SERIES_BELOW), || T::ONE - x * (T::of(0.5) - x * T::of(1.0 / 6.0)), || settled / x)
}

/// One step of `d e' + k e = f`, exact for k, d and f held over `dt` [s]. Returns the new offset, zero where it has died
/// away.
///
/// `damping` must be positive; `stiffness` may be zero, where the tool drifts by `dt f/d`.
///
/// ```
/// use hpf_core::admittance::step_offset;
/// let offset = step_offset(0.0_f64, 100.0, 50.0, 10.0, 1e3); // a long push of 10 N
/// assert!((offset - 0.1).abs() < 1e-15); // settles at f/k
/// assert_eq!(step_offset(0.0, 0.0, 50.0, 10.0, 0.5), 0.1); // no spring: dt f/d
/// ```
#[inline]
pub fn step_offset<T: Real>(offset: T, stiffness: T, damping: T, force: T, dt: T) -> T {
    let x = stiffness * dt / damping;
    let settled = -(-x).exp_m1();
    flushed(offset - settled * offset + force * dt / damping * mean_decay(x, settled))
}

/// One step of `y' = -lambda (y - q(t))`, exact for q running linearly from `target_start` to `target_end`.
///
/// `lambda_dt` is lambda times the step [1], at least 0.
///
/// ```
/// use hpf_core::admittance::relax;
/// assert_eq!(relax(0.3_f64, 1.0, 2.0, 0.0), 0.3); // no time, no change
/// assert!((relax(0.3_f64, 1.0, 2.0, 1e9) - 2.0).abs() < 1e-8); // stiff: on the target
/// ```
#[inline(always)]
pub fn relax<T: Real>(y: T, target_start: T, target_end: T, lambda_dt: T) -> T {
    let settled = -(-lambda_dt).exp_m1();
    let drift = target_end - target_start;
    y + settled * (target_start - y) + drift * (T::ONE - mean_decay(lambda_dt, settled))
}

/// All that decides the tool's motion at one instant: the coupled law `d (y' - x_r') + k (y - x_r) = b - K_e y`.
///
/// With a reference of zero it is the law of the offset alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant<T> {
    /// Stiffness k [N/m].
    pub stiffness: T,
    /// Damping d [N s/m].
    pub damping: T,
    /// Reference position x_r [m].
    pub reference_position: T,
    /// Reference velocity x_r' [m/s].
    pub reference_velocity: T,
    /// Force b that does not depend on the tool's position [N].
    pub load_force: T,
    /// Stiffness K_e of the environment [N/m].
    pub load_stiffness: T,
}

impl<T: Real> Instant<T> {
    /// Position q at which the tool would rest [m].
    #[inline(always)]
    pub fn target(&self) -> T {
        (self.stiffness * self.reference_position + self.damping * self.reference_velocity + self.load_force)
            / (self.stiffness + self.load_stiffness)
    }

    /// Rate lambda at which it gets there [1/s].
    #[inline(always)]
    pub fn lambda(&self) -> T {
        (self.stiffness + self.load_stiffness) / self.damping
    }

    /// Force of the environment on a tool at `position` [N].
    #[inline(always)]
    pub fn force(&self, position: T) -> T {
        self.load_force - self.load_stiffness * position
    }

    /// Velocity of a tool at `position` [m/s].
    #[inline(always)]
    pub fn velocity(&self, position: T) -> T {
        self.reference_velocity
            + (self.force(position) - self.stiffness * (position - self.reference_position)) / self.damping
    }
}
