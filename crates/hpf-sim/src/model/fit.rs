//! Fitting a family of environments to the motions of one axis, by the error of their simulation.
//!
//! ```text
//! minimise over theta  1/2 sum_motions w [sum_i (y_i - y^_i)^2/sigma_y^2 + (f_i - f^_i)^2/sigma_f^2] + prior(theta)
//! ```
//! y^ and f^ are the motion of the very kernels that the robot runs, closed over the modelled load, so that the regressor
//! is free of noise and nothing is smoothed. Levenberg-Marquardt with forward sensitivities
//! `S_{i+1} = (dg/dy) S_i + dg/dtheta` of the step g, the slopes of which come from the kernels over dual numbers.

use hpf_learn::gram;
use nalgebra::{DMatrix, DVector};

use super::dual::Dual;
use super::family::{Facts, Family};
use super::law::{Knot, Law, Load};
use super::spline::Spline;
use crate::simulation::Planned;

/// A motion of one axis: its plan, and what was recorded.
#[derive(Clone, Debug)]
pub(super) struct Made {
    pub(super) planned: Planned,
    pub(super) position: Vec<f64>,
    pub(super) force: Vec<f64>,
}

/// The size of the errors of a record.
#[derive(Clone, Copy, Debug)]
pub(super) struct Noise {
    /// [m]
    pub(super) position: f64,
    /// [N]
    pub(super) force: f64,
}

/// A load over a motion, at half steps, and where the motion starts.
#[derive(Clone, Debug)]
pub(super) struct Loads {
    pub(super) law: Law,
    pub(super) dt: f64,
    pub(super) start: f64,
    pub(super) loads: Vec<Load<f64>>,
}

pub(super) fn knot(planned: &Planned, i: usize) -> Knot<f64> {
    Knot {
        reference: planned.position[i],
        velocity: planned.velocity[i],
        stiffness: planned.stiffness[2 * i],
        damping: planned.damping[2 * i],
    }
}

impl Loads {
    /// Position, velocity and force at every sample.
    pub(super) fn roll(&self, planned: &Planned) -> [Vec<f64>; 3] {
        let steps = planned.position.len() - 1;
        let (mut y, mut signals) = (self.start, [0; 3].map(|_| Vec::with_capacity(steps + 1)));
        for i in 0..=steps {
            let now = knot(planned, i);
            let [velocity, force] = self.law.sample(y, &now, &self.loads[2 * i]);
            for (signal, value) in signals.iter_mut().zip([y, velocity, force]) {
                signal.push(value);
            }
            if i < steps {
                let middle = [planned.stiffness[2 * i + 1], planned.damping[2 * i + 1]];
                let loads = [0, 1, 2].map(|h| &self.loads[2 * i + h]);
                y = self.law.step(y, [&now, &knot(planned, i + 1)], middle, loads, self.dt);
            }
        }
        signals
    }
}

/// A family, its splines over the motion, and what is likely.
#[derive(Debug)]
pub(super) struct Fitting {
    pub(super) family: Box<dyn Family>,
    splines: [Spline; 3],
    law: Law,
    dt: f64,
}

/// What a fit found.
#[derive(Clone, Debug)]
pub(super) struct Fitted {
    pub(super) theta: Vec<f64>,
    /// Mean square of the errors beside the noise.
    pub(super) chi: f64,
    /// The cost that was minimised.
    cost: f64,
}

/// Most steps of a fit, of the first look at a start, and starts that are looked at.
const MOST_STEPS: usize = 20;
const FIRST_STEPS: usize = 3;
const MOST_STARTS: usize = 5;
/// A step that gains a smaller share is the last.
const LEAST_GAIN: f64 = 1e-4;
const FIRST_DAMPING: f64 = 1e-3;
const MOST_DAMPING: f64 = 1e9;
/// Motions that starts are compared by.
const COMPARED: usize = 2;
/// Numbers of a step that its slopes by the load are taken by.
const INPUTS: usize = 9;

impl Fitting {
    /// `instants` are the half steps of a motion; `is_coupled` says that position and force are stepped together even
    /// where nothing is touched.
    pub(super) fn new(family: Box<dyn Family>, instants: usize, [is_sampled, is_coupled]: [bool; 2], dt: f64) -> Self {
        let splines = family.counts().map(|count| Spline::new(count, instants));
        let is_offset = !is_coupled && splines[1].count == 0;
        let law = Law { side: family.side(), is_sampled, is_offset };
        Self { family, splines, law, dt }
    }

