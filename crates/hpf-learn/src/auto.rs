//! Learning without settings: signals where a problem has them, else the costs of its steps, else PI2.
//!
//! 1. **Signals**: [`GaussNewton`] on them.
//! 2. **Costs**, where no step's cost is negative: [`GaussNewton`] on their roots, `nu_t = sqrt(2 r_t)`, for then
//!    `J = 1/2 |nu|^2`. A root has lost the sign of its signal and its response has a kink at nought, so this comes
//!    near the optimum fast and may stall there.
//! 3. **PI2** from the best so far, on total costs by rank, each parameter's noise set from what its response was found
//!    to be (the step at which all parameters together are expected to double the cost), then adapted.
//!
//! A stage that ends hands over what it has learned, and a [`Note`] says why. Motions without noise at every step are
//! all evaluations: nothing is rolled out twice to know what it cost.

use rayon::prelude::*;

use crate::{
    Anneal, Cost, Covariance, Draws, GaussNewton, GaussNewtonOptions, History, LearnError, Parameters, Pi2, Pi2Options,
    Problem, Progress, Settled, SignalGroup, SignalModel, Stop, Temperature,
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

/// Something found out on the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Note {
    /// One group of parameters moves the signals of another: all are learned together.
    Coupled,
    /// The problem measures no signals: the costs of its steps stand in for them.
    NoSignals,
    /// The costs of the steps ended: PI2 goes on.
    FellBack(Settled),
    /// A step has a negative cost, which has no root: PI2 goes on.
    NegativeCosts,
}

impl core::fmt::Display for Note {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Coupled => f.write_str("groups of parameters move each other's signals: all are learned together"),
            Self::NoSignals => f.write_str("the problem measures no signals: learning from the costs of its steps"),
            Self::FellBack(reason) => write!(f, "pi2 goes on from the costs of the steps: {reason}"),
            Self::NegativeCosts => f.write_str("pi2 from here on: a step has a negative cost, which has no root"),
        }
    }
}

/// What a rollout gives a learner from signals.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Source {
    Signals,
    CostRoots,
}

/// The history of a run and what ends it.
struct Run<F> {
    history: History,
    max_rollouts: usize,
    updates: usize,
    cheapest: Cheapest,
    observe: F,
}

/// The cheapest motion of a batch or a round.
#[derive(Default)]
struct Cheapest {
    found: Option<(Vec<f64>, Cost)>,
}

impl Cheapest {
    fn offer(&mut self, weights: &[f64], cost: &Cost) {
        let total = cost.total();
        if total.is_finite() && self.found.as_ref().is_none_or(|(_, best)| total < best.total()) {
            self.found = Some((weights.to_vec(), cost.clone()));
        }
    }
}

impl<F: FnMut(&Progress) -> bool> Run<F> {
    /// Starts a run with the first batch of `learner`, whose first sample is the start.
    fn begin<P: Problem>(
        problem: &P,
        learner: &mut GaussNewton,
        source: Source,
        limits: (usize, Option<usize>),
        observe: F,
    ) -> Result<Self, LearnError> {
        let (updates, max_rollouts) = (limits.0, limits.1.unwrap_or(usize::MAX));
        let samples: Vec<Vec<f64>> = learner.ask().iter().take(max_rollouts.max(1)).cloned().collect();
        let outcomes = roll_out(problem, &samples, source);
        let initial = progress(0, 1, &samples[0], &outcomes[0].0, 1.0);
        if !initial.total.is_finite() {
            return Err(LearnError::BadStart);
        }
        let history = History {
            best: initial.clone(),
            initial,
            updates: 0,
            rollouts: samples.len(),
            rejected: 0,
            stop: Stop::Updates,
            notes: Vec::new(),
        };
        let mut run = Self { history, max_rollouts, updates, cheapest: Cheapest::default(), observe };
        if !(run.observe)(&run.history.initial) {
            run.history.stop = Stop::Asked;
        }
        run.tell(learner, &samples, outcomes);
        Ok(run)
    }

