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

mod bases;
mod group;
mod update;

use std::sync::Arc;

use hpf_core::Real as _;
use rand::RngExt as _;
use rand_distr::StandardNormal;
use rayon::prelude::*;

use crate::instructions::Instructions;
use crate::noise::stream;
use crate::weighting::{Pack, softmax};
use crate::{Anneal, Block, Cost, Covariance, Exploration, Parameters, ShapeError, Temperature, shape};
use bases::Bases;
use update::{Inputs, Scratch};

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
    /// Samples and costs that do not fit together.
    #[error(transparent)]
    Shape(#[from] ShapeError),
}

/// The samples of one update: K sets of parameters, or K x N where exploration is drawn at every step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    count: usize,
    rows: usize,
    samples: Vec<f64>,
}

impl Batch {
    /// Number of samples, K.
    pub fn len(&self) -> usize {
        self.samples.len().checked_div(self.rows * self.count).unwrap_or(0)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Whether a sample holds for all steps.
    pub(crate) fn is_constant(&self) -> bool {
        self.rows == 1
    }

    /// All numbers of rollout `k`.
    pub(crate) fn rows(&self, k: usize) -> &[f64] {
        let length = self.rows * self.count;
        &self.samples[k * length..(k + 1) * length]
    }

    /// The parameters of rollout `k`.
    pub fn sample(&self, k: usize) -> Parameters<'_> {
        parameters(self.rows(k), self.rows, self.count)
    }
}

/// A sample of so many rows of `count` numbers.
fn parameters(sample: &[f64], rows: usize, count: usize) -> Parameters<'_> {
    if rows == 1 { Parameters::Constant(sample) } else { Parameters::PerStep { rows: sample, count } }
}

/// The learner: parameters, and what an update needs of the basis.
#[derive(Clone, Debug)]
pub struct Pi2 {
    options: Pi2Options,
    steps: usize,
    blocks: Vec<BlockState>,
    /// Shared by all copies of the learner.
    bases: Arc<Bases>,
    weights: Vec<f64>,
    /// Standard deviation of each parameter's exploration before annealing, as a fraction of its block's noise.
    spread: Vec<f64>,
    update: usize,
    scratch: Scratch,
    instructions: Instructions,
}

#[derive(Clone, Debug)]
struct BlockState {
    start: usize,
    count: usize,
    min: f64,
    max: f64,
    noise: f64,
    /// The function that is most active at each step.
    most_active: Vec<usize>,
}

impl BlockState {
    fn new(block: &Block, start: usize, steps: usize) -> Self {
        let most = |phi: &[f64]| (0..phi.len()).fold(0, |most, j| if phi[j] > phi[most] { j } else { most });
        let most_active = block.features.chunks_exact(block.count).take(steps).map(most).collect();
        Self { start, count: block.count, min: block.min, max: block.max, noise: block.noise, most_active }
    }
}

impl Pi2 {
    /// A learner that starts from `weights`, all blocks one after the other, each row of the blocks' tables a step.
    ///
    /// # Errors
    /// [`ShapeError`] where they do not fit together.
    pub fn new(blocks: &[Block], steps: usize, weights: Vec<f64>, options: Pi2Options) -> Result<Self, ShapeError> {
        shape::check(blocks, steps, weights.len(), true)?;
        Ok(Self::checked(blocks, steps, weights, options))
    }

    /// The same of what is known to fit together.
    pub(crate) fn checked(blocks: &[Block], steps: usize, weights: Vec<f64>, options: Pi2Options) -> Self {
        let bases = Arc::new(Bases::new(blocks, steps, options.is_projected));
        let mut start = 0;
        let blocks = blocks
            .iter()
            .map(|block| {
                let state = BlockState::new(block, start, steps);
                start += block.count;
                state
            })
            .collect();
        let spread = vec![1.0; weights.len()];
        let (scratch, instructions) = (Scratch::default(), Instructions::best());
        Self { options, steps, blocks, bases, weights, spread, update: 0, scratch, instructions }
    }

