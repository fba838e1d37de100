//! What a motion meets that its policy does not decide: forces over time, and what the sensor makes of them.
//!
//! Draws come from streams of their own for every (seed, update, number): the same for all rollouts of an update,
//! whatever thread makes them. The n draws of a number are spread (McKay, Beckman, Conover, Technometrics 21:239,
//! 1979): one in each of n/2 even strata of the lower half of its distribution and the mirror image of each in the
//! upper half, in an order of its own. Their mean is that of a symmetric distribution, so that a few draws already
//! tell a policy not to lean against a push that is as often a pull.

use hpf_learn::Draws;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng as _};
use rand_distr::StandardNormal;

use crate::environment::disturbance::Side;
use crate::environment::{Disturbance, Quantity};
use crate::task::Task;

/// Sets of draws that share no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Set {
    /// Those of learning.
    Learning(Draws),
    /// Those that a policy is measured by.
    Evaluation,
}

/// What one motion meets.
#[derive(Clone, Debug)]
pub(crate) struct Scenario {
    pub(super) axes: Vec<AxisScenario>,
}

/// What one axis meets.
#[derive(Clone, Debug)]
pub(super) struct AxisScenario {
    /// Disturbing force just after the start and just before the end of each step, and after the last [N].
    pub(super) forces: Vec<(f64, f64)>,
    /// At every sample; empty where the sensor does not err.
    pub(super) readings: Vec<Reading>,
}

/// How one reading of the sensor goes wrong.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    /// Bias and noise [N].
    pub(super) error: f64,
    /// Whether the reading is lost.
    pub(super) is_lost: bool,
}

/// Streams of readings lie behind those of numbers.
const READINGS: u64 = 1 << 20;

/// The random numbers of one `index` of a set.
fn stream(seed: u64, set: Set, index: u64) -> ChaCha8Rng {
    let (kind, update) = match set {
        Set::Learning(Draws::Update(update)) => (1, update as u64),
        Set::Learning(Draws::HeldOut) => (2, 0),
        Set::Evaluation => (3, 0),
    };
    // Exploration draws from the bare seed.
    let mut generator = ChaCha8Rng::seed_from_u64(seed ^ (kind << 62) ^ 0x2545_F491_4F6C_DD1D);
    generator.set_stream((update << 24) | index);
    generator
}

/// Shares in (0, 1), one per draw, spread as the head of this file says.
fn spread_shares(generator: &mut ChaCha8Rng, count: usize) -> Vec<f64> {
    let pairs = count / 2;
    let mut strata: Vec<usize> = (0..pairs).collect();
    strata.shuffle(generator);
    let mut even = || generator.random::<f64>().max(f64::EPSILON);
    let mut shares = Vec::with_capacity(count);
    for stratum in strata {
        let share = (stratum as f64 + even()) / count as f64;
        let mirrored = 1.0 - share;
        shares.extend(if even() < 0.5 { [share, mirrored] } else { [mirrored, share] });
    }
    if count % 2 == 1 {
        shares.push(even());
    }
    shares
}

/// The shares of each drawn number of `task` in each of `count` motions of `set`: of disturbances, then of the sensor.
fn shares(task: &Task, set: Set, count: usize) -> Vec<Vec<f64>> {
    let biases = task.axis.iter().filter_map(|_| task.sensor.as_ref().map(|sensor| &sensor.bias));
    let numbers = task.disturbance.iter().flat_map(|disturbance| disturbance.quantities().into_iter().map(|q| q.1));
    let is_drawn = |number: &&Quantity| !number.is_fixed();
    let drawn = numbers.chain(biases).filter(is_drawn).count() as u64;
    (0..drawn).map(|index| spread_shares(&mut stream(task.learning.seed, set, index), count)).collect()
}

/// `number` as the next of `shares` draws it.
fn quantile(number: &Quantity, shares: &mut impl Iterator<Item = f64>) -> f64 {
    number.quantile(shares.next().expect("a share for every drawn number"))
}

