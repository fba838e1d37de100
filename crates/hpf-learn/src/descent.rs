//! The least of a cost whose signals can be computed with their slopes: projected Levenberg-Marquardt.
//!
//! ```text
//! minimise  1/2 |rho(w)|^2 + price(w) + distances(rho(w)) + 1/2 pull |D^-1 (w - anchor)|^2    within the bounds
//! ```
//! D are the scales of the parameters. Each step solves the damped normal equations over the parameters that no bound
//! holds, cuts what leaves the box off at its bounds and solves for the rest again; it is kept where the cost fell.
//! Nothing here makes a motion.

use nalgebra::{DMatrix, DVector};

use crate::distance::Distance;
use crate::gram::gram;
use crate::{Block, SignalModel};

/// Signals that can be computed, with their slopes: a model of what moves.
pub trait Computed: Sync {
    /// Writes the signals of group `group` with its parameters `weights`; false where they are no numbers.
    fn signals(&self, group: usize, weights: &[f64], signals: &mut Vec<f64>) -> bool;

    /// The same with the slope of every signal by every parameter, one column after the other.
    fn slopes(&self, group: usize, weights: &[f64], signals: &mut Vec<f64>, slopes: &mut Vec<f64>) -> bool;
}

/// How far to go.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Steps at most.
    pub steps: usize,
    /// A step that gains a smaller share of the cost is the last.
    pub least_gain: f64,
}

/// A search within the parameters of a problem.
#[derive(Clone, Debug)]
pub struct Descent {
    model: SignalModel,
    lo: Vec<f64>,
    hi: Vec<f64>,
    /// Parameters that are not learned.
    held: Vec<bool>,
    scales: Vec<f64>,
    /// The price of each group's parameters.
    prices: Vec<DMatrix<f64>>,
    /// Signals that are squared, by group, counted within it.
    squared: Vec<Vec<bool>>,
}

/// Where a search begins.
#[derive(Clone, Copy, Debug)]
pub struct Begin<'a> {
    /// The parameters, of all groups.
    pub weights: &'a [f64],
    /// What is pulled to.
    pub anchor: &'a [f64],
    /// How strongly.
    pub pull: f64,
    /// The moment at which each distance is measured; the nearest, where there is none.
    pub moments: Option<&'a [usize]>,
}

/// Damping at the first step, relative to the curvature.
const FIRST_DAMPING: f64 = 1e-3;
const MORE_DAMPING: f64 = 6.0;
const LESS_DAMPING: f64 = 0.2;
const LEAST_DAMPING: f64 = 1e-9;
const MOST_DAMPING: f64 = 1e8;
/// Rounds in which parameters are cut off at their bounds.
const MOST_CUTS: usize = 6;
/// Width over which a distance is smoothed, as a share of the farthest it has been.
const SMOOTHING: f64 = 1e-4;
/// Curvature of a parameter that nothing answers to.
const FLAT: f64 = 1e-12;

impl Descent {
    /// For the parameters `blocks` of `model`; `scales` are the sizes at which each parameter counts alike.
    pub fn new(blocks: &[Block], model: &SignalModel, scales: &[f64]) -> Self {
        let (mut lo, mut hi, mut held, mut at) = (Vec::new(), Vec::new(), Vec::new(), 0);
        let mut whole = DMatrix::zeros(scales.len(), scales.len());
        for (block, price) in blocks.iter().zip(&model.price) {
            for j in 0..block.count {
                lo.push(block.min);
                hi.push(block.max);
                held.push(block.noise == 0.0);
                for (i, price) in price.chunks(block.count).nth(j).unwrap_or_default().iter().enumerate() {
                    whole[(at + j, at + i)] = *price;
                }
            }
            at += block.count;
        }
        let price = |group: &crate::SignalGroup| {
            let range = &group.parameters;
            whole.view((range.start, range.start), (range.len(), range.len())).into_owned()
        };
        let is_offset = |signal: usize| {
            model.distances.iter().any(|distance| distance.offsets.iter().any(|offsets| offsets.contains(&signal)))
        };
        Self {
            lo,
            hi,
            held,
            scales: scales.to_vec(),
            prices: model.groups.iter().map(price).collect(),
            squared: model.groups.iter().map(|group| group.signals.clone().map(|s| !is_offset(s)).collect()).collect(),
            model: model.clone(),
        }
    }

