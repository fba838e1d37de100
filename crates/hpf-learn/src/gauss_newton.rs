//! Learning from signals: Gauss-Newton on what rollouts measure, as ask and tell.
//!
//! The cost is `J = 1/2 |rho(w)|^2 + distances + price(w)`, of the signals of a rollout ([`SignalModel`]). No model of
//! robot or environment: the response of rho to w is learned from rollouts, stage by stage.
//! 1. **Look**: the start twice, for the noise (four times more where there is any), and each group of parameters
//!    moved alone: signals of other groups that answer show a coupling, and all groups become one.
//! 2. **Bend**: each block moved by one unit and by half of it, and each pair: how far from linear it answers.
//! 3. **Columns**: each parameter moved alone, in all groups at once.
//! 4. **Try**: Levenberg-Marquardt steps of several dampings. **Correct**: from where they led, the model steps again,
//!    which takes back what bending cost. The cheapest of these becomes the base if it is cheaper, group by group where
//!    no distance joins them.
//! 5. Where three rounds in a row gain next to nothing, 3 again; where that does not help either, 2 and 3 with smaller
//!    perturbations; where those do not help or noise would hide them, learning ends.
//!
//! What is known of the response and its secant updates: `response.rs`. All samples lie within the bounds of their
//! blocks; perturbations are never larger than the blocks' noise, and are halved where a rollout has no finite signals.
//! The batches asked for do not depend on how many rollouts are made at a time.
//!
//! This is not PI2: it needs signals, and a response that is smooth at the size of the perturbations.

use rand::RngExt as _;

use crate::noise::stream;
use crate::response::{Point, Response, Rollout, bend_plan};
use crate::step::{Step, step};
use crate::{Block, Exhausted, SignalGroup, SignalModel};

/// Dampings tried in a round, times the current one.
const TRIALS: [f64; 3] = [0.1, 1.0, 10.0];
/// Corrections made in a round at most: from the trials the model expects most of.
const CORRECTIONS: usize = 2;
/// Corrections of which the model expects a smaller share of the cost than this are not made.
const LEAST_CORRECTION: f64 = 1e-4;
/// Change of the damping when a correction was the cheapest.
const AFTER_CORRECTION: f64 = 0.3;
/// Change of the damping when nothing was cheaper.
const AFTER_FAILURE: f64 = 10.0;
/// Dampings stay within this of one, and one over it.
const MOST_DAMPING: f64 = 1e9;
/// A round that gains a smaller share of the cost than this has stalled.
const LEAST_GAIN: f64 = 1e-3;
/// Rounds stalled in a row before the columns are learned anew, or learning ends.
const MOST_STALLS: usize = 3;
/// Further looks at the start where the first two differ.
const MORE_LOOKS: usize = 4;
/// Groups are coupled where one moves another's signals by this share of the energy of its own.
const COUPLING: f64 = 1e-4;
/// The same for noisy signals, times what noise alone does.
const SIGNIFICANT_COUPLING: f64 = 5.0;
/// The perturbations shrink at most this often where nothing improves.
const MOST_SHRINKS: usize = 3;

/// Settings of learning from signals; none of them has a scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GaussNewtonOptions {
    /// Most rollouts made at a time; changes nothing else.
    pub rollouts: usize,
    /// Most updates, a round of trials each.
    pub updates: usize,
    /// Seed of the signs of the perturbations.
    pub seed: u64,
}

