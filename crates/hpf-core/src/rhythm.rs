//! Rhythm: a movement that repeats, and the gains along it.
//!
//! ```text
//! phase       phi' = 2 pi r/P,   u = phi/(2 pi) in [0, 1)
//! basis       psi_i = exp(h (cos(phi - c_i) - 1)),   c_i = 2 pi i/n,   h = -ln(overlap)/(1 - cos(2 pi/n))
//! movement    tau^2 x'' = alpha (alpha/4 (g - x) - tau x') + A sum_i w_i psi_i/sum psi_i,   tau = P/(2 pi)
//! ```
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | P | `period` | s |
//! | r | `rate`, 1 = nominal, 0 = paused | 1 |
//! | u | [`Turn::part`]: the part of the period that has passed | 1 |
//! | g | `goal`: the middle that the spring pulls to | axis unit |
//! | A | `forcing_scale` | axis unit |
//! | w | `weights`, one per function | 1 |
//! | n | functions, at least 3 | 1 |
//!
//! The forcing term has no gate: a rhythm has no end. Step: exact for F held over it, F taken at mid-step: second order.
//! The motion is drawn to its limit cycle from wherever it is; [`RhythmicMovement::limit_cycle`] is where that starts.
//!
//! The phase is counted in periods, with what rounding takes from each step carried to the next, and a period is taken away
//! without rounding: it loses nothing however long it runs.
//!
//! Source: Ijspeert, Nakanishi, Hoffmann, Pastor, Schaal, Neural Computation 25(2):328, 2013, doi 10.1162/NECO_a_00393.

mod basis;

use core::f64::consts::TAU;

pub use basis::PeriodicBasis;

use crate::compensated::accumulate;
use crate::domain::LARGEST;
use crate::{ConfigError, Movement, MovementState, Real, Transition, error};

/// A phase that repeats.
///
/// ```
/// use hpf_core::rhythm::{Rhythm, Turn};
/// let rhythm = Rhythm::new(2.0_f64)?;
/// let mut turn = Turn::START;
/// for _ in 0..2500 {
///     rhythm.step(&mut turn, 1.0, 1e-3);
/// }
/// assert!((turn.part() - 0.25).abs() < 1e-12); // 2.5 s of periods of 2 s
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rhythm<T> {
    period: T,
}

/// Where in its period a rhythm is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn<T> {
    part: T,
    /// What rounding has taken from the part so far.
    remainder: T,
}

impl<T: Real> Turn<T> {
    /// The start of a period.
    pub const START: Self = Self { part: T::ZERO, remainder: T::ZERO };

    /// The part of the period that has passed, in [0, 1).
    #[inline]
    pub fn part(&self) -> T {
        self.part
    }

    /// The phase phi [rad], in [0, 2 pi).
    #[inline]
    pub fn angle(&self) -> T {
        self.part * T::of(TAU)
    }

    /// This, `change` periods later.
    #[inline]
    fn after(mut self, change: T) -> Self {
        accumulate(&mut self.part, &mut self.remainder, change);
        // Exact: of a number in [1, 2) its whole part leaves no rounding.
        self.part = self.part - self.part.floor();
        self
    }
}

impl<T: Real> Rhythm<T> {
    /// A rhythm of `period` [s].
    ///
    /// # Errors
    /// [`ConfigError`] for a period outside its [domain](crate::domain).
    pub fn new(period: T) -> Result<Self, ConfigError> {
        Ok(Self { period: error::size("period", period)? })
    }

    /// The period at the nominal rate [s].
    #[inline]
    pub fn period(&self) -> T {
        self.period
    }

    /// The time constant tau of a movement: `P/(2 pi)` [s].
    #[inline]
    pub fn time_constant(&self) -> T {
        self.period / T::of(TAU)
    }

    /// How many periods `dt` [s] at `rate` are.
    ///
    /// Total: `rate` is limited to [0, 1]; a `dt` that is negative or not finite counts as no time, beyond 1e9 s as 1e9 s.
    #[inline]
    fn periods(&self, rate: T, dt: T) -> T {
        let dt = if dt.is_finite() { dt.at_least(T::ZERO).at_most(T::of(LARGEST)) } else { T::ZERO };
        rate.max(T::ZERO).min(T::ONE) * dt / self.period
    }

    /// Advances by `dt` [s], time running at `rate`, which is limited to [0, 1]; another period in flight is another
    /// rhythm on the same turn.
    #[inline]
    pub fn step(&self, turn: &mut Turn<T>, rate: T, dt: T) {
        *turn = turn.after(self.periods(rate, dt));
    }
}

