//! Learning as a conversation: ask what to roll out, tell what came of it, and stop or go on wherever you are.
//!
//! ```text
//! pi2:                 start, then (batch, evaluation) for each update
//! gauss-newton, auto:  batches; their first motion is the start, and each is an evaluation
//! model:               one motion at a time; the first is the start, and each is an evaluation
//! cma-es:              start, then a batch for each update, each motion an evaluation
//! ```
//! Where the start may fail its motion ([`Problem::may_start_fail`]) and does, batches of motions near it follow until one
//! does not fail: learning begins there.
//!
//! Where a problem has draws ([`Problem::is_random`]), what a motion of a batch cost is what it cost under the
//! draws it learned from: the start, and the cheapest motion of each update, are then rolled out once more under those
//! held out, and these are the evaluations.
//!
//! A session is a function of its settings and of the [`Record`]s it was told: replayed, it is in the same state to the
//! bit, for random numbers come from (seed, update, rollout) and not from a generator that runs along.

mod learner;
mod replay;
mod seek;

use crate::auto::{Patience, roots};
use crate::record::{Price, Record};
use crate::{
    Batch, CmaEs, Cost, Draws, History, LearnError, Method, ModelLearner, Note, Parameters, Pi2, Pi2Error, Problem,
    Progress, TerminationReason, Wants, shape,
};
use learner::Learner;
use seek::{Plan, Seek, Signals, active_method, model_for};

/// What to roll out next.
#[derive(Debug)]
pub struct Ask<'s> {
    /// Under which circumstances.
    pub draws: Draws,
    /// With which parameters, a motion each.
    pub samples: Vec<Parameters<'s>>,
    /// What is needed of the motions beside their costs.
    pub wants: Wants,
}

/// What came of telling.
#[derive(Clone, Debug, PartialEq)]
pub struct TellOutcome {
    /// What to keep in order to come back to this state.
    pub record: Record,
    /// The evaluation, where one was complete: the start, or an update.
    pub progress: Option<Progress>,
}

/// A run of learning, wherever it stands.
///
/// ```
/// use hpf_learn::{Block, Cost, Method, Parameters, Pi2Options, Problem, Session, Draws};
/// // A parabola; anything that can tell a cost may stand in its place: `Problem` only says what the parameters are.
/// struct Parabola(Vec<Block>);
/// impl Problem for Parabola {
///     type Workspace = ();
///     fn blocks(&self) -> &[Block] { &self.0 }
///     fn steps(&self) -> usize { 1 }
///     fn terms(&self) -> &[&'static str] { &["height"] }
///     fn workspace(&self) {}
///     fn rollout(&self, _: Draws, _: Parameters<'_>, _: &mut (), _: &mut Cost) { unreachable!("made elsewhere") }
/// }
/// let block = Block {
///     name: "w".into(), count: 1, features: vec![1.0], activations: vec![1.0], min: 0.0, max: 10.0, noise: 1.0,
/// };
/// let (problem, method) = (Parabola(vec![block]), Method::Pi2(Pi2Options::default()));
/// let mut session = Session::begin(&problem, vec![1.0], &method, None)?;
/// let mut records = Vec::new();
/// while let Some(ask) = session.ask() {
///     let height = |w: f64| Cost { running: vec![(w - 3.0) * (w - 3.0)], terminal: 0.0, terms: vec![(w - 3.0) * (w - 3.0)] };
///     let costs: Vec<Cost> = ask.samples.iter().map(|sample| height(sample.at(0)[0])).collect();
///     records.push(session.tell(&costs, &[])?.record);
/// }
/// assert!((session.history().best.weights[0] - 3.0).abs() < 0.01);
///
/// // TellOutcome the same again, another session is where this one is.
/// let mut again = Session::begin(&problem, vec![1.0], &method, None)?;
/// records.iter().try_for_each(|record| again.replay(record).map(drop))?;
/// assert_eq!(again.history(), session.history());
/// # Ok::<(), hpf_learn::LearnError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Session {
    method: ActiveMethod,
    /// Where the last update led, yet to be evaluated; at first the start.
    due: Option<Progress>,
    /// The samples of PI2 that are rolled out.
    batch: Option<Batch>,
    /// The batch before, for its room.
    spare: Batch,
    history: History,
    /// Rollouts that take part in the next update of PI2 again, and how many there are at most.
    /// The cheapest motion of the running update, where motions are evaluations.
    cheapest: Option<(Vec<f64>, Price)>,
    over: Option<TerminationReason>,
    updates: usize,
    /// Rollouts of a batch.
    rollouts: usize,
    max_rollouts: usize,
    /// Motions per rollout.
    motions: usize,
    /// Whether what a motion costs depends on its draws.
    is_random: bool,
    /// How to begin elsewhere, where the start may fail and is not known yet.
    plan: Option<Box<Plan>>,
    /// The search for a start, where the start has failed.
    seek: Option<Seek>,
}

