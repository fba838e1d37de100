//! Families of environments: what a force may depend on, with how many coefficients, and what is held likely.

use core::fmt::Debug;

/// What is known of the motions of an axis before an environment is fitted to them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facts {
    /// Largest force recorded [N].
    pub(super) force: f64,
    /// Smallest, mean and largest position recorded [m].
    pub(super) positions: [f64; 3],
    /// Largest stiffness of the policy [N/m]: environments are stiff or soft beside it.
    pub(super) stiffness: f64,
}

impl Facts {
    pub(super) fn travel(&self) -> f64 {
        self.positions[2] - self.positions[0]
    }
}

/// What is held likely of a function of time: a normal distribution of each coefficient, and of the differences between
/// neighbors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Likely {
    pub(super) mean: f64,
    /// Standard deviation of a coefficient.
    pub(super) level: f64,
    /// Standard deviation of the difference between neighbors.
    pub(super) walk: f64,
}

/// A family of environments, `f = b(t) - K(t) (y - e(t))` with `K = exp(kappa)`.
pub(super) trait Family: Debug + Send + Sync {
    /// Its name.
    fn name(&self) -> &'static str;

    /// Coefficients of b [N], kappa [ln N/m] and e [m]: none, one, or those of a spline.
    fn counts(&self) -> [usize; 3];

    /// +1 or -1 where the force on y acts at larger or smaller positions than e only; else 0.
    fn side(&self) -> f64 {
        0.0
    }

    /// What is held likely of b, kappa and e.
    fn likely(&self, facts: &Facts) -> [Likely; 3];

    /// Places [m] and stiffnesses [N/m] that a fit starts from.
    fn starts(&self, facts: &Facts) -> Vec<[f64; 2]>;
}

/// Coefficients of a spline over a movement.
pub(super) const COEFFICIENTS: usize = 26;
/// Coefficients of a fine one.
pub(super) const FINE_COEFFICIENTS: usize = 90;

/// b of every family: any force, smooth beside its size.
pub(super) fn likely_force(facts: &Facts) -> Likely {
    Likely { mean: 0.0, level: 10.0 * facts.force, walk: facts.force }
}

/// kappa of every family.
pub(super) fn likely_stiffness(facts: &Facts) -> Likely {
    Likely { mean: libm::log(10.0 * facts.stiffness), level: 5.0, walk: 1.0 }
}
