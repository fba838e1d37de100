//! Admittance with directions: stiffness and damping are matrices, and a force along one axis gives way along others.
//!
//! Equation: `D e' + K e = f`, K and D symmetric, D positive definite. Step (exact for K, D and f held over it): with
//! `D = L L^T` and `L^-1 K L^-T = V diag(lambda) V^T`, the modes `u_i = L^-T v_i` have `u_i^T D u_j = 1` for i = j, else
//! 0, and
//! ```text
//! y_i = u_i^T D e,   y_i' + lambda_i y_i = u_i^T f,   e+ = sum_i u_i y_i+
//! ```
//! each mode by the scalar step. With inertia, `m e'' + D e' + K e = f` for a scalar m and `D = max(2 zeta sqrt(m K), d_0)`,
//! which has K's eigenvectors: the modes are the eigenvectors of K. Another D would couple them, and has no exact step here.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | e | `offset`: commanded minus reference position | m or rad |
//! | f | `force` of the environment ON the tool | N or N m |
//! | K | `stiffness`, positive semidefinite | N/m or N m/rad |
//! | D | `damping`, positive definite | N s/m or N m s/rad |
//! | m | `mass` | kg or kg m^2 |
//! | lambda | rates of the modes | 1/s |
//!
//! Gains taken at mid-step make the step second order where they vary. A diagonal K and D are cheaper axis by axis
//! ([`step_offset`](super::step_offset)), and the same.

use crate::admittance::{Inertial, OffsetMotion, step_offset};
use crate::domain::flushed;
use crate::rotation::{add_scaled, dot};
use crate::symmetric::Modes;
use crate::{Real, Symmetric};

/// One step of `D e' + K e = f`, exact for K, D and f held over `dt` [s]. Returns the new offset.
///
/// ```
/// use hpf_core::{Symmetric, admittance::step_coupled};
/// // 400 N/m along the diagonal of x and y, 30 N/m across it: a long push along x gives way along -y too.
/// let stiffness = Symmetric { xx: 215.0_f64, xy: 185.0, yy: 215.0, zz: 30.0, ..Symmetric::diagonal([0.0; 3]) };
/// let offset = step_coupled([0.0; 3], &stiffness, &Symmetric::isotropic(50.0), [10.0, 0.0, 0.0], 1e3);
/// assert!((offset[0] - 10.0 * 215.0 / 12_000.0).abs() < 1e-12); // K^-1 f, det = 215^2 - 185^2
/// assert!((offset[1] + 10.0 * 185.0 / 12_000.0).abs() < 1e-12);
/// ```
#[inline]
pub fn step_coupled<T: Real>(
    offset: [T; 3],
    stiffness: &Symmetric<T>,
    damping: &Symmetric<T>,
    force: [T; 3],
    dt: T,
) -> [T; 3] {
    stiffness.modes(damping).step(offset, force, dt)
}

impl<T: Real> Modes<T> {
    /// One step of all modes, exact for a force held over `dt` [s].
    #[inline]
    pub(crate) fn step(&self, offset: [T; 3], force: [T; 3], dt: T) -> [T; 3] {
        let mut next = [T::ZERO; 3];
        for ((&rate, &shape), &damped) in self.rates.iter().zip(&self.shapes).zip(&self.damped) {
            // Rounding may leave the rate of a stiffness of zero below zero.
            let rate = rate.at_least(T::ZERO);
            let part = step_offset(dot(damped, offset), rate, T::ONE, dot(shape, force), dt);
            next = add_scaled(next, shape, part);
        }
        next.map(flushed)
    }
}

