//! Learning from the costs of the steps: the squares that they are made of are found out, and learned from as signals are.
//!
//! What a step costs is a sum of few squares that nobody measures, `r_t = 1/2 |s_t|^2`. A root of it has a kink where
//! they vanish; the squares have none, and around a base they answer as signals do, `s_t(base + x) = s_t + A_t x`. All of
//! it follows from costs, but for a rotation of s_t that changes nothing (`step_costs/factor.rs`):
//! 1. **Sketch**: each parameter moved alone, at the base and at [`WAYS`] points beside it: slopes and second differences
//!    of every step's cost, and from them s_t and A_t.
//! 2. **Bend**: each block moved by one unit and by half of it, and each pair, as [`GaussNewton`](crate::GaussNewton)
//!    does: what is known of s_t at the base turns with the costs.
//! 3. **Try**: Levenberg-Marquardt steps of several dampings.
//! 4. **Probe**: the cheapest trial becomes the base. Rollouts both ways from it tell where its s_t are, for what costs
//!    tell of a sum of squares is how long s_t is, and not which way it points. The response is mended by a secant.
//! 5. Where three rounds in a row gain next to nothing, 1 again; where a sketch brought nothing, learning ends.
//!
//! A sketch takes `(WAYS + 1) (n + 1)` motions for n parameters. Second differences of costs that are noisy say nothing:
//! there this is not to be used.

mod factor;

use nalgebra::{DMatrix, DVector};
use rand::RngExt as _;

use crate::noise::stream;
use crate::response::{Point, Response, bend_plan};
use crate::step::step;
use crate::{Block, Exhausted, GaussNewtonOptions, SignalGroup, SignalModel};
use factor::{Differences, factor, locate};

/// Points beside the base where slopes are learned too; a step's cost is learned as one square more than these.
const WAYS: usize = 3;
/// StepCostLearner per cost.
const SQUARES: usize = WAYS + 1;
/// Size of the perturbations, as a share of the blocks' noise: second differences are those of the base.
const SIZE: f64 = 0.1;
/// Pairs of rollouts that tell where a new base is.
const PAIRS: usize = 6;
/// Dampings tried in a round, times the current one.
const TRIALS: [f64; 4] = [0.1, 1.0, 10.0, 100.0];
/// Change of the damping when nothing was cheaper.
const AFTER_FAILURE: f64 = 100.0;
/// Dampings stay within this of one, and one over it.
const MOST_DAMPING: f64 = 1e9;
/// A round, or a sketch, that gains a smaller share of the cost than this has stalled.
const LEAST_GAIN: f64 = 1e-3;
/// Rounds stalled in a row before the next sketch.
const MOST_STALLS: usize = 3;

#[derive(Clone, Copy, Debug)]
enum BatchKind {
    Sketch,
    Bend,
    Try,
    /// Around a trial, given with the roots of its costs.
    Probe,
}

/// Weights, and the root `sqrt(2 r_t)` of every cost there.
#[derive(Clone, Debug)]
struct Evaluated {
    weights: Vec<f64>,
    roots: Vec<f64>,
}

impl Evaluated {
    fn is_finite(&self) -> bool {
        self.roots.iter().all(|root| root.is_finite())
    }

    /// The cost of all steps; infinite where there is none.
    fn cost(&self) -> f64 {
        let cost = 0.5 * self.roots.iter().map(|root| root * root).sum::<f64>();
        if cost.is_finite() { cost } else { f64::INFINITY }
    }

    fn cost_of(&self, step: usize) -> f64 {
        0.5 * self.roots[step] * self.roots[step]
    }
}

