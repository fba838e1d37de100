//! The step that the model says is best, of groups that share a cost.
//!
//! ```text
//! minimise  sum_groups [1/2 |rho + R x|^2 + price(w + x) + 1/2 lambda sum_b D_b |x_b|^2] + sum distances(q + R_q x)
//! ```
//! within the bounds. Where there are distances, squares that touch them at x (`distance.rs`) are minimised and taken
//! anew; each time the way to their least is halved until it gains.

use nalgebra::{DMatrix, DVector};

use crate::box_step::box_step;
use crate::distance::Distance;
use crate::response::{Point, Response};

/// Width over which a distance is smoothed, as a share of how far the nearest offset is from the centre.
const SMOOTHING: f64 = 1e-4;
/// Squares are taken anew until they gain a smaller share of the cost than this, at most so often.
const LEAST_GAIN: f64 = 1e-9;
const MOST_SQUARES: usize = 100;
/// A step that gains nothing is halved at most so often.
const MOST_HALVINGS: i32 = 20;

/// Where the model leads.
pub(crate) struct Step {
    /// The parameters of each group.
    pub(crate) weights: Vec<Vec<f64>>,
    /// The cost that the model expects there.
    pub(crate) expected: f64,
    /// How much less than at the start.
    pub(crate) gain: f64,
}

/// The step from `from`, a point of each of `groups`; `None` where the model is no number.
pub(crate) fn step(groups: &[Response], distances: &[Distance], from: &[Point], damping: f64) -> Option<Step> {
    let n = groups.iter().map(|group| group.units.len()).sum();
    let (mut curvature, mut damped) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    let mut slope = DVector::zeros(n);
    let (mut lo, mut hi, mut start) = (Vec::new(), Vec::new(), 0);
    for (group, from) in groups.iter().zip(from) {
        let own = group.quadratic(from, damping);
        let count = own.slope.len();
        curvature.view_mut((start, start), (count, count)).copy_from(&own.curvature);
        damped.view_mut((start, start), (count, count)).copy_from(&own.damped);
        slope.rows_mut(start, count).copy_from(&own.slope);
        lo.extend(own.lo);
        hi.extend(own.hi);
        start += count;
    }
    let expect = |x: &DVector<f64>| -> Vec<f64> {
        let parts = groups.iter().zip(from).zip(split(groups, x));
        parts.flat_map(|((group, from), x)| group.expect(from, &x).as_slice().to_vec()).collect()
    };
    let quadratic = |x: &DVector<f64>, h: &DMatrix<f64>| slope.dot(x) + 0.5 * x.dot(&(h * x));
    let start_cost = from.iter().map(|point| point.cost).sum::<f64>();
    let mut x = DVector::zeros(n);
    let mut gain = 0.0;
    if distances.is_empty() {
        x = box_step(&damped, &slope, &lo, &hi)?;
    } else {
        let before = expect(&x);
        let width = |distance: &Distance| SMOOTHING * distance.nearest(&before).1.norm();
        let smooth: Vec<(&Distance, f64)> = distances.iter().map(|distance| (distance, width(distance))).collect();
        let cost = |x: &DVector<f64>| {
            let signals = expect(x);
            let far = smooth.iter().map(|(distance, delta)| distance.smooth_cost(*delta, &signals));
            quadratic(x, &damped) + far.sum::<f64>()
        };
        let mut least = cost(&x);
        for _ in 0..MOST_SQUARES {
            let signals = expect(&x);
            let (mut h, mut g) = (damped.clone(), &damped * &x + &slope);
            for squares in smooth.iter().filter_map(|(distance, delta)| distance.majorizer(*delta, &signals)) {
                let rows = squares.factor * answers(groups, &squares.signals, n);
                h += rows.tr_mul(&rows);
                g += rows.tr_mul(&squares.root);
            }
            let bound = |bounds: &[f64]| -> Vec<f64> { bounds.iter().zip(&x).map(|(bound, x)| bound - x).collect() };
            let way = box_step(&h, &g, &bound(&lo), &bound(&hi))?;
            let shares = (0..MOST_HALVINGS).map(|halvings| 0.5_f64.powi(halvings));
            let mut tried = shares.map(|share| &x + &way * share).map(|x| (cost(&x), x));
            let Some((found, next)) = tried.find(|(cost, _)| *cost < least) else { break };
            let is_level = least - found < LEAST_GAIN * start_cost;
            (least, x) = (found, next);
            if is_level {
                break;
            }
        }
        let after = expect(&x);
        gain = distances.iter().map(|distance| distance.cost(&before) - distance.cost(&after)).sum();
    }
    gain -= quadratic(&x, &curvature);
    let expected = start_cost - gain;
    let weights =
        groups.iter().zip(from).zip(split(groups, &x)).map(|((group, from), x)| group.land(from, &x)).collect();
    Some(Step { weights, expected, gain })
}

/// The part of each group.
fn split(groups: &[Response], x: &DVector<f64>) -> Vec<DVector<f64>> {
    let mut end = 0;
    let part = |group: &Response| {
        end += group.units.len();
        x.rows(end - group.units.len(), group.units.len()).into_owned()
    };
    groups.iter().map(part).collect()
}

/// How each of `signals` answers to all `n` parameters.
fn answers(groups: &[Response], signals: &[usize], n: usize) -> DMatrix<f64> {
    let mut rows = DMatrix::zeros(signals.len(), n);
    for (row, signal) in signals.iter().enumerate() {
        let mut start = 0;
        for group in groups {
            if group.signals.contains(signal) {
                rows.view_mut((row, start), (1, group.units.len())).copy_from(&group.answer(*signal));
            }
            start += group.units.len();
        }
    }
    rows
}
