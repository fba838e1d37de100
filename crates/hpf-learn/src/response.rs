//! What is known of how the signals of one group answer its parameters.
//!
//! In perturbation units `x = (w - w_base)/unit`, with blocks a, b of n_a, n_b parameters:
//! ```text
//! model:   rho(base + x) = rho + R x + bend,    |bend|^2 ~ 1/4 sum_ab c_ab |x_a|^2 |x_b|^2 / (n_a n_b)
//! step:    minimise 1/2 |rho + R x|^2 + price(w + x) + 1/2 lambda sum_b D_b |x_b|^2    in the box
//! secant:  R <- R + (drho - R x) G^T,   G = P x/(v + x^T P x),   P <- P - G x^T P
//! move:    P_aa <- P_aa + forgetting sum_b c_ab |x_b|^2 / (n_a n_b)
//! ```
//! | symbol | meaning |
//! |---|---|
//! | R | response, signals x parameters |
//! | P | doubt: covariance of a row of R, summed over the signals |
//! | c_ab | bend: energy of the second difference of the signals when blocks a and b move by one unit each |
//! | D_b | sum_a c_ab / n_b: with lambda = 1, a step of one unit is damped by what it is expected to cost by bending |
//! | v | energy of the noise in a difference of signals and of the bend at x |
//!
//! A block that answers linearly has no bend: it is neither damped nor forgotten, however far it goes. That is what
//! makes learning from signals fast here: the motion is linear in the movement's weights, so only stiffness and
//! damping need small steps. The secant update is recursive least squares with one covariance for all rows; where P
//! is large beside v it is Broyden's.
//!
//! Sources: Marquardt, SIAM J. Appl. Math. 11:431, 1963; Broyden, Math. Comp. 19:577, 1965; Ljung, System
//! Identification, 1999, ch. 11.

use core::ops::Range;

use nalgebra::{DMatrix, DVector, RowDVector};

use crate::distance::Distance;
use crate::{Block, SignalGroup, SignalModel};

/// Noise of signals that show none, as a share of the energy of their change: rounding.
const LEAST_NOISE: f64 = 1e-12;

/// Bend of a block that shows none, as a share of what one unit of it does to the signals: keeps the step regular.
const LEAST_BEND: f64 = 1e-9;

/// The same as a share of the noise, which hides smaller bends.
const NOISE_BEND: f64 = 0.1;

/// A second difference shows a bend where its energy is this many times what noise alone makes of it.
const SIGNIFICANT: f64 = 3.0;

/// Share of a bend that is forgotten of the response when the base moves. One would be right for a bend that changes
/// every column by itself; measured, a tenth learns as fast without noise and faster with it.
const FORGETTING: f64 = 0.1;

/// Size of smaller perturbations, as a share of those before.
const SHRINK: f64 = 0.3;

/// A perturbation is halved at most this often.
const MOST_HALVINGS: u32 = 10;

/// A sample and the signals it led to.
#[derive(Clone, Debug)]
pub(crate) struct Rollout {
    pub(crate) weights: Vec<f64>,
    pub(crate) signals: Vec<f64>,
}

impl Rollout {
    pub(crate) fn is_finite(&self) -> bool {
        self.signals.iter().all(|signal| signal.is_finite())
    }

    /// The mean of rollouts of the same weights.
    pub(crate) fn mean(repeats: &[&Self]) -> Self {
        let Self { weights, signals } = repeats[0];
        let mean = |i: usize| repeats.iter().map(|rollout| rollout.signals[i]).sum::<f64>() / repeats.len() as f64;
        Self { weights: weights.clone(), signals: (0..signals.len()).map(mean).collect() }
    }

    /// The part of `group`.
    pub(crate) fn of(&self, group: &Response) -> Point {
        group.point(&self.weights, &self.signals)
    }
}

/// Parameters tried and the signals measured there.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    pub(crate) weights: Vec<f64>,
    pub(crate) signals: DVector<f64>,
    pub(crate) cost: f64,
}

/// A quadratic of a step in a box, in perturbation units.
pub(crate) struct Quadratic {
    pub(crate) curvature: DMatrix<f64>,
    /// The same and the damping.
    pub(crate) damped: DMatrix<f64>,
    pub(crate) slope: DVector<f64>,
    pub(crate) lo: Vec<f64>,
    pub(crate) hi: Vec<f64>,
}

