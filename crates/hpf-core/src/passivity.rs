//! Energy: what a compliant tool may give, what it has given, and the guard that keeps the two in order.
//!
//! A tool whose stiffness varies is always stable (first order) but not always passive: raising the stiffness k at an
//! offset e puts `(k+ - k) e^2/2` into the spring out of nowhere, and the environment can take it out. The books of one
//! step with f and k held are exact, of first order (m = 0) and of second:
//! ```text
//! work of the environment    W = f (e+ - e)
//! stored                     S = k e^2/2 + m v^2/2
//! dissipated                 D = W - (S+ - S) >= 0      first order: (e+ - e) (f - k (e + e+)/2)
//! switched                   (k+ - k) e^2/2             at frozen e
//! ```
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | f | force of the environment ON the tool | N |
//! | e, v | offset and its velocity | m, m/s |
//! | k, m | stiffness, mass | N/m, kg |
//! | W, S, D, E_t | energies | J |
//!
//! [`EnergyTank`] pays for switching out of what was dissipated before; a [`Port`] keeps the same energy on what was
//! measured. [`first_order_fails_at`],
//! [`inertial_decay`], [`largest_offset`] and [`switched_energy`] judge a schedule of gains before it runs,
//! [`ForceLoop`] the tool and the contact it is run with.

mod certificate;
mod contact;
mod matrix;
mod port;
mod stored;
mod tank;

pub use certificate::{contact_stiffness_limit, first_order_fails_at, inertial_decay, largest_offset, switched_energy};
pub use contact::{Case, Contact, ForceLoop, Load, MOST_DELAY, Sampling, safe_tool_mass};
pub(crate) use port::PortAxis;
pub use port::{LONGEST_DELAY, Port};
pub use stored::Stored;
pub use tank::EnergyTank;

use crate::Real;

/// Energy `k e^2/2` of a spring of `stiffness` [N/m] at `offset` [m], in J.
///
/// ```
/// assert_eq!(hpf_core::passivity::spring_energy(400.0, 0.1_f64), 200.0 * (0.1 * 0.1));
/// ```
#[inline]
pub fn spring_energy<T: Real>(stiffness: T, offset: T) -> T {
    T::of(0.5) * stiffness * (offset * offset)
}

/// Energy `m v^2/2` of a `mass` [kg] at `velocity` [m/s], in J.
#[inline]
pub fn kinetic_energy<T: Real>(mass: T, velocity: T) -> T {
    T::of(0.5) * mass * (velocity * velocity)
}
