//! The loop around a session: roll out in parallel what it asks for, tell it, show what was learned.

use core::slice;

use rayon::prelude::*;

use crate::rollouts::Crew;
use crate::session::{Session, Told};
use crate::{
    AutoOptions, CmaEsOptions, Cost, GaussNewtonOptions, Note, Parameters, Pi2Error, Pi2Options, Problem, Settled,
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
    /// Evolution by covariance matrix adaptation, on total costs.
    CmaEs(CmaEsOptions),
}

impl Method {
    /// Updates made at most.
    pub fn updates(&self) -> usize {
        match self {
            Self::Pi2(options) => options.updates,
            Self::GaussNewton(options) => options.updates,
            Self::Auto(options) => options.updates,
            Self::CmaEs(options) => options.updates,
        }
    }

    /// Rollouts made at a time.
    pub fn rollouts(&self) -> usize {
        match self {
            Self::Pi2(options) => options.rollouts,
            Self::GaussNewton(options) => options.rollouts,
            Self::Auto(options) => options.rollouts,
            Self::CmaEs(options) => options.rollouts,
        }
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
    /// It was asked for.
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
    #[error("the problem measures no signals: learn it from its cost, with auto, pi2 or cma-es")]
    NoSignals,
    /// Elites keep what they cost, and the problem's costs are random.
    #[error("elites keep what they cost under other draws: leave `elites` at 0 where costs are random")]
    RandomElites,
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

/// Makes the motions that a session asks for on the current rayon pool: the same numbers for any number of threads.
///
/// Where the problem allows it ([`Problem::may_run_ahead`]), the batch that is sure to follow an evaluation is made beside
/// it. Its motions count once it is told: never, where nobody goes on after that evaluation.
pub struct Driver<'p, P: Problem> {
    problem: &'p P,
    session: Session,
    crew: Crew<P>,
    /// Those of a batch.
    costs: Vec<Cost>,
    signals: Vec<Vec<f64>>,
    /// How many of the costs are those of the batch asked for next, where it was made ahead.
    ahead: Option<usize>,
    evaluation: Evaluation<P>,
}

/// Rooms for a motion by itself.
struct Evaluation<P: Problem> {
    weights: Vec<f64>,
    workspace: P::Workspace,
    cost: Cost,
}

impl<'p, P: Problem> Driver<'p, P> {
    /// For `session`, wherever it stands, of `problem`; memory is reused from batch to batch.
    pub fn new(problem: &'p P, session: Session) -> Self {
        let evaluation = Evaluation { weights: Vec::new(), workspace: problem.workspace(), cost: Cost::default() };
        let (crew, costs, signals) = (Crew::new(), Vec::new(), Vec::new());
        Self { problem, session, crew, costs, signals, ahead: None, evaluation }
    }

    /// The session, told of every motion so far that it asked for.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Makes the motions asked for next and tells them; `None` where learning is over.
    ///
    /// # Errors
    /// As for [`Session::tell`].
    pub fn step(&mut self) -> Result<Option<Told>, LearnError> {
        let Self { problem, session, crew, costs, signals, evaluation, .. } = self;
        if let Some(count) = self.ahead.take() {
            return session.tell(&costs[..count], &[]).map(Some);
        }
        let Some(ask) = session.ask() else { return Ok(None) };
        let (draws, count) = (ask.draws, ask.samples.len());
        if ask.wants_signals {
            let (costs, signals) = (first(costs, count), first(signals, count));
            costs.par_iter_mut().zip(&mut *signals).zip(&ask.samples).for_each_init(
                || problem.workspace(),
                |workspace, ((cost, signals), sample)| problem.measure(draws, *sample, workspace, cost, signals),
            );
            return session.tell(costs, signals).map(Some);
        }
        let [Parameters::Constant(weights)] = ask.samples[..] else {
            let costs = first(costs, count);
            crew.roll_out(*problem, draws, &ask.samples, costs);
            return session.tell(costs, &[]).map(Some);
        };
        evaluation.weights.clear();
        evaluation.weights.extend(weights);
        let mut evaluate = || {
            let Evaluation { weights, workspace, cost } = &mut *evaluation;
            problem.rollout(draws, Parameters::Constant(weights), workspace, cost);
        };
        let begin_next = || {
            let ask = session.ahead()?;
            let count = ask.samples.len();
            crew.roll_out(*problem, ask.draws, &ask.samples, first(costs, count));
            Some(count)
        };
        if problem.may_run_ahead() {
            self.ahead = rayon::join(begin_next, evaluate).0;
        } else {
            evaluate();
        }
        session.tell(slice::from_ref(&evaluation.cost), &[]).map(Some)
    }

    /// Goes on to the next evaluation; `None` where learning is over.
    ///
    /// # Errors
    /// As for [`Session::tell`].
    pub fn advance(&mut self) -> Result<Option<Progress>, LearnError> {
        while let Some(told) = self.step()? {
            if told.progress.is_some() {
                return Ok(told.progress);
            }
        }
        Ok(None)
    }
}

/// The first `count` rooms, made where there are fewer.
fn first<T: Default>(rooms: &mut Vec<T>, count: usize) -> &mut [T] {
    rooms.resize_with(count.max(rooms.len()), T::default);
    &mut rooms[..count]
}

/// Learns `problem` from `weights` by `method` on the current rayon pool: the same numbers for any number of threads.
///
/// `observe` sees the start and every update, in order; it returns whether to go on. No more than `max_rollouts`
/// motions are made; every motion counts, but for those made beside the evaluation that `observe` stops at ([`Driver`]).
///
/// # Errors
/// [`LearnError`] where the start costs no finite amount, the method needs signals that are not there, or every
/// rollout of an update costs no finite amount.
pub fn learn_with<P: Problem>(
    problem: &P,
    weights: Vec<f64>,
    method: &Method,
    max_rollouts: Option<usize>,
    mut observe: impl FnMut(&Progress) -> bool,
) -> Result<History, LearnError> {
    let session = Session::begin(problem, weights, method, max_rollouts)?;
    let mut driver = Driver::new(problem, session);
    while let Some(progress) = driver.advance()? {
        if !observe(&progress) {
            break;
        }
    }
    Ok(driver.session().history())
}

/// [`learn_with`] PI2.
///
/// # Errors
/// As for [`learn_with`].
pub fn learn<P: Problem>(
    problem: &P,
    weights: Vec<f64>,
    options: Pi2Options,
    max_rollouts: Option<usize>,
    observe: impl FnMut(&Progress) -> bool,
) -> Result<History, LearnError> {
    learn_with(problem, weights, &Method::Pi2(options), max_rollouts, observe)
}

/// The parameters of one motion each.
pub(crate) fn constant(samples: &[Vec<f64>]) -> Vec<Parameters<'_>> {
    samples.iter().map(|sample| Parameters::Constant(sample)).collect()
}