#[derive(Clone, Debug)]
enum ActiveMethod {
    Pi2(Box<Pi2>),
    /// A model of the environment, and what goes on after it.
    Model(Box<ModelLearner>, Option<Box<Signals>>),
    /// Signals, or the costs of the steps.
    Signals(Box<Learner>),
    /// PI2 after the costs of the steps.
    Polish(Box<Pi2>, Patience),
    CmaEs(Box<CmaEs>),
}

impl Session {
    /// Begins to learn `problem` from `weights` by `method`.
    ///
    /// # Errors
    /// [`LearnError::Shape`] where blocks and `weights` do not fit together, [`LearnError::NoSignals`] where the method
    /// needs signals that the problem does not measure.
    pub fn begin<P: Problem>(
        problem: &P,
        weights: Vec<f64>,
        method: &Method,
        max_rollouts: Option<usize>,
    ) -> Result<Self, LearnError> {
        let (blocks, steps) = (problem.blocks(), problem.steps());
        let has_tables = match method {
            Method::Pi2(_) | Method::Auto(_) => true,
            Method::Model(_) | Method::GaussNewton(_) | Method::CmaEs(_) => false,
        };
        shape::check(blocks, steps, weights.len(), has_tables)?;
        let start = weights.clone();
        let active = active_method(method, (blocks, steps), (problem.signals(), model_for(problem, method)), weights)?;
        let is_auto = matches!(method, Method::Auto(_));
        let notes = (is_auto && problem.signals().is_none()).then_some(Note::NoSignals).into_iter().collect();
        let plan = problem.may_start_fail().then(|| Box::new(Plan::new(problem, method)));
        let exploration = if let ActiveMethod::Pi2(learner) = &active { learner.exploration() } else { 1.0 };
        let initial =
            Progress { update: 0, rollouts: 0, total: f64::INFINITY, terms: Vec::new(), exploration, weights: start };
        let motions = problem.motions().max(1);
        let is_random = problem.is_random();
        let starts_with_batch = !is_random && matches!(active, ActiveMethod::Signals(..) | ActiveMethod::Model(..));
        let due = (!starts_with_batch).then(|| initial.clone());
        let history = History {
            best: initial.clone(),
            initial,
            updates: 0,
            rollouts: 0,
            rejected: 0,
            stop: TerminationReason::Requested,
            notes,
        };
        Ok(Self {
            method: active,
            due,
            batch: None,
            spare: Batch::default(),
            history,
            cheapest: None,
            over: None,
            updates: method.updates(),
            rollouts: method.rollouts(),
            max_rollouts: max_rollouts.unwrap_or(usize::MAX),
            motions,
            is_random,
            plan,
            seek: None,
        })
    }

