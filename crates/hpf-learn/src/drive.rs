//! The loop around a session: roll out in parallel what it asks for, tell it, show what was learned.

use core::slice;

use crate::rollouts::RolloutPool;
use crate::session::{Session, TellOutcome};
use crate::{Draws, History, LearnError, Method, Parameters, Pi2Options, Problem, Progress};

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