/// One group of parameters and signals.
#[derive(Clone, Debug)]
pub(crate) struct Response {
    /// Where they stand among all.
    pub(crate) parameters: Range<usize>,
    pub(crate) signals: Range<usize>,
    /// The parameters of each block that is learned, among the group's.
    pub(crate) blocks: Vec<Range<usize>>,
    min: Vec<f64>,
    max: Vec<f64>,
    /// Size of a perturbation; zero for a parameter that is not to be learned.
    pub(crate) units: Vec<f64>,
    halvings: Vec<u32>,
    price: DMatrix<f64>,
    /// The signals that are squared.
    squares: Vec<usize>,
    /// The problem's distances, and the share of their cost that is told as this group's.
    distances: Vec<Distance>,
    share: f64,
    /// The best known point.
    pub(crate) base: Point,
    response: DMatrix<f64>,
    doubt: DMatrix<f64>,
    /// c_ab.
    pub(crate) bends: DMatrix<f64>,
    /// Energy of the noise in the signals of one rollout.
    pub(crate) noise: f64,
}

impl Response {
    /// Nothing known yet, at `weights`; `units` are the largest perturbations.
    pub(crate) fn new(group: &SignalGroup, blocks: &[Block], model: &SignalModel, weights: &[f64]) -> Self {
        let (n, m) = (group.parameters.len(), group.signals.len());
        let base = Point {
            weights: weights[group.parameters.clone()].to_vec(),
            signals: DVector::zeros(m),
            cost: f64::INFINITY,
        };
        let is_offset = |i: usize| model.distances.iter().flat_map(|d| &d.offsets).any(|offsets| offsets.contains(&i));
        let mut response = Self {
            parameters: group.parameters.clone(),
            signals: group.signals.clone(),
            blocks: Vec::new(),
            min: Vec::new(),
            max: Vec::new(),
            units: Vec::new(),
            halvings: vec![0; n],
            price: DMatrix::zeros(n, n),
            squares: (0..m).filter(|i| !is_offset(group.signals.start + i)).collect(),
            distances: model.distances.clone(),
            share: group.parameters.len() as f64 / weights.len() as f64,
            base,
            response: DMatrix::zeros(m, n),
            doubt: DMatrix::zeros(n, n),
            bends: DMatrix::zeros(0, 0),
            noise: 0.0,
        };
        let mut start = 0;
        for (block, price) in blocks.iter().zip(&model.price) {
            if group.parameters.contains(&start) {
                let first = response.units.len();
                let n = block.count;
                response.min.extend(vec![block.min; n]);
                response.max.extend(vec![block.max; n]);
                // At most half the box: then one of the two ways always lies inside.
                let unit = block.noise.min(0.5 * (block.max - block.min));
                response.units.extend(vec![unit; n]);
                if unit > 0.0 {
                    response.blocks.push(first..first + n);
                }
                if !price.is_empty() {
                    let price = DMatrix::from_row_slice(n, n, price);
                    response.price.view_mut((first, first), (n, n)).copy_from(&price);
                }
            }
            start += block.count;
        }
        let count = response.blocks.len();
        response.bends = DMatrix::zeros(count, count);
        response
    }

    /// The group's part of a rollout; without a cost where a signal is not finite.
    pub(crate) fn point(&self, weights: &[f64], signals: &[f64]) -> Point {
        let weights = weights[self.parameters.clone()].to_vec();
        let own = DVector::from_column_slice(&signals[self.signals.clone()]);
        let w = DVector::from_column_slice(&weights);
        let distances: f64 = self.distances.iter().map(|distance| distance.cost(signals)).sum();
        let squares = own.select_rows(&self.squares).norm_squared() + w.dot(&(&self.price * &w));
        let cost = 0.5 * squares + self.share * distances;
        Point { weights, signals: own, cost: if cost.is_finite() { cost } else { f64::INFINITY } }
    }

    /// Takes `mean`, that of rollouts of the same weights, as the base, and their scatter as the noise.
    pub(crate) fn settle(&mut self, mean: Point, repeats: &[Point]) {
        let scatter = repeats.iter().map(|point| (&point.signals - &mean.signals).norm_squared()).sum::<f64>();
        self.noise = scatter / (repeats.len() as f64 - 1.0).max(1.0);
        self.base = mean;
    }

    /// The base moved by `x` units, each parameter the other way where one unit would leave its bounds.
    pub(crate) fn perturbed(&self, x: impl Fn(usize) -> f64) -> Vec<f64> {
        let moved = |j: usize| {
            let (w, x) = (self.base.weights[j], x(j));
            let whole = w + x.signum() * self.units[j];
            let way = if self.min[j] <= whole && whole <= self.max[j] { 1.0 } else { -1.0 };
            (w + way * x * self.units[j]).max(self.min[j]).min(self.max[j])
        };
        (0..self.units.len()).map(moved).collect()
    }

