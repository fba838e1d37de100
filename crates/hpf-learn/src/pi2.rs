//! Policy improvement with path integrals (PI2), as ask and tell.
//!
//! With K rollouts of `w + eps_k`, N steps, and g_t the basis vector of a block at step t:
//! ```text
//! S_{t,k}  = phi_k + sum_{j>=t} r_{j,k}                              cost to go (Credit::ToGo)
//! P_{t,k}  = softmax_k( -h (S_{t,k} - min_k S)/(max_k S - min_k S) )   (Temperature::Range)
//! dw_t     = sum_k P_{t,k} M_t eps_k,   M_t = g_t g_t^T/(g_t^T g_t)
//! [dw]_j   = sum_t (N-t) psi_{t,j} [dw_t]_j / sum_t (N-t) psi_{t,j},   w <- w + dw, kept in its bounds
//! ```
//! M_t does not change with the length of g_t, so the features phi stand for g of a movement (s A phi) too.
//! Samples are brought within their bounds BEFORE the rollout, and eps is what remains of the step.
//!
//! Sources: Theodorou, Buchli, Schaal, JMLR 11:3137, 2010; the paper's Section 4 (doi 10.3390/s24123964), which
//! prints the full sum for S (`Credit::Total`) and exp(-S/lambda) with lambda unstated (`Temperature::Lambda`).

use rand::RngExt as _;
use rand_distr::StandardNormal;

use crate::noise::stream;
use crate::{Anneal, Block, Cost, Exploration, Parameters};

/// How costs become weights of the rollouts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Temperature {
    /// `softmax(-h (S - min)/(max - min))`: the same for any scale of the cost.
    Range(f64),
    /// `softmax(-S/lambda)`, lambda in the unit of the cost.
    Lambda(f64),
}

/// Which cost a step answers for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Credit {
    /// What comes after it.
    ToGo,
    /// The whole rollout's.
    Total,
}

/// Settings of PI2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pi2Options {
    /// Rollouts per update, K.
    pub rollouts: usize,
    /// Planned updates: what the annealing runs over.
    pub updates: usize,
    /// How costs become weights.
    pub temperature: Temperature,
    /// Which cost a step answers for.
    pub credit: Credit,
    /// When exploration is drawn.
    pub exploration: Exploration,
    /// How it shrinks.
    pub anneal: Anneal,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for Pi2Options {
    /// The canonical method: range h = 10, cost to go, one draw per rollout, annealed linearly to 0.1.
    fn default() -> Self {
        Self {
            rollouts: 20,
            updates: 100,
            temperature: Temperature::Range(10.0),
            credit: Credit::ToGo,
            exploration: Exploration::Rollout,
            anneal: Anneal::Linear { last: 0.1 },
            seed: 1,
        }
    }
}

impl Pi2Options {
    /// The paper's reading: noise at every step, a fixed lambda, every step answering for the whole rollout.
    pub fn paper(lambda: f64) -> Self {
        Self {
            temperature: Temperature::Lambda(lambda),
            credit: Credit::Total,
            exploration: Exploration::Step,
            ..Self::default()
        }
    }
}

/// Why an update could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Pi2Error {
    /// No rollout of the batch has a finite cost; the parameters are unchanged.
    #[error("none of the {rollouts} rollouts of update {update} has a finite cost")]
    AllRejected {
        /// The update, from 0.
        update: usize,
        /// Rollouts in its batch.
        rollouts: usize,
    },
}

/// The samples of one update: K sets of parameters, or K x N where exploration is drawn at every step.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    count: usize,
    rows: usize,
    samples: Vec<f64>,
}

impl Batch {
    /// Number of samples, K.
    pub fn len(&self) -> usize {
        self.samples.len() / (self.rows * self.count)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// The parameters of rollout `k`.
    pub fn sample(&self, k: usize) -> Parameters<'_> {
        let length = self.rows * self.count;
        let rows = &self.samples[k * length..(k + 1) * length];
        if self.rows == 1 { Parameters::Constant(rows) } else { Parameters::PerStep { rows, count: self.count } }
    }
}

/// The learner: parameters, and what an update needs of the basis.
#[derive(Clone, Debug)]
pub struct Pi2 {
    options: Pi2Options,
    steps: usize,
    blocks: Vec<BlockState>,
    weights: Vec<f64>,
    update: usize,
}

