//! Weights: how costs become shares of the rollouts in an update.

use hpf_core::{Lanes, Real};

/// Costs that are worked on together.
pub(crate) const LANES: usize = 8;
/// So many numbers, one per lane.
pub(crate) type Pack = Lanes<LANES>;

/// How costs become weights of the rollouts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Temperature {
    /// `softmax(-h (S - min)/(max - min))`: the same for any scale of the cost.
    Range(f64),
    /// `softmax(-S/lambda)`, lambda in the unit of the cost.
    Lambda(f64),
    /// By rank alone: `max(0, ln((K+1)/2) - ln(rank))`, as CMA-ES weighs its samples.
    Rank,
    /// Range weights whose h makes this many rollouts count, `1/sum_k P_k^2`; all alike where there are not as many.
    EffectiveSize(f64),
}

/// Largest h looked for: beyond it a rollout a hundredth of the range dearer than the cheapest weighs nothing.
const MOST_SHARPNESS: f64 = 1e5;
/// Halvings that leave nothing between 0 and that.
const SHARPNESS_HALVINGS: usize = 64;

/// Packs that hold `count` costs.
pub(crate) fn packs(count: usize) -> usize {
    count.div_ceil(LANES)
}

/// The costs of one step: `count` of them, the lanes behind them filled with any of theirs.
pub(crate) struct Costs<'a> {
    pub(crate) packs: &'a mut [[f64; LANES]],
    pub(crate) count: usize,
}

impl Costs<'_> {
    fn at(&self, k: usize) -> f64 {
        self.packs[k / LANES][k % LANES]
    }

    /// Nought in the lanes behind the last cost.
    #[inline(always)]
    fn masked(&self, pack: usize, weight: Pack) -> Pack {
        let mut weight = weight;
        for (lane, slot) in weight.0.iter_mut().enumerate() {
            *slot = if pack * LANES + lane < self.count { *slot } else { 0.0 };
        }
        weight
    }

    /// `exp(-h (S - min)/(2 half_unit))` of one pack.
    #[inline(always)]
    fn weigh(&self, pack: usize, sharpness: f64, min: f64, half_unit: f64) -> Pack {
        // Halves, because a difference of two finite costs may be infinite.
        let above = Lanes::of(0.5) * Lanes(self.packs[pack]) - Lanes::of(0.5 * min);
        self.masked(pack, (Lanes::of(-sharpness) * (above / Lanes::of(half_unit))).exp())
    }

    /// The h at which `size` rollouts count, by halving between none and one that leaves the cheapest alone.
    #[inline(always)]
    fn sharpness_of(&self, min: f64, half_range: f64, size: f64) -> f64 {
        let effective = |h: f64| {
            let (mut sum, mut squares) = (Pack::ZERO, Pack::ZERO);
            for pack in 0..self.packs.len() {
                let weights = self.weigh(pack, h, min, half_range);
                sum += weights;
                squares += weights * weights;
            }
            sum_of(sum) * sum_of(sum) / sum_of(squares)
        };
        let (mut low, mut high) = (0.0, MOST_SHARPNESS);
        for _ in 0..SHARPNESS_HALVINGS {
            let middle = 0.5 * (low + high);
            if effective(middle) > size { low = middle } else { high = middle }
        }
        low
    }

    /// The weights by rank; equal costs share what their ranks weigh together.
    fn rank(&mut self, order: &mut Vec<usize>) {
        let count = self.count;
        order.clear();
        order.extend(0..count);
        order.sort_unstable_by(|&a, &b| self.at(a).total_cmp(&self.at(b)).then(a.cmp(&b)));
        let weigh = |i: usize| (libm::log(0.5 * (count + 1) as f64) - libm::log((i + 1) as f64)).max(0.0);
        // A single rollout has the weight of nought by the formula, and all of it by being alone.
        let sum = (0..count).map(weigh).sum::<f64>();
        let mut first = 0;
        while first < count {
            let cost = self.at(order[first]);
            let end = (first..count).find(|&i| self.at(order[i]) != cost).unwrap_or(count);
            let share = (first..end).map(weigh).sum::<f64>() / (end - first) as f64;
            for &k in &order[first..end] {
                self.packs[k / LANES][k % LANES] = if sum > 0.0 { share / sum } else { 1.0 / count as f64 };
            }
            first = end;
        }
        for pack in 0..self.packs.len() {
            self.packs[pack] = self.masked(pack, Lanes(self.packs[pack])).0;
        }
    }
}

/// The sum of all lanes, in their order.
#[inline(always)]
pub(crate) fn sum_of(pack: Pack) -> f64 {
    pack.0.iter().fold(0.0, |sum, value| sum + value)
}

/// All lanes taken together two by two, by a choice that may be made in any order.
#[inline(always)]
fn reduce(mut pack: Pack, choose: impl Fn(f64, f64) -> f64) -> f64 {
    for half in [4, 2, 1] {
        for lane in 0..half {
            pack.0[lane] = choose(pack.0[lane], pack.0[lane + half]);
        }
    }
    pack.0[0]
}

