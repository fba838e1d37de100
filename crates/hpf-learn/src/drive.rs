//! The loop around a session: roll out in parallel what it asks for, tell it, show what was learned.

use core::slice;

use crate::rollouts::RolloutPool;
use crate::session::{Session, TellOutcome};
use crate::{
    AutoOptions, CmaEsOptions, Draws, Exhausted, GaussNewtonOptions, Note, Parameters, Pi2Error, Pi2Options, Price,
    Problem, ShapeError,
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
    /// A model of the environment, fitted to the motions made.
    Model(AutoOptions),
}

impl Method {
    /// Updates made at most.
    pub fn updates(&self) -> usize {
        match self {
            Self::Pi2(options) => options.updates,
            Self::GaussNewton(options) => options.updates,
            Self::Auto(options) => options.updates,
            Self::CmaEs(options) => options.updates,
            Self::Model(options) => options.updates,
        }
    }

    /// The seed of all random numbers.
    pub fn seed(&self) -> u64 {
        match self {
            Self::Pi2(options) => options.seed,
            Self::GaussNewton(options) => options.seed,
            Self::Auto(options) => options.seed,
            Self::CmaEs(options) => options.seed,
            Self::Model(options) => options.seed,
        }
    }

    /// Rollouts made at a time.
    pub fn rollouts(&self) -> usize {
        match self {
            Self::Pi2(options) => options.rollouts,
            Self::GaussNewton(options) => options.rollouts,
            Self::Auto(options) => options.rollouts,
            Self::CmaEs(options) => options.rollouts,
            Self::Model(options) => options.rollouts,
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

impl Progress {
    /// The same, known to cost `price`.
    pub(crate) fn priced(self, price: &Price) -> Self {
        Self { total: price.total, terms: price.terms.clone(), ..self }
    }
}

/// Why learning ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerminationReason {
    /// All updates were made.
    Updates,
    /// The next batch would have passed the rollouts allowed.
    Rollouts,
    /// It was asked for.
    Requested,
    /// The method found nothing more to do.
    Exhausted(Exhausted),
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
    pub stop: TerminationReason,
    /// What the method found out on its way: a coupling, a fall-back.
    pub notes: Vec<Note>,
}

/// Why learning failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LearnError {
    /// The starting parameters already cost no finite amount.
    #[error("the starting policy has no finite cost")]
    BadStart,
    /// The start fails its motion, and so does everything that was tried near it.
    #[error("the starting policy has no finite cost, and neither has any of {tried} tried near it")]
    NoStart {
        /// Motions tried near the start.
        tried: usize,
    },
    /// No more motions can be made ([`Problem::is_stopped`]); the session was told nothing of the last ones.
    #[error("no more motions can be made")]
    Stopped,
    /// The method learns from signals, and the problem measures none.
    #[error("the problem measures no signals: learn it from its cost, with auto, pi2 or cma-es")]
    NoSignals,
    /// The method learns from motions, and the problem has no model that explains them.
    #[error("the problem has no model of its motions: learn it with auto, gauss-newton, pi2 or cma-es")]
    NoModel,
    /// The problem, its start or an answer does not fit together.
    #[error(transparent)]
    Shape(#[from] ShapeError),
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
/// Where the problem allows it ([`Problem::may_run_ahead`]), the evaluation of an update of PI2 is one more rollout of
/// the batch that is sure to follow, which is told after it. What nobody asks for any more never counts.
pub struct LearningLoop<'p, P: Problem> {
    problem: &'p P,
    session: Session,
    batch: RolloutPool<P>,
    evaluation: RolloutPool<P>,
    /// How many rollouts of a batch are made and not yet told.
    made: Option<usize>,
}

impl<'p, P: Problem> LearningLoop<'p, P> {
    /// For `session`, wherever it stands, of `problem`; memory is reused from batch to batch.
    pub fn new(problem: &'p P, session: Session) -> Self {
        Self { problem, session, batch: RolloutPool::default(), evaluation: RolloutPool::default(), made: None }
    }

    /// The session, told of all that [`LearningLoop::step`] has handed out.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// What came of the motions asked for next, made where they are not made already; `None` where learning is over.
    ///
    /// # Errors
    /// As for [`Session::tell`].
    pub fn step(&mut self) -> Result<Option<TellOutcome>, LearnError> {
        let Self { problem, session, batch, evaluation, made } = self;
        let Some(weights) = session.due().map(|due| due.weights.clone()) else {
            if !session.has_batch() {
                return Ok(None);
            }
            let count = made.take().unwrap_or_else(|| batch.make_next(*problem, session, None));
            go_on(*problem)?;
            let signals = batch.signals.get(..count).unwrap_or(&[]);
            return session.tell_batch(&batch.costs[..count], signals).map(Some);
        };
        // Under draws of its own an evaluation is no rollout of a batch.
        let runs_ahead = problem.may_run_ahead() && !problem.is_random() && session.has_batch();
        let cost = if runs_ahead && made.is_none() {
            let count = batch.make_next(*problem, session, Some(&weights));
            *made = Some(count);
            &batch.costs[count]
        } else {
            evaluation.make(*problem, Draws::HeldOut, &[Parameters::Constant(&weights)]);
            &evaluation.costs[0]
        };
        go_on(*problem)?;
        session.tell(slice::from_ref(cost), &[]).map(Some)
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

/// Learns `problem` from `weights` by `method` on the current rayon pool: the same numbers for any number of threads.
///
/// `observe` sees the start and every update, in order; it returns whether to go on. No more than `max_rollouts` motions
/// are made; every motion counts, but for those made ahead of the evaluation that `observe` stops at ([`LearningLoop`]).
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
    let mut learning = LearningLoop::new(problem, session);
    while let Some(progress) = learning.advance()? {
        if !observe(&progress) {
            break;
        }
    }
    Ok(learning.session().history())
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

/// Whether what was made last is a result.
fn go_on<P: Problem>(problem: &P) -> Result<(), LearnError> {
    if problem.is_stopped() { Err(LearnError::Stopped) } else { Ok(()) }
}

/// The parameters of one motion each.
pub(crate) fn constant<'s>(samples: impl IntoIterator<Item = &'s Vec<f64>>) -> Vec<Parameters<'s>> {
    samples.into_iter().map(|sample| Parameters::Constant(sample)).collect()
}