    /// Length of the way from `from` to `to`: the root of the mean square of the ways of the parameters, in their scales.
    pub fn length(&self, from: &[f64], to: &[f64]) -> f64 {
        let ways = from.iter().zip(to).zip(&self.scales).map(|((from, to), scale)| (to - from) / scale);
        (ways.map(|way| way * way).sum::<f64>() / self.learned() as f64).sqrt()
    }

    /// Parameters that are learned, at least one.
    pub fn learned(&self) -> usize {
        self.held.iter().filter(|held| !**held).count().max(1)
    }

    /// The groups that have to be searched together: those that a distance joins.
    fn parties(&self) -> Vec<Vec<usize>> {
        let all = 0..self.model.groups.len();
        if self.model.distances.is_empty() { all.map(|group| vec![group]).collect() } else { vec![all.collect()] }
    }

    /// What `weights` are computed to cost; infinite where that is no number.
    pub fn cost(&self, computed: &impl Computed, weights: &[f64]) -> f64 {
        let cost = |party: &Vec<usize>| {
            let point = Point::at(self, computed, party, weights);
            point.map_or(f64::INFINITY, |point| self.exact_cost(&point))
        };
        self.parties().iter().map(cost).sum()
    }

    /// The least that is found from `begin`, and what it costs without the pull.
    pub fn least(&self, computed: &impl Computed, begin: Begin<'_>, effort: Effort) -> (Vec<f64>, f64) {
        let mut weights: Vec<f64> =
            begin.weights.iter().zip(self.lo.iter().zip(&self.hi)).map(|(w, (lo, hi))| w.max(*lo).min(*hi)).collect();
        let mut total = 0.0;
        for party in self.parties() {
            total += self.search(computed, &party, begin, effort, &mut weights);
        }
        (weights, total)
    }

    /// Moments in one motion, where there are distances.
    pub fn moments(&self) -> usize {
        self.model.distances.first().map_or(0, |distance| distance.offsets[0].len())
    }

    /// Distances that the cost has.
    pub fn distances(&self) -> usize {
        self.model.distances.len()
    }

    fn search(
        &self,
        computed: &impl Computed,
        party: &[usize],
        begin: Begin<'_>,
        effort: Effort,
        weights: &mut [f64],
    ) -> f64 {
        let Some(mut point) = Point::at(self, computed, party, weights) else { return f64::INFINITY };
        let widths = self.widths(&point, begin.moments);
        let mut cost = self.smooth_cost(&point, begin, &widths);
        let mut damping = FIRST_DAMPING;
        let mut stalls = 0;
        for _ in 0..effort.steps {
            let Some((curvature, slope)) = self.quadratic(computed, &mut point, begin, &widths) else { break };
            let before = cost;
            while damping < MOST_DAMPING {
                let Some(step) = self.step(&point, &curvature, &slope, damping) else {
                    damping *= MORE_DAMPING;
                    continue;
                };
                let moved: Vec<f64> = point
                    .indices
                    .iter()
                    .zip(point.weights.iter().zip(&step))
                    .map(|(&i, (w, x))| (w + x).max(self.lo[i]).min(self.hi[i]))
                    .collect();
                let next = Point::of(self, computed, party, moved);
                let found = next.as_ref().map_or(f64::INFINITY, |next| self.smooth_cost(next, begin, &widths));
                if let Some(next) = next
                    && found < cost
                {
                    (point, cost) = (next, found);
                    damping = (damping * LESS_DAMPING).max(LEAST_DAMPING);
                    break;
                }
                damping *= MORE_DAMPING;
            }
            stalls = if before - cost <= effort.least_gain * cost.abs() { stalls + 1 } else { 0 };
            if damping >= MOST_DAMPING || stalls > 1 {
                break;
            }
        }
        for (&i, w) in point.indices.iter().zip(&point.weights) {
            weights[i] = *w;
        }
        self.exact_cost(&point)
    }

    fn exact_cost(&self, point: &Point) -> f64 {
        let distances: f64 = self.model.distances.iter().map(|distance| distance.cost(&point.signals)).sum();
        self.square_cost(point) + distances
    }

    /// Squares and prices.
    fn square_cost(&self, point: &Point) -> f64 {
        let mut cost = 0.0;
        for (&group, weights) in point.party.iter().zip(point.split(self)) {
            let range = self.model.groups[group].signals.clone();
            let squares = point.signals[range].iter().zip(&self.squared[group]);
            cost += 0.5 * squares.map(|(signal, squared)| if *squared { signal * signal } else { 0.0 }).sum::<f64>();
            let weights = DVector::from_column_slice(weights);
            cost += 0.5 * weights.dot(&(&self.prices[group] * &weights));
        }
        cost
    }

