//! Evolution by covariance matrix adaptation (CMA-ES), as ask and tell: to compare with, in the same tool.
//!
//! ```text
//! x_k  = m + sigma y_k,  y_k = B D z_k,  z_k ~ N(0, I),  C = B D^2 B^T        k = 1..K, brought within its bounds
//! m   <- m + sigma y_w,  y_w = sum_i w_i y_i:K                                 the cheapest half, by rank
//! p_s <- (1-c_s) p_s + sqrt(c_s (2-c_s) mu_w) C^-1/2 y_w
//! sigma <- sigma exp(c_s/d_s (|p_s|/chi_n - 1))
//! p_c <- (1-c_c) p_c + h sqrt(c_c (2-c_c) mu_w) y_w
//! C   <- (1 + c_1 a - c_1 - c_mu) C + c_1 p_c p_c^T + c_mu sum_i w_i y_i:K y_i:K^T
//! ```
//! | symbol | meaning |
//! |---|---|
//! | x | parameters, each in units of its block's noise, so that sigma starts at 1 |
//! | w_i, mu_w | `ln((K+1)/2) - ln i`, made to sum to one, and `1/sum w_i^2` |
//! | c_s, d_s, c_c, c_1, c_mu | the defaults of the source |
//! | chi_n | mean length of n normal numbers |
//! | h, a | 0 and `c_c (2-c_c)` where p_s is long, else 1 and 0 |
//!
//! A sample that leaves its bounds is brought back BEFORE the rollout, and y is what remains of the step, as with PI2. A
//! rollout without a finite cost ranks last. Only the cheapest half weighs (no negative weights), K is the caller's, and
//! there are no restarts. B and D are made anew every few updates, as often as keeps their cost below that of the update.
//!
//! Source: Hansen, The CMA Evolution Strategy: A Tutorial, arXiv:1604.00772, Table 1 and Figure 6.

use nalgebra::{DMatrix, DVector};
use rand::RngExt as _;
use rand_distr::StandardNormal;

use crate::noise::stream;
use crate::{Block, Pi2Error};

/// Largest growth of sigma in one update, as the source advises against sudden leaps.
const MOST_GROWTH: f64 = 1.0;
/// Smallest share of the largest variance that a direction keeps: rounding leaves less than nothing otherwise.
const LEAST_VARIANCE: f64 = 1e-14;

/// Settings of CMA-ES; it has no other scale than the blocks' noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CmaEsOptions {
    /// Rollouts per update, K.
    pub rollouts: usize,
    /// Most updates.
    pub updates: usize,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// The learner.
///
/// ```
/// use hpf_learn::{Block, CmaEs, CmaEsOptions};
/// let block = Block {
///     name: "w".into(), count: 2, features: vec![], activations: vec![], min: -5.0, max: 5.0, noise: 1.0,
/// };
/// let mut learner = CmaEs::new(&[block], vec![0.0, 0.0], CmaEsOptions { rollouts: 8, updates: 60, seed: 1 });
/// for _ in 0..60 {
///     let costs: Vec<f64> = learner.ask().iter().map(|w| (w[0] - 2.0).powi(2) + 100.0 * (w[1] + w[0]).powi(2)).collect();
///     learner.tell(&costs)?;
/// }
/// assert!((learner.weights()[0] - 2.0).abs() < 1e-3 && (learner.weights()[1] + 2.0).abs() < 1e-3);
/// # Ok::<(), hpf_learn::Pi2Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct CmaEs {
    options: CmaEsOptions,
    /// All parameters; those that explore follow the mean.
    weights: Vec<f64>,
    /// The parameters that explore, with their unit and bounds.
    free: Vec<Free>,
    rates: Rates,
    mean: DVector<f64>,
    sigma: f64,
    covariance: DMatrix<f64>,
    /// B D, and B D^-1 B^T = C^-1/2.
    spread: DMatrix<f64>,
    whitening: DMatrix<f64>,
    /// p_s and p_c.
    step_path: DVector<f64>,
    covariance_path: DVector<f64>,
    /// The samples of this update, and what remains of their steps, y.
    samples: Vec<Vec<f64>>,
    steps: Vec<DVector<f64>>,
    update: usize,
}

