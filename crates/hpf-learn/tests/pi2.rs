//! PI2's update against a plain transcription of its formulas, and what its samples promise.

#![expect(clippy::needless_range_loop, reason = "sums over t, k, i and j read like their formulas")]

use crate::block::{FREE, block, phase};
use hpf_learn::{
    Anneal, Batch, Block, Cost, Covariance, Credit, Exploration, Parameters, Pi2, Pi2Error, Pi2Options, Temperature,
};

/// Not a multiple of the steps that are worked on together.
const STEPS: usize = 43;

/// Forcing scale of the movement block: it must cancel.
const SCALE: f64 = -0.37;

/// Two axes' worth of unequal blocks; the gains' start sits on a bound, so that many samples are clamped.
fn blocks() -> [Block; 3] {
    [
        block("x.movement", 7, STEPS, FREE, 10.0),
        block("x.stiffness", 5, STEPS, (30.0, 120.0), 40.0),
        block("x.damping", 4, STEPS, (10.0, 60.0), 5.0),
    ]
}

fn start() -> Vec<f64> {
    let movement = (0..7).map(|i| 3.0 * f64::from(i) - 8.0);
    movement.chain([30.0, 100.0, 120.0, 80.0, 31.0]).chain([10.0, 20.0, 60.0, 50.0]).collect()
}

/// Made-up costs that differ by rollout and step.
fn costs(rollouts: usize) -> Vec<Cost> {
    (0..rollouts)
        .map(|k| {
            let wave = |t: usize| 1.0 + (1.3 * k as f64 + 0.21 * t as f64).sin();
            Cost { running: (0..STEPS).map(wave).collect(), terminal: 5.0 + 3.0 * (k as f64).cos(), terms: vec![] }
        })
        .collect()
}

fn every_option(rollouts: usize) -> impl Iterator<Item = Pi2Options> {
    let temperatures = [Temperature::Range(10.0), Temperature::Lambda(7.0), Temperature::Rank];
    let credits = [Credit::ToGo, Credit::Total];
    let explorations = [Exploration::Rollout, Exploration::Basis, Exploration::Step];
    temperatures.into_iter().flat_map(move |temperature| {
        credits.into_iter().flat_map(move |credit| {
            explorations.into_iter().flat_map(move |exploration| {
                [true, false].map(|is_projected| Pi2Options {
                    rollouts,
                    temperature,
                    credit,
                    exploration,
                    is_projected,
                    updates: 10,
                    ..Pi2Options::default()
                })
            })
        })
    })
}