    fn moment(distance: &Distance, signals: &[f64], d: usize, moments: Option<&[usize]>) -> usize {
        moments.and_then(|moments| moments.get(d).copied()).unwrap_or_else(|| distance.nearest(signals).0)
    }

    fn widths(&self, point: &Point, moments: Option<&[usize]>) -> Vec<f64> {
        let width = |(d, distance): (usize, &Distance)| {
            let moment = Self::moment(distance, &point.signals, d, moments);
            SMOOTHING * distance.offset(&point.signals, moment).norm().max(distance.radius)
        };
        self.model.distances.iter().enumerate().map(width).collect()
    }

    fn smooth_cost(&self, point: &Point, begin: Begin<'_>, widths: &[f64]) -> f64 {
        let smooth = |(d, (distance, width)): (usize, (&Distance, &f64))| {
            let moment = Self::moment(distance, &point.signals, d, begin.moments);
            distance.smooth_cost_of(*width, &distance.offset(&point.signals, moment))
        };
        let distances: f64 = self.model.distances.iter().zip(widths).enumerate().map(smooth).sum();
        let pull = |(&i, w): (&usize, &f64)| ((w - begin.anchor[i]) / self.scales[i]).powi(2);
        let pulled: f64 = if begin.pull > 0.0 { point.indices.iter().zip(&point.weights).map(pull).sum() } else { 0.0 };
        let cost = self.square_cost(point) + distances + 0.5 * begin.pull * pulled;
        if cost.is_nan() { f64::INFINITY } else { cost }
    }

    /// Curvature and slope of the cost at `point`; `None` where they are no numbers.
    fn quadratic(
        &self,
        computed: &impl Computed,
        point: &mut Point,
        begin: Begin<'_>,
        widths: &[f64],
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let n = point.indices.len();
        let (mut curvature, mut slope) = (DMatrix::zeros(n, n), DVector::zeros(n));
        let (mut own, mut slopes, mut at) = (Vec::new(), Vec::new(), 0);
        let mut answers: Vec<(usize, Vec<f64>)> = Vec::new();
        for &group in &point.party {
            let range = self.model.groups[group].signals.clone();
            let count = self.model.groups[group].parameters.len();
            let weights = &point.weights[at..at + count];
            if !computed.slopes(group, weights, &mut own, &mut slopes) {
                return None;
            }
            let rows = range.len();
            if self.model.distances.is_empty() {
                curvature.view_mut((at, at), (count, count)).copy_from(&gram(&slopes, rows));
            } else {
                answers.push((at, slopes.clone()));
                let mut squared = slopes.clone();
                for column in squared.chunks_mut(rows) {
                    column.iter_mut().zip(&self.squared[group]).filter(|(_, is)| !**is).for_each(|(s, _)| *s = 0.0);
                }
                curvature.view_mut((at, at), (count, count)).copy_from(&gram(&squared, rows));
            }
            let price = &self.prices[group];
            let mut view = curvature.view_mut((at, at), (count, count));
            view += price;
            let paid = price * DVector::from_column_slice(weights);
            for (j, column) in slopes.chunks(rows).enumerate() {
                let products = column.iter().zip(&own).zip(&self.squared[group]);
                let sum: f64 = products.map(|((s, rho), is)| if *is { s * rho } else { 0.0 }).sum();
                slope[at + j] += sum + paid[j];
            }
            point.signals[range].copy_from_slice(&own);
            at += count;
        }
        for (d, (distance, width)) in self.model.distances.iter().zip(widths).enumerate() {
            let moment = Self::moment(distance, &point.signals, d, begin.moments);
            let Some(squares) = distance.majorizer_at(*width, &point.signals, moment) else { continue };
            let mut rows = DMatrix::zeros(squares.signals.len(), n);
            for (r, signal) in squares.signals.iter().enumerate() {
                let party = point.party.iter().zip(&answers);
                let mut of = party.filter(|(group, _)| self.model.groups[**group].signals.contains(signal));
                let (&group, (start, slopes)) = of.next()?;
                let signals = &self.model.groups[group].signals;
                for (j, column) in slopes.chunks(signals.len()).enumerate() {
                    rows[(r, start + j)] = column[signal - signals.start];
                }
            }
            let rows = squares.factor * rows;
            curvature += rows.tr_mul(&rows);
            slope += rows.tr_mul(&squares.root);
        }
        if begin.pull > 0.0 {
            for (j, (&i, w)) in point.indices.iter().zip(&point.weights).enumerate() {
                let share = begin.pull / (self.scales[i] * self.scales[i]);
                curvature[(j, j)] += share;
                slope[j] += share * (w - begin.anchor[i]);
            }
        }
        (slope.iter().chain(&curvature).all(|x| x.is_finite())).then_some((curvature, slope))
    }