#[derive(Clone, Copy, Debug)]
struct Free {
    parameter: usize,
    unit: f64,
    min: f64,
    max: f64,
}

/// The constants of the source, for n parameters and K rollouts.
#[derive(Clone, Debug)]
struct Rates {
    weights: Vec<f64>,
    effective: f64,
    step: f64,
    damping: f64,
    path: f64,
    one: f64,
    mu: f64,
    length: f64,
    /// Updates from one B D to the next.
    period: usize,
}

impl Rates {
    fn new(count: usize, rollouts: usize) -> Self {
        let n = count as f64;
        let raw: Vec<f64> = (1..=(rollouts / 2).max(1))
            .map(|rank| libm::log(0.5 * (rollouts + 1) as f64) - libm::log(rank as f64))
            .collect();
        let sum: f64 = raw.iter().sum();
        // A single rollout has the weight of zero by the formula, and all of it by being alone.
        let weights: Vec<f64> = raw.iter().map(|weight| if sum > 0.0 { weight / sum } else { 1.0 }).collect();
        let effective = 1.0 / weights.iter().map(|weight| weight * weight).sum::<f64>();
        let step = (effective + 2.0) / (n + effective + 5.0);
        let one = 2.0 / ((n + 1.3) * (n + 1.3) + effective);
        let mu = (2.0 * (effective - 2.0 + 1.0 / effective) / ((n + 2.0) * (n + 2.0) + effective)).min(1.0 - one);
        Self {
            step,
            damping: 1.0 + 2.0 * (((effective - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + step,
            path: (4.0 + effective / n) / (n + 4.0 + 2.0 * effective / n),
            one,
            mu,
            length: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
            period: ((1.0 / ((one + mu) * n * 10.0)) as usize).max(1),
            weights,
            effective,
        }
    }
}

impl CmaEs {
    /// A learner that starts from `weights`, all blocks one after the other; blocks without noise stay as they are.
    pub fn new(blocks: &[Block], weights: Vec<f64>, options: CmaEsOptions) -> Self {
        let bounds = blocks.iter().flat_map(|block| vec![(block.noise, block.min, block.max); block.count]);
        let free: Vec<Free> = bounds
            .enumerate()
            .filter(|(_, (noise, min, max))| *noise > 0.0 && min < max)
            .map(|(parameter, (unit, min, max))| Free { parameter, unit, min, max })
            .collect();
        let n = free.len();
        let mut learner = Self {
            options,
            rates: Rates::new(n.max(1), options.rollouts),
            mean: DVector::from_iterator(n, free.iter().map(|free| weights[free.parameter] / free.unit)),
            weights,
            free,
            sigma: 1.0,
            covariance: DMatrix::identity(n, n),
            spread: DMatrix::identity(n, n),
            whitening: DMatrix::identity(n, n),
            step_path: DVector::zeros(n),
            covariance_path: DVector::zeros(n),
            samples: Vec::new(),
            steps: Vec::new(),
            update: 0,
        };
        learner.draw();
        learner
    }

    /// The samples of the next update.
    pub fn ask(&self) -> &[Vec<f64>] {
        &self.samples
    }

    /// The mean of the samples to come.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Updates made so far.
    pub fn update(&self) -> usize {
        self.update
    }

    /// Size of the steps: the largest standard deviation of a parameter, as a fraction of its block's noise.
    pub fn exploration(&self) -> f64 {
        self.sigma * self.covariance.diagonal().iter().fold(0.0, |most: f64, variance| most.max(*variance)).sqrt()
    }

    fn draw(&mut self) {
        self.samples.clear();
        self.steps.clear();
        for k in 0..self.options.rollouts {
            let mut generator = stream(self.options.seed, self.update, k);
            let normal = DVector::from_fn(self.free.len(), |_, _| generator.sample::<f64, _>(StandardNormal));
            let mut step = &self.spread * normal;
            let mut sample = self.weights.clone();
            for ((free, y), mean) in self.free.iter().zip(&mut step).zip(&self.mean) {
                let weight = (free.unit * (mean + self.sigma * *y)).max(free.min).min(free.max);
                *y = (weight / free.unit - mean) / self.sigma;
                sample[free.parameter] = weight;
            }
            self.samples.push(sample);
            self.steps.push(step);
        }
    }

    /// Improves the mean and its spread by what the samples of [`CmaEs::ask`] cost, one number per sample in their
    /// order. Returns how many were rejected because their cost is not finite.
    ///
    /// # Errors
    /// [`Pi2Error::AllRejected`] where none is left; nothing changes then.
    pub fn tell(&mut self, costs: &[f64]) -> Result<usize, Pi2Error> {
        let rejected = costs.iter().filter(|cost| !cost.is_finite()).count();
        if rejected == costs.len() {
            return Err(Pi2Error::AllRejected { update: self.update, rollouts: costs.len() });
        }
        let rank_of = |k: usize| if costs[k].is_finite() { costs[k] } else { f64::INFINITY };
        let mut order: Vec<usize> = (0..costs.len()).collect();
        order.sort_by(|&a, &b| rank_of(a).total_cmp(&rank_of(b)));
        let kept: Vec<(f64, &DVector<f64>)> =
            self.rates.weights.iter().copied().zip(order.iter().map(|&k| &self.steps[k])).collect();

        let Rates { effective, step, damping, path, one, mu, length, period, .. } = self.rates;
        let n = self.free.len() as f64;
        let zero = DVector::zeros(self.free.len());
        let mean_step = kept.iter().fold(zero, |sum, (weight, y)| sum + *y * *weight);
        self.mean += &mean_step * self.sigma;
        self.step_path =
            &self.step_path * (1.0 - step) + &self.whitening * &mean_step * (step * (2.0 - step) * effective).sqrt();
        // The path is shorter than its final length in the first updates.
        let settled = 1.0 - libm::pow(1.0 - step, 2.0 * (self.update + 1) as f64);
        let is_short = self.step_path.norm() / settled.sqrt() < (1.4 + 2.0 / (n + 1.0)) * length;
        let share = if is_short { (path * (2.0 - path) * effective).sqrt() } else { 0.0 };
        self.covariance_path = &self.covariance_path * (1.0 - path) + &mean_step * share;
        let missing = if is_short { 0.0 } else { path * (2.0 - path) };
        self.covariance *= 1.0 + one * missing - one - mu;
        self.covariance.ger(one, &self.covariance_path, &self.covariance_path, 1.0);
        for (weight, y) in kept {
            self.covariance.ger(mu * weight, y, y, 1.0);
        }
        self.sigma *= libm::exp((step / damping * (self.step_path.norm() / length - 1.0)).min(MOST_GROWTH));
        self.update += 1;
        if self.update.is_multiple_of(period) && !self.free.is_empty() {
            self.decompose();
        }
        for (free, mean) in self.free.iter().zip(&self.mean) {
            self.weights[free.parameter] = (mean * free.unit).max(free.min).min(free.max);
        }
        self.draw();
        Ok(rejected)
    }

    /// Makes B and D from C.
    fn decompose(&mut self) {
        let eigen = self.covariance.clone().symmetric_eigen();
        let least = LEAST_VARIANCE * eigen.eigenvalues.amax();
        let deviations = eigen.eigenvalues.map(|variance| variance.max(least).sqrt());
        let vectors = &eigen.eigenvectors;
        self.spread = vectors * DMatrix::from_diagonal(&deviations);
        self.whitening = vectors * DMatrix::from_diagonal(&deviations.map(|d| 1.0 / d)) * vectors.transpose();
    }
}