    /// Coefficients, and the start of the motion.
    pub(super) fn count(&self) -> usize {
        1 + self.splines.iter().map(|spline| spline.count).sum::<usize>()
    }

    /// The coefficients of b, kappa and e.
    fn split<'t>(&self, theta: &'t [f64]) -> [&'t [f64]; 3] {
        let [b, kappa, _] = self.splines.each_ref().map(|spline| spline.count);
        [&theta[1..1 + b], &theta[1 + b..1 + b + kappa], &theta[1 + b + kappa..]]
    }

    pub(super) fn loads(&self, theta: &[f64]) -> Loads {
        let parts = self.split(theta);
        let instants = self.instants();
        let load = |h: usize| {
            let [force, kappa, place] = [0, 1, 2].map(|p: usize| self.splines[p].at(h, parts[p]));
            let stiffness = if self.splines[1].count > 0 { libm::exp(kappa) } else { 0.0 };
            Load { force, stiffness, place }
        };
        Loads { law: self.law, dt: self.dt, start: theta[0], loads: (0..instants).map(load).collect() }
    }

    fn instants(&self) -> usize {
        self.splines[0].instants()
    }

    /// Mean square of the errors that `theta` leaves, beside the noise.
    pub(super) fn chi(&self, theta: &[f64], made: &[&Made], noise: Noise) -> f64 {
        let loads = self.loads(theta);
        let (mut sum, mut count) = (0.0, 0);
        for made in made {
            let [position, _, force] = loads.roll(&made.planned);
            for (found, recorded, sigma) in
                [(&position, &made.position, noise.position), (&force, &made.force, noise.force)]
            {
                sum += found.iter().zip(recorded).map(|(a, b)| ((a - b) / sigma).powi(2)).sum::<f64>();
                count += found.len();
            }
        }
        let chi = sum / count as f64;
        if chi.is_finite() { chi } else { f64::INFINITY }
    }

    /// The mean and the precision of the prior.
    fn prior(&self, facts: &Facts, start: f64) -> (DVector<f64>, DMatrix<f64>) {
        let n = self.count();
        let (mut mean, mut precision) = (DVector::zeros(n), DMatrix::zeros(n, n));
        mean[0] = start;
        precision[(0, 0)] = 1.0 / facts.travel().powi(2);
        let mut at = 1;
        for (spline, likely) in self.splines.iter().zip(self.family.likely(facts)) {
            for j in at..at + spline.count {
                mean[j] = likely.mean;
                precision[(j, j)] += 1.0 / likely.level.powi(2);
                if j > at {
                    let share = 1.0 / likely.walk.powi(2);
                    precision[(j, j)] += share;
                    precision[(j - 1, j - 1)] += share;
                    precision[(j, j - 1)] -= share;
                    precision[(j - 1, j)] -= share;
                }
            }
            at += spline.count;
        }
        (mean, precision)
    }

    /// The start of a fit with one stiffness at one place: b is what the recorded forces leave.
    fn start(&self, [place, stiffness]: [f64; 2], made: &[&Made]) -> Vec<f64> {
        let law = self.law;
        let start = made.iter().map(|made| made.position[0]).sum::<f64>() / made.len() as f64;
        let load = Load { force: 0.0, stiffness, place };
        let mut rest = vec![0.0; made[0].force.len()];
        let share = 1.0 / made.len() as f64;
        for made in made {
            for (rest, (f, y)) in rest.iter_mut().zip(made.force.iter().zip(&made.position)) {
                let own = if law.is_touching(*y, &load) { stiffness * (y - place) } else { 0.0 };
                *rest += share * (f + own);
            }
        }
        let mut b = self.splines[0].fitted(&rest);
        if law.side != 0.0 {
            // Most of the motion is free, and there the force is b.
            rest.sort_by(f64::total_cmp);
            b.fill(rest[rest.len() / 2]);
        }
        let kappa = if stiffness > 0.0 { libm::log(stiffness) } else { 0.0 };
        let constant = |p: usize, value: f64| vec![value; self.splines[p].count];
        [vec![start], b, constant(1, kappa), constant(2, place)].concat()
    }

    /// Fits the family to `made`, each with its weight; from `before` where there is a fit already.
    pub(super) fn fit(
        &self,
        made: &[&Made],
        weights: &[f64],
        noise: Noise,
        facts: &Facts,
        before: Option<&Fitted>,
    ) -> Fitted {
        let start = made.iter().map(|made| made.position[0]).sum::<f64>() / made.len() as f64;
        let prior = self.prior(facts, start);
        let fit = |theta: Vec<f64>, steps: usize| self.descend(theta, made, weights, noise, &prior, steps);
        let best = |fits: Vec<Fitted>| fits.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
        let warm = before.map(|before| fit(before.theta.clone(), MOST_STEPS));
        if let (Some(warm), Some(before)) = (&warm, before)
            && (warm.chi < GOOD || (made.len() > TOLD_APART && warm.chi < GOOD * before.chi))
        {
            return warm.clone();
        }
        let newest = &made[made.len().saturating_sub(COMPARED)..];
        let mut starts: Vec<(f64, Vec<f64>)> = self
            .family
            .starts(facts)
            .into_iter()
            .map(|start| self.start(start, newest))
            .map(|theta| (self.chi(&theta, newest, noise), theta))
            .collect();
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts.truncate(MOST_STARTS);
        let looked = starts.into_iter().map(|(_, theta)| fit(theta, FIRST_STEPS)).collect();
        let cold = best(looked).map(|looked| fit(looked.theta, MOST_STEPS));
        best(warm.into_iter().chain(cold).collect()).expect("a family has a start")
    }

    fn cost(
        &self,
        theta: &[f64],
        made: &[&Made],
        weights: &[f64],
        noise: Noise,
        (mean, precision): &(DVector<f64>, DMatrix<f64>),
    ) -> f64 {
        let away = DVector::from_column_slice(theta) - mean;
        let count = |made: &Made| 2.0 * made.position.len() as f64;
        let errors: f64 =
            made.iter().zip(weights).map(|(made, w)| w * count(made) * self.chi(theta, &[*made], noise)).sum();
        0.5 * (errors + away.dot(&(precision * &away)))
    }

    fn descend(
        &self,
        mut theta: Vec<f64>,
        made: &[&Made],
        weights: &[f64],
        noise: Noise,
        prior: &(DVector<f64>, DMatrix<f64>),
        steps: usize,
    ) -> Fitted {
        let n = self.count();
        let mut cost = self.cost(&theta, made, weights, noise, prior);
        let mut damping = FIRST_DAMPING;
        for _ in 0..steps {
            let Some((mut curvature, mut slope)) = self.normal(&theta, made, weights, noise) else { break };
            curvature += &prior.1;
            slope += &prior.1 * (DVector::from_column_slice(&theta) - &prior.0);
            let before = cost;
            while damping < MOST_DAMPING {
                let mut damped = curvature.clone();
                (0..n).for_each(|j| damped[(j, j)] *= 1.0 + damping);
                let next = damped.cholesky().map(|root| {
                    let step = root.solve(&slope);
                    theta.iter().zip(&step).map(|(theta, step)| theta - step).collect::<Vec<f64>>()
                });
                let found = next.as_ref().map_or(f64::INFINITY, |next| self.cost(next, made, weights, noise, prior));
                if let Some(next) = next
                    && found < cost
                {
                    (theta, cost) = (next, found);
                    damping = (damping * 0.2).max(1e-9);
                    break;
                }
                damping *= 6.0;
            }
            if before - cost <= LEAST_GAIN * cost.abs() {
                break;
            }
        }
        Fitted { chi: self.weighted_chi(&theta, made, weights, noise), theta, cost }
    }

    fn weighted_chi(&self, theta: &[f64], made: &[&Made], weights: &[f64], noise: Noise) -> f64 {
        let sum: f64 = made.iter().zip(weights).map(|(made, w)| w * self.chi(theta, &[*made], noise)).sum();
        sum / weights.iter().sum::<f64>()
    }

    /// The normal equations of the errors at `theta`.
    fn normal(
        &self,
        theta: &[f64],
        made: &[&Made],
        weights: &[f64],
        noise: Noise,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let (n, samples) = (self.count(), made[0].position.len());
        let rows = 2 * samples;
        let (mut curvature, mut slope) = (DMatrix::zeros(n, n), DVector::zeros(n));
        let loads = self.loads(theta);
        let (mut columns, mut errors) = (vec![0.0; n * rows], vec![0.0; rows]);
        for (made, weight) in made.iter().zip(weights) {
            let root = weight.sqrt();
            let scale = [root / noise.position, root / noise.force];
            let mut y = loads.start;
            // Slopes of y by theta.
            let mut by = vec![0.0; n];
            by[0] = 1.0;
            for i in 0..samples {
                let now = knot(&made.planned, i);
                let (load, force) = self.force_slopes(&loads, y, &now, i);
                let mut force_by: Vec<f64> = by.iter().map(|s| force.slopes[0] * s).collect();
                self.spread(&load, 2 * i, [force.slopes[1], force.slopes[2], force.slopes[3]], &mut force_by);
                errors[i] = scale[0] * (y - made.position[i]);
                errors[samples + i] = scale[1] * (force.value - made.force[i]);
                for j in 0..n {
                    columns[j * rows + i] = scale[0] * by[j];
                    columns[j * rows + samples + i] = scale[1] * force_by[j];
                }
                if i + 1 == samples {
                    break;
                }
                let next = self.step_slopes(&loads, y, made, i);
                by.iter_mut().for_each(|s| *s *= next.slopes[0]);
                let parts = [[1, 2, 3], [INPUTS, 4, 8], [5, 6, 7]];
                for (h, part) in parts.into_iter().enumerate() {
                    let slopes = part.map(|p| next.slopes.get(p).copied().unwrap_or(0.0));
                    self.spread(&loads.loads[2 * i + h], 2 * i + h, slopes, &mut by);
                }
                y = next.value;
            }
            if errors.iter().any(|error| !error.is_finite()) {
                return None;
            }
            curvature += gram(&columns, rows);
            for (slope, column) in slope.iter_mut().zip(columns.chunks(rows)) {
                *slope += column.iter().zip(&errors).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        curvature.iter().all(|x| x.is_finite()).then_some((curvature, slope))
    }

    /// Adds to the slopes by theta those by b, K and e at half step `h`.
    fn spread(&self, load: &Load<f64>, h: usize, slopes: [f64; 3], by: &mut [f64]) {
        let mut at = 1;
        let by_coefficients = [slopes[0], slopes[1] * load.stiffness, slopes[2]];
        for (spline, slope) in self.splines.iter().zip(by_coefficients) {
            if spline.count > 0 && slope != 0.0 {
                let row = spline.row(h);
                let places = by[at + row.first..at + spline.count].iter_mut();
                places.zip(row.weights).for_each(|(by, weight)| *by += slope * weight);
            }
            at += spline.count;
        }
    }

    /// The force at sample `i` with its slopes by y, b, K and e.
    fn force_slopes(&self, loads: &Loads, y: f64, now: &Knot<f64>, i: usize) -> (Load<f64>, Dual<4>) {
        let load = loads.loads[2 * i];
        let dual = Load {
            force: Dual::input(load.force, 1),
            stiffness: Dual::input(load.stiffness, 2),
            place: Dual::input(load.place, 3),
        };
        let [_, force] = loads.law.sample(Dual::input(y, 0), &held(now), &dual);
        (load, force)
    }

    /// The next position with its slopes by y, the load at the start of the step, K and e at its middle, and the load at
    /// its end, in the order of `normal`.
    fn step_slopes(&self, loads: &Loads, y: f64, made: &Made, i: usize) -> Dual<INPUTS> {
        let [start, middle, end] = [0, 1, 2].map(|h| loads.loads[2 * i + h]);
        let input = |load: Load<f64>, [b, stiffness, place]: [Option<usize>; 3]| {
            let of = |value: f64, i: Option<usize>| match i {
                Some(i) => Dual::<INPUTS>::input(value, i),
                None => hpf_core::Real::of(value),
            };
            Load { force: of(load.force, b), stiffness: of(load.stiffness, stiffness), place: of(load.place, place) }
        };
        let start = input(start, [Some(1), Some(2), Some(3)]);
        let middle = input(middle, [None, Some(4), Some(8)]);
        let end = input(end, [Some(5), Some(6), Some(7)]);
        let knots = [i, i + 1].map(|i| held(&knot(&made.planned, i)));
        let gains = [&made.planned.stiffness, &made.planned.damping].map(|gain| hpf_core::Real::of(gain[2 * i + 1]));
        loads.law.step(Dual::input(y, 0), [&knots[0], &knots[1]], gains, [&start, &middle, &end], loads.dt)
    }
}

/// A fit whose errors are at most so much more than the noise, or than before the newest motion, needs no other start.
const GOOD: f64 = 1.5;
/// Motions after which a family that explains them badly is not looked for anew with every further one.
const TOLD_APART: usize = 2;

/// A knot that has no slopes.
fn held<const N: usize>(knot: &Knot<f64>) -> Knot<Dual<N>> {
    let of = <Dual<N> as hpf_core::Real>::of;
    Knot {
        reference: of(knot.reference),
        velocity: of(knot.velocity),
        stiffness: of(knot.stiffness),
        damping: of(knot.damping),
    }
}
