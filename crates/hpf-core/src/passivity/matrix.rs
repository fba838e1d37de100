//! The energy tank where stiffness is a matrix.
//!
//! ```text
//! asked for          C = e^T (K_des - K) e/2
//! C <= 0             K' = K_des,                   E_t += eta |C|
//! C > 0              K' = K + g (K_des - K),       E_t -= g C,   g = min(1, min(E_t - E_min, P h)/C)
//! ```
//! K' lies between K and K_des: it is positive definite, and its eigenvalues are within the bounds of both. Turning a stiff
//! direction towards the offset costs as much as raising it there, and is paid alike; a tank for each axis does not see it:
//! eigenvalues a and b that turn at the rate w give up to `(a - b) w e^2/2` to an offset e between them.

use super::{EnergyTank, Stored};
use crate::{Real, Symmetric};

impl<T: Real + PartialOrd> EnergyTank<T> {
    /// The stiffness [N/m] that may follow `stiffness` where `wanted` is asked for at `offset` [m], over `dt` [s]: the
    /// largest part of the way there that can be paid.
    ///
    /// ```
    /// use hpf_core::{Symmetric, passivity::EnergyTank};
    /// let tank = EnergyTank::new(0.2_f64, 0.0, 0.9, 1e3)?;
    /// let mut energy = tank.full();
    /// // At 0.1 m along x, turning a stiffness of 430 - 30 N/m from y to x costs 400 0.1^2/2 = 2 J; a tenth can be paid.
    /// let (soft, stiff) = (Symmetric::diagonal([30.0, 430.0, 30.0]), Symmetric::diagonal([430.0, 30.0, 30.0]));
    /// let found = tank.stiffness_matrix(&mut energy, &soft, &stiff, [0.1, 0.0, 0.0], 1e-3);
    /// assert!((found.xx - 70.0).abs() < 1e-11 && (found.yy - 390.0).abs() < 1e-11 && energy.level().abs() < 1e-15);
    /// # Ok::<(), hpf_core::ConfigError>(())
    /// ```
    #[inline]
    pub fn stiffness_matrix(
        &self,
        energy: &mut Stored<T>,
        stiffness: &Symmetric<T>,
        wanted: &Symmetric<T>,
        offset: [T; 3],
        dt: T,
    ) -> Symmetric<T> {
        let half = T::of(0.5);
        let cost = half * (wanted.quadratic(offset) - stiffness.quadratic(offset));
        let paid = self.available(energy.level()).at_most(self.power() * dt);
        if cost <= paid {
            self.book(energy, -cost);
            return *wanted;
        }
        let allowed = stiffness.towards(wanted, paid / cost);
        self.book(energy, half * (stiffness.quadratic(offset) - allowed.quadratic(offset)));
        allowed
    }
}
