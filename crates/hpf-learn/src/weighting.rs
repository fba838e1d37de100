//! Weights: how costs become shares of the rollouts in an update.

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

/// Turns costs into weights that sum to one; equal costs get equal weights.
pub(crate) fn softmax(costs: &mut [f64], temperature: Temperature) {
    let min = costs.iter().copied().fold(f64::INFINITY, f64::min);
    let max = costs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if temperature == Temperature::Rank {
        return rank(costs);
    }
    // Halves, because a difference of two finite costs may be infinite.
    let half_range = 0.5 * max - 0.5 * min;
    let (sharpness, half_unit) = match temperature {
        Temperature::Range(h) if half_range > 0.0 => (h, half_range),
        Temperature::Range(_) => (0.0, 1.0),
        Temperature::Lambda(lambda) => (1.0, 0.5 * lambda),
        Temperature::EffectiveSize(size) if half_range > 0.0 => {
            (sharpness_of(costs, min, half_range, size), half_range)
        }
        Temperature::EffectiveSize(_) | Temperature::Rank => (0.0, 1.0),
    };
    let mut sum = 0.0;
    for cost in costs.iter_mut() {
        *cost = libm::exp(-sharpness * ((0.5 * *cost - 0.5 * min) / half_unit));
        sum += *cost;
    }
    costs.iter_mut().for_each(|weight| *weight /= sum);
}

/// The weights by rank; equal costs share what their ranks weigh together.
fn rank(costs: &mut [f64]) {
    let count = costs.len();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| costs[a].total_cmp(&costs[b]));
    let weigh = |i: usize| (libm::log(0.5 * (count + 1) as f64) - libm::log((i + 1) as f64)).max(0.0);
    // A single rollout has the weight of nought by the formula, and all of it by being alone.
    let sum = (0..count).map(weigh).sum::<f64>();
    let mut first = 0;
    while first < count {
        let cost = costs[order[first]];
        let end = (first..count).find(|&i| costs[order[i]] != cost).unwrap_or(count);
        let share = (first..end).map(weigh).sum::<f64>() / (end - first) as f64;
        for &k in &order[first..end] {
            costs[k] = if sum > 0.0 { share / sum } else { 1.0 / count as f64 };
        }
        first = end;
    }
}

/// The h at which `size` rollouts count, by halving between none and one that leaves the cheapest alone.
fn sharpness_of(costs: &[f64], min: f64, half_range: f64, size: f64) -> f64 {
    let effective = |h: f64| {
        let weights = costs.iter().map(|cost| libm::exp(-h * ((0.5 * cost - 0.5 * min) / half_range)));
        let (sum, squares) = weights.fold((0.0, 0.0), |(sum, squares), w| (sum + w, squares + w * w));
        sum * sum / squares
    };
    let (mut low, mut high) = (0.0, MOST_SHARPNESS);
    for _ in 0..SHARPNESS_HALVINGS {
        let middle = 0.5 * (low + high);
        if effective(middle) > size { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_weigh_as_cma_es_does_and_equals_share() {
        let mut costs = [4.0, 1.0, 9.0, 2.0];
        softmax(&mut costs, Temperature::Rank);
        // ln 2.5 - ln 1, ln 2.5 - ln 2, and nought: 0.9163, 0.2231.
        let sum = 0.916_290_731_874_155 + 0.223_143_551_314_209_7;
        for (found, expected) in
            costs.iter().zip([0.0, 0.916_290_731_874_155 / sum, 0.0, 0.223_143_551_314_209_7 / sum])
        {
            assert!((found - expected).abs() < 1e-15);
        }
        let mut equal = [1.0; 5];
        softmax(&mut equal, Temperature::Rank);
        assert!(equal.iter().all(|weight| (weight - 0.2).abs() < 1e-15));
        let mut alone = [3.0];
        softmax(&mut alone, Temperature::Rank);
        assert_eq!(alone, [1.0]);
    }

    #[test]
    fn as_many_rollouts_count_as_asked_for() {
        for size in [2.0, 5.0, 9.0] {
            let mut costs: Vec<f64> = (0..12).map(|k| 1.0 + (1.7 * f64::from(k)).sin()).collect();
            softmax(&mut costs, Temperature::EffectiveSize(size));
            let effective = 1.0 / costs.iter().map(|p| p * p).sum::<f64>();
            assert!((costs.iter().sum::<f64>() - 1.0).abs() < 1e-14 && (effective - size).abs() < 1e-6, "{effective}");
        }
    }

    #[test]
    fn equal_costs_get_equal_weights() {
        let mut costs = [3.0; 4];
        softmax(&mut costs, Temperature::Range(10.0));
        assert_eq!(costs, [0.25; 4]);
    }

    #[test]
    fn range_weights_do_not_change_with_the_unit_of_the_cost() {
        let (mut euros, mut cents) = ([1.0, 2.0, 4.0], [100.0, 200.0, 400.0]);
        softmax(&mut euros, Temperature::Range(10.0));
        softmax(&mut cents, Temperature::Range(10.0));
        for (a, b) in euros.iter().zip(cents) {
            assert!((a - b).abs() < 1e-15);
        }
    }

    #[test]
    fn differences_beyond_the_largest_number_are_still_ranked() {
        let mut costs = [-1e308, 0.0, 1e308];
        softmax(&mut costs, Temperature::Range(10.0));
        assert!(costs.iter().all(|weight| weight.is_finite()), "{costs:?}");
    }
}