/// The disturbances of the motion that `shares` are of.
fn acting(task: &Task, shares: &mut impl Iterator<Item = f64>) -> Vec<Disturbance> {
    task.disturbance.iter().map(|disturbance| disturbance.drawn(&mut |number| quantile(number, shares))).collect()
}

/// The disturbances of each motion that policies of `task` are measured by. Traces are those of the first.
pub fn disturbances(task: &Task) -> Vec<Vec<Disturbance>> {
    let count = task.evaluation_draws();
    let shares = shares(task, Set::Evaluation, count);
    (0..count).map(|draw| acting(task, &mut shares.iter().map(|shares| shares[draw]))).collect()
}

impl Scenario {
    /// Whether a force acts after `steps`.
    pub(crate) fn lasts_beyond(&self, steps: usize) -> bool {
        let acts = |forces: &(f64, f64)| forces.0 != 0.0 || forces.1 != 0.0;
        self.axes.iter().any(|scenario| scenario.forces.iter().skip(steps).any(acts))
    }

    /// Those of each of `count` motions of `set`; made one by one, as a long movement's fill memory.
    pub(crate) fn of_set(task: &Task, set: Set, count: usize) -> impl Iterator<Item = Self> {
        let shares = shares(task, set, count);
        (0..count).map(move |draw| Self::of_draw(task, set, draw, &mut shares.iter().map(|shares| shares[draw])))
    }

    fn of_draw(task: &Task, set: Set, draw: usize, shares: &mut impl Iterator<Item = f64>) -> Self {
        let acting = acting(task, shares);
        let mut next = |number: &Quantity| quantile(number, shares);
        let steps = task.steps() + task.rest_steps();
        let time = |i: usize| i as f64 * (task.duration / task.steps() as f64);
        let axes = task.axis.iter().enumerate().map(|(a, axis)| {
            let force = |time: f64, side: Side| {
                acting.iter().filter(|d| d.axis() == axis.name).map(|d| d.force(time, side)).sum::<f64>()
            };
            let after = |i: usize| force(time(i), Side::After);
            let forces = (0..steps).map(|i| (after(i), force(time(i + 1), Side::Before)));
            let forces = forces.chain([(after(steps), after(steps))]).collect();
            let Some(sensor) = &task.sensor else { return AxisScenario { forces, readings: Vec::new() } };
            let bias = sensor.bias.drawn(&mut next).mean();
            let index = READINGS + (draw * task.axis.len() + a) as u64;
            let mut generator = stream(task.learning.seed, set, index);
            let reading = |_| Reading {
                error: bias + sensor.noise * generator.sample::<f64, _>(StandardNormal),
                is_lost: generator.random::<f64>() < sensor.dropout,
            };
            AxisScenario { forces, readings: (0..=steps).map(reading).collect() }
        });
        Self { axes: axes.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_fill_every_stratum_once_and_mirror_each_other() {
        for count in [1, 2, 4, 7, 100] {
            let shares = spread_shares(&mut stream(1, Set::Evaluation, 0), count);
            assert_eq!(shares.len(), count);
            assert!(shares.iter().all(|share| *share > 0.0 && *share < 1.0));
            let mut even: Vec<f64> = shares[..count - count % 2].to_vec();
            even.sort_by(f64::total_cmp);
            if count % 2 == 0 {
                assert!(even.iter().enumerate().all(|(i, share)| (share * count as f64) as usize == i), "{even:?}");
            }
            assert!(even.iter().zip(even.iter().rev()).all(|(low, high)| (low + high - 1.0).abs() < 1e-15));
        }
    }

    #[test]
    fn sets_updates_and_numbers_have_streams_of_their_own() {
        let sets = [Set::Learning(Draws::Update(0)), Set::Learning(Draws::Update(1)), Set::Learning(Draws::HeldOut)];
        let mut first: Vec<u64> = Vec::new();
        for set in sets.into_iter().chain([Set::Evaluation]) {
            first.extend([0, 1, READINGS].map(|index| stream(7, set, index).random::<u64>()));
        }
        let count = first.len();
        first.sort_unstable();
        first.dedup();
        assert_eq!(first.len(), count);
    }
}