    /// What to roll out next; `None` where learning is over. The same until something is told.
    pub fn ask(&mut self) -> Option<Ask<'_>> {
        if self.due.is_none() {
            return if self.over.is_none() { Some(self.ask_batch()) } else { None };
        }
        let samples = Parameters::constants(self.due.iter().map(|due| &due.weights));
        Some(Ask { draws: Draws::HeldOut, samples, wants: Wants::Costs })
    }

    /// Motions made so far.
    pub(crate) fn made(&self) -> usize {
        self.history.rollouts
    }

    /// What is yet to be evaluated.
    pub(crate) fn due(&self) -> Option<&Progress> {
        self.due.as_ref()
    }

    /// Whether a batch follows: where an evaluation is due, whatever comes of it.
    pub(crate) fn has_batch(&self) -> bool {
        match &self.due {
            None => self.over.is_none(),
            Some(due) => due.update > 0 && matches!(self.method, ActiveMethod::Pi2(_)) && self.limit().is_none(),
        }
    }

    /// PI2 and room for the samples that it is to draw, where the batch is one of its.
    pub(crate) fn drawing(&mut self) -> Option<(&Pi2, &mut Batch)> {
        match &self.method {
            _ if self.seek.is_some() => None,
            ActiveMethod::Pi2(learner) | ActiveMethod::Polish(learner, _) => {
                let batch = self.batch.get_or_insert_with(|| core::mem::take(&mut self.spare));
                Some((learner, batch))
            }
            _ => None,
        }
    }

    pub(crate) fn ask_batch(&mut self) -> Ask<'_> {
        let room = self.room();
        if let Some(seek) = &self.seek {
            let samples = Parameters::constants(seek.ask(self.rollouts.clamp(1, room)));
            return Ask { draws: Draws::HeldOut, samples, wants: Wants::Costs };
        }
        let (draws, samples, wants) = match &self.method {
            ActiveMethod::Pi2(learner) | ActiveMethod::Polish(learner, _) => {
                let batch = self.batch.get_or_insert_with(|| {
                    let mut batch = core::mem::take(&mut self.spare);
                    learner.ask_into(&mut batch);
                    batch
                });
                let samples = (0..batch.len()).map(|k| batch.sample(k)).collect();
                (Draws::Update(learner.update()), samples, Wants::Costs)
            }
            ActiveMethod::Model(learner, _) => {
                (Draws::Update(learner.made()), Parameters::constants(learner.ask()), Wants::Motion)
            }
            ActiveMethod::Signals(learner) => {
                let samples = learner.ask();
                // The response needs fixed draws: it is learned from differences between updates too.
                let wants = if learner.wants_signals() { Wants::Signals } else { Wants::Costs };
                (Draws::Update(0), Parameters::constants(samples.iter().take(room)), wants)
            }
            ActiveMethod::CmaEs(learner) => {
                (Draws::Update(learner.update()), Parameters::constants(learner.ask()), Wants::Costs)
            }
        };
        Ask { draws, samples, wants }
    }

    /// Rollouts that may yet be made for batches, at least one.
    fn room(&self) -> usize {
        let left = self.max_rollouts.saturating_sub(self.history.rollouts) / self.motions;
        left.saturating_sub(usize::from(self.is_judged())).max(1)
    }

    /// What forbids another batch, once all is evaluated that is due.
    fn limit(&self) -> Option<TerminationReason> {
        let is_one = matches!(self.method, ActiveMethod::Signals(..) | ActiveMethod::Model(..));
        let rollouts = if is_one { 1 } else { self.rollouts };
        let needed = (usize::from(self.due.is_some()) + rollouts + usize::from(self.is_judged())) * self.motions;
        if self.history.updates >= self.updates {
            Some(TerminationReason::Updates)
        } else if self.history.rollouts + needed > self.max_rollouts {
            Some(TerminationReason::Rollouts)
        } else {
            None
        }
    }

    /// Whether the outcome of an update is rolled out once more.
    fn is_judged(&self) -> bool {
        self.is_random || matches!(self.method, ActiveMethod::Pi2(_))
    }

    /// Takes what came of the samples of [`Session::ask`], in their order: a cost each, and where they were asked for
    /// the signals of each.
    ///
    /// # Errors
    /// [`LearnError::BadStart`] where the start costs no finite amount, [`LearnError::NoStart`] where it may fail and
    /// nothing near it does not, [`LearnError::Update`] where no sample of an update costs a finite amount.
    /// [`LearnError::Shape`] where something else was asked for: another number of samples, or signals that are not there;
    /// then nothing has changed.
    pub fn tell(&mut self, costs: &[Cost], signals: &[Vec<f64>]) -> Result<TellOutcome, LearnError> {
        if self.due.is_none() {
            return self.tell_batch(costs, signals);
        }
        shape::length("costs", costs.len(), 1)?;
        let record = Record::Costs(costs.iter().map(Price::from).collect());
        let progress = self.replay(&record)?;
        Ok(TellOutcome { record, progress })
    }

    /// Takes what came of the samples of [`Session::ask_batch`].
    pub(crate) fn tell_batch(&mut self, costs: &[Cost], signals: &[Vec<f64>]) -> Result<TellOutcome, LearnError> {
        let (asked, wants) = match &self.batch {
            Some(batch) => (batch.len(), Wants::Costs),
            None if self.over.is_some() => (0, Wants::Costs),
            None => {
                let ask = self.ask_batch();
                (ask.samples.len(), ask.wants)
            }
        };
        shape::length("costs", costs.len(), asked)?;
        if wants != Wants::Costs {
            shape::length("signals", signals.len(), asked)?;
        }
        let prices = || costs.iter().map(Price::from).collect();
        let record = match &self.method {
            _ if self.seek.is_some() => Record::Costs(prices()),
            ActiveMethod::Pi2(_) | ActiveMethod::Polish(..) => self.update(costs)?,
            ActiveMethod::Signals(..) | ActiveMethod::Model(..) => {
                let signals_of = |(k, cost): (usize, &Cost)| match wants {
                    Wants::Costs => roots(cost),
                    _ if cost.total().is_finite() => signals[k].clone(),
                    // A rollout may fail without a signal that says so.
                    _ => vec![f64::NAN; signals[k].len()],
                };
                let signals = costs.iter().enumerate().map(signals_of).collect();
                Record::Signals { prices: prices(), signals }
            }
            ActiveMethod::CmaEs(_) => Record::Costs(prices()),
        };
        let progress = self.replay(&record)?;
        Ok(TellOutcome { record, progress })
    }

    /// Tells PI2 what its batch cost.
    fn update(&mut self, costs: &[Cost]) -> Result<Record, LearnError> {
        let batch = self.batch.take().expect("a batch was asked for");
        let (learner, exploration, are_evaluations) = match &mut self.method {
            ActiveMethod::Pi2(learner) => {
                let exploration = learner.exploration();
                (learner, exploration, false)
            }
            ActiveMethod::Polish(learner, _) => {
                let exploration = learner.spread().iter().fold(0.0, |most: f64, spread| most.max(*spread));
                (learner, exploration, true)
            }
            _ => unreachable!("only PI2 has a batch"),
        };
        let rejected = match learner.tell(&batch, costs) {
            Ok(rejected) => rejected,
            Err(reason) => return Err(self.failed(reason)),
        };
        let cheapest = || {
            let offers = costs.iter().enumerate().filter(|(_, cost)| cost.total().is_finite());
            let best = offers.min_by(|a, b| a.1.total().total_cmp(&b.1.total()))?;
            Some((batch.sample(best.0).at(0).to_vec(), Price::from(best.1)))
        };
        let record = Record::Update {
            update: learner.update(),
            weights: learner.weights().to_vec(),
            spread: learner.spread().to_vec(),
            exploration,
            rejected,
            cheapest: if are_evaluations { cheapest() } else { None },
        };
        self.spare = batch;
        Ok(record)
    }

    fn failed(&self, reason: Pi2Error) -> LearnError {
        let mut history = self.history();
        history.rollouts += self.rollouts * self.motions;
        history.rejected += self.rollouts;
        LearnError::Update { reason, history: Box::new(history) }
    }

    /// What has been learned so far; [`TerminationReason::Requested`] where learning could go on.
    pub fn history(&self) -> History {
        let mut history = self.history.clone();
        if let (ActiveMethod::Signals(learner), Some((weights, price))) = (&self.method, &self.cheapest)
            && !self.is_random
            && price.total < history.best.total
        {
            history.best = self.outcome(weights.clone(), learner.reach()).priced(price);
        }
        history.stop = self.over.unwrap_or(TerminationReason::Requested);
        history
    }

    /// Whether the start and every update have been evaluated: a good moment to stop.
    pub fn is_evaluated(&self) -> bool {
        self.history.rollouts > 0 && self.due.is_none() && self.seek.is_none()
    }

    /// Whether learning is over by itself.
    pub fn is_over(&self) -> bool {
        self.over.is_some()
    }
}