/// The learner, from the roots of the costs of the steps.
#[derive(Clone, Debug)]
pub(crate) struct StepCostLearner {
    costs: usize,
    options: GaussNewtonOptions,
    response: Response,
    /// Parameters that are learned.
    learned: Vec<usize>,
    damping: f64,
    stage: BatchKind,
    queue: Vec<Vec<f64>>,
    told: Vec<Evaluated>,
    /// The base; in `Probe` the next one.
    base: Evaluated,
    /// Cost at the last sketch.
    mark: f64,
    /// Batches of random ways so far.
    drawn: usize,
    update: usize,
    stalls: usize,
    exhausted: Option<Exhausted>,
}

impl StepCostLearner {
    /// A learner on `costs` costs, those of the steps and of the end, that starts from `weights`.
    pub(crate) fn new(blocks: &[Block], costs: usize, weights: Vec<f64>, options: GaussNewtonOptions) -> Self {
        let whole = SignalGroup { parameters: 0..weights.len(), signals: 0..costs * SQUARES };
        let model =
            SignalModel { groups: vec![whole.clone()], price: vec![Vec::new(); blocks.len()], distances: Vec::new() };
        let mut learner = Self {
            costs,
            options,
            response: Response::new(&whole, blocks, &model, &weights),
            learned: Vec::new(),
            damping: 1.0,
            stage: BatchKind::Sketch,
            queue: Vec::new(),
            told: Vec::new(),
            base: Evaluated { weights, roots: Vec::new() },
            mark: f64::INFINITY,
            drawn: 0,
            update: 0,
            stalls: 0,
            exhausted: None,
        };
        learner.plan_sketch();
        learner
    }

    /// The samples to roll out next: at most the options' `rollouts`, none once learning has exhausted.
    pub(crate) fn ask(&self) -> &[Vec<f64>] {
        let left = &self.queue[self.told.len()..];
        &left[..left.len().min(self.options.rollouts.max(1))]
    }

    /// Takes the roots of the costs of the first samples of [`StepCostLearner::ask`]; returns how many are not finite.
    pub(crate) fn tell(&mut self, roots: &[Vec<f64>]) -> usize {
        let samples = self.ask()[..roots.len()].to_vec();
        let told = samples.into_iter().zip(roots).map(|(weights, roots)| Evaluated { weights, roots: roots.clone() });
        let told: Vec<Evaluated> = told.collect();
        let rejected = told.iter().filter(|told| !told.is_finite()).count();
        self.told.extend(told);
        if self.told.len() == self.queue.len() && self.exhausted.is_none() {
            let told = core::mem::take(&mut self.told);
            match self.stage {
                BatchKind::Sketch => self.sketched(told),
                BatchKind::Bend => self.bent(&told),
                BatchKind::Try => self.tried(told),
                BatchKind::Probe => self.probed(&told),
            }
        }
        rejected
    }

    /// How far each parameter may go until all together are expected to double the cost.
    pub(crate) fn scales(&self) -> Vec<f64> {
        self.response.scales()
    }

    /// Number of costs of a sample, whose roots stand for signals.
    pub(crate) fn signals(&self) -> usize {
        self.costs
    }

    /// Rounds of trials made.
    pub(crate) fn update(&self) -> usize {
        self.update
    }

    /// Why learning is over, once it is.
    pub(crate) fn exhausted(&self) -> Option<Exhausted> {
        self.exhausted
    }

    /// Size of the steps the damping allows, in units of the blocks' noise.
    pub(crate) fn reach(&self) -> f64 {
        1.0 / self.damping.sqrt()
    }

    fn exhaust(&mut self, reason: Exhausted) {
        self.queue.clear();
        self.exhausted = Some(reason);
    }

    /// A random way for each parameter, of the size of a perturbation.
    fn draw(&mut self) -> Vec<f64> {
        let mut generator = stream(self.options.seed, 1, self.drawn);
        self.drawn += 1;
        self.response.units.iter().map(|_| if generator.random::<bool>() { SIZE } else { -SIZE }).collect()
    }

