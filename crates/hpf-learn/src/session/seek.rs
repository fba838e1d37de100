//! Where learning begins: at the start, or where that fails its motion at the first motion near it that does not.
//!
//! Motions near the start differ from it as the exploration of a first update does: every parameter by a normal deviate
//! of its block's noise, from random numbers of (seed, motion) alone.

use rand::RngExt as _;

use super::{ActiveMethod, Learner};
use crate::auto::{FallBack, on_roots};
use crate::noise::stream;
use crate::{Block, CmaEs, GaussNewton, LearnError, Method, Model, ModelLearner, Pi2, Problem, SignalModel};

/// Motions tried near a start that fails, at most.
const MOST: usize = 50;
/// The stream of random numbers that no update has.
const UPDATE: usize = u32::MAX as usize;

/// The first stage of `method` from `weights`, for `blocks` and steps.
pub(super) fn active_method(
    method: &Method,
    (blocks, steps): (&[Block], usize),
    (model, environment): (Option<&SignalModel>, Option<Box<dyn Model>>),
    weights: Vec<f64>,
) -> Result<ActiveMethod, LearnError> {
    let signals = |options, model, fall_back, weights| {
        let learner = GaussNewton::new(blocks, model, weights, options);
        ActiveMethod::Signals(Box::new(Learner::Signals(learner, fall_back)))
    };
    let fall_back = |options| FallBack { blocks: blocks.to_vec(), steps, options };
    Ok(match (*method, model) {
        (Method::Pi2(options), _) => ActiveMethod::Pi2(Box::new(Pi2::checked(blocks, steps, weights, options))),
        (Method::CmaEs(options), _) => ActiveMethod::CmaEs(Box::new(CmaEs::new(blocks, weights, options))),
        (Method::Model(_), _) => {
            let environment = environment.ok_or(LearnError::NoModel)?;
            ActiveMethod::Model(Box::new(ModelLearner::new(environment, weights)), None)
        }
        (Method::GaussNewton(options), Some(model)) => signals(options, model, None, weights),
        (Method::GaussNewton(_), None) => return Err(LearnError::NoSignals),
        (Method::Auto(options), Some(model)) => {
            let after = Signals { model: model.clone(), fall_back: fall_back(options) };
            match environment {
                Some(environment) => {
                    ActiveMethod::Model(Box::new(ModelLearner::new(environment, weights)), Some(Box::new(after)))
                }
                None => after.active(weights),
            }
        }
        (Method::Auto(options), None) => {
            let learner = on_roots(blocks, steps, weights, options);
            ActiveMethod::Signals(Box::new(Learner::Roots(learner, fall_back(options))))
        }
    })
}

/// The model of the environment that `method` begins with, where `problem` has one.
pub(super) fn model_for<P: Problem>(problem: &P, method: &Method) -> Option<Box<dyn Model>> {
    if matches!(method, Method::Model(_) | Method::Auto(_)) { problem.model() } else { None }
}

/// What learning from signals needs where a model of the environment has ended.
#[derive(Clone, Debug)]
pub(super) struct Signals {
    model: SignalModel,
    fall_back: FallBack,
}

impl Signals {
    /// Learning from signals from `weights`, and after it PI2.
    pub(super) fn active(&self, weights: Vec<f64>) -> ActiveMethod {
        let FallBack { blocks, options, .. } = &self.fall_back;
        let learner = GaussNewton::new(blocks, &self.model, weights, options.signals());
        ActiveMethod::Signals(Box::new(Learner::Signals(learner, Some(self.fall_back.clone()))))
    }
}

/// How learning begins, from wherever it may.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    method: Method,
    blocks: Vec<Block>,
    steps: usize,
    model: Option<SignalModel>,
    environment: Option<Box<dyn Model>>,
}

impl Plan {
    /// Of learning `problem` by `method`.
    pub(super) fn new<P: Problem>(problem: &P, method: &Method) -> Self {
        let (blocks, model) = (problem.blocks().to_vec(), problem.signals().cloned());
        Self { method: *method, blocks, steps: problem.steps(), model, environment: model_for(problem, method) }
    }

    /// Looks for a start near `start`, which failed.
    pub(super) fn seek(self: Box<Self>, start: &[f64]) -> Seek {
        let near = |motion: usize| {
            let mut generator = stream(self.method.seed(), UPDATE, motion);
            let blocks = self.blocks.iter().flat_map(|block| core::iter::repeat_n(block, block.count));
            let moved = blocks.zip(start).map(|(block, weight)| {
                let deviate: f64 = generator.sample(rand_distr::StandardNormal);
                (weight + block.noise * deviate).clamp(block.min, block.max)
            });
            moved.collect()
        };
        Seek { samples: (0..MOST).map(near).collect(), tried: 0, plan: self }
    }
}

/// The search for a start.
#[derive(Clone, Debug)]
pub(super) struct Seek {
    plan: Box<Plan>,
    samples: Vec<Vec<f64>>,
    /// How many of the samples were tried.
    tried: usize,
}

impl Seek {
    /// The samples to roll out next, at most `count`.
    pub(super) fn ask(&self, count: usize) -> &[Vec<f64>] {
        let left = &self.samples[self.tried..];
        &left[..left.len().min(count)]
    }

    /// The next `count` samples, which were tried; `None` where there are not so many.
    pub(super) fn take(&mut self, count: usize) -> Option<Vec<Vec<f64>>> {
        let taken = self.samples.get(self.tried..self.tried + count)?.to_vec();
        self.tried += count;
        (count > 0).then_some(taken)
    }

    /// How many samples were tried.
    pub(super) fn tried(&self) -> usize {
        self.tried
    }

    /// Whether all were.
    pub(super) fn is_over(&self) -> bool {
        self.tried == self.samples.len()
    }

    /// What there is to say where none of them is a start.
    pub(super) fn failed(&self) -> LearnError {
        LearnError::NoStart { tried: self.tried }
    }

    /// The first method from `weights`.
    pub(super) fn active(&self, weights: Vec<f64>) -> Result<ActiveMethod, LearnError> {
        let Plan { method, blocks, steps, model, environment } = &*self.plan;
        active_method(method, (blocks, *steps), (model.as_ref(), environment.clone()), weights)
    }
}
