//! The loop around a session: roll out in parallel what it asks for, tell it, show what was learned.

use core::slice;
use core::time::Duration;
use std::collections::VecDeque;
use std::time::Instant;

use crate::rollouts::Crew;
use crate::session::{Session, Told};
use crate::{
    AutoOptions, CmaEsOptions, Draws, GaussNewtonOptions, Note, Parameters, Pi2Error, Pi2Options, Price, Problem,
    Settled,
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

    /// The seed of all random numbers.
    pub fn seed(&self) -> u64 {
        match self {
            Self::Pi2(options) => options.seed,
            Self::GaussNewton(options) => options.seed,
            Self::Auto(options) => options.seed,
            Self::CmaEs(options) => options.seed,
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

impl Progress {
    /// The same, known to cost `price`.
    pub(crate) fn priced(self, price: &Price) -> Self {
        Self { total: price.total, terms: price.terms.clone(), ..self }
    }
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

/// Evaluations gather for no longer than this, so that whoever watches sees learning go on.
const LONGEST_GATHERING: Duration = Duration::from_millis(100);

/// Makes the motions that a session asks for on the current rayon pool: the same numbers for any number of threads.
///
/// Where the problem allows it ([`Problem::may_run_ahead`]), PI2 does not wait for what its updates are found to cost:
/// evaluations gather until every thread has as many as it likes best, and are made together; where they do not become
/// as many, beside the batch that is sure to follow. What is handed out, and in which order, stays the same; what nobody
/// asks for any more never counts.
pub struct Driver<'p, P: Problem> {
    problem: &'p P,
    /// Told of what was handed out.
    session: Session,
    /// Told of all that was made, where that is more.
    ahead: Option<Session>,
    batch: Crew<P>,
    evaluations: Crew<P>,
    /// How many rollouts of a batch are made and not yet told.
    made: Option<usize>,
    /// What was told to the session ahead and is yet to be handed out.
    told: VecDeque<Told>,
}

impl<'p, P: Problem> Driver<'p, P> {
    /// For `session`, wherever it stands, of `problem`; memory is reused from batch to batch.
    pub fn new(problem: &'p P, session: Session) -> Self {
        let ahead = (problem.may_run_ahead() && session.may_run_ahead()).then(|| session.clone());
        let (batch, evaluations) = (Crew::default(), Crew::default());
        Self { problem, session, ahead, batch, evaluations, made: None, told: VecDeque::new() }
    }

    /// The session, told of all that [`Driver::step`] has handed out.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// What came of the motions asked for next, made where they are not made already; `None` where learning is over.
    ///
    /// # Errors
    /// As for [`Session::tell`].
    pub fn step(&mut self) -> Result<Option<Told>, LearnError> {
        let Self { problem, session, ahead: None, batch, evaluations, .. } = self else { return self.step_behind() };
        if session.evaluations().len() > 0 {
            let weights = weights_of(session);
            evaluations.make(*problem, Draws::HeldOut, &constant(&weights));
            go_on(*problem)?;
            return session.tell(&evaluations.costs[..weights.len()], &[]).map(Some);
        }
        if !session.has_batch() {
            return Ok(None);
        }
        let count = batch.make_next(*problem, session);
        go_on(*problem)?;
        let signals = batch.signals.get(..count).unwrap_or(&[]);
        session.tell_batch(&batch.costs[..count], signals).map(Some)
    }

    /// Hands out what was told ahead.
    fn step_behind(&mut self) -> Result<Option<Told>, LearnError> {
        if self.told.is_empty() {
            self.run_ahead()?;
        }
        let Some(told) = self.told.pop_front() else { return Ok(None) };
        self.session.replay(&told.record)?;
        Ok(Some(told))
    }

    /// Goes on until evaluations are made or learning is over.
    fn run_ahead(&mut self) -> Result<(), LearnError> {
        let begun = Instant::now();
        let enough = self.enough();
        let mut updates = Vec::new();
        loop {
            let Self { problem, ahead: Some(ahead), batch, made, .. } = self else { return Ok(()) };
            let due = ahead.evaluations().len();
            // One that was due from the beginning is handed out before any update.
            let is_enough = due >= enough || due > updates.len() || begun.elapsed() >= LONGEST_GATHERING;
            if due > 0 && (is_enough || !ahead.has_batch()) {
                return self.evaluate(updates);
            }
            let count = match made.take() {
                Some(count) => count,
                None if ahead.has_batch() => batch.make_next(*problem, ahead),
                None => return Ok(()),
            };
            go_on(*problem)?;
            match ahead.tell_batch(&batch.costs[..count], &[]) {
                Ok(update) => updates.push(update),
                Err(_) if due > 0 => {
                    // The error holds what was learned before: that is found out first.
                    *made = Some(count);
                    return self.evaluate(updates);
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// How many evaluations keep every thread at work.
    fn enough(&self) -> usize {
        self.problem.together() * rayon::current_num_threads()
    }

    /// Makes the evaluations that are due, to be handed out each after its update; beside the next batch, where they alone
    /// do not keep every thread at work.
    fn evaluate(&mut self, updates: Vec<Told>) -> Result<(), LearnError> {
        let enough = self.enough();
        let Self { problem, ahead: Some(ahead), batch, evaluations, made, told, .. } = self else { return Ok(()) };
        let weights = weights_of(ahead);
        let mut evaluate = || evaluations.make(*problem, Draws::HeldOut, &constant(&weights));
        if weights.len() < enough && made.is_none() && ahead.has_batch() {
            *made = Some(rayon::join(|| batch.make_next(*problem, ahead), evaluate).0);
        } else {
            evaluate();
        }
        go_on(*problem)?;
        let mut updates = updates.into_iter();
        for cost in &evaluations.costs[..weights.len()] {
            told.extend(updates.next());
            told.push_back(ahead.tell(slice::from_ref(cost), &[])?);
        }
        Ok(())
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
/// are made; every motion counts, but for those made ahead of the evaluation that `observe` stops at ([`Driver`]).
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

/// Whether what was made last is a result.
fn go_on<P: Problem>(problem: &P) -> Result<(), LearnError> {
    if problem.is_stopped() { Err(LearnError::Stopped) } else { Ok(()) }
}

/// What `session` is to have evaluated.
fn weights_of(session: &Session) -> Vec<Vec<f64>> {
    session.evaluations().map(|progress| progress.weights.clone()).collect()
}

/// The parameters of one motion each.
pub(crate) fn constant<'s>(samples: impl IntoIterator<Item = &'s Vec<f64>>) -> Vec<Parameters<'s>> {
    samples.into_iter().map(|sample| Parameters::Constant(sample)).collect()
}