    /// Tells `learner` what its samples led to.
    fn tell(&mut self, learner: &mut GaussNewton, samples: &[Vec<f64>], outcomes: Vec<(Cost, Vec<f64>)>) {
        for (sample, (cost, _)) in samples.iter().zip(&outcomes) {
            self.cheapest.offer(sample, cost);
        }
        let (update, reach, was_coupled) = (learner.update(), learner.reach(), learner.is_coupled());
        let signals: Vec<Vec<f64>> = outcomes.into_iter().map(|(_, signals)| signals).collect();
        self.history.rejected += learner.tell(&signals);
        if learner.is_coupled() && !was_coupled {
            self.history.notes.push(Note::Coupled);
        }
        if learner.update() > update {
            self.end_update(reach);
        }
    }

    /// Whether motions may go on; says why not.
    fn may_go_on(&mut self, motions: usize) -> bool {
        if self.history.stop == Stop::Asked || self.history.updates >= self.updates {
            return false;
        }
        if self.history.rollouts + motions > self.max_rollouts {
            self.history.stop = Stop::Rollouts;
            return false;
        }
        true
    }

    /// Keeps the cheapest motion of an update, where one has a cost, and shows it.
    fn end_update(&mut self, exploration: f64) {
        self.history.updates += 1;
        let Some((weights, cost)) = self.cheapest.found.take() else { return };
        let progress = progress(self.history.updates, self.history.rollouts, &weights, &cost, exploration);
        if !(self.observe)(&progress) {
            self.history.stop = Stop::Asked;
        }
        if progress.total < self.history.best.total {
            self.history.best = progress;
        }
    }

    /// Keeps the cheapest motion of an update that was not finished.
    fn keep(&mut self, exploration: f64) {
        if let Some((weights, cost)) = self.cheapest.found.take()
            && cost.total() < self.history.best.total
        {
            self.history.best = progress(self.history.updates, self.history.rollouts, &weights, &cost, exploration);
        }
    }
}

fn progress(update: usize, rollouts: usize, weights: &[f64], cost: &Cost, exploration: f64) -> Progress {
    let (total, terms, weights) = (cost.total(), cost.terms.clone(), weights.to_vec());
    Progress { update, rollouts, total, terms, exploration, weights }
}

/// Rolls out `samples` in parallel, in order.
fn roll_out<P: Problem>(problem: &P, samples: &[Vec<f64>], source: Source) -> Vec<(Cost, Vec<f64>)> {
    let mut outcomes = vec![(Cost::default(), Vec::new()); samples.len()];
    outcomes.par_iter_mut().zip(samples).for_each_init(
        || problem.workspace(),
        |workspace, ((cost, signals), sample)| {
            problem.measure(Draws::Update(0), Parameters::Constant(sample), workspace, cost, signals);
            if source == Source::CostRoots {
                signals.clear();
                signals.extend(cost.running.iter().chain([&cost.terminal]).map(|cost| (2.0 * cost).sqrt()));
            } else if !cost.total().is_finite() {
                // A rollout may fail without a signal that says so.
                signals.fill(f64::NAN);
            }
        },
    );
    outcomes
}

/// Runs a learner from signals until it settles or the run ends.
fn run_gauss_newton<P: Problem, F: FnMut(&Progress) -> bool>(
    problem: &P,
    learner: &mut GaussNewton,
    source: Source,
    run: &mut Run<F>,
) {
    while learner.settled().is_none() && run.may_go_on(1) {
        let left = run.max_rollouts - run.history.rollouts;
        let samples: Vec<Vec<f64>> = learner.ask().iter().take(left).cloned().collect();
        let outcomes = roll_out(problem, &samples, source);
        run.history.rollouts += samples.len();
        run.tell(learner, &samples, outcomes);
    }
    run.keep(learner.reach());
}

/// Learns from signals alone.
pub(crate) fn learn_signals<P: Problem>(
    problem: &P,
    weights: Vec<f64>,
    options: GaussNewtonOptions,
    max_rollouts: Option<usize>,
    observe: impl FnMut(&Progress) -> bool,
) -> Result<History, LearnError> {
    let model = problem.signals().ok_or(LearnError::NoSignals)?;
    let mut learner = GaussNewton::new(problem.blocks(), model, weights, options);
    let limits = (options.updates, max_rollouts);
    let mut run = Run::begin(problem, &mut learner, Source::Signals, limits, observe)?;
    run_gauss_newton(problem, &mut learner, Source::Signals, &mut run);
    if let (Some(reason), true) = (learner.settled(), run.history.stop == Stop::Updates) {
        run.history.stop = Stop::Settled(reason);
    }
    Ok(run.history)
}