    /// `weights` moved by `x` units and by as much the other way, but for parameters that would leave their bounds.
    pub(crate) fn both_ways(&self, weights: &[f64], x: &[f64]) -> [Vec<f64>; 2] {
        let moved = |way: f64| {
            let moved = |j: usize| {
                let step = x[j] * self.units[j];
                let is_inside = self.min[j] <= weights[j] - step.abs() && weights[j] + step.abs() <= self.max[j];
                if is_inside { weights[j] + way * step } else { weights[j] }
            };
            (0..weights.len()).map(moved).collect()
        };
        [moved(1.0), moved(-1.0)]
    }

    /// Takes `base` and its `response` for known.
    pub(crate) fn know(&mut self, base: Point, response: DMatrix<f64>) {
        self.base = base;
        self.response = response;
    }

    /// Takes the response as it is for known.
    pub(crate) fn trust(&mut self) {
        self.doubt.fill(0.0);
    }

    /// Makes every perturbation smaller.
    pub(crate) fn shrink(&mut self) {
        self.units.iter_mut().for_each(|unit| *unit *= SHRINK);
        self.response *= SHRINK;
        self.doubt *= SHRINK * SHRINK;
    }

    /// Whether most of what smaller perturbations did would be noise.
    pub(crate) fn is_hidden_when_smaller(&self) -> bool {
        let answer = self.response.norm_squared() / self.units.len() as f64;
        SHRINK * SHRINK * answer < 2.0 * self.noise
    }

    /// Halves the perturbation of parameter `j`; after [`MOST_HALVINGS`] it is no longer learned.
    pub(crate) fn halve(&mut self, j: usize) {
        self.halvings[j] += 1;
        self.units[j] *= if self.halvings[j] > MOST_HALVINGS { 0.0 } else { 0.5 };
        self.response.column_mut(j).scale_mut(0.5);
        self.doubt.row_mut(j).scale_mut(0.5);
        self.doubt.column_mut(j).scale_mut(0.5);
    }

    /// How far `weights` are from the base, in units.
    pub(crate) fn distance(&self, weights: &[f64]) -> DVector<f64> {
        let pairs = weights.iter().zip(&self.base.weights).zip(&self.units);
        let units = pairs.map(|((w, base), unit)| if *unit > 0.0 { (w - base) / unit } else { 0.0 });
        DVector::from_iterator(weights.len(), units)
    }

    /// `|x_b|^2 / n_b` of each block.
    fn lengths(&self, x: &DVector<f64>) -> DVector<f64> {
        let length = |block: &Range<usize>| x.rows(block.start, block.len()).norm_squared() / block.len() as f64;
        DVector::from_iterator(self.blocks.len(), self.blocks.iter().map(length))
    }

    /// Learns the bends from rollouts around the base: of each block by one unit and by half of it, then of each pair
    /// of blocks by one unit, in the order of [`bend_plan`]. The response itself is in full doubt after it.
    pub(crate) fn learn_bends(&mut self, points: &[Point]) {
        let count = self.blocks.len();
        let rest = &self.base.signals;
        // Energy of a sum of signals beyond what noise makes of it; `spread` is the sum of its squared factors.
        let beyond = |sum: DVector<f64>, spread: f64| {
            let energy = sum.norm_squared();
            if energy > SIGNIFICANT * spread * self.noise { energy - spread * self.noise } else { 0.0 }
        };
        let mut pairs = points[2 * count..].iter();
        for a in 0..count {
            let (whole, half) = (&points[2 * a].signals, &points[2 * a + 1].signals);
            let answer = (whole - rest).norm_squared();
            // The half step's second difference is a quarter of the whole's.
            let bend = 16.0 * beyond(whole - 2.0 * half + rest, 6.0);
            self.bends[(a, a)] = bend.max(LEAST_BEND * answer).max(NOISE_BEND * self.noise);
            for j in self.blocks[a].clone() {
                self.doubt[(j, j)] += answer / self.blocks[a].len() as f64;
            }
            for b in a + 1..count {
                let both = &pairs.next().expect("one rollout for each pair of blocks").signals;
                let bend = beyond(both - whole - &points[2 * b].signals + rest, 4.0);
                self.bends[(a, b)] = bend;
                self.bends[(b, a)] = bend;
            }
        }
    }

    /// Mends the response by the signals of a rollout.
    pub(crate) fn learn_secant(&mut self, point: &Point) {
        let x = self.distance(&point.weights);
        let change = &point.signals - &self.base.signals;
        let lengths = self.lengths(&x);
        let bend = 0.25 * lengths.dot(&(&self.bends * &lengths));
        let doubt = &self.doubt * &x;
        let spread = 2.0 * self.noise + bend + LEAST_NOISE * change.norm_squared() + x.dot(&doubt);
        if point.cost.is_finite() && spread > 0.0 {
            let gain = &doubt / spread;
            let miss = change - &self.response * &x;
            self.response.ger(1.0, &miss, &gain, 1.0);
            self.doubt.ger(-1.0, &gain, &doubt, 1.0);
        }
    }