#[derive(Clone, Debug)]
struct BlockState {
    start: usize,
    count: usize,
    min: f64,
    max: f64,
    noise: f64,
    features: Vec<f64>,
    /// `1/(phi_t^T phi_t)` per step.
    inverse_norm: Vec<f64>,
    /// `(N-t) psi_{t,j} phi_{t,j} / sum_t (N-t) psi_{t,j}`: steps x n.
    averaging: Vec<f64>,
}

impl BlockState {
    fn new(block: &Block, start: usize, steps: usize) -> Self {
        let n = block.count;
        let rows = |table: &[f64]| -> Vec<f64> { table[..steps * n].to_vec() };
        let features = rows(&block.features);
        let inverse_norm = features.chunks_exact(n).map(|row| 1.0 / row.iter().map(|x| x * x).sum::<f64>()).collect();
        let mut averaging = rows(&block.activations);
        let mut sums = vec![0.0; n];
        for (t, row) in averaging.chunks_exact_mut(n).enumerate() {
            for (psi, sum) in row.iter_mut().zip(&mut sums) {
                *psi *= (steps - t) as f64;
                *sum += *psi;
            }
        }
        for (row, phi) in averaging.chunks_exact_mut(n).zip(features.chunks_exact(n)) {
            for ((a, sum), phi) in row.iter_mut().zip(&sums).zip(phi) {
                // A function too narrow to be seen at any step has nothing to learn from.
                *a = if *sum > 0.0 { *a * phi / sum } else { 0.0 };
            }
        }
        Self { start, count: n, min: block.min, max: block.max, noise: block.noise, features, inverse_norm, averaging }
    }
}

impl Pi2 {
    /// A learner that starts from `weights`, all blocks one after the other, each row of the blocks' tables a step.
    pub fn new(blocks: &[Block], steps: usize, weights: Vec<f64>, options: Pi2Options) -> Self {
        let mut start = 0;
        let blocks = blocks
            .iter()
            .map(|block| {
                let state = BlockState::new(block, start, steps);
                start += block.count;
                state
            })
            .collect();
        Self { options, steps, blocks, weights, update: 0 }
    }

    /// The parameters as learned so far.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Updates made so far.
    pub fn update(&self) -> usize {
        self.update
    }

    /// The scale of the exploration in the next batch, 1 at the start.
    pub fn exploration(&self) -> f64 {
        self.options.anneal.scale(self.update, self.options.updates)
    }

    /// The samples of the next update. The same for the same seed and update, however often asked.
    pub fn ask(&self) -> Batch {
        let count = self.weights.len();
        let rows = match self.options.exploration {
            Exploration::Rollout => 1,
            Exploration::Step => self.steps,
        };
        let scale = self.exploration();
        let mut samples = Vec::with_capacity(self.options.rollouts * rows * count);
        for k in 0..self.options.rollouts {
            let mut generator = stream(self.options.seed, self.update, k);
            for _ in 0..rows {
                for block in &self.blocks {
                    for &weight in &self.weights[block.start..block.start + block.count] {
                        let normal: f64 = generator.sample(StandardNormal);
                        samples.push((weight + scale * block.noise * normal).clamp(block.min, block.max));
                    }
                }
            }
        }
        Batch { count, rows, samples }
    }

    /// Improves the parameters by what the samples of [`Pi2::ask`] cost, one cost per sample in their order.
    /// Returns how many rollouts were rejected because their cost is not finite.
    ///
    /// # Errors
    /// [`Pi2Error::AllRejected`] where none is left; the parameters stay as they are and the update is not counted.
    pub fn tell(&mut self, batch: &Batch, costs: &[Cost]) -> Result<usize, Pi2Error> {
        let kept: Vec<usize> = (0..costs.len()).filter(|&k| is_finite(&costs[k])).collect();
        let rejected = costs.len() - kept.len();
        if kept.is_empty() {
            return Err(Pi2Error::AllRejected { update: self.update, rollouts: costs.len() });
        }
        let probabilities = self.probabilities(costs, &kept);
        let mut changes = Vec::with_capacity(self.weights.len());
        for block in &self.blocks {
            changes.extend(self.change(block, batch, &kept, &probabilities));
        }
        let mut changes = changes.into_iter();
        for block in &self.blocks {
            for weight in &mut self.weights[block.start..block.start + block.count] {
                let change = changes.next().expect("one change per weight");
                *weight = (*weight + change).clamp(block.min, block.max);
            }
        }
        self.update += 1;
        Ok(rejected)
    }