    /// The base, each parameter moved alone; then the same at each point beside it.
    fn plan_sketch(&mut self) {
        let units = self.response.units.iter().enumerate();
        self.learned = units.filter(|(_, unit)| **unit > 0.0).map(|(j, _)| j).collect();
        if self.learned.is_empty() {
            self.exhaust(Exhausted::NothingImproves);
            return;
        }
        let base = self.response.base.weights.clone();
        let mut queue = Vec::new();
        for way in 0..=WAYS {
            let signs = if way == 0 { vec![0.0; base.len()] } else { self.draw() };
            let from = self.response.perturbed(|j| signs[j]);
            let alone = |j: usize| {
                let moved = self.response.perturbed(|i| if i == j { SIZE } else { 0.0 });
                let mut sample = from.clone();
                sample[j] += moved[j] - base[j];
                sample
            };
            queue.push(from.clone());
            queue.extend(self.learned.iter().map(|&j| alone(j)));
        }
        self.queue = queue;
        self.stage = BatchKind::Sketch;
    }

    /// Halves every perturbation and sketches again; the end, where nothing is left of them.
    fn sketch_smaller(&mut self) {
        (0..self.response.units.len()).for_each(|j| self.response.halve(j));
        if self.response.units.iter().all(|unit| *unit == 0.0) {
            self.exhaust(Exhausted::NoSignals);
        } else {
            self.plan_sketch();
        }
    }

    fn sketched(&mut self, told: Vec<Evaluated>) {
        if !told.iter().all(Evaluated::is_finite) {
            self.sketch_smaller();
            return;
        }
        let n = self.learned.len();
        let beside: Vec<&[Evaluated]> = told.chunks(n + 1).collect();
        let moved = |told: &Evaluated| {
            let x = self.response.distance(&told.weights);
            DVector::from_iterator(n, self.learned.iter().map(|&j| x[j]))
        };
        let lengths = DVector::from_iterator(n, (0..n).map(|j| moved(&beside[0][1 + j])[j]));
        let ways = DMatrix::from_columns(&beside[1..].iter().map(|told| moved(&told[0])).collect::<Vec<_>>());
        let mut signals = DVector::zeros(self.costs * SQUARES);
        let mut response = DMatrix::zeros(self.costs * SQUARES, self.response.units.len());
        for t in 0..self.costs {
            let rise = |k: usize, j: usize| beside[k][1 + j].cost_of(t) - beside[k][0].cost_of(t);
            let differences = Differences {
                cost: beside[0][0].cost_of(t),
                rises: DVector::from_fn(n, |j, _| rise(0, j)),
                turns: DMatrix::from_fn(n, WAYS, |j, k| (rise(k + 1, j) - rise(0, j)) / lengths[j]),
            };
            let (s, a) = factor(&differences, &lengths, &ways);
            signals.rows_mut(t * SQUARES, SQUARES).copy_from(&s);
            for (column, &j) in a.column_iter().zip(&self.learned) {
                response.view_mut((t * SQUARES, j), (SQUARES, 1)).copy_from(&column);
            }
        }
        self.base = told.into_iter().next().expect("the base comes first");
        let cost = 0.5 * signals.norm_squared();
        self.response.know(Point { weights: self.base.weights.clone(), signals, cost }, response);
        self.mark = self.base.cost();
        self.damping = 1.0;
        self.plan_bend();
    }

    fn plan_bend(&mut self) {
        let signs = self.draw();
        let plan = bend_plan(self.response.blocks.len());
        let blocks = &self.response.blocks;
        let moved = |moving: &[usize], size: f64| {
            let is_moving = |j: usize| moving.iter().any(|&b| blocks[b].contains(&j));
            self.response.perturbed(|j| if is_moving(j) { size * signs[j].signum() } else { 0.0 })
        };
        self.queue = plan.iter().map(|(moving, size)| moved(moving, *size)).collect();
        self.stage = BatchKind::Bend;
    }

