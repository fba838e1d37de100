//! The energy tank: a tool never gives more than it was given.
//!
//! ```text
//! stiffness asked for above the last:  k' = min(k_des, k + 2 min(E_t - E_min, P h)/e^2),  E_t -= (k' - k) e^2/2
//! below it:                            k' = k_des,                                        E_t += eta (k - k') e^2/2
//! after the admittance step:           E_t += eta D,  or  E_t += D  where D < 0
//! force set-point p:                  c p acts,  c = min(1, (E_t - E_min)/max((E_t0 - E_min)/4, 8 p^2 h/(d + m/h)))
//! ```
//! E_t never rises above its capacity. For every force and every k_des: `sum W >= -(E_t0 - E_min + S_0)`.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | E_t | `energy` in the tank, the whole state, a [`Stored`] | J |
//! | E_min | `reserve` that switching leaves alone | J |
//! | eta | `refill`: share of dissipated energy that comes back | 1 |
//! | P | `power`: the most that switching may put into one axis | W |
//! | c | [`valve`](EnergyTank::valve) | 1 |
//!
//! Source: the tank of Ferraguti, Secchi, Fantuzzi, ICRA 2013, doi 10.1109/ICRA.2013.6630830, with exact books.

use super::Stored;
use crate::{ConfigError, Real, error};

/// The part of what a full tank can spend below which a force set-point is throttled.
const VALVE: f64 = 0.25;

/// The steps that a throttled set-point has to be let go in, at least.
const VALVE_STEPS: f64 = 8.0;

/// Parameters of an energy tank; its state is the energy in it.
///
/// ```
/// use hpf_core::passivity::EnergyTank;
/// let tank = EnergyTank::new(0.2_f64, 0.0, 0.9, 1e3)?;
/// let mut energy = tank.full();
/// // At 0.1 m, 0.2 J raise the stiffness by 2 0.2/0.1^2 = 40 N/m, and not by the 370 N/m asked for.
/// let stiffness = tank.stiffness(&mut energy, 30.0, 400.0, 0.1, 1e-3);
/// assert!((stiffness - 70.0).abs() < 1e-12 && energy.level().abs() < 1e-15);
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyTank<T> {
    capacity: T,
    reserve: T,
    refill: T,
    power: T,
}

impl<T: Real> EnergyTank<T> {
    /// A tank of `capacity` [J] that keeps `reserve` [J], is refilled by the share `refill` of what is dissipated, and
    /// raises the stiffness of an axis with `power` [W] at most.
    ///
    /// # Errors
    /// [`ConfigError`] unless capacity and power are finite and positive, and `0 <= reserve <= capacity`,
    /// `0 <= refill <= 1`.
    pub fn new(capacity: T, reserve: T, refill: T, power: T) -> Result<Self, ConfigError> {
        Ok(Self {
            capacity: error::size("tank.capacity", capacity)?,
            reserve: error::within("tank.reserve", reserve, 0.0, capacity.to_f64())?,
            refill: error::within("tank.refill", refill, 0.0, 1.0)?,
            power: error::size("tank.power", power)?,
        })
    }

    /// The most the tank holds, and what it starts with [J].
    pub fn capacity(&self) -> T {
        self.capacity
    }

    /// The energy of a full tank.
    pub fn full(&self) -> Stored<T> {
        Stored::new(self.capacity)
    }

    /// The most that switching may put into one axis, or into the axes of one matrix [W].
    pub fn power(&self) -> T {
        self.power
    }

    /// What may be spent of `energy` [J].
    #[inline]
    pub fn available(&self, energy: T) -> T {
        (energy - self.reserve).at_least(T::ZERO)
    }

    /// The part of a force set-point that may act while `left` [J] can be spent: all of it above a quarter of what the
    /// full tank can spend, and eight times what it spends in one `step` [J] without resistance; below that in
    /// proportion.
    ///
    /// ```
    /// use hpf_core::passivity::EnergyTank;
    /// let tank = EnergyTank::new(0.5_f64, 0.1, 0.9, 1e3)?; // 0.4 J can be spent
    /// assert_eq!([0.4, 0.1, 0.05, 0.0].map(|left| tank.valve(left, 0.01)), [1.0, 1.0, 0.5, 0.0]);
    /// assert_eq!((tank.valve(0.4, 0.1), tank.valve(-0.4, 0.1)), (0.5, 0.0));
    /// # Ok::<(), hpf_core::ConfigError>(())
    /// ```
    #[inline]
    pub fn valve(&self, left: T, step: T) -> T {
        let open = (T::of(VALVE) * (self.capacity - self.reserve)).at_least(T::of(VALVE_STEPS) * step);
        // A tank that can spend nothing, or less, is shut; a set-point of zero costs nothing.
        let left = left.at_least(T::ZERO);
        left.select_below(open, left / open, T::ONE)
    }

    /// The stiffness [N/m] that may follow `stiffness` where `wanted` is asked for at `offset` [m], over `dt` [s]. What
    /// comes in above the capacity is lost at the next [`book`](Self::book).
    #[inline]
    pub fn stiffness(&self, energy: &mut Stored<T>, stiffness: T, wanted: T, offset: T, dt: T) -> T
    where
        T: PartialOrd,
    {
        let square = offset * offset;
        let gain = T::of(0.5) * (stiffness - wanted) * square;
        // At no offset any stiffness is free.
        if gain >= T::ZERO {
            energy.add(gain * self.refill);
            return wanted;
        }
        if -gain <= energy.level() - self.reserve && -gain <= self.power * dt {
            energy.add(gain);
            return wanted;
        }
        let paid = self.available(energy.level()).at_most(self.power * dt);
        let allowed = (stiffness + (paid + paid) / square).at_most(wanted);
        self.book(energy, T::of(0.5) * (stiffness - allowed) * square);
        allowed
    }

    /// Books `balance` [J]: what comes in, less the share that is lost; what goes out, in full.
    #[inline]
    pub fn book(&self, energy: &mut Stored<T>, balance: T) {
        energy.add(balance.select_below(T::ZERO, balance, balance * self.refill));
        *energy = energy.capped(self.capacity);
    }
}