    /// P_{t,k}: steps x kept rollouts.
    fn probabilities(&self, costs: &[Cost], kept: &[usize]) -> Vec<f64> {
        let width = kept.len();
        let mut table = vec![0.0; self.steps * width];
        for (column, &k) in kept.iter().enumerate() {
            let mut to_go = costs[k].terminal;
            for t in (0..self.steps).rev() {
                to_go += costs[k].running[t];
                table[t * width + column] = to_go;
            }
            if self.options.credit == Credit::Total {
                (0..self.steps).for_each(|t| table[t * width + column] = to_go);
            }
        }
        for row in table.chunks_exact_mut(width) {
            softmax(row, self.options.temperature);
        }
        table
    }

    /// The change of one block's weights.
    fn change(&self, block: &BlockState, batch: &Batch, kept: &[usize], probabilities: &[f64]) -> Vec<f64> {
        let weights = &self.weights[block.start..block.start + block.count];
        let mut change = vec![0.0; block.count];
        for t in 0..self.steps {
            let phi = &block.features[t * block.count..(t + 1) * block.count];
            let mut along = 0.0;
            for (column, &k) in kept.iter().enumerate() {
                let sample = &batch.sample(k).at(t)[block.start..block.start + block.count];
                let projected: f64 = phi.iter().zip(sample).zip(weights).map(|((phi, s), w)| phi * (s - w)).sum();
                along += probabilities[t * kept.len() + column] * projected;
            }
            along *= block.inverse_norm[t];
            let averaging = &block.averaging[t * block.count..(t + 1) * block.count];
            for (change, a) in change.iter_mut().zip(averaging) {
                *change += a * along;
            }
        }
        change
    }
}

/// Whether the cost to go of every step is finite: the sums that the weights are made of.
fn is_finite(cost: &Cost) -> bool {
    let mut to_go = cost.terminal;
    cost.running.iter().rev().all(|cost| {
        to_go += cost;
        to_go.is_finite()
    }) && to_go.is_finite()
}

/// Turns costs into weights that sum to one; equal costs get equal weights.
fn softmax(costs: &mut [f64], temperature: Temperature) {
    let min = costs.iter().copied().fold(f64::INFINITY, f64::min);
    let max = costs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Halves, because a difference of two finite costs may be infinite.
    let half_range = 0.5 * max - 0.5 * min;
    let (sharpness, half_unit) = match temperature {
        Temperature::Range(h) if half_range > 0.0 => (h, half_range),
        Temperature::Range(_) => (0.0, 1.0),
        Temperature::Lambda(lambda) => (1.0, 0.5 * lambda),
    };
    let mut sum = 0.0;
    for cost in costs.iter_mut() {
        *cost = libm::exp(-sharpness * ((0.5 * *cost - 0.5 * min) / half_unit));
        sum += *cost;
    }
    costs.iter_mut().for_each(|weight| *weight /= sum);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_costs_get_equal_weights() {
        let mut costs = [3.0; 4];
        softmax(&mut costs, Temperature::Range(10.0));
        assert_eq!(costs, [0.25; 4]);
    }

    #[test]
    fn range_weights_do_not_change_with_the_unit_of_the_cost() {
        let (mut euros, mut cents) = ([1.0, 2.0, 4.0], [100.0, 200.0, 400.0]);
        softmax(&mut euros, Temperature::Range(10.0));
        softmax(&mut cents, Temperature::Range(10.0));
        for (a, b) in euros.iter().zip(cents) {
            assert!((a - b).abs() < 1e-15);
        }
    }

    #[test]
    fn differences_beyond_the_largest_number_are_still_ranked() {
        let mut costs = [-1e308, 0.0, 1e308];
        softmax(&mut costs, Temperature::Range(10.0));
        assert!(costs.iter().all(|weight| weight.is_finite()), "{costs:?}");
    }
}
