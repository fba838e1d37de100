//! What a session was told, as plain data: told again in the same order, it leads to the same state, to the bit.

use serde::{Deserialize, Serialize};

use crate::Cost;

/// What a motion cost, all steps together.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Price {
    /// The total.
    pub total: f64,
    /// The same by term.
    pub terms: Vec<f64>,
}

impl From<&Cost> for Price {
    fn from(cost: &Cost) -> Self {
        Self { total: cost.total(), terms: cost.terms.clone() }
    }
}

/// One answer to [`Session::ask`](crate::Session::ask), in what the method keeps of it.
///
/// PI2 would need the cost of every step of every rollout, and leaves a few hundred numbers: these are kept. Methods
/// with a large state, a response or a covariance, need few numbers of a rollout: those are kept, and the state is made
/// from them again.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub enum Record {
    /// What motions cost: evaluations, samples of a method that asks for no more.
    Costs(Vec<Price>),
    /// The same with what they measured, a vector per motion.
    Signals {
        /// What they cost.
        prices: Vec<Price>,
        /// What they measured.
        signals: Vec<Vec<f64>>,
    },
    /// Where an update of PI2 led.
    Update {
        /// Updates that the learner has made.
        update: usize,
        /// Its parameters.
        weights: Vec<f64>,
        /// Its spread.
        spread: Vec<f64>,
        /// Scale of the exploration that led here.
        exploration: f64,
        /// Rollouts without a finite cost.
        rejected: usize,
        /// The cheapest sample, where samples are evaluations.
        cheapest: Option<(Vec<f64>, Price)>,
    },
}
