//! What learning leaves behind: its evaluations, why it ended, why it failed.

use crate::{Exhausted, Note, Pi2Error, Price, ShapeError};

/// The state of learning after one update, evaluated without noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Updates made: 0 before the first.
    pub update: usize,
    /// Motions made so far, evaluations included.
    pub rollouts: usize,
    /// Total cost of the noiseless evaluation.
    pub total: f64,
    /// The same by term, in the order of [`Problem::terms`].
    pub terms: Vec<f64>,
    /// Scale of the exploration in the batch that led here; at update 0, in the first batch.
    pub exploration: f64,
    /// The parameters evaluated.
    pub weights: Vec<f64>,
}

impl Progress {
    /// The same, known to cost `price`.
    pub(crate) fn priced(self, price: &Price) -> Self {
        Self { total: price.total, terms: price.terms.clone(), ..self }
    }
}

/// Why learning ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerminationReason {
    /// All updates were made.
    Updates,
    /// The next batch would have passed the rollouts allowed.
    Rollouts,
    /// It was asked for.
    Requested,
    /// The method found nothing more to do.
    Exhausted(Exhausted),
}

/// What a run of learning leaves behind.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// The evaluation of the starting parameters.
    pub initial: Progress,
    /// The evaluation with the lowest cost.
    pub best: Progress,
    /// Updates made.
    pub updates: usize,
    /// Motions made, evaluations included.
    pub rollouts: usize,
    /// Rollouts whose cost was not finite.
    pub rejected: usize,
    /// Why it ended.
    pub stop: TerminationReason,
    /// What the method found out on its way: a coupling, a fall-back.
    pub notes: Vec<Note>,
}

/// Why learning failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LearnError {
    /// The starting parameters already cost no finite amount.
    #[error("the starting policy has no finite cost")]
    BadStart,
    /// The start fails its motion, and so does everything that was tried near it.
    #[error("the starting policy has no finite cost, and neither has any of {tried} tried near it")]
    NoStart {
        /// Motions tried near the start.
        tried: usize,
    },
    /// No more motions can be made ([`Problem::is_stopped`]); the session was told nothing of the last ones.
    #[error("no more motions can be made")]
    Stopped,
    /// The method learns from signals, and the problem measures none.
    #[error("the problem measures no signals: learn it from its cost, with auto, pi2 or cma-es")]
    NoSignals,
    /// The method learns from motions, and the problem has no model that explains them.
    #[error("the problem has no model of its motions: learn it with auto, gauss-newton, pi2 or cma-es")]
    NoModel,
    /// The problem, its start or an answer does not fit together.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A [`Record`](crate::Record) that this problem and method cannot have led to.
    #[error("what was recorded does not belong to this problem and method")]
    WrongRecord,
    /// An update could not be made; what was learned before it is in `history`.
    #[error("{reason}")]
    Update {
        /// What went wrong.
        reason: Pi2Error,
        /// What was learned before.
        history: Box<History>,
    },
}
