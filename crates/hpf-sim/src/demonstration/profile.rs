//! Profiles over the phase, fitted to the samples of one movement.

use hpf_core::Basis;
use hpf_learn::fit::{self, FitError};

use super::gains::Bounds;
use super::imitation::Fit;

/// Penalty on weights of a gain, for features that sum to one at each sample: what no sample reaches becomes the mean.
const GAIN_PENALTY: f64 = 1e-6;

/// Features of a basis at some phases, and how profiles are fitted to them.
pub struct Profile {
    fit: Fit,
    /// Basis functions.
    pub count: usize,
    /// `phi`, a row per phase.
    pub features: Vec<f64>,
    /// `psi`, where the fit needs it.
    activations: Vec<f64>,
}

impl Profile {
    pub fn new(fit: Fit, basis: &Basis<f64, Vec<f64>>, phases: &[f64]) -> Self {
        let count = basis.count();
        let table = |write: &dyn Fn(f64, &mut [f64])| {
            let mut table = vec![0.0; phases.len() * count];
            table.chunks_exact_mut(count).zip(phases).for_each(|(row, phase)| write(*phase, row));
            table
        };
        let activations = match fit {
            Fit::Ridge => Vec::new(),
            Fit::LocallyWeighted => table(&|s, row| basis.activations_into(s, row)),
        };
        Self { fit, count, features: table(&|s, row| basis.features_into(s, row)), activations }
    }

    /// The weights of a forcing term `gate sum w phi` that come nearest to `forcing`.
    pub fn movement(&self, gate: &[f64], forcing: &[f64], penalty: f64) -> Result<Vec<f64>, FitError> {
        match self.fit {
            Fit::Ridge => {
                let rows = self.features.chunks_exact(self.count).zip(gate);
                let features: Vec<f64> = rows.flat_map(|(row, s)| row.iter().map(move |phi| s * phi)).collect();
                fit::ridge(&features, self.count, forcing, penalty)
            }
            Fit::LocallyWeighted => fit::locally_weighted(&self.activations, self.count, gate, forcing, penalty),
        }
    }

    /// The weights within `bounds` of the gain that comes nearest to `values`, where there are any.
    pub fn gain(&self, values: &[Option<f64>], bounds: Bounds) -> Result<Vec<f64>, FitError> {
        let known: Vec<f64> = values.iter().copied().flatten().collect();
        let rows = |table: &[f64]| -> Vec<f64> {
            let rows = table.chunks_exact(self.count).zip(values).filter(|(_, value)| value.is_some());
            rows.flat_map(|(row, _)| row).copied().collect()
        };
        let middle = known.iter().sum::<f64>() / known.len() as f64;
        match self.fit {
            Fit::Ridge => {
                let bounds = [bounds.min, bounds.max];
                fit::bounded_ridge(&rows(&self.features), self.count, &known, GAIN_PENALTY, middle, bounds)
            }
            Fit::LocallyWeighted => {
                let rest: Vec<f64> = known.iter().map(|value| value - middle).collect();
                let ones = vec![1.0; known.len()];
                let rows = rows(&self.activations);
                let weights = fit::locally_weighted(&rows, self.count, &ones, &rest, GAIN_PENALTY)?;
                Ok(weights.into_iter().map(|w| (middle + w).max(bounds.min).min(bounds.max)).collect())
            }
        }
    }
}