/// The update as its formulas say, one loop per index, every matrix written out.
fn transcribed(blocks: &[Block], weights: &[f64], batch: &Batch, costs: &[Cost], options: Pi2Options) -> Vec<f64> {
    let (rollouts, steps, mut start, mut next) = (costs.len(), costs[0].running.len(), 0, Vec::new());
    // S_{t,k} and P_{t,k}
    let mut probability = vec![vec![0.0; rollouts]; steps];
    for (t, row) in probability.iter_mut().enumerate() {
        let first = if options.credit == Credit::ToGo { t } else { 0 };
        let s: Vec<f64> = costs.iter().map(|cost| cost.terminal + cost.running[first..].iter().sum::<f64>()).collect();
        let least = s.iter().copied().fold(f64::INFINITY, f64::min);
        let most = s.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let weigh = |h: f64, s: f64| (-h * (s - least) / (most - least)).exp();
        let sum = |h: f64, power: i32| s.iter().map(|s| weigh(h, *s).powi(power)).sum::<f64>();
        let (mut h, mut high) = (0.0, 1e5);
        if let Temperature::EffectiveSize(size) = options.temperature {
            for _ in 0..100 {
                let middle = 0.5 * (h + high);
                if sum(middle, 1).powi(2) / sum(middle, 2) > size { h = middle } else { high = middle }
            }
        }
        for k in 0..rollouts {
            row[k] = match options.temperature {
                Temperature::Range(h) => weigh(h, s[k]),
                Temperature::Lambda(lambda) => (-s[k] / lambda).exp(),
                Temperature::Rank => {
                    let rank = 1 + s.iter().filter(|other| **other < s[k]).count();
                    ((0.5 * (rollouts + 1) as f64).ln() - (rank as f64).ln()).max(0.0)
                }
                Temperature::EffectiveSize(_) => weigh(h, s[k]),
            };
        }
        let sum: f64 = row.iter().sum();
        row.iter_mut().for_each(|p| *p /= sum);
    }
    for (b, block) in blocks.iter().enumerate() {
        let n = block.count;
        let (mut above, mut below) = (vec![0.0; n], vec![0.0; n]);
        for t in 0..steps {
            let phi = &block.features[t * n..(t + 1) * n];
            // g_t: s A phi of a movement, phi of a gain.
            let factor = if b == 0 { phase(t, steps) * SCALE } else { 1.0 };
            let g: Vec<f64> = phi.iter().map(|phi| factor * phi).collect();
            let square: f64 = g.iter().map(|g| g * g).sum();
            let mut change = vec![0.0; n];
            for k in 0..rollouts {
                let sample = &batch.sample(k).at(t)[start..start + n];
                for i in 0..n {
                    for j in 0..n {
                        let identity = f64::from(u8::from(i == j));
                        let projection = if options.is_projected { g[i] * g[j] / square } else { identity };
                        change[i] += probability[t][k] * projection * (sample[j] - weights[start + j]);
                    }
                }
            }
            for j in 0..n {
                let weight = (steps - t) as f64 * block.activations[t * n + j];
                above[j] += weight * change[j];
                below[j] += weight;
            }
        }
        for j in 0..n {
            next.push((weights[start + j] + above[j] / below[j]).clamp(block.min, block.max));
        }
        start += n;
    }
    next
}

#[test]
fn an_update_is_its_formulas_for_every_option() {
    let mut seen = 0;
    for options in every_option(9) {
        let mut learner = Pi2::new(&blocks(), STEPS, start(), options).unwrap();
        for update in 0..3 {
            let before = learner.weights().to_vec();
            let batch = learner.ask();
            let expected = transcribed(&blocks(), &before, &batch, &costs(9), options);
            assert_eq!(learner.tell(&batch, &costs(9)), Ok(0));
            for (i, (found, expected)) in learner.weights().iter().zip(&expected).enumerate() {
                // Relative to the size of the weights, some 10: sums of 43 x 9 products in another order.
                let tolerance = 1e-12 * expected.abs().max(1.0);
                assert!(
                    (found - expected).abs() <= tolerance,
                    "{options:?}, update {update}: weight {i} is {found}, not {expected}"
                );
            }
            assert!(learner.weights().iter().zip(&before).any(|(now, before)| now != before));
            seen += 1;
        }
    }
    assert_eq!(seen, 36 * 3);
}

#[test]
fn threads_that_share_an_update_change_no_bit_nor_do_instructions() {
    // More costs than one thread works on alone, and more rollouts than are ranked by counting.
    let (steps, rollouts) = (100, 300);
    let blocks = [block("movement", 7, steps, FREE, 10.0), block("stiffness", 5, steps, (30.0, 120.0), 40.0)];
    let wave = |k: usize, t: usize| 1.0 + (1.3 * k as f64 + 0.021 * t as f64).sin();
    let cost = |k: usize| Cost { running: (0..steps).map(|t| wave(k, t)).collect(), terminal: 0.1, terms: vec![] };
    let costs: Vec<Cost> = (0..rollouts).map(cost).collect();
    for temperature in [Temperature::Range(10.0), Temperature::Rank, Temperature::EffectiveSize(9.0)] {
        let options = Pi2Options { rollouts, temperature, ..Pi2Options::default() };
        let start = vec![50.0; 12];
        let learner = Pi2::new(&blocks, steps, start.clone(), options).unwrap();
        let batch = learner.ask();
        let learned = |mut learner: Pi2, threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(|| learner.tell(&batch, &costs)), Ok(0));
            learner.weights().to_vec()
        };
        let alone = learned(learner.clone(), 1);
        for (found, expected) in alone.iter().zip(transcribed(&blocks, &start, &batch, &costs, options)) {
            // Relative to the size of the weights; the h of an effective size is found to a part in 1e14 or so.
            assert!((found - expected).abs() <= 1e-10 * expected.abs(), "{temperature:?}: {found}, not {expected}");
        }
        for threads in [2, 3, 8] {
            assert_eq!(learned(learner.clone(), threads), alone, "{temperature:?} on {threads} threads");
        }
        assert_eq!(learned(learner.clone().portable(), 2), alone, "{temperature:?} in every processor's instructions");
    }
}