    /// Makes `point` the base: the further the way, the less is known of what bends.
    pub(crate) fn move_to(&mut self, point: Point) {
        let lengths = self.lengths(&self.distance(&point.weights));
        self.forget(&(FORGETTING * lengths));
        self.learn_secant(&point);
        self.base = point;
    }

    /// Doubts the response as after a move of each block by one unit, all of it forgotten.
    pub(crate) fn doubt_all(&mut self) {
        self.forget(&DVector::repeat(self.blocks.len(), 1.0));
    }

    fn forget(&mut self, lengths: &DVector<f64>) {
        let growth = &self.bends * lengths;
        for (block, growth) in self.blocks.iter().zip(&growth) {
            for j in block.clone() {
                self.doubt[(j, j)] += growth / block.len() as f64;
            }
        }
    }

    /// How far each parameter may go from the base, all at once, until they are expected to double the cost: at most
    /// its perturbation.
    pub(crate) fn scales(&self) -> Vec<f64> {
        let count = self.units.len() as f64;
        let scale = |j: usize| {
            let unit = self.units[j];
            let curvature = self.response.column(j).norm_squared() + unit * unit * self.price[(j, j)];
            unit * (2.0 * self.base.cost / (count * curvature)).sqrt().min(1.0)
        };
        (0..self.units.len()).map(scale).collect()
    }

    /// What the model says of steps from `from`, but for the distances.
    pub(crate) fn quadratic(&self, from: &Point, damping: f64) -> Quadratic {
        let n = self.units.len();
        let units = DVector::from_column_slice(&self.units);
        let weights = DVector::from_column_slice(&from.weights);
        let price = DMatrix::from_fn(n, n, |i, j| units[i] * self.price[(i, j)] * units[j]);
        let response = self.response.select_rows(&self.squares);
        let curvature = response.tr_mul(&response) + price;
        let signals = from.signals.select_rows(&self.squares);
        let slope = response.tr_mul(&signals) + (&self.price * weights).component_mul(&units);
        let mut damped = curvature.clone();
        (0..n).filter(|j| self.units[*j] == 0.0).for_each(|j| damped[(j, j)] += 1.0);
        for (b, block) in self.blocks.iter().enumerate() {
            let bend = self.bends.column(b).sum() / block.len() as f64;
            for j in block.clone() {
                // Parameters that nothing answers to have no curvature: any number will do.
                damped[(j, j)] += if bend > 0.0 { damping * bend } else { 1.0 };
            }
        }
        let reach = |bound: f64, j: usize| if units[j] > 0.0 { (bound - from.weights[j]) / units[j] } else { 0.0 };
        let lo = (0..n).map(|j| reach(self.min[j], j).min(0.0)).collect();
        let hi = (0..n).map(|j| reach(self.max[j], j).max(0.0)).collect();
        Quadratic { curvature, damped, slope, lo, hi }
    }

    /// The signals expected `x` units from `from`.
    pub(crate) fn expect(&self, from: &Point, x: &DVector<f64>) -> DVector<f64> {
        &from.signals + &self.response * x
    }

    /// By how much the signals are expected to differ `x` units apart.
    pub(crate) fn answers(&self, x: &DVector<f64>) -> DVector<f64> {
        &self.response * x
    }

    /// How signal `i`, of all, answers.
    pub(crate) fn answer(&self, i: usize) -> RowDVector<f64> {
        self.response.row(i - self.signals.start).into_owned()
    }

    /// The parameters `x` units from `from`.
    pub(crate) fn land(&self, from: &Point, x: &DVector<f64>) -> Vec<f64> {
        let moved = |j: usize| (from.weights[j] + x[j] * self.units[j]).max(self.min[j]).min(self.max[j]);
        (0..self.units.len()).map(moved).collect()
    }
}

/// The blocks that move, and by how many units, in each rollout that [`Response::learn_bends`] learns from.
pub(crate) fn bend_plan(blocks: usize) -> Vec<(Vec<usize>, f64)> {
    let alone = (0..blocks).flat_map(|b| [(vec![b], 1.0), (vec![b], 0.5)]);
    let pairs = (0..blocks).flat_map(|a| (a + 1..blocks).map(move |b| (vec![a, b], 1.0)));
    alone.chain(pairs).collect()
}
