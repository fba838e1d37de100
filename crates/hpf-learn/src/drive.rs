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
/// as many evaluations as make a full batch gather and are made together, beside the batch that is sure to follow. What
/// is told, and in which order, stays the same.
pub struct Driver<'p, P: Problem> {
    problem: &'p P,
    session: Session,
    batch: Crew<P>,
    evaluations: Crew<P>,
    /// How many rollouts of a batch are made and not yet told.
    made: Option<usize>,
    /// What was told and is yet to be handed out.
    told: VecDeque<Told>,
}

impl<'p, P: Problem> Driver<'p, P> {
    /// For `session`, wherever it stands, of `problem`; memory is reused from batch to batch.
    pub fn new(problem: &'p P, session: Session) -> Self {
        let (batch, evaluations) = (Crew::default(), Crew::default());
        Self { problem, session, batch, evaluations, made: None, told: VecDeque::new() }
    }

    /// The session; told of more than [`Driver::step`] has handed out unless the driver [is at rest](Self::is_at_rest).
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Whether all that was told is handed out, and the start and every update are evaluated: a good moment to stop.
    pub fn is_at_rest(&self) -> bool {
        self.told.is_empty() && self.session.is_evaluated()
    }

    /// What came of the motions asked for next, made where they are not made already; `None` where learning is over.
    ///
    /// # Errors
    /// As for [`Session::tell`].
    pub fn step(&mut self) -> Result<Option<Told>, LearnError> {
        if self.told.is_empty() {
            self.go_on()?;
        }
        Ok(self.told.pop_front())
    }

    /// Makes and tells motions until there is something to hand out or learning is over.
    fn go_on(&mut self) -> Result<(), LearnError> {
        let most = if self.problem.may_run_ahead() { self.problem.together() } else { 1 };
        let begun = Instant::now();
        let mut updates = Vec::new();
        loop {
            let Self { problem, session, batch, made, told, .. } = self;
            let due = session.evaluations().len();
            // One that was due from the beginning is handed out before any update.
            let is_enough = due >= most || due > updates.len() || begun.elapsed() >= LONGEST_GATHERING;
            if due > 0 && (is_enough || !session.has_batch()) {
                return self.evaluate(updates);
            }
            let count = match made.take() {
                Some(count) => count,
                None if session.has_batch() => batch.make_next(*problem, session),
                None => return Ok(()),
            };
            let signals = batch.signals.get(..count).unwrap_or(&[]);
            match session.tell_batch(&batch.costs[..count], signals) {
                Ok(update) => updates.push(update),
                Err(_) if due > 0 => {
                    // The error holds what was learned before: that is found out first.
                    *made = Some(count);
                    return self.evaluate(updates);
                }
                Err(error) => return Err(error),
            }
            if session.evaluations().len() == 0 {
                told.extend(updates);
                return Ok(());
            }
        }
    }

    /// Makes the evaluations that are due, and hands them out, each after its update.
    fn evaluate(&mut self, updates: Vec<Told>) -> Result<(), LearnError> {
        let Self { problem, session, batch, evaluations, made, told } = self;
        let weights: Vec<Vec<f64>> = session.evaluations().map(|progress| progress.weights.clone()).collect();
        let mut evaluate = || evaluations.make(*problem, Draws::HeldOut, &constant(&weights));
        if problem.may_run_ahead() && made.is_none() && session.has_batch() {
            *made = Some(rayon::join(|| batch.make_next(*problem, session), evaluate).0);
        } else {
            evaluate();
        }
        let mut updates = updates.into_iter();
        for cost in &evaluations.costs[..weights.len()] {
            told.extend(updates.next());
            told.push_back(session.tell(slice::from_ref(cost), &[])?);
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
/// `observe` sees the start and every update, in order; it returns whether to go on, and is shown all that was learned
/// by then ([`Driver`]). No more than `max_rollouts` motions are made; every motion counts.
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
    let mut goes_on = true;
    while goes_on || !driver.is_at_rest() {
        let Some(progress) = driver.advance()? else { break };
        goes_on &= observe(&progress);
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
pub(crate) fn constant<'s>(samples: impl IntoIterator<Item = &'s Vec<f64>>) -> Vec<Parameters<'s>> {
    samples.into_iter().map(|sample| Parameters::Constant(sample)).collect()
}