#[test]
fn one_rollout_at_one_step_moves_the_weights_onto_the_basis_vector() {
    // N = 1: P = 1, the average over steps has one member, dw = M eps.
    let block = block("gain", 3, 1, FREE, 1.0);
    let options = Pi2Options { rollouts: 1, ..Pi2Options::default() };
    let mut learner = Pi2::new(core::slice::from_ref(&block), 1, vec![0.0; 3], options).unwrap();
    let batch = learner.ask();
    let eps = batch.sample(0).at(0).to_vec();
    learner.tell(&batch, &[Cost { running: vec![2.0], terminal: 0.0, terms: vec![] }]).unwrap();
    let phi = &block.features;
    let along = phi.iter().zip(&eps).map(|(p, e)| p * e).sum::<f64>() / phi.iter().map(|p| p * p).sum::<f64>();
    for (weight, phi) in learner.weights().iter().zip(phi) {
        assert!((weight - along * phi).abs() < 1e-15); // three products
    }
}

#[test]
fn a_black_box_update_is_the_weighted_mean_of_the_samples() {
    let options = Pi2Options { rollouts: 9, temperature: Temperature::Rank, ..Pi2Options::black_box() };
    let free = [block("x", 6, STEPS, FREE, 1.0)];
    let mut learner = Pi2::new(&free, STEPS, vec![0.0; 6], options).unwrap();
    let batch = learner.ask();
    let costs = costs(9);
    learner.tell(&batch, &costs).unwrap();
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|&a, &b| costs[a].total().total_cmp(&costs[b].total()));
    let weigh = |rank: usize| (5.0_f64.ln() - ((rank + 1) as f64).ln()).max(0.0);
    let sum: f64 = (0..9).map(weigh).sum();
    for j in 0..6 {
        let mean: f64 = order.iter().enumerate().map(|(i, &k)| weigh(i) / sum * batch.sample(k).at(0)[j]).sum();
        assert!((learner.weights()[j] - mean).abs() < 1e-14); // nine products of numbers near 1
    }
}

#[test]
fn basis_noise_moves_one_parameter_of_each_block_at_a_time() {
    let options = Pi2Options { exploration: Exploration::Basis, ..Pi2Options::default() };
    let two = [block("x", 6, STEPS, FREE, 1.0), block("k", 4, STEPS, FREE, 1.0)];
    let batch = Pi2::new(&two, STEPS, vec![0.0; 10], options).unwrap().ask();
    for k in 0..batch.len() {
        let mut values = vec![Vec::new(); 10];
        for t in 0..STEPS {
            let row = batch.sample(k).at(t);
            for (range, block) in [(0..6, &two[0]), (6..10, &two[1])] {
                let moved: Vec<usize> = range.clone().filter(|&j| row[j] != 0.0).collect();
                assert_eq!(moved.len(), 1);
                let phi = &block.features[t * block.count..(t + 1) * block.count];
                assert!(phi.iter().all(|other| *other <= phi[moved[0] - range.start]), "the most active one");
                values[moved[0]].push(row[moved[0]]);
            }
        }
        assert!(values.iter().all(|held| held.windows(2).all(|pair| pair[0] == pair[1])), "held while active");
    }
}

