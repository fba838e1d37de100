//! Learners that are told many numbers of a motion: signals, or the roots of the costs of its steps.

use crate::auto::FallBack;
use crate::step_costs::StepCostLearner;
use crate::{Exhausted, GaussNewton};

/// One of them, and where it learns from costs what comes after it.
#[derive(Clone, Debug)]
pub(super) enum Learner {
    /// Gauss-Newton on signals.
    Signals(GaussNewton, Option<FallBack>),
    /// Gauss-Newton on the roots of costs.
    Roots(GaussNewton, FallBack),
    /// The squares of costs.
    StepCosts(Box<StepCostLearner>, FallBack),
}

/// The same of each.
macro_rules! each {
    ($self:ident, $learner:ident => $result:expr) => {
        match $self {
            Self::Signals($learner, _) | Self::Roots($learner, _) => $result,
            Self::StepCosts($learner, _) => $result,
        }
    };
}

impl Learner {
    /// The samples to roll out next.
    pub(super) fn ask(&self) -> &[Vec<f64>] {
        each!(self, learner => learner.ask())
    }

    /// Takes what the first of them were told; returns how many were rejected.
    pub(super) fn tell(&mut self, told: &[Vec<f64>]) -> usize {
        each!(self, learner => learner.tell(told))
    }

    /// How many numbers it is told of a sample.
    pub(super) fn signals(&self) -> usize {
        each!(self, learner => learner.signals())
    }

    pub(super) fn update(&self) -> usize {
        each!(self, learner => learner.update())
    }

    pub(super) fn reach(&self) -> f64 {
        each!(self, learner => learner.reach())
    }

    pub(super) fn exhausted(&self) -> Option<Exhausted> {
        each!(self, learner => learner.exhausted())
    }

    /// Whether it is told signals, rather than the roots of costs.
    pub(super) fn wants_signals(&self) -> bool {
        matches!(self, Self::Signals(..))
    }

    pub(super) fn is_coupled(&self) -> bool {
        match self {
            Self::Signals(learner, _) | Self::Roots(learner, _) => learner.is_coupled(),
            Self::StepCosts(..) => false,
        }
    }
}
