//! A wall: `f = b(t) - K max(0, side (y - e)) side`, of one stiffness at one place, on either side.

use super::family::{Facts, Family, Likely, likely_force, likely_stiffness};

/// A wall at larger (+1) or smaller (-1) positions.
#[derive(Debug)]
pub(super) struct Wall {
    pub(super) side: f64,
    /// Coefficients of b.
    pub(super) count: usize,
}

/// Stiffnesses that a fit starts from, beside that of the policy.
const LADDER: [f64; 6] = [0.3, 3.0, 30.0, 300.0, 3000.0, 30000.0];
/// Places that a fit starts from, evenly over the travel.
const PLACES: usize = 12;
/// How much b is held likely to change between two coefficients, as a share of the force.
const WALK: f64 = 0.1;

impl Family for Wall {
    fn name(&self) -> &'static str {
        if self.side > 0.0 { "a wall above" } else { "a wall below" }
    }

    fn counts(&self) -> [usize; 3] {
        [self.count, 1, 1]
    }

    fn side(&self) -> f64 {
        self.side
    }

    fn likely(&self, facts: &Facts) -> [Likely; 3] {
        let force = likely_force(facts);
        let place = Likely { mean: facts.positions[1], level: 2.0 * facts.travel(), walk: facts.travel() };
        [Likely { walk: WALK * force.walk, ..force }, likely_stiffness(facts), place]
    }

    fn starts(&self, facts: &Facts) -> Vec<[f64; 2]> {
        let [low, _, high] = facts.positions;
        let place = |i: usize| low + (high - low) * (i as f64 + 0.5) / PLACES as f64;
        let place = |i: usize| if i == PLACES { if self.side > 0.0 { high } else { low } } else { place(i) };
        let of_place = |i| LADDER.into_iter().map(move |ratio| [place(i), ratio * facts.stiffness]);
        (0..=PLACES).flat_map(of_place).collect()
    }
}
