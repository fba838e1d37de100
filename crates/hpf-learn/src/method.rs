//! The ways to learn, each with its options.

use crate::{AutoOptions, CmaEsOptions, GaussNewtonOptions, Pi2Options};

/// A way to learn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Policy improvement with path integrals.
    Pi2(Pi2Options),
    /// Gauss-Newton on the signals of a problem that has them.
    GaussNewton(GaussNewtonOptions),
    /// Signals where there are any, else costs; nothing to set.
    Auto(AutoOptions),
    /// Evolution by covariance matrix adaptation, on total costs.
    CmaEs(CmaEsOptions),
    /// A model of the environment, fitted to the motions made.
    Model(AutoOptions),
}

impl Method {
    /// Updates made at most.
    pub fn updates(&self) -> usize {
        match self {
            Self::Pi2(options) => options.updates,
            Self::GaussNewton(options) => options.updates,
            Self::Auto(options) => options.updates,
            Self::CmaEs(options) => options.updates,
            Self::Model(options) => options.updates,
        }
    }

    /// The seed of all random numbers.
    pub fn seed(&self) -> u64 {
        match self {
            Self::Pi2(options) => options.seed,
            Self::GaussNewton(options) => options.seed,
            Self::Auto(options) => options.seed,
            Self::CmaEs(options) => options.seed,
            Self::Model(options) => options.seed,
        }
    }

    /// Rollouts made at a time.
    pub fn rollouts(&self) -> usize {
        match self {
            Self::Pi2(options) => options.rollouts,
            Self::GaussNewton(options) => options.rollouts,
            Self::Auto(options) => options.rollouts,
            Self::CmaEs(options) => options.rollouts,
            Self::Model(options) => options.rollouts,
        }
    }
}