    /// The step from `point` that is best by the damped quadratic, but for the cuts at the bounds.
    fn step(&self, point: &Point, curvature: &DMatrix<f64>, slope: &DVector<f64>, damping: f64) -> Option<Vec<f64>> {
        let n = slope.len();
        let room = |j: usize| {
            let (i, w) = (point.indices[j], point.weights[j]);
            if self.held[i] { (0.0, 0.0) } else { (self.lo[i] - w, self.hi[i] - w) }
        };
        let mut step = vec![0.0; n];
        let mut held: Vec<bool> = (0..n)
            .map(|j| {
                let (lo, hi) = room(j);
                (lo >= 0.0 && slope[j] > 0.0) || (hi <= 0.0 && slope[j] < 0.0) || lo >= hi
            })
            .collect();
        let most = (0..n).map(|j| curvature[(j, j)] * self.scales[point.indices[j]].powi(2)).fold(0.0, f64::max);
        for _ in 0..MOST_CUTS {
            let free: Vec<usize> = (0..n).filter(|&j| !held[j]).collect();
            if free.is_empty() {
                break;
            }
            let mut inner = DMatrix::from_fn(free.len(), free.len(), |a, b| curvature[(free[a], free[b])]);
            for (a, &j) in free.iter().enumerate() {
                let scale = self.scales[point.indices[j]];
                inner[(a, a)] += damping * curvature[(j, j)] + FLAT * most / (scale * scale) + f64::MIN_POSITIVE;
            }
            let right = DVector::from_fn(free.len(), |a, _| {
                let j = free[a];
                let fixed: f64 =
                    (0..n).filter(|&i| held[i] && step[i] != 0.0).map(|i| curvature[(j, i)] * step[i]).sum();
                -slope[j] - fixed
            });
            let solved = inner.cholesky()?.solve(&right);
            let mut cuts = 0;
            for (a, &j) in free.iter().enumerate() {
                let (lo, hi) = room(j);
                step[j] = solved[a];
                if !(lo..=hi).contains(&step[j]) {
                    step[j] = step[j].max(lo).min(hi);
                    held[j] = true;
                    cuts += 1;
                }
            }
            if cuts == 0 {
                break;
            }
        }
        step.iter().all(|x| x.is_finite()).then_some(step)
    }
}

/// Parameters of some groups, and the signals there.
struct Point {
    party: Vec<usize>,
    /// Of the parameters among all.
    indices: Vec<usize>,
    weights: Vec<f64>,
    /// Of all groups; those of others are zero.
    signals: Vec<f64>,
}

impl Point {
    fn at(descent: &Descent, computed: &impl Computed, party: &[usize], weights: &[f64]) -> Option<Self> {
        let own = party.iter().flat_map(|&group| weights[descent.model.groups[group].parameters.clone()].to_vec());
        Self::of(descent, computed, party, own.collect())
    }

    fn of(descent: &Descent, computed: &impl Computed, party: &[usize], weights: Vec<f64>) -> Option<Self> {
        let groups = &descent.model.groups;
        let mut signals = vec![0.0; groups.last().map_or(0, |group| group.signals.end)];
        let (mut at, mut own) = (0, Vec::new());
        for &group in party {
            let count = groups[group].parameters.len();
            if !computed.signals(group, &weights[at..at + count], &mut own) {
                return None;
            }
            signals[groups[group].signals.clone()].copy_from_slice(&own);
            at += count;
        }
        let indices = party.iter().flat_map(|&group| groups[group].parameters.clone()).collect();
        Some(Self { party: party.to_vec(), indices, weights, signals })
    }

    /// The weights of each group.
    fn split<'p>(&'p self, descent: &'p Descent) -> impl Iterator<Item = &'p [f64]> {
        let mut at = 0;
        self.party.iter().map(move |&group| {
            at += descent.model.groups[group].parameters.len();
            &self.weights[at - descent.model.groups[group].parameters.len()..at]
        })
    }
}
