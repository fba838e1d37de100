//! Learning from a model of what moves: fitted to the motions made, asked for the best motion, told what came of it.
//!
//! 1. The start is made.
//! 2. The model learns from each motion, and proposes the one that it expects to be cheapest within a radius of the
//!    cheapest so far. That one is made.
//! 3. The radius doubles when a motion was cheaper than all before it, and is cut when it was not.
//! 4. Where the model expects next to no gain, or several motions in a row brought none, learning from it ends.
//!
//! No motion is random: each one is the model's best. What the model is made of, whoever knows the law of the motion
//! says: [`Model`].

use core::fmt::Debug;

use crate::Exhausted;

/// A motion that a model proposes.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// Its parameters.
    pub weights: Vec<f64>,
    /// What the model expects it to cost.
    pub expected: f64,
    /// What the model expects the motion that it starts from to cost.
    pub before: f64,
    /// How far it goes from there, in the model's own scale.
    pub length: f64,
}

/// What predicts motions and is fitted to those made. It is a function of what it was told, to the bit.
pub trait Model: Debug + Send + Sync {
    /// Numbers that a motion shows, over all its draws.
    fn shown(&self) -> usize;

    /// Learns from what a motion with `weights` showed. False where the model cannot explain what it has seen.
    fn learn(&mut self, weights: &[f64], motion: &[f64]) -> bool;

    /// The cheapest motion expected within `radius` of `anchor`; `None` where there is none that may be made.
    fn propose(&mut self, anchor: &[f64], radius: f64) -> Option<Proposal>;

    /// What the model takes the environment for, in words.
    fn explanation(&self) -> String;

    /// A copy.
    fn boxed(&self) -> Box<dyn Model>;
}

impl Clone for Box<dyn Model> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}

/// Radius of the first proposal, in the model's scale.
const FIRST_RADIUS: f64 = 128.0;
const LARGEST_RADIUS: f64 = 1e6;
/// Change of the radius when a motion was the cheapest so far.
const AFTER_SUCCESS: f64 = 2.0;
/// Share of the way of a motion that was not, which is the next radius.
const AFTER_FAILURE: f64 = 0.4;
/// A smaller share of the cost is no gain.
const LEAST_GAIN: f64 = 1e-3;
/// Motions in a row that may be expected to gain nothing: they still tell what the noise is.
const MOST_QUIET: usize = 2;
/// Motions in a row that may bring no gain.
const MOST_FAILURES: usize = 6;

/// The learner.
#[derive(Clone, Debug)]
pub struct ModelLearner {
    model: Box<dyn Model>,
    radius: f64,
    best: Option<(Vec<f64>, f64)>,
    queue: Vec<Vec<f64>>,
    length: f64,
    made: usize,
    update: usize,
    quiet: usize,
    failures: usize,
    exhausted: Option<Exhausted>,
}

impl ModelLearner {
    /// A learner that starts from `weights`.
    pub fn new(model: Box<dyn Model>, weights: Vec<f64>) -> Self {
        Self {
            model,
            radius: FIRST_RADIUS,
            best: None,
            queue: vec![weights],
            length: 0.0,
            made: 0,
            update: 0,
            quiet: 0,
            failures: 0,
            exhausted: None,
        }
    }

    /// The motion to make next: one, or none once learning has settled.
    pub fn ask(&self) -> &[Vec<f64>] {
        &self.queue
    }

    /// Takes what the motion of [`ModelLearner::ask`] cost and showed. Returns how many were rejected because a number
    /// is not finite.
    pub fn tell(&mut self, cost: f64, motion: &[f64]) -> usize {
        let Some(weights) = self.queue.pop() else { return 0 };
        let is_finite = cost.is_finite() && motion.iter().all(|number| number.is_finite());
        let is_first = self.best.is_none();
        self.made += 1;
        self.update += usize::from(!is_first);
        let before = self.best.as_ref().map_or(f64::INFINITY, |best| best.1);
        let gain = if is_finite { before - cost } else { f64::NEG_INFINITY };
        if gain > 0.0 {
            self.best = Some((weights.clone(), cost));
        }
        if !is_first {
            if gain > 0.0 {
                self.radius = (AFTER_SUCCESS * self.radius).min(LARGEST_RADIUS);
            } else {
                self.radius = AFTER_FAILURE * self.length;
            }
            self.failures = if gain > LEAST_GAIN * before.abs() { 0 } else { self.failures + 1 };
        }
        let explains = !is_finite || self.model.learn(&weights, motion);
        let Some((anchor, _)) = &self.best else {
            self.exhausted = Some(Exhausted::NoSignals);
            return usize::from(!is_finite);
        };
        match self.model.propose(anchor, self.radius) {
            _ if !explains => self.exhausted = Some(Exhausted::Unexplained),
            None => self.exhausted = Some(Exhausted::NothingSafe),
            Some(proposal) => {
                let is_quiet = proposal.before - proposal.expected <= LEAST_GAIN * proposal.before.abs();
                self.quiet = if is_quiet { self.quiet + 1 } else { 0 };
                if proposal.length == 0.0 || self.quiet > MOST_QUIET || self.failures >= MOST_FAILURES {
                    let is_known = self.quiet > 0;
                    self.exhausted =
                        Some(if is_known { Exhausted::NothingExpected } else { Exhausted::NothingImproves });
                } else {
                    self.length = proposal.length;
                    self.queue.push(proposal.weights);
                }
            }
        }
        usize::from(!is_finite)
    }

    /// Numbers that a motion shows.
    pub(crate) fn shown(&self) -> usize {
        self.model.shown()
    }

    /// Motions told of.
    pub(crate) fn made(&self) -> usize {
        self.made
    }

    /// Motions proposed and made.
    pub fn update(&self) -> usize {
        self.update
    }

    /// How far the next motion may go, in the model's scale.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Why learning is over, once it is.
    pub fn exhausted(&self) -> Option<Exhausted> {
        self.exhausted
    }

    /// What the model takes the environment for.
    pub fn explanation(&self) -> String {
        self.model.explanation()
    }
}