impl Default for GaussNewtonOptions {
    fn default() -> Self {
        Self { rollouts: 20, updates: 100, seed: 1 }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BatchKind {
    Look,
    Listen,
    Bend,
    Columns,
    Try,
    Correct,
}

/// The learner.
///
/// ```
/// use hpf_learn::{Block, GaussNewton, GaussNewtonOptions, SignalGroup, SignalModel};
/// // Two parameters, two signals: rho = (w0 - 3, w1 w1 - 4), so J is zero at w = (3, 2).
/// let block = |name: &str| Block {
///     name: name.into(), count: 1, features: vec![], activations: vec![], min: 0.0, max: 10.0, noise: 0.5,
/// };
/// let model = SignalModel {
///     groups: vec![SignalGroup { parameters: 0..2, signals: 0..2 }],
///     price: vec![vec![], vec![]],
///     distances: vec![],
/// };
/// let mut learner = GaussNewton::new(&[block("a"), block("b")], &model, vec![1.0, 1.0], GaussNewtonOptions::default());
/// while learner.exhausted().is_none() {
///     let signals: Vec<Vec<f64>> = learner.ask().iter().map(|w| vec![w[0] - 3.0, w[1] * w[1] - 4.0]).collect();
///     learner.tell(&signals);
/// }
/// assert!((learner.weights()[0] - 3.0).abs() < 1e-3 && (learner.weights()[1] - 2.0).abs() < 1e-3);
/// ```
#[derive(Clone, Debug)]
pub struct GaussNewton {
    blocks: Vec<Block>,
    model: SignalModel,
    options: GaussNewtonOptions,
    groups: Vec<Response>,
    /// lambda of each party.
    damping: Vec<f64>,
    /// Ways of the perturbations, one sign per parameter.
    signs: Vec<f64>,
    stage: BatchKind,
    queue: Vec<Vec<f64>>,
    told: Vec<Rollout>,
    /// Rollouts of the stage before that this one needs.
    kept: Vec<Rollout>,
    /// In `Columns`: the parameter of each sample in the queue, counted within its group.
    columns: Vec<usize>,
    update: usize,
    stalls: usize,
    is_fresh: bool,
    /// How often the perturbations may yet shrink.
    shrinks: usize,
    is_coupled: bool,
    exhausted: Option<Exhausted>,
}

impl GaussNewton {
    /// A learner that starts from `weights`, all blocks one after the other.
    pub fn new(blocks: &[Block], model: &SignalModel, weights: Vec<f64>, options: GaussNewtonOptions) -> Self {
        let mut generator = stream(options.seed, 0, 0);
        let signs = weights.iter().map(|_| if generator.random::<bool>() { 1.0 } else { -1.0 }).collect();
        let groups: Vec<Response> =
            model.groups.iter().map(|group| Response::new(group, blocks, model, &weights)).collect();
        let mut learner = Self {
            blocks: blocks.to_vec(),
            model: model.clone(),
            options,
            damping: vec![1.0; groups.len()],
            groups,
            signs,
            stage: BatchKind::Look,
            queue: Vec::new(),
            told: Vec::new(),
            kept: Vec::new(),
            columns: Vec::new(),
            update: 0,
            stalls: 0,
            is_fresh: true,
            shrinks: MOST_SHRINKS,
            is_coupled: false,
            exhausted: None,
        };
        learner.plan_look();
        learner
    }

    /// The same, ending instead of trying smaller perturbations: for signals whose response has kinks.
    #[must_use]
    pub(crate) fn without_shrinking(mut self) -> Self {
        self.shrinks = 0;
        self
    }

    /// The samples to roll out next: at most the options' `rollouts`, none once learning has exhausted.
    pub fn ask(&self) -> &[Vec<f64>] {
        &self.queue[..self.queue.len().min(self.options.rollouts.max(1))]
    }

    /// Takes the signals of the first samples of [`GaussNewton::ask`], one vector per sample in their order.
    /// Returns how many were rejected because a signal is not finite.
    pub fn tell(&mut self, signals: &[Vec<f64>]) -> usize {
        let samples = self.queue.drain(..signals.len());
        self.told.extend(samples.zip(signals).map(|(weights, signals)| Rollout { weights, signals: signals.clone() }));
        if self.queue.is_empty() && self.exhausted.is_none() {
            let mut told = core::mem::take(&mut self.kept);
            told.append(&mut self.told);
            match self.stage {
                BatchKind::Look => self.looked(told),
                BatchKind::Listen => self.listened(told),
                BatchKind::Bend => self.bent(&told),
                BatchKind::Columns => self.answered(&told),
                BatchKind::Try => self.tried(told),
                BatchKind::Correct => self.corrected(&told),
            }
        }
        signals.iter().filter(|signals| !signals.iter().all(|signal| signal.is_finite())).count()
    }

    /// The best known parameters. Where groups are independent they may never have been rolled out together.
    pub fn weights(&self) -> Vec<f64> {
        self.sample(|_, group| group.base.weights.clone())
    }

    /// How far each parameter may go from the base until all of them together are expected to double the cost; at most
    /// its perturbation.
    pub fn scales(&self) -> Vec<f64> {
        self.sample(|_, group| group.scales())
    }

    /// Number of signals of a sample.
    pub(crate) fn signals(&self) -> usize {
        self.groups.last().map_or(0, |group| group.signals.end)
    }

    /// Rounds of trials made.
    pub fn update(&self) -> usize {
        self.update
    }

    /// Why learning is over, once it is.
    pub fn exhausted(&self) -> Option<Exhausted> {
        self.exhausted
    }

    /// Whether groups were found to act on each other's signals.
    pub fn is_coupled(&self) -> bool {
        self.is_coupled
    }

    /// Whether rollouts of the same parameters differ.
    pub(crate) fn is_noisy(&self) -> bool {
        self.groups.iter().any(|group| group.noise > 0.0)
    }

    /// Size of the steps the damping allows, in units of the perturbations: the largest over the groups.
    pub fn reach(&self) -> f64 {
        self.damping.iter().map(|damping| 1.0 / damping.sqrt()).fold(0.0, f64::max)
    }

    /// All parameters, each group's from `part`.
    fn sample(&self, part: impl Fn(usize, &Response) -> Vec<f64>) -> Vec<f64> {
        let parts = self.groups.iter().enumerate().flat_map(|(a, group)| part(a, group));
        parts.collect()
    }

    fn plan_look(&mut self) {
        let start = self.weights();
        self.queue = vec![start.clone(), start];
        if self.groups.len() > 1 {
            for a in 0..self.groups.len() {
                let alone = |b: usize, group: &Response| {
                    group.perturbed(|j| if a == b { self.signs[group.parameters.start + j] } else { 0.0 })
                };
                self.queue.push(self.sample(alone));
            }
        }
        self.stage = BatchKind::Look;
    }

    /// Halves every perturbation; false, and the end, where nothing is left of them.
    fn halve(&mut self) -> bool {
        for group in &mut self.groups {
            (0..group.units.len()).for_each(|j| group.halve(j));
        }
        let is_left = self.groups.iter().any(|group| group.units.iter().any(|unit| *unit > 0.0));
        if !is_left {
            self.exhausted = Some(Exhausted::NoSignals);
        }
        is_left
    }

    fn looked(&mut self, told: Vec<Rollout>) {
        if !told[..2].iter().all(Rollout::is_finite) {
            self.exhausted = Some(Exhausted::NoSignals);
        } else if !told.iter().all(Rollout::is_finite) {
            if self.halve() {
                self.plan_look();
            }
        } else if told[0].signals == told[1].signals {
            self.listened(told);
        } else {
            self.queue = vec![self.weights(); MORE_LOOKS];
            self.stage = BatchKind::Listen;
            self.kept = told;
        }
    }

    /// `told`: two looks, each group alone where there are several, further looks.
    fn listened(&mut self, told: Vec<Rollout>) {
        let alone = if self.groups.len() > 1 { self.groups.len() } else { 0 };
        let is_look = |i: usize| i < 2 || i >= 2 + alone;
        let looks: Vec<&Rollout> =
            told.iter().enumerate().filter(|(i, rollout)| is_look(*i) && rollout.is_finite()).map(|(_, r)| r).collect();
        let mean = Rollout::mean(&looks);
        let exhaust = |group: &mut Response| {
            group.settle(mean.of(group), &looks.iter().map(|look| look.of(group)).collect::<Vec<_>>());
        };
        self.groups.iter_mut().for_each(exhaust);
        let change =
            |group: &Response, rollout: &Rollout| (rollout.of(group).signals - &group.base.signals).norm_squared();
        self.is_coupled = self.groups.iter().enumerate().any(|(b, group)| {
            let others = (0..alone).filter(|a| *a != b);
            let own = if alone > 0 { change(group, &told[2 + b]) } else { 0.0 };
            let most = COUPLING * own + SIGNIFICANT_COUPLING * 2.0 * group.noise;
            others.map(|a| change(group, &told[2 + a])).any(|change| change > most)
        });
        if self.is_coupled {
            let weights = self.weights();
            let signals = self.groups.last().map_or(0, |group| group.signals.end);
            let whole = SignalGroup { parameters: 0..weights.len(), signals: 0..signals };
            self.groups = vec![Response::new(&whole, &self.blocks, &self.model, &weights)];
            self.damping = vec![1.0];
            self.groups.iter_mut().for_each(exhaust);
        }
        self.plan_bend();
    }

    /// Most learned blocks of a group; where nothing is learned, one that is not there, so that the stage ends.
    fn most_blocks(&self) -> usize {
        self.groups.iter().map(|group| group.blocks.len()).max().unwrap_or(0).max(1)
    }

    fn plan_bend(&mut self) {
        let most = self.most_blocks();
        let moved = |group: &Response, blocks: &[usize], size: f64| {
            let moving: Vec<_> = blocks.iter().filter_map(|&b| group.blocks.get(b)).collect();
            let is_moving = |j: usize| moving.iter().any(|block| block.contains(&j));
            group.perturbed(|j| if is_moving(j) { size * self.signs[group.parameters.start + j] } else { 0.0 })
        };
        let plan = bend_plan(most);
        self.queue = plan.iter().map(|(blocks, size)| self.sample(|_, group| moved(group, blocks, *size))).collect();
        self.stage = BatchKind::Bend;
    }

    fn bent(&mut self, told: &[Rollout]) {
        if told.iter().all(Rollout::is_finite) {
            let plan = bend_plan(self.most_blocks());
            for group in &mut self.groups {
                // A group with fewer blocks than the largest has no use for the rest of the plan.
                let own =
                    plan.iter().zip(told).filter(|((blocks, _), _)| blocks.iter().all(|&b| b < group.blocks.len()));
                group.learn_bends(&own.map(|(_, rollout)| rollout.of(group)).collect::<Vec<_>>());
            }
            let most = self.groups.iter().map(|group| group.units.len()).max().unwrap_or(0);
            self.plan_columns((0..most).collect());
        } else if self.halve() {
            self.plan_bend();
        }
    }

    fn plan_columns(&mut self, mut columns: Vec<usize>) {
        // What is not to be learned in any group needs no rollout; one stays, so that the stage ends.
        let learned = |j: usize| self.groups.iter().any(|group| group.units.get(j).is_some_and(|unit| *unit > 0.0));
        let first = columns.first().copied();
        columns.retain(|&j| learned(j));
        columns.extend(first.filter(|_| columns.is_empty()));
        let alone = |j: usize| self.sample(|_, group| group.perturbed(|i| if i == j { 1.0 } else { 0.0 }));
        self.queue = columns.iter().map(|&j| alone(j)).collect();
        self.columns = columns;
        self.stage = BatchKind::Columns;
    }

    fn answered(&mut self, told: &[Rollout]) {
        let mut again = Vec::new();
        for (&j, rollout) in self.columns.iter().zip(told) {
            for group in self.groups.iter_mut().filter(|group| j < group.units.len()) {
                if rollout.is_finite() {
                    group.learn_secant(&rollout.of(group));
                } else {
                    group.halve(j);
                }
            }
            let is_left = |group: &Response| group.units.get(j).is_some_and(|unit| *unit > 0.0);
            if !rollout.is_finite() && self.groups.iter().any(is_left) {
                again.push(j);
            }
        }
        if again.is_empty() {
            self.plan_trials();
        } else {
            self.plan_columns(again);
        }
    }

    /// Groups that share a cost, whose steps are found and judged together: all where there are distances.
    fn party(&self) -> usize {
        if self.model.distances.is_empty() { 1 } else { self.groups.len().max(1) }
    }

    /// The step of each party from `rollout`, or from the base, with `factor` times its damping.
    fn steps(&self, rollout: Option<&Rollout>, factor: f64) -> Vec<Option<Step>> {
        let from = |group: &Response| rollout.map_or_else(|| group.base.clone(), |rollout| rollout.of(group));
        let parties = self.groups.chunks(self.party()).zip(&self.damping);
        let steps = parties.map(|(groups, damping)| {
            let from: Vec<Point> = groups.iter().map(from).collect();
            let is_finite = from.iter().all(|point| point.cost.is_finite());
            if is_finite { step(groups, &self.model.distances, &from, damping * factor) } else { None }
        });
        steps.collect()
    }

    /// All parameters, of each party those of its step or of the base.
    fn landing(&self, steps: Vec<Option<Step>>) -> Vec<f64> {
        let parties = self.groups.chunks(self.party()).zip(steps);
        let stay = |groups: &[Response]| groups.iter().map(|group| group.base.weights.clone()).collect();
        let landed =
            |(groups, step): (&[Response], Option<Step>)| step.map_or_else(|| stay(groups), |step| step.weights);
        parties.flat_map(landed).flatten().collect()
    }

    fn plan_trials(&mut self) {
        self.queue = TRIALS.map(|factor| self.landing(self.steps(None, factor))).to_vec();
        self.stage = BatchKind::Try;
    }

    fn tried(&mut self, told: Vec<Rollout>) {
        let mut plans: Vec<Vec<Step>> = self.damping.iter().map(|_| Vec::new()).collect();
        for (rollout, factor) in told.iter().zip(TRIALS) {
            for (plan, step) in plans.iter_mut().zip(self.steps(Some(rollout), factor)) {
                plan.extend(step.filter(|step| step.gain > LEAST_CORRECTION * (step.expected + step.gain)));
            }
        }
        plans.iter_mut().for_each(|plan| plan.sort_by(|a, b| a.expected.total_cmp(&b.expected)));
        let most = plans.iter().map(Vec::len).max().unwrap_or(0).min(CORRECTIONS);
        let mut plans: Vec<_> = plans.into_iter().map(Vec::into_iter).collect();
        self.queue = (0..most).map(|_| self.landing(plans.iter_mut().map(Iterator::next).collect())).collect();
        if self.queue.is_empty() {
            self.corrected(&told);
        } else {
            self.kept = told;
            self.stage = BatchKind::Correct;
        }
    }

    /// `told`: the trials, then the corrections.
    fn corrected(&mut self, told: &[Rollout]) {
        let cost = |groups: &[Response]| groups.iter().map(|group| group.base.cost).sum::<f64>();
        let before = cost(&self.groups);
        let party = self.party();
        for (groups, damping) in self.groups.chunks_mut(party).zip(&mut self.damping) {
            let total = |rollout: &Rollout| groups.iter().map(|group| rollout.of(group).cost).sum::<f64>();
            let costs: Vec<f64> = told.iter().map(total).collect();
            let best = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).unwrap_or(0);
            let is_cheaper = costs[best] < cost(groups);
            *damping *= match TRIALS.get(best) {
                _ if !is_cheaper => AFTER_FAILURE,
                Some(factor) => *factor,
                None => AFTER_CORRECTION,
            };
            *damping = damping.clamp(1.0 / MOST_DAMPING, MOST_DAMPING);
            for group in groups {
                let mut points: Vec<Point> = told.iter().map(|rollout| rollout.of(group)).collect();
                let next = is_cheaper.then(|| points.swap_remove(best));
                points.iter().for_each(|point| group.learn_secant(point));
                if let Some(next) = next {
                    group.move_to(next);
                }
            }
        }
        self.update += 1;
        if before - cost(&self.groups) > LEAST_GAIN * before {
            (self.stalls, self.is_fresh) = (0, false);
        } else {
            self.stalls += 1;
        }
        if self.stalls < MOST_STALLS {
            self.plan_trials();
        } else if self.is_fresh && self.shrinks == 0 {
            self.exhausted = Some(Exhausted::NothingImproves);
        } else if self.is_fresh && self.groups.iter().all(Response::is_hidden_when_smaller) {
            self.exhausted = Some(Exhausted::Noise);
        } else if self.is_fresh {
            self.shrinks -= 1;
            self.stalls = 0;
            self.damping.fill(1.0);
            self.groups.iter_mut().for_each(Response::shrink);
            self.plan_bend();
        } else {
            (self.stalls, self.is_fresh) = (0, true);
            self.damping.fill(1.0);
            self.groups.iter_mut().for_each(Response::doubt_all);
            self.plan_columns((0..self.groups.iter().map(|group| group.units.len()).max().unwrap_or(0)).collect());
        }
    }
}
