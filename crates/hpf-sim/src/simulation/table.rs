//! Basis functions over time, and mixtures of them as small matrix products.

use hpf_core::{Basis, Lanes, Real};

/// Steps whose mixtures are made together: a weight is read once for all of them.
pub(super) const TILE: usize = 4;

/// Basis functions by row: one row per instant, and so many rows of zeros behind that a tile always has its rows.
#[derive(Clone, Debug)]
pub(super) struct Table {
    count: usize,
    rows: Vec<f64>,
}

impl Table {
    pub(super) fn new(basis: &Basis<f64, Vec<f64>>, phases: impl ExactSizeIterator<Item = f64>) -> Self {
        let count = basis.count();
        let mut rows = vec![0.0; (phases.len() + 2 * TILE) * count];
        for (row, phase) in rows.chunks_exact_mut(count).zip(phases) {
            basis.features_into(phase, row);
        }
        Self { count, rows }
    }

    /// The rows of the first `count` samples, where the instants are half steps.
    pub(super) fn samples(&self, count: usize) -> Vec<&[f64]> {
        self.rows.chunks_exact(self.count).step_by(2).take(count).collect()
    }

    #[inline(always)]
    fn row(&self, row: usize) -> &[f64] {
        // Cut to a length that is written out, so that an index below it needs no check.
        &self.rows[row * self.count..][..self.count]
    }

    /// The mixture of one list of weights at the instant of `row`.
    #[inline]
    pub(super) fn mix(&self, row: usize, weights: &[f64]) -> f64 {
        self.row(row).iter().zip(weights).fold(0.0, |sum, (phi, weight)| sum + phi * weight)
    }

    /// The mixtures of each lane's weights at the instants of `R` rows from `first` on; each the same sum in the same
    /// order as [`mix`](Self::mix).
    #[inline(always)]
    pub(super) fn mix_rows<const N: usize, const R: usize>(&self, first: usize, weights: &[Lanes<N>]) -> [Lanes<N>; R] {
        let weights = &weights[..self.count];
        let rows: [&[f64]; R] = core::array::from_fn(|r| self.row(first + r));
        let mut sums = [Lanes::ZERO; R];
        for (i, &weight) in weights.iter().enumerate() {
            for (sum, row) in sums.iter_mut().zip(rows) {
                *sum += Lanes::of(row[i]) * weight;
            }
        }
        sums
    }
}
