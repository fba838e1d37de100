//! Exploration: what is added to the parameters, and how it shrinks over a run.

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

/// When a rollout draws new exploration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exploration {
    /// Once per rollout: smooth motion, safe on hardware.
    Rollout,
    /// Once per rollout, and at each step only the parameter of the most active basis function explores.
    Basis,
    /// Anew at every step, as the paper does: it averages out, and needs about four times the scale.
    Step,
}

/// How the exploration shrinks over a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anneal {
    /// The same scale throughout.
    None,
    /// From 1 to `last`, in equal differences.
    Linear {
        /// Scale at the last update.
        last: f64,
    },
    /// From 1 to `last`, in equal ratios.
    Geometric {
        /// Scale at the last update.
        last: f64,
    },
}

impl Anneal {
    /// The scale of the exploration at `update` (from 0) of `updates`.
    pub fn scale(&self, update: usize, updates: usize) -> f64 {
        let done = if updates > 1 { update as f64 / (updates - 1) as f64 } else { 0.0 };
        match *self {
            Self::None => 1.0,
            Self::Linear { last } => 1.0 + (last - 1.0) * done,
            Self::Geometric { last } => libm::pow(last, done),
        }
    }
}

/// The random numbers of one rollout: one stream per (seed, update, rollout), whatever thread draws from it.
pub(crate) fn stream(seed: u64, update: usize, rollout: usize) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(((update as u64) << 24) | rollout as u64);
    generator
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_run_from_one_to_last() {
        for anneal in [Anneal::Linear { last: 0.1 }, Anneal::Geometric { last: 0.1 }] {
            assert_eq!(anneal.scale(0, 600), 1.0);
            assert!((anneal.scale(599, 600) - 0.1).abs() < 1e-15);
        }
        assert_eq!(Anneal::Linear { last: 0.1 }.scale(0, 1), 1.0);
        assert!((Anneal::Geometric { last: 0.01 }.scale(1, 3) - 0.1).abs() < 1e-15);
    }
}
