//! Movement primitive: a critically damped pull to the goal, bent by a learned forcing term (a discrete DMP).
//!
//! Equation: `tau^2 x'' = alpha (beta (g - x) - tau x') + F(s)`, `beta = alpha/4`, `F(s) = s A sum_i w_i phi_i(s)`
//! (the paper's Eq. 3 and 7, which disagree in one tau; this is the consistent form). The factor s is the gate of a
//! decaying phase, [`Phase::gate`](crate::Phase::gate): after the duration it fades to exactly zero.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | x | `position` | axis unit: m or rad |
//! | z = tau x' | `scaled_velocity` | axis unit |
//! | g | `goal` | axis unit |
//! | alpha | `alpha` | 1 |
//! | A | `forcing_scale`, fixed when the movement starts | axis unit |
//! | w | `weights`, one per basis function, oldest phase first | 1 |
//!
//! Step: [`Transition`], exact for F held over the step. With F taken at the mid-step phase the step is second order
//! in dt, with F at the start of the step first order.
//!
//! Source: Ijspeert, Nakanishi, Hoffmann, Pastor, Schaal, Neural Computation 25(2):328, 2013, doi 10.1162/NECO_a_00393.

mod increment;

pub(crate) use increment::Increment;

use crate::domain::{ALPHA, LARGEST, LARGEST_FORCING, single};
use crate::{ConfigError, Real, error};

/// Spring factor alpha where nothing else is asked for.
pub const DEFAULT_ALPHA: f64 = 25.0;

/// Parameters of the movement primitive of one axis; `S` holds the weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Movement<T, S> {
    start: T,
    goal: T,
    alpha: T,
    forcing_scale: T,
    weights: S,
}

impl<T: Real, S: AsRef<[T]>> Movement<T, S> {
    /// A movement from rest at `start` to `goal` (both in the axis unit).
    ///
    /// # Errors
    /// [`ConfigError`] for values outside their [domain](crate::domain), the forcing scale times a weight among them.
    pub fn new(start: T, goal: T, alpha: T, forcing_scale: T, weights: S) -> Result<Self, ConfigError> {
        error::finite_list("movement.weights", weights.as_ref(), weights.as_ref().len())?;
        error::number("start", start)?;
        error::number("goal", goal)?;
        error::positive("alpha", alpha)?;
        let [least, most] = ALPHA;
        error::within("alpha", alpha, least, most)?;
        error::number("forcing_scale", forcing_scale)?;
        for weight in weights.as_ref() {
            error::number("movement.weights", *weight)?;
            let forcing = forcing_scale * *weight;
            error::within("forcing_scale times weights", forcing, -LARGEST_FORCING, LARGEST_FORCING)?;
        }
        Ok(Self { start, goal, alpha, forcing_scale, weights })
    }

    /// Where the movement starts [axis unit].
    pub fn start(&self) -> T {
        self.start
    }

    /// Where the movement ends [axis unit].
    pub fn goal(&self) -> T {
        self.goal
    }

    /// Spring factor alpha.
    pub fn alpha(&self) -> T {
        self.alpha
    }

    /// Scale A of the forcing term [axis unit].
    pub fn forcing_scale(&self) -> T {
        self.forcing_scale
    }

    /// Weights, one per basis function, oldest phase first.
    pub fn weights(&self) -> &[T] {
        self.weights.as_ref()
    }

    /// The forcing term `F = gamma A sum_i w_i phi_i(s)`, given the [`gate`](crate::Phase::gate) gamma and the mixture of
    /// the weights at phase s.
    #[inline(always)]
    pub fn forcing(&self, gate: T, mixed_weights: T) -> T {
        gate * self.forcing_scale * mixed_weights
    }

    /// The state at the start: at rest at `start`.
    pub fn initial_state(&self) -> MovementState<T> {
        MovementState { position: self.start, scaled_velocity: T::ZERO }
    }
}

/// State of a movement primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovementState<T> {
    /// Reference position x [axis unit].
    pub position: T,
    /// Reference velocity times duration, z = tau x' [axis unit].
    pub scaled_velocity: T,
}

