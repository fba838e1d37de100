//! The loop around a learner: ask, roll out in parallel, tell, look at what was learned, keep the best.

use crate::rollouts::Crew;
use crate::{
    AutoOptions, Batch, Cost, Draws, GaussNewtonOptions, Note, Parameters, Pi2, Pi2Error, Pi2Options, Problem, Settled,
    auto,
};

/// A way to learn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Policy improvement with path integrals.
    Pi2(Pi2Options),
    /// Gauss-Newton on the signals of a problem that has them.
    GaussNewton(GaussNewtonOptions),
    /// Signals where there are any, else costs; nothing to set.
    Auto(AutoOptions),
}

/// Learns `problem` from `weights` by `method` on the current rayon pool: the same numbers for any number of threads.
///
/// `observe` sees the start and every update, in order; it returns whether to go on. No more than `max_rollouts`
/// motions are made. Every motion counts, and with [`Method::GaussNewton`] and [`Method::Auto`] every motion without
/// step-wise noise is an evaluation: the best is the cheapest of them.
///
/// # Errors
/// [`LearnError`] where the start costs no finite amount, the method needs signals that are not there, or every
/// rollout of an update of PI2 costs no finite amount.
pub fn learn_with<P: Problem>(
    problem: &P,
    weights: Vec<f64>,
    method: &Method,
    max_rollouts: Option<usize>,
    observe: impl FnMut(&Progress) -> bool,
) -> Result<History, LearnError> {
    match *method {
        Method::Pi2(options) => learn(problem, weights, options, max_rollouts, observe),
        Method::GaussNewton(options) => auto::learn_signals(problem, weights, options, max_rollouts, observe),
        Method::Auto(options) => auto::learn_auto(problem, weights, options, max_rollouts, observe),
    }
}

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

/// Why learning ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// All updates were made.
    Updates,
    /// The next batch would have passed the rollouts allowed.
    Rollouts,
    /// The observer asked for it.
    Asked,
    /// The method found nothing more to do.
    Settled(Settled),
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
    pub stop: Stop,
    /// What the method found out on its way: a coupling, a fall-back.
    pub notes: Vec<Note>,
}

/// Why learning failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LearnError {
    /// The starting parameters already cost no finite amount.
    #[error("the starting policy has no finite cost")]
    BadStart,
    /// The method learns from signals, and the problem measures none.
    #[error("the problem measures no signals: learn it from its cost, with auto or pi2")]
    NoSignals,
    /// An update could not be made; what was learned before it is in `history`.
    #[error("{reason}")]
    Update {
        /// What went wrong.
        reason: Pi2Error,
        /// What was learned before.
        history: Box<History>,
    },
}

/// Learns `problem` from `weights` with PI2 on the current rayon pool: the same numbers for any number of threads.
///
/// `observe` sees the start and every update, in order; it returns whether to go on. Learning stops before a batch
/// and its evaluation would pass `max_rollouts` motions.
///
/// # Errors
/// [`LearnError`] where the start costs no finite amount, or every rollout of an update does.
pub fn learn<P: Problem>(
    problem: &P,
    weights: Vec<f64>,
    options: Pi2Options,
    max_rollouts: Option<usize>,
    mut observe: impl FnMut(&Progress) -> bool,
) -> Result<History, LearnError> {
    let mut learner = Pi2::new(problem.blocks(), problem.steps(), weights, options);
    let mut workspace = problem.workspace();
    let mut evaluate = |learner: &Pi2, rollouts: usize, exploration: f64| {
        let mut cost = Cost::default();
        problem.rollout(Draws::HeldOut, Parameters::Constant(learner.weights()), &mut workspace, &mut cost);
        Progress {
            update: learner.update(),
            rollouts,
            total: cost.total(),
            terms: cost.terms,
            exploration,
            weights: learner.weights().to_vec(),
        }
    };

    let initial = evaluate(&learner, 1, learner.exploration());
    if !initial.total.is_finite() {
        return Err(LearnError::BadStart);
    }
    let mut history = History {
        best: initial.clone(),
        initial,
        updates: 0,
        rollouts: 1,
        rejected: 0,
        stop: Stop::Updates,
        notes: vec![],
    };
    let mut go_on = observe(&history.initial);
    let mut costs = vec![Cost::default(); options.rollouts];
    let (mut crew, mut batch) = (Crew::new(), Batch::default());
    for _ in 0..options.updates {
        if !go_on {
            history.stop = Stop::Asked;
            break;
        }
        if max_rollouts.is_some_and(|max| history.rollouts + options.rollouts + 1 > max) {
            history.stop = Stop::Rollouts;
            break;
        }
        let exploration = learner.exploration();
        learner.ask_into(&mut batch);
        crew.roll_out(problem, Draws::Update(learner.update()), &batch, &mut costs);
        match learner.tell(&batch, &costs) {
            Ok(rejected) => history.rejected += rejected,
            Err(reason) => {
                history.rollouts += options.rollouts;
                history.rejected += options.rollouts;
                return Err(LearnError::Update { reason, history: Box::new(history) });
            }
        }
        history.updates += 1;
        history.rollouts += options.rollouts + 1;
        let progress = evaluate(&learner, history.rollouts, exploration);
        go_on = observe(&progress);
        if progress.total < history.best.total {
            history.best = progress;
        }
    }
    Ok(history)
}