/// Velocity of an offset [m/s]: `D^-1 (f - K e)`.
///
/// ```
/// use hpf_core::{Symmetric, admittance::coupled_velocity};
/// let [stiffness, damping] = [100.0_f64, 50.0].map(Symmetric::isotropic);
/// let [x, y, z] = coupled_velocity([0.05, 0.1, 0.0], &stiffness, &damping, [10.0, 0.0, 5.0]);
/// assert!((x - 0.1).abs() < 1e-15 && (y + 0.2).abs() < 1e-15 && (z - 0.1).abs() < 1e-15);
/// ```
#[inline]
pub fn coupled_velocity<T: Real>(
    offset: [T; 3],
    stiffness: &Symmetric<T>,
    damping: &Symmetric<T>,
    force: [T; 3],
) -> [T; 3] {
    damping.solve(add_scaled(force, stiffness.times(offset), -T::ONE))
}

/// State of an offset of three axes with inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoupledMotion<T> {
    /// Offset e: commanded minus reference position [m].
    pub offset: [T; 3],
    /// Its velocity [m/s].
    pub velocity: [T; 3],
}

/// The law of second order with a scalar mass and a damping that follows the stiffness in every direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoupledInertia<T> {
    law: Inertial<T>,
    ratio: T,
    floor: T,
}

impl<T: Real> CoupledInertia<T> {
    /// A law of `mass` [kg] with `D = max(2 ratio sqrt(m K), floor)`, floor in N s/m, for eigenvalues of K up to `stiffness`
    /// [N/m] and steps up to `dt` [s].
    ///
    /// # Errors
    /// [`ConfigError`](crate::ConfigError) for numbers outside their [domain](crate::domain), and as [`Inertial::new`].
    pub fn new(mass: T, ratio: T, floor: T, stiffness: T, dt: T) -> Result<Self, crate::ConfigError> {
        let law = crate::Law::SecondOrder { mass, damping: crate::Damping::Ratio { ratio, floor } };
        law.check()?;
        let law = Inertial::new(mass, stiffness, law.damping(stiffness, T::ZERO), dt)?;
        Ok(Self { law, ratio, floor })
    }

    /// One step of `m e'' + D e' + K e = f`, exact for K and f held over `dt` [s].
    ///
    /// ```
    /// use hpf_core::{Symmetric, admittance::{CoupledInertia, CoupledMotion}};
    /// let law = CoupledInertia::new(2.0_f64, 1.0, 10.0, 400.0, 100.0)?;
    /// let stiffness = Symmetric { xx: 215.0, xy: 185.0, yy: 215.0, zz: 30.0, ..Symmetric::diagonal([0.0; 3]) };
    /// let mut motion = CoupledMotion { offset: [0.0; 3], velocity: [0.0; 3] };
    /// law.step(&mut motion, &stiffness, [4.0, 4.0, 3.0], 100.0); // a long push, stiff and soft
    /// let [x, y, z] = motion.offset;
    /// assert!((x - 0.01).abs() < 1e-9 && (y - 0.01).abs() < 1e-9 && (z - 0.1).abs() < 1e-9);
    /// # Ok::<(), hpf_core::ConfigError>(())
    /// ```
    #[inline]
    pub fn step(&self, motion: &mut CoupledMotion<T>, stiffness: &Symmetric<T>, force: [T; 3], dt: T) {
        let modes = stiffness.eigen();
        let law = crate::Law::SecondOrder {
            mass: self.law.mass(),
            damping: crate::Damping::Ratio { ratio: self.ratio, floor: self.floor },
        };
        let mut next = CoupledMotion { offset: [T::ZERO; 3], velocity: [T::ZERO; 3] };
        for (value, vector) in modes.values.into_iter().zip(modes.vectors) {
            let value = value.at_least(T::ZERO);
            let mut mode = OffsetMotion { offset: dot(vector, motion.offset), velocity: dot(vector, motion.velocity) };
            self.law.step(&mut mode, value, law.damping(value, T::ZERO), dot(vector, force), dt);
            next.offset = add_scaled(next.offset, vector, mode.offset);
            next.velocity = add_scaled(next.velocity, vector, mode.velocity);
        }
        *motion = next;
    }
}