/// Turns costs into weights that sum to one, nought in the lanes behind them; equal costs get equal weights.
///
/// `order` is room for the order of the costs.
#[inline(always)]
pub(crate) fn softmax(costs: &mut Costs<'_>, temperature: Temperature, order: &mut Vec<usize>) {
    if temperature == Temperature::Rank {
        return costs.rank(order);
    }
    // The costs are finite: no choice here needs to care for NaN.
    let least = |a: f64, b: f64| if b < a { b } else { a };
    let most = |a: f64, b: f64| if b > a { b } else { a };
    let (mut low, mut high) = (Pack::of(f64::INFINITY), Pack::of(f64::NEG_INFINITY));
    for pack in costs.packs.iter() {
        (low, high) = (low.zip(Lanes(*pack), least), high.zip(Lanes(*pack), most));
    }
    let (min, max) = (reduce(low, least), reduce(high, most));
    let half_range = 0.5 * max - 0.5 * min;
    let (sharpness, half_unit) = match temperature {
        Temperature::Range(h) if half_range > 0.0 => (h, half_range),
        Temperature::Range(_) => (0.0, 1.0),
        Temperature::Lambda(lambda) => (1.0, 0.5 * lambda),
        Temperature::EffectiveSize(size) if half_range > 0.0 => (costs.sharpness_of(min, half_range, size), half_range),
        Temperature::EffectiveSize(_) | Temperature::Rank => (0.0, 1.0),
    };
    // One after the other, so that a weight of nought leaves the others alone to the last bit.
    let mut sum = 0.0;
    for pack in 0..costs.packs.len() {
        costs.packs[pack] = costs.weigh(pack, sharpness, min, half_unit).0;
        sum = costs.packs[pack].iter().fold(sum, |sum, weight| sum + weight);
    }
    let sum = Pack::of(sum);
    costs.packs.iter_mut().for_each(|weights| *weights = (Lanes(*weights) / sum).0);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weights(costs: &[f64], temperature: Temperature) -> Vec<f64> {
        let mut room = vec![[costs[0]; LANES]; packs(costs.len())];
        for (k, cost) in costs.iter().enumerate() {
            room[k / LANES][k % LANES] = *cost;
        }
        softmax(&mut Costs { packs: &mut room, count: costs.len() }, temperature, &mut Vec::new());
        let all: Vec<f64> = room.as_flattened().to_vec();
        assert!(all[costs.len()..].iter().all(|weight| *weight == 0.0), "lanes behind the costs");
        all[..costs.len()].to_vec()
    }

    #[test]
    fn ranks_weigh_as_cma_es_does_and_equals_share() {
        // ln 2.5 - ln 1, ln 2.5 - ln 2, and nought: 0.9163, 0.2231.
        let sum = 0.916_290_731_874_155 + 0.223_143_551_314_209_7;
        let found = weights(&[4.0, 1.0, 9.0, 2.0], Temperature::Rank);
        for (found, expected) in
            found.iter().zip([0.0, 0.916_290_731_874_155 / sum, 0.0, 0.223_143_551_314_209_7 / sum])
        {
            assert!((found - expected).abs() < 1e-15);
        }
        let equal = weights(&[1.0; 5], Temperature::Rank);
        assert!(equal.iter().all(|weight| (weight - 0.2).abs() < 1e-15));
        assert_eq!(weights(&[3.0], Temperature::Rank), [1.0]);
    }

    #[test]
    fn as_many_rollouts_count_as_asked_for() {
        for size in [2.0, 5.0, 9.0] {
            let costs: Vec<f64> = (0..12).map(|k| 1.0 + (1.7 * f64::from(k)).sin()).collect();
            let weights = weights(&costs, Temperature::EffectiveSize(size));
            let effective = 1.0 / weights.iter().map(|p| p * p).sum::<f64>();
            assert!(
                (weights.iter().sum::<f64>() - 1.0).abs() < 1e-14 && (effective - size).abs() < 1e-6,
                "{effective}"
            );
        }
    }

    #[test]
    fn equal_costs_get_equal_weights() {
        assert_eq!(weights(&[3.0; 4], Temperature::Range(10.0)), [0.25; 4]);
    }

    #[test]
    fn range_weights_do_not_change_with_the_unit_of_the_cost() {
        let euros = weights(&[1.0, 2.0, 4.0], Temperature::Range(10.0));
        let cents = weights(&[100.0, 200.0, 400.0], Temperature::Range(10.0));
        for (a, b) in euros.iter().zip(cents) {
            assert!((a - b).abs() < 1e-15);
        }
    }

    #[test]
    fn differences_beyond_the_largest_number_are_still_ranked() {
        let weights = weights(&[-1e308, 0.0, 1e308], Temperature::Range(10.0));
        assert!(weights.iter().all(|weight| weight.is_finite()), "{weights:?}");
    }
}