#[test]
fn the_spread_shrinks_where_the_cost_is_steep_and_stays_where_it_is_flat() {
    let covariance = Covariance::Diagonal { floor: 0.05, ceiling: 1.5 };
    let options = Pi2Options { covariance, anneal: Anneal::None, ..Pi2Options::black_box() };
    let free = [block("x", 2, STEPS, FREE, 1.0)];
    let mut learner = Pi2::new(&free, STEPS, vec![0.0; 2], options).unwrap();
    for _ in 0..40 {
        let batch = learner.ask();
        // Only the first parameter costs anything.
        let price = |k: usize| batch.sample(k).at(0)[0].powi(2);
        let costs: Vec<Cost> =
            (0..20).map(|k| Cost { running: vec![0.0; STEPS], terminal: price(k), terms: vec![] }).collect();
        learner.tell(&batch, &costs).unwrap();
    }
    assert_eq!(learner.spread()[0], 0.05, "as narrow as the floor allows");
    assert!(learner.spread()[1] > 0.2 && learner.spread()[1] <= 1.5, "{}", learner.spread()[1]);
}

#[test]
fn samples_stay_within_their_bounds_and_some_lie_on_them() {
    for exploration in [Exploration::Rollout, Exploration::Step] {
        let options = Pi2Options { exploration, ..Pi2Options::default() };
        let batch = Pi2::new(&blocks(), STEPS, start(), options).unwrap().ask();
        let mut on_bound = 0;
        assert_eq!((batch.len(), batch.is_empty()), (20, false));
        for k in 0..batch.len() {
            for t in 0..STEPS {
                let row = batch.sample(k).at(t);
                assert_eq!(row.len(), 16);
                for &value in &row[7..12] {
                    assert!((30.0..=120.0).contains(&value));
                    on_bound += usize::from(value == 30.0 || value == 120.0);
                }
                assert!(row[12..].iter().all(|value| (10.0..=60.0).contains(value)));
            }
        }
        assert!(on_bound > 0);
    }
}

#[test]
fn learned_weights_stay_within_their_bounds() {
    for options in every_option(5) {
        let mut learner = Pi2::new(&blocks(), STEPS, start(), options).unwrap();
        for _ in 0..10 {
            let batch = learner.ask();
            // The stiffer the cheaper: pushes into the bounds.
            let price = |k: usize| -batch.sample(k).at(0)[7..].iter().sum::<f64>();
            let costs: Vec<Cost> =
                (0..5).map(|k| Cost { running: vec![0.0; STEPS], terminal: price(k), terms: vec![] }).collect();
            learner.tell(&batch, &costs).unwrap();
            assert!(learner.weights()[7..12].iter().all(|w| (30.0..=120.0).contains(w)));
            assert!(learner.weights()[12..].iter().all(|w| (10.0..=60.0).contains(w)));
        }
    }
}

#[test]
fn a_step_past_the_last_row_takes_the_last_row() {
    let rows = [1.0, 2.0, 3.0, 4.0];
    let parameters = Parameters::PerStep { rows: &rows, count: 2 };
    assert_eq!([0, 1, 2, 9].map(|t| parameters.at(t)[0]), [1.0, 3.0, 3.0, 3.0]);
    assert_eq!(Parameters::Constant(&rows).at(7), rows);
}

