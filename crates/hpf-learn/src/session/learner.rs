//! Learners that are told many numbers of a motion: signals, or the roots of the costs of its steps.

use crate::auto::FallBack;
use crate::squares::Squares;
use crate::{GaussNewton, Settled};

/// One of them, and where it learns from costs what comes after it.
#[derive(Clone, Debug)]
pub(super) enum Learner {
    /// Gauss-Newton on signals.
    Signals(GaussNewton),
    /// Gauss-Newton on the roots of costs.
    Roots(GaussNewton, FallBack),
    /// The squares of costs.
    Squares(Box<Squares>, FallBack),
}

impl Learner {
    /// The samples to roll out next.
    pub(super) fn ask(&self) -> &[Vec<f64>] {
        match self {
            Self::Signals(learner) | Self::Roots(learner, _) => learner.ask(),
            Self::Squares(learner, _) => learner.ask(),
        }
    }

    /// Takes what the first of them were told; returns how many were rejected.
    pub(super) fn tell(&mut self, told: &[Vec<f64>]) -> usize {
        match self {
            Self::Signals(learner) | Self::Roots(learner, _) => learner.tell(told),
            Self::Squares(learner, _) => learner.tell(told),
        }
    }

    /// Whether it is told signals, rather than the roots of costs.
    pub(super) fn wants_signals(&self) -> bool {
        matches!(self, Self::Signals(_))
    }

    /// How many numbers it is told of a sample.
    pub(super) fn count(&self) -> usize {
        match self {
            Self::Signals(learner) | Self::Roots(learner, _) => learner.signals(),
            Self::Squares(learner, _) => learner.costs(),
        }
    }

    pub(super) fn update(&self) -> usize {
        match self {
            Self::Signals(learner) | Self::Roots(learner, _) => learner.update(),
            Self::Squares(learner, _) => learner.update(),
        }
    }

    pub(super) fn reach(&self) -> f64 {
        match self {
            Self::Signals(learner) | Self::Roots(learner, _) => learner.reach(),
            Self::Squares(learner, _) => learner.reach(),
        }
    }

    pub(super) fn settled(&self) -> Option<Settled> {
        match self {
            Self::Signals(learner) | Self::Roots(learner, _) => learner.settled(),
            Self::Squares(learner, _) => learner.settled(),
        }
    }

    pub(super) fn is_coupled(&self) -> bool {
        match self {
            Self::Signals(learner) | Self::Roots(learner, _) => learner.is_coupled(),
            Self::Squares(..) => false,
        }
    }
}