/// One exact step of the critically damped system: what `alpha` and the step size alone decide.
///
/// With `y = x - g`, `p = alpha/2`, `u = p dth`, `E = exp(-u)`:
/// ```text
/// x+ = g + E ((1+u) y + dth z) + G1 F        G1 = (1 - (1+u) E)/p^2
/// z+ = E ((1-u) z - p^2 dth y) + G2 F        G2 = dth E
/// ```
///
/// ```
/// use hpf_core::{MovementState, Transition};
/// let step = Transition::new(25.0_f64, 0.5);
/// let mut state = MovementState { position: 0.0, scaled_velocity: 0.0 };
/// step.apply(&mut state, 1.0, 0.0);
/// let u = 6.25_f64; // without forcing: x = g - (1 + u) exp(-u) (g - x0)
/// assert!((state.position - (1.0 - (1.0 + u) * (-u).exp())).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<T> {
    position_from_position: T,
    /// As well as `velocity_from_forcing`.
    position_from_velocity: T,
    velocity_from_position: T,
    velocity_from_velocity: T,
    position_from_forcing: T,
}

/// Below this u the closed form of G1 loses digits and its series takes over.
const SERIES_BELOW: f64 = 0.05;

/// `(-1)^n (n+1)/(n+2)!`: the series of `(1 - (1+u) exp(-u))/u^2`, its first missing term below 1e-15 of the sum.
const SERIES: [f64; 8] =
    [1.0 / 2.0, -2.0 / 6.0, 3.0 / 24.0, -4.0 / 120.0, 5.0 / 720.0, -6.0 / 5040.0, 7.0 / 40320.0, -8.0 / 362_880.0];

/// So many of them count in single precision.
const SINGLE_TERMS: usize = 5;

/// What every form of the step is made of.
struct Response<T> {
    dth: T,
    p: T,
    u: T,
    /// 1 - E.
    settled: T,
    /// E.
    decay: T,
    g1: T,
}

impl<T: Real> Response<T> {
    #[inline]
    fn new(alpha: T, normalised_dt: T) -> Self {
        let dth = normalised_dt.at_least(T::ZERO).at_most(T::of(LARGEST));
        let [least, most] = ALPHA.map(T::of);
        let p = alpha.at_least(least).at_most(most) * T::of(0.5);
        let u = p * dth;
        let settled = -(-u).exp_m1();
        let decay = T::ONE - settled;
        // 1 - E from expm1 keeps the digits that 1 - (1+u) E cancels.
        let closed = || (settled - u * decay) / (p * p);
        let terms = SERIES.iter().take(if single::<T>() { SINGLE_TERMS } else { SERIES.len() });
        let series = || dth * dth * terms.rev().fold(T::ZERO, |sum, &c| sum * u + T::of(c));
        Self { dth, p, u, settled, decay, g1: u.choose_below(T::of(SERIES_BELOW), series, closed) }
    }
}

impl<T: Real> Transition<T> {
    /// The step for spring factor `alpha` over `normalised_dt = rate dt / duration`, each brought into its
    /// [domain](crate::domain): no step makes what is finite infinite.
    #[inline]
    pub fn new(alpha: T, normalised_dt: T) -> Self {
        let Response { dth, p, u, decay, g1, .. } = Response::new(alpha, normalised_dt);
        Self {
            position_from_position: decay * (T::ONE + u),
            position_from_velocity: decay * dth,
            velocity_from_position: -decay * p * p * dth,
            velocity_from_velocity: decay * (T::ONE - u),
            position_from_forcing: g1,
        }
    }

    /// Advances `state` towards `goal`, `forcing` held over the step.
    #[inline(always)]
    pub fn apply(&self, state: &mut MovementState<T>, goal: T, forcing: T) {
        let y = state.position - goal;
        let z = state.scaled_velocity;
        state.position = goal
            + self.position_from_position * y
            + self.position_from_velocity * z
            + self.position_from_forcing * forcing;
        state.scaled_velocity =
            self.velocity_from_position * y + self.velocity_from_velocity * z + self.position_from_velocity * forcing;
    }
}