#[test]
fn ask_is_a_function_of_seed_and_update_alone() {
    for exploration in [Exploration::Rollout, Exploration::Step] {
        let options = Pi2Options { exploration, anneal: Anneal::None, ..Pi2Options::default() };
        let free = [block("x", 6, STEPS, FREE, 1.0)];
        let learner = |seed| Pi2::new(&free, STEPS, vec![0.0; 6], Pi2Options { seed, ..options }).unwrap();
        let mut one = learner(1);
        let first = one.ask();
        assert_eq!(first, one.ask());
        assert_eq!(first, learner(1).ask());
        assert_ne!(first, learner(2).ask());

        // Equal costs leave another mean, so compare the exploration of the second update with that of the first.
        let flat = vec![Cost { running: vec![0.0; STEPS], terminal: 1.0, terms: vec![] }; 20];
        one.tell(&first, &flat).unwrap();
        assert_eq!(one.update(), 1);
        let second = one.ask();
        let drawn = |batch: &Batch, k: usize, mean: &[f64]| -> Vec<f64> {
            batch.sample(k).at(0).iter().zip(mean).map(|(sample, mean)| sample - mean).collect()
        };
        let mut seen = Vec::new();
        for k in 0..20 {
            seen.push(drawn(&first, k, &[0.0; 6]));
            seen.push(drawn(&second, k, one.weights()));
        }
        for (i, this) in seen.iter().enumerate() {
            for other in &seen[..i] {
                // 1e-9: far above the rounding of the subtraction, far below what two draws come near to each other.
                assert!(this.iter().zip(other).all(|(a, b)| (a - b).abs() > 1e-9), "two rollouts draw the same number");
            }
        }
        if exploration == Exploration::Step {
            let batch = learner(1).ask();
            assert_ne!(batch.sample(0).at(0), batch.sample(0).at(1));
        }
    }
}

#[test]
fn exploration_has_the_standard_deviation_it_is_given_and_shrinks_as_annealed() {
    let rollouts = 4000;
    for (anneal, scales) in [
        (Anneal::None, [1.0, 1.0, 1.0]),
        (Anneal::Linear { last: 0.1 }, [1.0, 0.55, 0.1]),
        (Anneal::Geometric { last: 0.01 }, [1.0, 0.1, 0.01]),
    ] {
        let options = Pi2Options { rollouts, updates: 3, anneal, ..Pi2Options::default() };
        let two = [block("movement", 5, 2, FREE, 10.0), block("stiffness", 5, 2, FREE, 0.3)];
        let mut learner = Pi2::new(&two, 2, vec![100.0; 10], options).unwrap();
        for scale in scales {
            assert!((learner.exploration() - scale).abs() < 1e-15);
            let batch = learner.ask();
            for (columns, noise) in [(0..5, 10.0), (5..10, 0.3)] {
                let eps: Vec<f64> = (0..rollouts)
                    .flat_map(|k| columns.clone().map(move |j| (k, j)))
                    .map(|(k, j)| (batch.sample(k).at(0)[j] - learner.weights()[j]) / (noise * scale))
                    .collect();
                let count = eps.len() as f64;
                let mean = eps.iter().sum::<f64>() / count;
                let spread = (eps.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / count).sqrt();
                // 20 000 normal numbers: the mean is right to 0.007, the spread to 0.005; four times that.
                assert!(mean.abs() < 0.03 && (spread - 1.0).abs() < 0.02, "{anneal:?}: {mean} {spread}");
            }
            let flat = vec![Cost { running: vec![0.0; 2], terminal: 0.0, terms: vec![] }; rollouts];
            learner.tell(&batch, &flat).unwrap();
        }
    }
}