    /// The same learner in the instructions that every processor has, for comparison: it is slower, and every number is
    /// the same.
    #[must_use]
    pub fn portable(mut self) -> Self {
        self.instructions = Instructions::portable();
        self
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
    ///
    /// # Errors
    /// [`ShapeError`] for another number of them.
    pub fn with_spread(self, spread: Vec<f64>) -> Result<Self, ShapeError> {
        shape::length("spread", spread.len(), self.weights.len())?;
        Ok(self.with_own_spread(spread))
    }

    /// The same of as many numbers as there are parameters.
    pub(crate) fn with_own_spread(mut self, spread: Vec<f64>) -> Self {
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
        let mut batch = Batch::default();
        self.ask_into(&mut batch);
        batch
    }

    /// Writes what [`Pi2::ask`] returns into `batch`, in the room that it has.
    pub fn ask_into(&self, batch: &mut Batch) {
        self.begin(batch);
        let length = batch.rows * batch.count;
        batch.samples.chunks_exact_mut(length).enumerate().for_each(|(k, sample)| self.draw(k, sample));
    }

    /// Makes room for the samples of the next update in `batch`; returns how many there are.
    pub(crate) fn begin(&self, batch: &mut Batch) -> usize {
        batch.count = self.weights.len();
        batch.rows = match self.options.exploration {
            Exploration::Rollout => 1,
            Exploration::Step | Exploration::Basis => self.steps,
        };
        batch.samples.resize(self.options.rollouts * batch.rows * batch.count, 0.0);
        self.options.rollouts
    }

    /// The samples of the next update in groups of `size`, each drawn by the thread that takes it.
    pub(crate) fn groups<'b>(
        &'b self,
        batch: &'b mut Batch,
        size: usize,
    ) -> impl IndexedParallelIterator<Item = Vec<Parameters<'b>>> {
        let (rows, count) = (batch.rows, batch.count);
        let length = rows * count;
        batch.samples.par_chunks_mut(size * length).enumerate().map(move |(group, samples)| {
            let draw = |(i, sample): (usize, &'b mut [f64])| {
                self.draw(group * size + i, sample);
                parameters(sample, rows, count)
            };
            samples.chunks_exact_mut(length).enumerate().map(draw).collect()
        })
    }

    /// Draws the parameters of rollout `k`.
    fn draw(&self, k: usize, sample: &mut [f64]) {
        let (count, scale) = (self.weights.len(), self.exploration());
        let mut generator = stream(self.options.seed, self.update, k);
        let drawn_rows = if self.options.exploration == Exploration::Step { self.steps } else { 1 };
        for row in sample.chunks_exact_mut(count).take(drawn_rows) {
            for block in &self.blocks {
                let own = block.start..block.start + block.count;
                let centers = self.weights[own.clone()].iter().zip(&self.spread[own.clone()]);
                for (slot, (weight, spread)) in row[own].iter_mut().zip(centers) {
                    let normal: f64 = generator.sample(StandardNormal);
                    *slot = (weight + scale * block.noise * spread * normal).clamp(block.min, block.max);
                }
            }
        }
        if self.options.exploration == Exploration::Basis {
            let (first, rest) = sample.split_at_mut(count);
            let places = |t: usize| self.blocks.iter().map(move |block| block.start + block.most_active[t]);
            for (t, row) in rest.chunks_exact_mut(count).enumerate() {
                row.copy_from_slice(&self.weights);
                places(t + 1).for_each(|place| row[place] = first[place]);
            }
            for (block, place) in self.blocks.iter().zip(places(0)) {
                let own = block.start..block.start + block.count;
                own.filter(|j| *j != place).for_each(|j| first[j] = self.weights[j]);
            }
        }
    }

    /// Improves the parameters by what the samples of [`Pi2::ask`] cost, one cost per sample in their order.
    /// Returns how many rollouts were rejected because their cost is not finite.
    ///
    /// # Errors
    /// [`Pi2Error::AllRejected`] where none is left, [`Pi2Error::Shape`] where samples and costs are not those of an
    /// update of this learner; the parameters stay as they are and the update is not counted.
    pub fn tell(&mut self, batch: &Batch, costs: &[Cost]) -> Result<usize, Pi2Error> {
        self.check(batch, costs)?;
        let Pi2Options { temperature, credit, .. } = self.options;
        let mut scratch = core::mem::take(&mut self.scratch);
        let inputs = Inputs {
            bases: &self.bases,
            steps: self.steps,
            temperature,
            credit,
            weights: &self.weights,
            batch,
            costs,
            instructions: self.instructions,
        };
        if !scratch.take(&inputs) {
            self.scratch = scratch;
            return Err(Pi2Error::AllRejected { update: self.update, rollouts: costs.len() });
        }
        let rejected = costs.len() - scratch.kept().count();
        scratch.improve(&inputs);
        if self.options.covariance != Covariance::Fixed {
            let kept: Vec<usize> = scratch.kept().collect();
            self.adapt(batch, costs, &kept);
        }
        for block in &self.blocks {
            let own = block.start..block.start + block.count;
            for (weight, change) in self.weights[own.clone()].iter_mut().zip(&scratch.changes()[own]) {
                *weight = (*weight + change).clamp(block.min, block.max);
            }
        }
        self.scratch = scratch;
        self.update += 1;
        Ok(rejected)
    }

    /// That `batch` is one of this learner, and that there is a cost of every step of each of its samples. A cost without
    /// steps is one of a total alone.
    fn check(&self, batch: &Batch, costs: &[Cost]) -> Result<(), ShapeError> {
        shape::length("parameters of a sample", batch.count, self.weights.len())?;
        shape::length("costs", costs.len(), batch.len())?;
        let mut of_steps = costs.iter().enumerate().filter(|(_, cost)| !cost.running.is_empty());
        of_steps.try_for_each(|(k, cost)| {
            shape::length(format_args!("steps of cost {k}"), cost.running.len().min(self.steps), self.steps)
        })
    }

    /// Lets the spread follow that of the rollouts that weigh.
    fn adapt(&mut self, batch: &Batch, costs: &[Cost], kept: &[usize]) {
        let totals: Vec<Pack> = kept.iter().map(|&k| Pack::of(costs[k].total())).collect();
        let shares = softmax(&totals, self.options.temperature);
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
                    let weighted = kept.iter().zip(&shares).map(|(&k, share)| share.0[0] * mean_square(k)).sum();
                    self.spread[j] = self.options.covariance.next(self.spread[j], weighted);
                }
            }
        }
    }
}
