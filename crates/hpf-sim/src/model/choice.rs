//! What is known of the environment of one axis: the motions made, every family fitted to them, and which one is taken.
//!
//! ```text
//! score = log max(1, chi^2 of the fit) + sum over predictions 0.5^age log max(1, chi^2) + p log N/N
//! ```
//! chi^2 is the mean square of the errors beside the noise of the record; a prediction is of a motion by the fit to those
//! before it; p are the coefficients of the family, N the numbers recorded. The lowest is taken: never by the name or the
//! kind of the task.

use rayon::prelude::*;

use super::family::Facts;
use super::fit::{Fitted, Fitting, Loads, Made, Noise};

/// How much less a motion counts for each that was made after it, where a family is not exact.
const FORGETTING: f64 = 0.5;
/// A family whose errors at the newest motion are at most so much more than the noise is exact.
const EXACT: f64 = 1.5;
/// A family whose score lies so far above the best after this many motions is not fitted any more.
const HOPELESS: f64 = 6.0;
const TOLD_APART: usize = 2;
/// Least noise: of the travel, and of the force. Splines tell no more.
const LEAST_POSITION: f64 = 1e-5;
const LEAST_FORCE: f64 = 1e-4;
/// The third difference of white noise has the variance 1 + 9 + 9 + 1.
const THIRD_DIFFERENCE: f64 = 20.0;
/// Median of the magnitude of a standard normal number.
const MEDIAN: f64 = 0.6745;

/// The environment of one axis, as far as it is known.
#[derive(Clone, Debug)]
pub(super) struct AxisEnvironment {
    made: Vec<Made>,
    fits: Vec<Option<Fitted>>,
    /// Of each family: log chi^2 of its predictions, newest last.
    predicted: Vec<Vec<f64>>,
    /// Of each family, after the motion before.
    scores: Vec<f64>,
    chosen: usize,
}

impl AxisEnvironment {
    pub(super) fn new(families: usize) -> Self {
        Self {
            made: Vec::new(),
            fits: vec![None; families],
            predicted: vec![Vec::new(); families],
            scores: vec![0.0; families],
            chosen: 0,
        }
    }

    /// The family that is taken.
    pub(super) fn chosen(&self) -> usize {
        self.chosen
    }

    /// Root of the mean square of the errors that the fit leaves: of positions [m] and of forces [N].
    pub(super) fn errors(&self) -> [f64; 2] {
        let root = self.fits[self.chosen].as_ref().map_or(f64::INFINITY, |fitted| fitted.chi.max(1.0).sqrt());
        let noise = self.noise();
        [root * noise.position, root * noise.force]
    }

    /// The load over a motion, as it is taken to be.
    pub(super) fn loads(&self, fittings: &[Fitting]) -> Option<Loads> {
        Some(fittings[self.chosen].loads(&self.fits[self.chosen].as_ref()?.theta))
    }

    /// Learns from one more motion. False where no family is fitted to finite errors.
    pub(super) fn learn(&mut self, fittings: &[Fitting], made: Made, largest_stiffness: f64) -> bool {
        self.made.push(made);
        let (facts, noise) = (self.facts(largest_stiffness), self.noise());
        let all: Vec<&Made> = self.made.iter().collect();
        let (newest, count) = ([all[all.len() - 1]], all.len());
        let best = self.scores.iter().copied().fold(f64::INFINITY, f64::min);
        let learned = fittings.par_iter().zip(&self.fits).zip(&self.scores).map(|((fitting, before), score)| {
            let before = before.as_ref();
            let predicted = before.map(|before| libm::log(fitting.chi(&before.theta, &newest, noise).max(1.0)));
            if let Some(before) = before
                && count > TOLD_APART
                && score - best > HOPELESS
            {
                return (predicted, before.clone());
            }
            let mut fitted = fitting.fit(&all, &vec![1.0; count], noise, &facts, before);
            if count > 1 && fitting.chi(&fitted.theta, &newest, noise) > EXACT {
                let weights: Vec<f64> = (0..count).rev().map(|age| FORGETTING.powi(age as i32)).collect();
                fitted = fitting.fit(&all, &weights, noise, &facts, Some(&fitted));
            }
            (predicted, fitted)
        });
        let learned: Vec<(Option<f64>, Fitted)> = learned.collect();
        for ((predictions, fit), (predicted, fitted)) in self.predicted.iter_mut().zip(&mut self.fits).zip(learned) {
            predictions.extend(predicted);
            *fit = Some(fitted);
        }
        let numbers = 2.0 * (self.made.len() * self.made[0].position.len()) as f64;
        let score = |f: usize| {
            let predictions = self.predicted[f].iter().rev().enumerate();
            let predicted: f64 = predictions.map(|(age, log)| FORGETTING.powi(age as i32) * log).sum();
            let fit = self.fits[f].as_ref().map_or(f64::INFINITY, |fitted| libm::log(fitted.chi.max(1.0)));
            fit + predicted + fittings[f].count() as f64 * libm::log(numbers) / numbers
        };
        let scores: Vec<f64> = (0..fittings.len()).map(score).collect();
        self.chosen = (0..fittings.len()).min_by(|&a, &b| scores[a].total_cmp(&scores[b])).unwrap_or(0);
        self.scores = scores;
        self.scores[self.chosen].is_finite()
    }

    fn facts(&self, stiffness: f64) -> Facts {
        let positions = || self.made.iter().flat_map(|made| &made.position).copied();
        let (low, high) = positions().fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(y), high.max(y)));
        let mean = positions().sum::<f64>() / positions().count() as f64;
        let travel = (high - low).max(f64::MIN_POSITIVE.sqrt());
        let force = self.made.iter().flat_map(|made| &made.force).fold(0.0, |most: f64, f| most.max(f.abs()));
        // Where nothing pushes, a force that would move the tool by its travel.
        let force = if force > 0.0 { force } else { stiffness * travel };
        Facts { force, positions: [low, mean, low + travel], stiffness }
    }

    /// The noise of the record, from what no smooth motion has: the medians of third differences.
    fn noise(&self) -> Noise {
        let facts = self.facts(1.0);
        let spread = |signal: fn(&Made) -> &[f64]| {
            let mut differences: Vec<f64> = self
                .made
                .iter()
                .flat_map(|made| signal(made).windows(4))
                .map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs())
                .collect();
            differences.sort_by(f64::total_cmp);
            differences.get(differences.len() / 2).copied().unwrap_or(0.0) / (MEDIAN * THIRD_DIFFERENCE.sqrt())
        };
        Noise {
            position: spread(|made| &made.position).max(LEAST_POSITION * facts.travel()),
            force: spread(|made| &made.force).max(LEAST_FORCE * facts.force),
        }
    }
}