/// Learns from signals, or from the costs of the steps and then with PI2.
pub(crate) fn learn_auto<P: Problem>(
    problem: &P,
    weights: Vec<f64>,
    options: AutoOptions,
    max_rollouts: Option<usize>,
    observe: impl FnMut(&Progress) -> bool,
) -> Result<History, LearnError> {
    let AutoOptions { rollouts, updates, seed } = options;
    let signals = GaussNewtonOptions { rollouts, updates, seed };
    if problem.signals().is_some() {
        return learn_signals(problem, weights, signals, max_rollouts, observe);
    }
    let whole = SignalGroup { parameters: 0..weights.len(), signals: 0..problem.steps() + 1 };
    let model = SignalModel { groups: vec![whole], price: vec![Vec::new(); problem.blocks().len()] };
    let mut learner = GaussNewton::new(problem.blocks(), &model, weights, signals).without_shrinking();
    let mut run = Run::begin(problem, &mut learner, Source::CostRoots, (updates, max_rollouts), observe)?;
    run.history.notes.push(Note::NoSignals);
    run_gauss_newton(problem, &mut learner, Source::CostRoots, &mut run);
    if let Some(reason) = learner.settled() {
        let is_negative = run.history.updates == 0 && reason == Settled::NoSignals;
        run.history.notes.push(if is_negative { Note::NegativeCosts } else { Note::FellBack(reason) });
        polish(problem, &learner, options, &mut run)?;
    }
    Ok(run.history)
}

/// PI2 from the best so far, with noise of the size that the responses found call for.
fn polish<P: Problem, F: FnMut(&Progress) -> bool>(
    problem: &P,
    learner: &GaussNewton,
    options: AutoOptions,
    run: &mut Run<F>,
) -> Result<(), LearnError> {
    let (floor, ceiling) = NOISE_RANGE;
    let noise = problem.blocks().iter().flat_map(|block| vec![block.noise; block.count]);
    let share = |(scale, noise): (f64, f64)| if scale > 0.0 { (scale / noise).max(floor) } else { ceiling };
    let spread = learner.scales().into_iter().zip(noise).map(share).collect();
    let options = Pi2Options {
        rollouts: options.rollouts,
        updates: options.updates,
        temperature: Temperature::Rank,
        anneal: Anneal::None,
        covariance: Covariance::Diagonal { floor, ceiling },
        seed: options.seed,
        ..Pi2Options::black_box()
    };
    let mut pi2 =
        Pi2::new(problem.blocks(), problem.steps(), run.history.best.weights.clone(), options).with_spread(spread);
    let (mut mark, mut since) = (run.history.best.total, 0);
    while run.may_go_on(options.rollouts) {
        let exploration = pi2.spread().iter().fold(0.0, |most: f64, spread| most.max(*spread));
        let batch = pi2.ask();
        let samples: Vec<Vec<f64>> = (0..batch.len()).map(|k| batch.sample(k).at(0).to_vec()).collect();
        let costs: Vec<Cost> =
            roll_out(problem, &samples, Source::CostRoots).into_iter().map(|(cost, _)| cost).collect();
        run.history.rollouts += samples.len();
        for (sample, cost) in samples.iter().zip(&costs) {
            run.cheapest.offer(sample, cost);
        }
        match pi2.tell(&batch, &costs) {
            Ok(rejected) => run.history.rejected += rejected,
            Err(reason) => return Err(LearnError::Update { reason, history: Box::new(run.history.clone()) }),
        }
        run.end_update(exploration);
        since += 1;
        if mark - run.history.best.total > LEAST_GAIN * mark.abs() {
            (mark, since) = (run.history.best.total, 0);
        }
        if since == PATIENCE {
            run.history.stop = Stop::Settled(Settled::NothingImproves);
            break;
        }
    }
    Ok(())
}
