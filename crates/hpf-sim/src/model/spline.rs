//! Functions of time with few coefficients: a constant, or a uniform cubic B-spline.
//!
//! With n coefficients over n - 3 intervals of length 1 and u the place within one:
//! `(1-u)^3/6, (3u^3 - 6u^2 + 4)/6, (-3u^3 + 3u^2 + 3u + 1)/6, u^3/6`; they sum to one (de Boor, 1978).

use nalgebra::{DMatrix, DVector};

/// Keeps coefficients that few samples tell of finite.
const RIDGE: f64 = 1e-9;

/// Coefficients that count at one instant: the first of them, and the weight of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) first: usize,
    pub(super) weights: [f64; 4],
}

/// The weights of `count` coefficients at each of `instants` instants, evenly from the start to the end.
#[derive(Clone, Debug)]
pub(super) struct Spline {
    pub(super) count: usize,
    rows: Vec<Row>,
}

impl Spline {
    /// `count` is 0, 1 or at least 4.
    pub(super) fn new(count: usize, instants: usize) -> Self {
        let row = |i: usize| {
            if count < 4 {
                return Row { first: 0, weights: [1.0, 0.0, 0.0, 0.0] };
            }
            let at = i as f64 / (instants - 1).max(1) as f64 * (count - 3) as f64;
            let first = (at.floor() as usize).min(count - 4);
            let u = at - first as f64;
            let v = 1.0 - u;
            let weights =
                [v * v * v, 3.0 * u * u * u - 6.0 * u * u + 4.0, 3.0 * u * (1.0 + u - u * u) + 1.0, u * u * u];
            Row { first, weights: weights.map(|weight| weight / 6.0) }
        };
        Self { count, rows: (0..instants).map(row).collect() }
    }

    pub(super) fn instants(&self) -> usize {
        self.rows.len()
    }

    /// The coefficients nearest to `samples`, one at every second instant.
    pub(super) fn fitted(&self, samples: &[f64]) -> Vec<f64> {
        let n = self.count;
        let (mut square, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for (i, sample) in samples.iter().enumerate() {
            let Row { first, weights } = self.rows[2 * i];
            for (a, wa) in weights.iter().enumerate().take(n - first.min(n)) {
                right[first + a] += wa * sample;
                for (b, wb) in weights.iter().enumerate().take(n - first.min(n)) {
                    square[(first + a, first + b)] += wa * wb;
                }
            }
        }
        for j in 0..n {
            square[(j, j)] += RIDGE * samples.len() as f64;
        }
        square.cholesky().map_or_else(|| vec![0.0; n], |root| root.solve(&right).as_slice().to_vec())
    }

    pub(super) fn row(&self, instant: usize) -> Row {
        self.rows[instant]
    }

    /// The value at `instant`; zero where there are no coefficients.
    pub(super) fn at(&self, instant: usize, coefficients: &[f64]) -> f64 {
        let Row { first, weights } = self.rows[instant];
        coefficients[first.min(coefficients.len())..].iter().zip(weights).map(|(c, w)| c * w).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_and_reproduce_a_line() {
        let spline = Spline::new(9, 101);
        let line: Vec<f64> = (0..9).map(|i| 2.0 * i as f64).collect();
        for i in 0..101 {
            assert!((spline.row(i).weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            // The coefficients of a line are its values a knot before: 2 (6 t + 1).
            assert!((spline.at(i, &line) - 2.0 * (6.0 * i as f64 / 100.0 + 1.0)).abs() < 1e-13);
        }
        assert_eq!(Spline::new(1, 5).at(3, &[7.0]), 7.0);
        assert_eq!(Spline::new(0, 5).at(3, &[]), 0.0);
    }
}
