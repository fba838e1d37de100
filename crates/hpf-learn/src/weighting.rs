//! Weights: how costs become shares of the rollouts in an update, eight steps at a time.

use hpf_core::{Lanes, Real};

/// Steps that are worked on together.
pub(crate) const LANES: usize = 8;
/// A number of each of them.
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

/// Largest h looked for: beyond it a rollout that costs a hundredth of the range more than the cheapest weighs nothing.
const MOST_SHARPNESS: f64 = 1e5;
/// Halvings that leave nothing between 0 and that.
const SHARPNESS_HALVINGS: usize = 64;
/// Rollouts up to which counting the cheaper ones of each, eight steps at a time, is faster than sorting step by step.
const MOST_COUNTED: usize = 256;

/// The smaller of two, lane by lane; `a` where `b` is NaN.
#[inline(always)]
pub(crate) fn least(a: Pack, b: Pack) -> Pack {
    a.zip(b, |a, b| if b < a { b } else { a })
}

/// The larger of two, lane by lane; `a` where `b` is NaN.
#[inline(always)]
pub(crate) fn most(a: Pack, b: Pack) -> Pack {
    a.zip(b, |a, b| if b > a { b } else { a })
}

/// What a cost weighs beside the others of its step: `exp(-rate (S - least)/2)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scale {
    half_least: Pack,
    rate: Pack,
}

impl Default for Scale {
    /// All alike.
    fn default() -> Self {
        Self { half_least: Pack::ZERO, rate: Pack::ZERO }
    }
}

impl Scale {
    #[inline(always)]
    pub(crate) fn weigh(self, costs: Pack) -> Pack {
        // Halves, because a difference of two finite costs may be infinite.
        let above = Lanes::of(0.5) * costs - self.half_least;
        (-self.rate * above).exp()
    }

    /// With another sharpness: `exp(-h (S - least)/range)`, and all alike where there is no range.
    #[inline(always)]
    fn sharp(self, h: Pack, half_range: Pack) -> Self {
        // A range so small that the rate would be infinite is none, either.
        let rate = (h / half_range)
            .zip(half_range, |rate, range| if range > 0.0 && rate < f64::INFINITY { rate } else { 0.0 });
        Self { rate, ..self }
    }
}

impl Temperature {
    /// How `costs` between `least` and `most` weigh. Ranks are weighed by [`Ranking`].
    #[inline(always)]
    pub(crate) fn scale(self, least: Pack, most: Pack, costs: impl Iterator<Item = Pack> + Clone) -> Scale {
        let half = Pack::of(0.5);
        let half_range = half * most - half * least;
        let scale = Scale { half_least: half * least, rate: Pack::ZERO };
        match self {
            Self::Range(h) => scale.sharp(Pack::of(h), half_range),
            Self::Lambda(lambda) => Scale { rate: Pack::of((2.0 / lambda).min(f64::MAX)), ..scale },
            Self::EffectiveSize(size) => {
                let mut bounds = [Pack::ZERO, Pack::of(MOST_SHARPNESS)];
                for _ in 0..SHARPNESS_HALVINGS {
                    let middle = half * (bounds[0] + bounds[1]);
                    let scale = scale.sharp(middle, half_range);
                    let (mut sum, mut squares) = (Pack::ZERO, Pack::ZERO);
                    for costs in costs.clone() {
                        let weights = scale.weigh(costs);
                        sum += weights;
                        squares += weights * weights;
                    }
                    let effective = sum * sum / squares;
                    for lane in 0..LANES {
                        bounds[usize::from(effective.0[lane] <= size)].0[lane] = middle.0[lane];
                    }
                }
                scale.sharp(bounds[0], half_range)
            }
            Self::Rank => scale,
        }
    }
}

/// What ranks weigh, summed up: entry i is of the i cheapest together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ranking(Vec<f64>);

impl Ranking {
    /// Makes it that of so many rollouts.
    pub(crate) fn set(&mut self, count: usize) {
        // A single rollout has the weight of zero by the formula, and all of it by being alone.
        let of_one = if count == 1 { 1.0 } else { 0.0 };
        let weigh = |i: usize| (libm::log(0.5 * (count + 1) as f64) - libm::log((i + 1) as f64)).max(of_one);
        self.0.clear();
        self.0.push(0.0);
        for i in 0..count {
            self.0.push(self.0[i] + weigh(i));
        }
    }

    /// The weights of `all` costs; equal costs share what their ranks weigh together, NaN has none.
    #[inline(always)]
    pub(crate) fn weigh<'a, I: Iterator<Item = &'a Pack>>(&self, all: impl Fn() -> I, weights: &mut [Pack]) {
        let share = |below: usize, equal: usize| (self.0[below + equal] - self.0[below]) / equal as f64;
        if weights.len() > MOST_COUNTED {
            for lane in 0..LANES {
                let mut sorted: Vec<f64> = all().map(|costs| costs.0[lane]).filter(|cost| !cost.is_nan()).collect();
                sorted.sort_unstable_by(f64::total_cmp);
                for (weight, costs) in weights.iter_mut().zip(all()) {
                    let below = sorted.partition_point(|other| *other < costs.0[lane]);
                    let equal = sorted[below..].partition_point(|other| *other == costs.0[lane]);
                    weight.0[lane] = share(below, equal);
                }
            }
            return;
        }
        for (weight, costs) in weights.iter_mut().zip(all()) {
            let (mut below, mut equal) = (Pack::ZERO, Pack::ZERO);
            for others in all() {
                below += others.zip(*costs, |other, cost| if other < cost { 1.0 } else { 0.0 });
                equal += others.zip(*costs, |other, cost| if other == cost { 1.0 } else { 0.0 });
            }
            *weight = below.zip(equal, |below, equal| share(below as usize, equal as usize));
        }
    }
}

/// The weights of costs, a rollout's each, which sum to one; equal costs weigh the same.
pub(crate) fn softmax(costs: &[Pack], temperature: Temperature) -> Vec<Pack> {
    let all = || costs.iter().copied();
    let mut weights: Vec<Pack> = if temperature == Temperature::Rank {
        let mut ranking = Ranking::default();
        ranking.set(costs.len());
        let mut weights = costs.to_vec();
        ranking.weigh(|| costs.iter(), &mut weights);
        weights
    } else {
        let low = all().fold(Pack::of(f64::INFINITY), least);
        let high = all().fold(Pack::of(f64::NEG_INFINITY), most);
        let scale = temperature.scale(low, high, all());
        all().map(|costs| scale.weigh(costs)).collect()
    };
    let sum = weights.iter().fold(Pack::ZERO, |sum, weights| sum + *weights);
    weights.iter_mut().for_each(|weights| *weights = *weights / sum);
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weights(costs: &[f64], temperature: Temperature) -> Vec<f64> {
        let packs: Vec<Pack> = costs.iter().map(|cost| Pack::of(*cost)).collect();
        softmax(&packs, temperature).iter().map(|weights| weights.0[0]).collect()
    }

    #[test]
    fn ranks_weigh_as_cma_es_does_and_equals_share() {
        // ln 2.5 - ln 1, ln 2.5 - ln 2, and zero: 0.9163, 0.2231.
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
