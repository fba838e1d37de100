//! Elites: the cheapest rollouts so far, which take part in the next update of PI2 again.
//!
//! What they say is how far they are from the parameters as they are then, so nothing has to be corrected; what they cost
//! must still be true, which it is not where a cost is random.
//!
//! After Theodorou, Buchli, Schaal, JMLR 11:3137, 2010.

use serde::{Deserialize, Serialize};

use crate::{Batch, Cost};

/// A rollout that takes part again.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Elite {
    /// Its parameters: one set, or one per step.
    pub sample: Vec<f64>,
    /// What each of its steps cost.
    pub running: Vec<f64>,
    /// What its end cost.
    pub terminal: f64,
}

impl Elite {
    fn cost(&self) -> Cost {
        Cost { running: self.running.clone(), terminal: self.terminal, terms: Vec::new() }
    }
}

/// `batch` with its costs, and the elites after them.
pub(crate) fn join(elites: &[Elite], batch: &Batch, costs: &[Cost]) -> (Batch, Vec<Cost>) {
    let mut joined = batch.clone();
    elites.iter().for_each(|elite| joined.push(&elite.sample));
    (joined, costs.iter().cloned().chain(elites.iter().map(Elite::cost)).collect())
}

/// The `count` cheapest rollouts, the cheapest first.
pub(crate) fn choose(count: usize, batch: &Batch, costs: &[Cost]) -> Vec<Elite> {
    let mut order: Vec<usize> = (0..costs.len()).filter(|&k| costs[k].total().is_finite()).collect();
    order.sort_by(|&a, &b| costs[a].total().total_cmp(&costs[b].total()));
    let elite = |&k: &usize| Elite {
        sample: batch.rows(k).to_vec(),
        running: costs[k].running.clone(),
        terminal: costs[k].terminal,
    };
    order.iter().take(count).map(elite).collect()
}
