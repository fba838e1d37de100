//! Learning without settings: signals where a problem has them, else the costs of its steps, else PI2.
//!
//! 1. **Signals**: [`GaussNewton`] on them.
//! 2. **Costs**, where no step's cost is negative: [`GaussNewton`] on their roots, `nu_t = sqrt(2 r_t)`, for then
//!    `J = 1/2 |nu|^2`. A root has lost the sign of its signal and its response has a kink at zero, so this comes
//!    near the optimum fast and may stall there.
//! 3. **Squares**, where rollouts repeat: what the costs of the steps are the squares of is found out from how these
//!    bend, and learned from ([`Squares`]). They have no kink, and what stalled before goes on.
//! 4. **PI2** from the best so far, on total costs by rank, each parameter's noise set from what its response was found
//!    to be (the step at which all parameters together are expected to double the cost), then adapted.
//!
//! A stage that ends hands over what it has learned, and a [`Note`] says why. Motions without noise at every step are
//! all evaluations: nothing is rolled out twice to know what it cost.

use crate::step_costs::StepCostLearner;
use crate::{
    Anneal, Block, Cost, Covariance, Exhausted, GaussNewton, GaussNewtonOptions, Pi2, Pi2Options, SignalGroup,
    SignalModel, Temperature,
};

/// Least and largest standard deviation that PI2 adapts to, as a fraction of a block's noise.
const NOISE_RANGE: (f64, f64) = (1e-4, 1.0);
/// PI2 ends when this many updates in a row bring no motion cheaper by [`LEAST_GAIN`].
const PATIENCE: usize = 40;
/// A smaller share of the cost is no gain.
const LEAST_GAIN: f64 = 1e-3;

/// Settings of learning without settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AutoOptions {
    /// Most rollouts made at a time; rollouts of an update of PI2.
    pub rollouts: usize,
    /// Most updates.
    pub updates: usize,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl AutoOptions {
    /// The same for learning from signals.
    pub(crate) fn signals(self) -> GaussNewtonOptions {
        GaussNewtonOptions { rollouts: self.rollouts, updates: self.updates, seed: self.seed }
    }
}

/// Something found out on the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Note {
    /// One group of parameters moves the signals of another: all are learned together.
    Coupled,
    /// The model of the environment ended: learning from signals goes on.
    Signals(Exhausted),
    /// The problem measures no signals: the costs of its steps stand in for them.
    NoSignals,
    /// The roots of the costs of the steps ended: the squares that they are made of go on.
    StepCosts(Exhausted),
    /// Signals, or the costs of the steps, ended: PI2 goes on.
    FellBack(Exhausted),
    /// A step has a negative cost, which has no root: PI2 goes on.
    NegativeCosts,
    /// The start failed its motion: learning began at a motion near it, after so many.
    Sought(usize),
    /// The motions allowed were made before the first update: what is returned is the start.
    TooFew,
}

impl core::fmt::Display for Note {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Coupled => f.write_str("groups of parameters move each other's signals: all are learned together"),
            Self::Signals(reason) => write!(f, "learning from signals goes on from the model: {reason}"),
            Self::NoSignals => f.write_str("the problem measures no signals: learning from the costs of its steps"),
            Self::StepCosts(reason) => {
                write!(f, "the squares that the costs of the steps are made of go on from their roots: {reason}")
            }
            Self::FellBack(reason) => write!(f, "pi2 goes on: {reason}"),
            Self::Sought(motions) => {
                write!(f, "the start failed its motion: learning began at the first near it that did not, of {motions}")
            }
            Self::TooFew => f.write_str(
                "nothing was learned: the motions allowed were made before the first update, raise max_rollouts",
            ),
            Self::NegativeCosts => f.write_str("pi2 from here on: a step has a negative cost, which has no root"),
        }
    }
}

/// A learner on the roots of the costs of `steps` steps.
pub(crate) fn on_roots(blocks: &[Block], steps: usize, weights: Vec<f64>, options: AutoOptions) -> GaussNewton {
    let whole = SignalGroup { parameters: 0..weights.len(), signals: 0..steps + 1 };
    let model = SignalModel { groups: vec![whole], price: vec![Vec::new(); blocks.len()], distances: Vec::new() };
    GaussNewton::new(blocks, &model, weights, options.signals()).without_shrinking()
}

/// `nu_t = sqrt(2 r_t)` of every step and of the end.
pub(crate) fn roots(cost: &Cost) -> Vec<f64> {
    cost.running.iter().chain([&cost.terminal]).map(|cost| (2.0 * cost).sqrt()).collect()
}

/// What PI2 needs where the costs of the steps have ended.
#[derive(Clone, Debug)]
pub(crate) struct FallBack {
    pub(crate) blocks: Vec<Block>,
    pub(crate) steps: usize,
    pub(crate) options: AutoOptions,
}

impl FallBack {
    /// A learner on the squares of the costs, from `weights`.
    pub(crate) fn step_costs(&self, weights: Vec<f64>) -> StepCostLearner {
        StepCostLearner::new(&self.blocks, self.steps + 1, weights, self.options.signals())
    }

    /// PI2 from `weights`, with noise of the size that the responses found call for: `scales`, one per parameter.
    pub(crate) fn polish(&self, scales: Vec<f64>, weights: Vec<f64>) -> Pi2 {
        let (floor, ceiling) = NOISE_RANGE;
        let noise = self.blocks.iter().flat_map(|block| vec![block.noise; block.count]);
        let share = |(scale, noise): (f64, f64)| if scale > 0.0 { (scale / noise).max(floor) } else { ceiling };
        let spread = scales.into_iter().zip(noise).map(share).collect();
        let options = Pi2Options {
            rollouts: self.options.rollouts,
            updates: self.options.updates,
            temperature: Temperature::Rank,
            anneal: Anneal::None,
            covariance: Covariance::Diagonal { floor, ceiling },
            seed: self.options.seed,
            ..Pi2Options::black_box()
        };
        Pi2::checked(&self.blocks, self.steps, weights, options).with_own_spread(spread)
    }
}

/// How long updates may bring nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Patience {
    mark: f64,
    since: usize,
}

impl Patience {
    /// From a cost of `mark` on, before any update.
    pub(crate) fn new(mark: f64) -> Self {
        Self { mark, since: 0 }
    }

    /// Whether it is at an end after `update` updates, with a lowest cost of `best`.
    pub(crate) fn count(&mut self, update: usize, best: f64) -> bool {
        if self.mark - best > LEAST_GAIN * self.mark.abs() {
            *self = Self { mark: best, since: update };
        }
        update - self.since >= PATIENCE
    }
}
