//! A force that is affine in the position at every moment: `f = b(t) - exp(kappa(t)) (y - e(t))`.

use super::family::{Facts, Family, Likely, likely_force, likely_stiffness};

/// `f = b(t) - exp(kappa(t)) (y - e(t))`.
#[derive(Debug)]
pub(super) struct Affine {
    /// Coefficients of each of b, kappa and e.
    pub(super) count: usize,
}

/// Stiffnesses that a fit starts from, beside that of the policy.
const LADDER: [f64; 5] = [0.1, 1.0, 10.0, 100.0, 1000.0];
/// How far the place is held likely to move between two coefficients, as a share of the travel.
const WALK: f64 = 0.1;

impl Family for Affine {
    fn name(&self) -> &'static str {
        "a spring over time"
    }

    fn counts(&self) -> [usize; 3] {
        [self.count; 3]
    }

    fn likely(&self, facts: &Facts) -> [Likely; 3] {
        let place = Likely { mean: facts.positions[1], level: 2.0 * facts.travel(), walk: WALK * facts.travel() };
        [likely_force(facts), likely_stiffness(facts), place]
    }

    fn starts(&self, facts: &Facts) -> Vec<[f64; 2]> {
        LADDER.into_iter().map(|ratio| [facts.positions[1], ratio * facts.stiffness]).collect()
    }
}
