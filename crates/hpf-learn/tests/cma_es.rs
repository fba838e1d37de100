//! CMA-ES on functions whose optimum is known.

use hpf_learn::{Block, CmaEs, CmaEsOptions, Pi2Error};

fn block(count: usize, min: f64, max: f64, noise: f64) -> Block {
    Block { name: "w".into(), count, features: vec![], activations: vec![], min, max, noise }
}

fn learned(blocks: &[Block], start: &[f64], updates: usize, seed: u64, cost: impl Fn(&[f64]) -> f64) -> CmaEs {
    let mut learner = CmaEs::new(blocks, start.to_vec(), CmaEsOptions { rollouts: 12, updates, seed });
    for _ in 0..updates {
        let costs: Vec<f64> = learner.ask().iter().map(|w| cost(w)).collect();
        learner.tell(&costs).unwrap();
    }
    learner
}

#[test]
fn an_ill_conditioned_bowl_in_any_direction_is_learned_to_its_bottom() {
    // Curvatures 1 to 1e6 along directions that are no axes: without its covariance this would take a million updates.
    let cost = |w: &[f64]| {
        let turned =
            |i: usize| w.iter().enumerate().map(|(j, w)| (w - 1.0) * ((i * 8 + j) as f64 * 1.7).sin()).sum::<f64>();
        (0..8).map(|i| 10f64.powf(6.0 * i as f64 / 7.0) * turned(i).powi(2)).sum::<f64>()
    };
    for seed in [1, 2, 3] {
        let blocks = [block(8, f64::NEG_INFINITY, f64::INFINITY, 0.5)];
        let learner = learned(&blocks, &[0.0; 8], 600, seed, cost);
        assert!(cost(learner.weights()) < 1e-12 * cost(&[0.0; 8]), "{}", cost(learner.weights()));
    }
}

#[test]
fn samples_stay_in_their_bounds_and_an_optimum_on_them_is_found() {
    let blocks = [block(2, -1.0, 1.0, 0.3), block(2, 10.0, 50.0, 5.0)];
    let cost = |w: &[f64]| (w[0] - 3.0).powi(2) + (w[1] - 0.2).powi(2) + (0.1 * w[2] - 0.5).powi(2) + 0.01 * w[3];
    let mut learner =
        CmaEs::new(&blocks, vec![0.0, 0.0, 20.0, 20.0], CmaEsOptions { rollouts: 12, updates: 0, seed: 1 });
    for _ in 0..150 {
        for sample in learner.ask() {
            assert!(sample[..2].iter().all(|w| (-1.0..=1.0).contains(w)));
            assert!(sample[2..].iter().all(|w| (10.0..=50.0).contains(w)));
        }
        let costs: Vec<f64> = learner.ask().iter().map(|w| cost(w)).collect();
        learner.tell(&costs).unwrap();
    }
    // w0 = 1, w1 = 0.2, w2 = w3 = 10, all but one of them on a bound.
    let best = cost(&[1.0, 0.2, 10.0, 10.0]);
    assert!(cost(learner.weights()) - best < 1e-3 * (cost(&[0.0, 0.0, 20.0, 20.0]) - best));
}

#[test]
fn another_unit_of_a_parameter_changes_nothing() {
    let cost = |w: &[f64]| (w[0] - 1.0).powi(2) + 5.0 * (w[1] - w[0]).powi(2);
    let free = (f64::NEG_INFINITY, f64::INFINITY);
    let one = learned(&[block(2, free.0, free.1, 0.5)], &[0.0; 2], 30, 7, cost);
    // A power of two: no rounding.
    let other =
        learned(&[block(2, free.0, free.1, 512.0)], &[0.0; 2], 30, 7, |w| cost(&[w[0] / 1024.0, w[1] / 1024.0]));
    assert_eq!(one.weights().iter().map(|w| w * 1024.0).collect::<Vec<_>>(), other.weights());
}

#[test]
fn costs_that_are_no_number_rank_last_and_none_at_all_changes_nothing() {
    let blocks = [block(2, f64::NEG_INFINITY, f64::INFINITY, 0.5)];
    let cost = |w: &[f64]| if w[0] > 0.7 { f64::NAN } else { (w[0] - 0.5).powi(2) + w[1] * w[1] };
    let learner = learned(&blocks, &[0.0, 1.0], 80, 1, cost);
    assert!((learner.weights()[0] - 0.5).abs() < 1e-3 && learner.weights()[1].abs() < 1e-3);
    let mut learner = CmaEs::new(&blocks, vec![0.0, 1.0], CmaEsOptions { rollouts: 4, updates: 1, seed: 1 });
    let before = learner.ask().to_vec();
    let refused = learner.tell(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::NAN]);
    assert_eq!(refused, Err(Pi2Error::AllRejected { update: 0, rollouts: 4 }));
    assert_eq!(learner.ask(), before);
}

#[test]
fn parameters_without_noise_stay_where_they_are() {
    let blocks = [block(1, 0.0, 9.0, 0.0), block(2, 0.0, 9.0, 0.5), block(1, 4.0, 4.0, 1.0)];
    let learner = learned(&blocks, &[3.0, 1.0, 1.0, 4.0], 60, 1, |w| w.iter().map(|w| (w - 2.0).powi(2)).sum());
    assert_eq!((learner.weights()[0], learner.weights()[3]), (3.0, 4.0));
    assert!((learner.weights()[1] - 2.0).abs() < 1e-3);
    let none = learned(&blocks[..1], &[3.0], 5, 1, |w| w[0]);
    assert_eq!(none.weights(), [3.0]);
}
