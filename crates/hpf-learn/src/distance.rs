//! A cost that is a distance and no square: how near something came to a ball, at the nearest moment.
//!
//! ```text
//! cost:     W max(0, min_i |q_i| - r)
//! smooth:   phi(v) = W v^2/(2 delta) up to delta, then W (v - delta/2);   v = max(0, |q| - (r - delta))
//! squares:  1/2 |s_n (n^T q - |q| + v) n + s_t (q - n n^T q)|^2,   s_n^2 = W/max(v, delta),   s_t^2 = phi'(v)/|q|
//! ```
//! q is the offset from the centre at the nearest moment, n its direction. The smooth cost bounds the cost from above,
//! and its edge lies inside the ball, so that what is best by it lies inside too where the weight allows. The squares
//! touch it at q; outside they bound it from above (Hunter, Lange, Am. Stat. 58:30, 2004), so that stepping to the
//! least of the squares, and taking them anew there, leads to the least of the smooth cost.

use core::ops::Range;

use nalgebra::{DMatrix, DVector};

/// A distance to a ball: what it costs, and the signals it is measured by. These are not squared.
#[derive(Clone, Debug, PartialEq)]
pub struct Distance {
    /// Cost per unit of distance.
    pub weight: f64,
    /// Of the ball, in the unit of the signals; within it nothing is to be paid.
    pub radius: f64,
    /// The offset from the centre: for each coordinate its signals, one per moment.
    pub offsets: Vec<Range<usize>>,
}

/// Squares that touch a smooth distance.
pub(crate) struct Majorizer {
    /// The signals of the nearest moment, one for each coordinate.
    pub(crate) signals: Vec<usize>,
    /// What an offset is multiplied by, coordinates x coordinates.
    pub(crate) factor: DMatrix<f64>,
    /// The square's root where it touches.
    pub(crate) root: DVector<f64>,
}

impl Distance {
    /// What `signals` cost.
    ///
    /// ```
    /// use hpf_learn::Distance;
    /// let distance = Distance { weight: 2.0, radius: 1.0, offsets: vec![0..2, 2..4] };
    /// // (3, 4) and then (0, 6): the first is nearer, 5 from the centre.
    /// assert_eq!(distance.cost(&[3.0, 0.0, 4.0, 6.0]), 8.0);
    /// ```
    pub fn cost(&self, signals: &[f64]) -> f64 {
        let outside = self.nearest(signals).1.norm() - self.radius;
        // A motion that is no number anywhere is near nothing.
        self.weight * if outside < 0.0 { 0.0 } else { outside }
    }

    /// The offset from the center at `moment`.
    pub(crate) fn offset(&self, signals: &[f64], moment: usize) -> DVector<f64> {
        DVector::from_iterator(self.offsets.len(), self.offsets.iter().map(|q| signals[q.start + moment]))
    }

    /// The nearest moment and the offset there.
    pub(crate) fn nearest(&self, signals: &[f64]) -> (usize, DVector<f64>) {
        let mut near = (0, self.offset(signals, 0));
        for i in 1..self.offsets[0].len() {
            let next = self.offset(signals, i);
            if next.norm().is_nan() || next.norm() < near.1.norm() {
                near = (i, next);
            }
        }
        near
    }

    /// `phi` and its slope at distance `v`.
    fn smooth(&self, delta: f64, v: f64) -> [f64; 2] {
        if v < delta {
            [0.5 * self.weight * v * v / delta, self.weight * v / delta]
        } else {
            [self.weight * (v - 0.5 * delta), self.weight]
        }
    }

    /// How far `offset` is from the ball of which [`Distance::smooth`] tells the cost.
    fn outside(&self, delta: f64, offset: &DVector<f64>) -> f64 {
        (offset.norm() - (self.radius - delta).max(0.0)).max(0.0)
    }

    /// What `signals` cost, smoothed over `delta`.
    pub(crate) fn smooth_cost(&self, delta: f64, signals: &[f64]) -> f64 {
        self.smooth_cost_of(delta, &self.nearest(signals).1)
    }

    /// What `offset` costs, smoothed over `delta`.
    pub(crate) fn smooth_cost_of(&self, delta: f64, offset: &DVector<f64>) -> f64 {
        self.smooth(delta, self.outside(delta, offset))[0]
    }

    /// The squares that touch the smooth cost at `signals`; `None` within the ball.
    pub(crate) fn majorizer(&self, delta: f64, signals: &[f64]) -> Option<Majorizer> {
        self.majorizer_at(delta, signals, self.nearest(signals).0)
    }

    /// The squares that touch the smooth cost of the offset at `moment`; `None` within the ball.
    pub(crate) fn majorizer_at(&self, delta: f64, signals: &[f64], moment: usize) -> Option<Majorizer> {
        let offset = self.offset(signals, moment);
        let v = self.outside(delta, &offset);
        if v == 0.0 {
            return None;
        }
        let way = offset.normalize();
        let along = (self.weight / v.max(delta)).sqrt();
        let across = (self.smooth(delta, v)[1] / offset.norm()).sqrt();
        let (coordinates, outer) = (offset.len(), &way * way.transpose());
        let factor = DMatrix::identity(coordinates, coordinates) * across + outer * (along - across);
        let signals = self.offsets.iter().map(|offsets| offsets.start + moment).collect();
        Some(Majorizer { signals, factor, root: way * (along * v) })
    }
}
