//! A force that does not depend on the tool: `f = b(t)`.

use super::family::{Facts, Family, Likely, likely_force, likely_stiffness};

/// `f = b(t)`.
#[derive(Debug)]
pub(super) struct Zero {
    /// Coefficients of b.
    pub(super) count: usize,
}

impl Family for Zero {
    fn name(&self) -> &'static str {
        "a force over time"
    }

    fn counts(&self) -> [usize; 3] {
        [self.count, 0, 0]
    }

    fn likely(&self, facts: &Facts) -> [Likely; 3] {
        [likely_force(facts), likely_stiffness(facts), likely_force(facts)]
    }

    fn starts(&self, _: &Facts) -> Vec<[f64; 2]> {
        vec![[0.0, 0.0]]
    }
}
