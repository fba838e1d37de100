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
//! Without projection M_t is the identity: with `Credit::Total` an update is then the weighted mean of the samples.
//! Variants: weights in `weighting.rs`, exploration in `noise.rs`, its shape in `covariance.rs`.
//! Samples are brought within their bounds BEFORE the rollout, and eps is what remains of the step.
//!
//! Sources: Theodorou, Buchli, Schaal, JMLR 11:3137, 2010; the paper's Section 4 (doi 10.3390/s24123964), which
//! prints the full sum for S (`Credit::Total`) and exp(-S/lambda) with lambda unstated (`Temperature::Lambda`).

use rand::RngExt as _;
use rand_distr::StandardNormal;

use crate::noise::stream;
use crate::weighting::softmax;
use crate::{Anneal, Block, Cost, Covariance, Exploration, Parameters, Temperature};

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
    /// How its shape follows what was learned.
    pub covariance: Covariance,
    /// Whether a step moves the weights along its basis vector only (M_t), or as the rollouts went.
    pub is_projected: bool,
    /// The cheapest rollouts so far that take part in the next update again; needs costs that are not random.
    pub elites: usize,
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
            covariance: Covariance::Fixed,
            is_projected: true,
            elites: 0,
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

    /// PI-BB: every step answers for the whole rollout and nothing is projected, so an update is the weighted mean of
    /// the rollouts' parameters (Stulp, Sigaud, Paladyn 4:49, 2013, doi 10.2478/pjbr-2013-0003).
    pub fn black_box() -> Self {
        Self { credit: Credit::Total, is_projected: false, ..Self::default() }
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

    /// All numbers of rollout `k`.
    pub(crate) fn rows(&self, k: usize) -> &[f64] {
        let length = self.rows * self.count;
        &self.samples[k * length..(k + 1) * length]
    }

    /// Adds a sample of the same kind.
    pub(crate) fn push(&mut self, rows: &[f64]) {
        self.samples.extend(rows);
    }

    /// The parameters of rollout `k`.
    pub fn sample(&self, k: usize) -> Parameters<'_> {
        let rows = self.rows(k);
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
    /// Standard deviation of each parameter's exploration before annealing, as a fraction of its block's noise.
    spread: Vec<f64>,
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
    /// `(N-t) psi_{t,j} phi_{t,j} / sum_t (N-t) psi_{t,j}`, without phi_{t,j} where nothing is projected: steps x n.
    averaging: Vec<f64>,
}

impl BlockState {
    fn new(block: &Block, start: usize, steps: usize, is_projected: bool) -> Self {
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
                let phi = if is_projected { *phi } else { 1.0 };
                *a = if *sum > 0.0 { *a * phi / sum } else { 0.0 };
            }
        }
        Self { start, count: n, min: block.min, max: block.max, noise: block.noise, features, inverse_norm, averaging }
    }
}

impl BlockState {
    /// The basis function that is most active at step `t`.
    fn most_active(&self, t: usize) -> usize {
        let phi = &self.features[t * self.count..(t + 1) * self.count];
        (0..self.count).fold(0, |most, j| if phi[j] > phi[most] { j } else { most })
    }
}

impl Pi2 {
    /// A learner that starts from `weights`, all blocks one after the other, each row of the blocks' tables a step.
    pub fn new(blocks: &[Block], steps: usize, weights: Vec<f64>, options: Pi2Options) -> Self {
        let mut start = 0;
        let blocks = blocks
            .iter()
            .map(|block| {
                let state = BlockState::new(block, start, steps, options.is_projected);
                start += block.count;
                state
            })
            .collect();
        let spread = vec![1.0; weights.len()];
        Self { options, steps, blocks, weights, spread, update: 0 }
    }

    /// The parameters as learned so far.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Standard deviation of each parameter's exploration before annealing, as a fraction of its block's noise.
    pub fn spread(&self) -> &[f64] {
        &self.spread
    }

    /// The same learner with another spread, one number per parameter.
    #[must_use]
    pub fn with_spread(mut self, spread: Vec<f64>) -> Self {
        assert_eq!(spread.len(), self.weights.len(), "one number per parameter");
        self.spread = spread;
        self
    }

    /// Takes the place of a learner that had made `update` updates.
    pub(crate) fn restore(&mut self, update: usize, weights: &[f64], spread: &[f64]) {
        self.update = update;
        self.weights.copy_from_slice(weights);
        self.spread.copy_from_slice(spread);
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
            Exploration::Step | Exploration::Basis => self.steps,
        };
        let draws = if self.options.exploration == Exploration::Step { self.steps } else { 1 };
        let scale = self.exploration();
        let mut samples = Vec::with_capacity(self.options.rollouts * rows * count);
        for k in 0..self.options.rollouts {
            let mut generator = stream(self.options.seed, self.update, k);
            let first = samples.len();
            for _ in 0..draws {
                for block in &self.blocks {
                    let own = block.start..block.start + block.count;
                    for (weight, spread) in self.weights[own.clone()].iter().zip(&self.spread[own]) {
                        let normal: f64 = generator.sample(StandardNormal);
                        samples.push((weight + scale * block.noise * spread * normal).clamp(block.min, block.max));
                    }
                }
            }
            if self.options.exploration == Exploration::Basis {
                let drawn = samples.split_off(first);
                for t in 0..rows {
                    samples.extend(&self.weights);
                    let row = samples.len() - count;
                    for place in self.blocks.iter().map(|block| block.start + block.most_active(t)) {
                        samples[row + place] = drawn[place];
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
        if self.options.covariance != Covariance::Fixed {
            self.adapt(batch, costs, &kept);
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

    /// Lets the spread follow that of the rollouts that weigh.
    fn adapt(&mut self, batch: &Batch, costs: &[Cost], kept: &[usize]) {
        let mut shares: Vec<f64> = kept.iter().map(|&k| costs[k].total()).collect();
        softmax(&mut shares, self.options.temperature);
        let scale = self.exploration();
        for block in &self.blocks {
            for j in block.start..block.start + block.count {
                let unit = scale * block.noise;
                let mean_square = |k: usize| {
                    let drawn = (0..batch.rows).map(|t| batch.sample(k).at(t)[j] - self.weights[j]);
                    // Where only one basis at a time explores, the steps of the others say nothing.
                    let (sum, steps) =
                        drawn.filter(|eps| *eps != 0.0).fold((0.0, 0.0), |(s, n), e| (s + e * e, n + 1.0));
                    if steps > 0.0 { sum / (steps * unit * unit) } else { 0.0 }
                };
                if unit > 0.0 {
                    let weighted = kept.iter().zip(&shares).map(|(&k, share)| share * mean_square(k)).sum();
                    self.spread[j] = self.options.covariance.next(self.spread[j], weighted);
                }
            }
        }
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
        if !self.options.is_projected {
            for t in 0..self.steps {
                let averaging = &block.averaging[t * block.count..(t + 1) * block.count];
                for (column, &k) in kept.iter().enumerate() {
                    let share = probabilities[t * kept.len() + column];
                    let sample = &batch.sample(k).at(t)[block.start..block.start + block.count];
                    for (((change, a), sample), w) in change.iter_mut().zip(averaging).zip(sample).zip(weights) {
                        *change += a * share * (sample - w);
                    }
                }
            }
            return change;
        }
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