/// Costs of which some are refused, and the same without them.
fn spoilt() -> [(Cost, &'static str); 7] {
    let with = |at: usize, value: f64| {
        let mut running = vec![1.0; STEPS];
        running[at] = value;
        running
    };
    let cost = |running, terminal| Cost { running, terminal, terms: vec![] };
    [
        (cost(with(3, f64::NAN), 1.0), "NaN at a step"),
        (cost(with(0, f64::INFINITY), 1.0), "infinite at a step"),
        (cost(with(39, f64::NEG_INFINITY), 1.0), "minus infinity at a step"),
        (cost(vec![1.0; STEPS], f64::NAN), "NaN at the end"),
        (cost(vec![1e308; STEPS], 1e308), "a sum beyond the largest number"),
        (
            cost([-1.5e308].into_iter().chain([1.5e308; 2]).chain([0.0; STEPS - 3]).collect(), 0.0),
            "a cost to go beyond the largest number, in a total that is not",
        ),
        (
            cost([0.0; 6].into_iter().chain([-1.5e308, 1.5e308, 1.5e308]).chain([0.0; STEPS - 9]).collect(), 0.0),
            "a cost to go beyond the largest number, in a total and in the first steps that are not",
        ),
    ]
}

#[test]
fn rollouts_without_a_finite_cost_weigh_nothing_and_are_counted() {
    for options in every_option(9) {
        for (bad, what) in spoilt() {
            let mut learner = Pi2::new(&blocks(), STEPS, start(), options).unwrap();
            let batch = learner.ask();
            let mut costs = costs(9);
            // The last one has a group of its own.
            costs[2] = bad.clone();
            costs[8] = bad;
            assert_eq!(learner.tell(&batch, &costs), Ok(2), "{what}, {options:?}");
            assert!(learner.weights().iter().all(|w| w.is_finite()), "{what}, {options:?}");
            // With a fixed lambda, a rollout so expensive that its weight is 0 to the last bit leaves the others alone.
            if let Temperature::Lambda(_) = options.temperature {
                let mut other = Pi2::new(&blocks(), STEPS, start(), options).unwrap();
                for k in [2, 8] {
                    costs[k] = Cost { running: vec![0.0; STEPS], terminal: 1e6, terms: vec![] };
                }
                assert_eq!(other.tell(&batch, &costs), Ok(0));
                assert_eq!(learner.weights(), other.weights(), "{what}, {options:?}");
            }
        }
    }
}

#[test]
fn an_update_without_any_finite_cost_is_an_error_and_changes_nothing() {
    for options in every_option(4) {
        for (bad, what) in spoilt() {
            let mut learner = Pi2::new(&blocks(), STEPS, start(), options).unwrap();
            let batch = learner.ask();
            let refused = learner.tell(&batch, &vec![bad; 4]);
            assert_eq!(refused, Err(Pi2Error::AllRejected { update: 0, rollouts: 4 }), "{what}");
            assert_eq!((learner.weights(), learner.update()), (start().as_slice(), 0));
            assert_eq!(learner.ask(), batch, "the same samples again");
        }
    }
    let message = Pi2Error::AllRejected { update: 3, rollouts: 4 }.to_string();
    assert_eq!(message, "none of the 4 rollouts of update 3 has a finite cost");
}

#[test]
fn equal_costs_weigh_all_rollouts_the_same() {
    for options in every_option(6).filter(|options| options.is_projected) {
        let mut learner = Pi2::new(&blocks(), STEPS, start(), options).unwrap();
        let batch = learner.ask();
        let flat = vec![Cost { running: vec![2.0; STEPS], terminal: 1.0, terms: vec![] }; 6];
        learner.tell(&batch, &flat).unwrap();

        // The same as every rollout having drawn the mean of all draws.
        let width = start().len();
        let mean: Vec<Vec<f64>> = (0..STEPS)
            .map(|t| (0..width).map(|j| (0..6).map(|k| batch.sample(k).at(t)[j]).sum::<f64>() / 6.0).collect())
            .collect();
        let (mut offset, mut expected) = (0, start());
        for block in blocks() {
            let n = block.count;
            for j in 0..n {
                let (mut above, mut below) = (0.0, 0.0);
                for t in 0..STEPS {
                    let phi = &block.features[t * n..(t + 1) * n];
                    let along: f64 = (0..n).map(|i| phi[i] * (mean[t][offset + i] - start()[offset + i])).sum();
                    let square: f64 = phi.iter().map(|phi| phi * phi).sum();
                    let weight = (STEPS - t) as f64 * block.activations[t * n + j];
                    above += weight * phi[j] * along / square;
                    below += weight;
                }
                expected[offset + j] = (expected[offset + j] + above / below).clamp(block.min, block.max);
            }
            offset += n;
        }
        for (found, expected) in learner.weights().iter().zip(&expected) {
            assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{found} {expected}");
        }
    }
}
