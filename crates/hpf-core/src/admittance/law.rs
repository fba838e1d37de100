//! The law by which an axis gives way: part of its skill, for gains are learned under one law and mean little under another.

use crate::admittance::Inertial;
use crate::{ConfigError, Real, error};

/// By which law an axis gives way.
///
/// ```
/// use hpf_core::{Damping, Law};
/// let law = Law::SecondOrder { mass: 2.0_f64, damping: Damping::Ratio { ratio: 1.0, floor: 10.0 } };
/// assert_eq!(law.mass(), 2.0);
/// assert_eq!(law.damping(50.0, 0.0), 2.0 * (2.0_f64 * 50.0).sqrt()); // critical at 50 N/m, whatever the primitive says
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law<T> {
    /// `d e' + k e = f`, damping from its primitive.
    FirstOrder,
    /// `m e'' + d e' + k e = f`.
    SecondOrder {
        /// Virtual mass m [kg].
        mass: T,
        /// Where d comes from.
        damping: Damping<T>,
    },
}

/// Where the damping of a second-order axis comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Damping<T> {
    /// The damping primitive.
    Primitive,
    /// `d = max(2 ratio sqrt(m k), floor)`: it follows stiffness, and does not vanish with it.
    Ratio {
        /// Damping ratio; 1 is critical.
        ratio: T,
        /// Least damping [N s/m].
        floor: T,
    },
}

impl<T: Real> Law<T> {
    /// The law of three numbers, as packed skills and C have it: a `mass` [kg] of zero is the first order, a damping
    /// `ratio` of zero the damping primitive, else `floor` [N s/m] is the least damping.
    ///
    /// # Errors
    /// [`ConfigError`] for a ratio without a mass and a floor without a ratio; what else cannot be is refused where a
    /// skill is made of it.
    pub fn of(mass: T, ratio: T, floor: T) -> Result<Self, ConfigError> {
        let absent = |value: T| value.to_f64() == 0.0;
        let unused = |field, value| error::within(field, value, 0.0, 0.0);
        if absent(ratio) {
            unused("damping.floor", floor)?;
        }
        if absent(mass) {
            unused("damping.ratio", ratio)?;
            return Ok(Self::FirstOrder);
        }
        let damping = if absent(ratio) { Damping::Primitive } else { Damping::Ratio { ratio, floor } };
        Ok(Self::SecondOrder { mass, damping })
    }

    /// The three numbers that [`of`](Self::of) makes this law of.
    ///
    /// ```
    /// use hpf_core::Law;
    /// assert_eq!(Law::of(2.0, 0.7, 5.0)?.numbers(), [2.0, 0.7, 5.0]);
    /// assert_eq!(Law::<f64>::FirstOrder.numbers(), [0.0; 3]);
    /// # Ok::<(), hpf_core::ConfigError>(())
    /// ```
    pub fn numbers(&self) -> [T; 3] {
        match *self {
            Self::FirstOrder => [T::ZERO; 3],
            Self::SecondOrder { mass, damping: Damping::Primitive } => [mass, T::ZERO, T::ZERO],
            Self::SecondOrder { mass, damping: Damping::Ratio { ratio, floor } } => [mass, ratio, floor],
        }
    }

    /// Virtual mass [kg]; zero for the first order.
    #[inline]
    pub fn mass(&self) -> T {
        match *self {
            Self::FirstOrder => T::ZERO,
            Self::SecondOrder { mass, .. } => mass,
        }
    }

    /// Damping [N s/m] at `stiffness` [N/m] where the primitive says `primitive` [N s/m].
    #[inline]
    pub fn damping(&self, stiffness: T, primitive: T) -> T {
        match *self {
            Self::SecondOrder { mass, damping: Damping::Ratio { ratio, floor } } => {
                ((ratio + ratio) * (mass * stiffness).sqrt()).max(floor)
            }
            _ => primitive,
        }
    }

    /// # Errors
    /// [`ConfigError`] for a mass, a damping ratio or a least damping outside its [domain](crate::domain).
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        let Self::SecondOrder { mass, damping } = *self else { return Ok(()) };
        error::size("mass", mass)?;
        if let Damping::Ratio { ratio, floor } = damping {
            error::size("damping.ratio", ratio)?;
            error::size("damping.floor", floor)?;
        }
        Ok(())
    }

    /// The second-order step for stiffness up to `stiffness` [N/m], a damping primitive up to `damping` [N s/m] and steps
    /// up to `dt` [s]; none for the first order.
    ///
    /// # Errors
    /// [`ConfigError`] for a mass, a damping ratio or a least damping outside its
    /// [domain](crate::domain), and as for [`Inertial::new`].
    pub fn inertial(&self, stiffness: T, damping: T, dt: T) -> Result<Option<Inertial<T>>, ConfigError> {
        self.check()?;
        let Self::SecondOrder { mass, .. } = *self else { return Ok(None) };
        Inertial::new(mass, stiffness, self.damping(stiffness, damping), dt).map(Some)
    }
}