/// The movement of one axis that repeats; `S` holds the lists of basis and weights.
///
/// ```
/// use hpf_core::{Movement, rhythm::{PeriodicBasis, Rhythm, RhythmicMovement, Turn}};
/// let basis = PeriodicBasis::new(0.6, [0.0; 3], [0.0; 3])?;
/// // A constant forcing F holds the axis at g + F/(alpha beta), beta = alpha/4.
/// let movement = Movement::new(0.2, 0.2, 25.0, 0.5, [10.0; 3])?;
/// let rhythm = RhythmicMovement::new(Rhythm::new(1.5)?, basis, movement)?;
/// let state = rhythm.limit_cycle(100);
/// assert!((state.position - (0.2_f64 + 5.0 / 156.25)).abs() < 1e-12 && state.scaled_velocity.abs() < 1e-12);
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RhythmicMovement<T, S> {
    rhythm: Rhythm<T>,
    basis: PeriodicBasis<T, S>,
    movement: Movement<T, S>,
}

impl<T: Real, S: AsRef<[T]>> RhythmicMovement<T, S> {
    /// A movement of which `goal` is the middle that it is pulled to; its `start` is where it starts if it does not start on
    /// its limit cycle.
    ///
    /// # Errors
    /// [`ConfigError`] unless there is one weight per function.
    pub fn new(rhythm: Rhythm<T>, basis: PeriodicBasis<T, S>, movement: Movement<T, S>) -> Result<Self, ConfigError> {
        error::finite_list("movement.weights", movement.weights(), basis.count())?;
        Ok(Self { rhythm, basis, movement })
    }

    /// The phase.
    pub fn rhythm(&self) -> &Rhythm<T> {
        &self.rhythm
    }

    /// The basis of the weights.
    pub fn basis(&self) -> &PeriodicBasis<T, S> {
        &self.basis
    }

    /// The movement that is repeated.
    pub fn movement(&self) -> &Movement<T, S> {
        &self.movement
    }

    /// The same in another period: the path is the same, its velocity is not.
    pub fn with_rhythm(self, rhythm: Rhythm<T>) -> Self {
        Self { rhythm, ..self }
    }

    /// Advances by `dt` [s] at `rate`, as [`Rhythm::step`].
    #[inline]
    pub fn step(&self, turn: &mut Turn<T>, state: &mut MovementState<T>, rate: T, dt: T) {
        let periods = self.rhythm.periods(rate, dt);
        let transition = Transition::new(self.movement.alpha(), periods * T::of(TAU));
        self.go(&transition, periods, turn, state);
    }

    fn go(&self, transition: &Transition<T>, periods: T, turn: &mut Turn<T>, state: &mut MovementState<T>) {
        let middle = turn.after(periods * T::of(0.5));
        let [mixed] = self.basis.mix(middle.part(), [self.movement.weights()]);
        transition.apply(state, self.movement.goal(), self.movement.forcing(T::ONE, mixed));
        *turn = turn.after(periods);
    }

    /// Velocity of a state [axis unit/s] at `rate`.
    #[inline]
    pub fn velocity(&self, state: &MovementState<T>, rate: T) -> T {
        state.scaled_velocity * rate / self.rhythm.time_constant()
    }

    /// The state at the start of a period that comes back after it, when a period is made in `steps` equal steps, at least 1:
    /// the fixed point of the period's map, which is affine.
    ///
    /// At most 1e6 steps are made: their limit cycle is that of more, to the square of the step.
    pub fn limit_cycle(&self, steps: u32) -> MovementState<T> {
        let steps = steps.clamp(1, 1_000_000);
        let periods = T::ONE / T::of(f64::from(steps));
        let alpha = self.movement.alpha();
        let transition = Transition::new(alpha, periods * T::of(TAU));
        // Relative to the goal: x+ = M x + b, so b is where a start at rest at the goal leads.
        let goal = self.movement.goal();
        let mut turn = Turn::START;
        let mut end = MovementState { position: goal, scaled_velocity: T::ZERO };
        for _ in 0..steps {
            self.go(&transition, periods, &mut turn, &mut end);
        }
        let (bx, bz) = (end.position - goal, end.scaled_velocity);
        // The columns of M: a whole period without forcing is one step of it.
        let whole = Transition::new(alpha, T::of(TAU));
        let column = |position: T, scaled_velocity: T| {
            let mut state = MovementState { position, scaled_velocity };
            whole.apply(&mut state, T::ZERO, T::ZERO);
            state
        };
        let (first, second) = (column(T::ONE, T::ZERO), column(T::ZERO, T::ONE));
        // (I - M) x = b, by Cramer's rule; every eigenvalue of M is exp(-alpha pi) < 1.
        let (a, b) = (T::ONE - first.position, -second.position);
        let (c, d) = (-first.scaled_velocity, T::ONE - second.scaled_velocity);
        let determinant = a * d - b * c;
        MovementState {
            position: goal + (d * bx - b * bz) / determinant,
            scaled_velocity: (a * bz - c * bx) / determinant,
        }
    }
}