    fn bent(&mut self, told: &[Evaluated]) {
        if !told.iter().all(Evaluated::is_finite) {
            self.sketch_smaller();
            return;
        }
        let points: Vec<Point> = told.iter().map(|told| self.turned(told)).collect();
        self.response.learn_bends(&points);
        self.response.trust();
        self.plan_trials();
    }

    /// The squares of `told`: as the model expects them, as long as the costs say.
    fn turned(&self, told: &Evaluated) -> Point {
        let expected = self.response.expect(&self.response.base, &self.response.distance(&told.weights));
        let mut signals = expected.as_slice().to_vec();
        for (squares, root) in signals.chunks_exact_mut(SQUARES).zip(&told.roots) {
            let length = squares.iter().map(|square| square * square).sum::<f64>().sqrt();
            if length > 0.0 {
                squares.iter_mut().for_each(|square| *square *= root / length);
            } else {
                squares[WAYS] = *root;
            }
        }
        self.response.point(&told.weights, &signals)
    }

    fn plan_trials(&mut self) {
        let base = &self.response.base;
        let land = |factor: f64| {
            let (groups, from) = (core::slice::from_ref(&self.response), core::slice::from_ref(base));
            let step = step(groups, &[], from, self.damping * factor);
            step.map_or_else(|| base.weights.clone(), |step| step.weights.concat())
        };
        self.queue = TRIALS.map(land).to_vec();
        self.stage = BatchKind::Try;
    }

    fn tried(&mut self, told: Vec<Evaluated>) {
        let before = self.base.cost();
        let trials = TRIALS.into_iter().zip(told);
        let (factor, best) =
            trials.min_by(|a, b| a.1.cost().total_cmp(&b.1.cost())).expect("there is more than one trial");
        let is_cheaper = best.cost() < before;
        self.damping *= if is_cheaper { factor } else { AFTER_FAILURE };
        self.damping = self.damping.clamp(1.0 / MOST_DAMPING, MOST_DAMPING);
        self.update += 1;
        self.stalls = if before - best.cost() > LEAST_GAIN * before { 0 } else { self.stalls + 1 };
        if is_cheaper {
            self.base = best;
            self.plan_probes();
        } else {
            self.go_on();
        }
    }

    fn plan_probes(&mut self) {
        self.queue.clear();
        for _ in 0..PAIRS {
            let way = self.draw();
            self.queue.extend(self.response.both_ways(&self.base.weights, &way));
        }
        self.stage = BatchKind::Probe;
    }

    fn probed(&mut self, told: &[Evaluated]) {
        let pairs = || told.chunks(2).filter(|pair| pair.iter().all(Evaluated::is_finite));
        let way =
            |pair: &[Evaluated]| self.response.distance(&pair[0].weights) - self.response.distance(&pair[1].weights);
        let answers: Vec<DVector<f64>> = pairs().map(|pair| self.response.answers(&way(pair))).collect();
        let Point { weights, mut signals, cost } = self.turned(&self.base);
        for t in 0..self.costs {
            let own = t * SQUARES..(t + 1) * SQUARES;
            let answers = DMatrix::from_fn(answers.len(), SQUARES, |k, i| answers[k][own.start + i]);
            let changes = pairs().map(|pair| pair[0].cost_of(t) - pair[1].cost_of(t));
            let changes = DVector::from_iterator(answers.nrows(), changes);
            let expected = signals.rows(own.start, SQUARES).into_owned();
            let found = locate(expected, &answers, &changes, self.base.roots[t]);
            signals.rows_mut(own.start, SQUARES).copy_from(&found);
        }
        self.response.move_to(Point { weights, signals, cost });
        self.go_on();
    }

    fn go_on(&mut self) {
        if self.stalls < MOST_STALLS {
            self.plan_trials();
        } else if self.mark - self.base.cost() > LEAST_GAIN * self.mark {
            self.stalls = 0;
            self.plan_sketch();
        } else {
            self.exhaust(Exhausted::NothingImproves);
        }
    }
}
