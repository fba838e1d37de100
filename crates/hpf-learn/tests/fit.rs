//! Fits against closed forms, against what a fitted path rolls out to, and against the stored numbers of another
//! implementation (`data/README.md` says whose).

use hpf_core::{Basis, Movement, Phase, Transition};
use hpf_learn::fit::{FitError, bounded_ridge, locally_weighted, movement_forcing, ridge};
use serde_json::Value;

const N: usize = 20;
const ALPHA: f64 = 25.0;

fn decay() -> f64 {
    100.0_f64.ln()
}

fn basis(overlap: f64) -> Basis<f64, Vec<f64>> {
    Basis::equally_spaced(decay(), overlap, vec![0.0; N], vec![0.0; N]).unwrap()
}

#[track_caller]
fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= tolerance, "{a} is not {b} within {tolerance:e}");
    }
}

#[test]
fn ridge_on_one_feature_is_the_quotient_of_two_sums() {
    let (x, y) = ([1.0, -2.0, 3.0], [2.0, 1.0, 5.0]);
    // x.y = 15, x.x = 14; a few operations, each right to the last bit.
    for (penalty, expected) in [(0.0, 15.0 / 14.0), (1.0, 1.0), (16.0, 0.5)] {
        assert_close(&ridge(&x, 1, &y, penalty).unwrap(), &[expected], 1e-15);
    }
}

#[test]
fn ridge_on_orthonormal_features_shrinks_each_weight_by_one_plus_penalty() {
    let h = 0.5_f64.sqrt();
    let features = [h, h, h, -h];
    for penalty in [0.0, 0.25, 3.0] {
        let found = ridge(&features, 2, &[3.0, 1.0], penalty).unwrap();
        assert_close(&found, &[4.0 * h / (1.0 + penalty), 2.0 * h / (1.0 + penalty)], 1e-14);
    }
}

#[test]
fn ridge_leaves_a_residual_that_no_feature_can_explain() {
    // The normal equations: X^T (y - X w) = penalty w. Sums of 60 products near 1.
    let basis = basis(0.6);
    let mut features = vec![0.0; 60 * N];
    for (i, row) in features.chunks_exact_mut(N).enumerate() {
        basis.features_into((-decay() * i as f64 / 59.0).exp(), row);
    }
    let values: Vec<f64> = (0..60).map(|i| (0.3 * f64::from(i)).sin()).collect();
    let penalty = 1e-3;
    let weights = ridge(&features, N, &values, penalty).unwrap();
    for j in 0..N {
        let correlation: f64 = features
            .chunks_exact(N)
            .zip(&values)
            .map(|(row, y)| row[j] * (y - row.iter().zip(&weights).map(|(x, w)| x * w).sum::<f64>()))
            .sum();
        assert!((correlation - penalty * weights[j]).abs() < 1e-13, "{correlation:e} {:e}", penalty * weights[j]);
    }
}

#[test]
fn ridge_finds_the_weights_that_made_the_data() {
    let basis = basis(0.6);
    let truth: Vec<f64> = (0..N).map(|i| 50.0 * (1.7 * i as f64).cos()).collect();
    let mut features = vec![0.0; 200 * N];
    let mut values = Vec::new();
    for (i, row) in features.chunks_exact_mut(N).enumerate() {
        let s = (-decay() * i as f64 / 199.0).exp();
        basis.features_into(s, row);
        values.extend(basis.mix(s, [&truth]));
    }
    // Rounding times the condition of the normal equations, about 1e3.
    assert_close(&ridge(&features, N, &values, 0.0).unwrap(), &truth, 1e-10);
}

#[test]
fn ridge_within_bounds_out_of_reach_is_ridge() {
    let basis = basis(0.6);
    let mut features = vec![0.0; 60 * N];
    for (i, row) in features.chunks_exact_mut(N).enumerate() {
        basis.features_into((-decay() * i as f64 / 59.0).exp(), row);
    }
    let values: Vec<f64> = (0..60).map(|i| 100.0 + 50.0 * (0.3 * f64::from(i)).sin()).collect();
    let free = ridge(&features, N, &values, 1e-6).unwrap();
    let bounded = bounded_ridge(&features, N, &values, 1e-6, 0.0, [-1e6, 1e6]).unwrap();
    // Rounding of weights to 1e2 times the condition of the normal equations, about 1e3.
    assert_close(&bounded, &free, 1e-9);
}

#[test]
fn ridge_within_bounds_holds_a_weight_there_and_lets_the_others_make_up_for_it() {
    // Two features that overlap: the first weight wants 4 and may have 3; the second then takes what is left.
    let features = [1.0, 0.0, 1.0, 1.0];
    let found = bounded_ridge(&features, 2, &[4.0, 6.0], 0.0, 0.0, [0.0, 3.0]).unwrap();
    assert_close(&found, &[3.0, 3.0], 1e-14);
    let found = bounded_ridge(&features, 2, &[4.0, 5.0], 0.0, 0.0, [0.0, 3.0]).unwrap();
    assert_close(&found, &[3.0, 2.0], 1e-14);
}

#[test]
fn a_weight_that_no_sample_reaches_becomes_the_prior_within_bounds() {
    let features = [1.0, 0.0, 1.0, 0.0];
    for (prior, expected) in [(70.0, 70.0), (900.0, 400.0)] {
        let found = bounded_ridge(&features, 2, &[100.0, 100.0], 1e-9, prior, [30.0, 400.0]).unwrap();
        assert_close(&found, &[100.0, expected], 1e-6);
    }
    assert_eq!(bounded_ridge(&features, 2, &[1.0, 1.0], 0.0, 0.0, [0.0, 1.0]), Err(FitError::Singular));
    let wrong = FitError::Length { name: "features", found: 3, expected: 4 };
    assert_eq!(bounded_ridge(&[1.0; 3], 2, &[1.0; 2], 0.0, 0.0, [0.0, 1.0]), Err(wrong));
}

#[test]
fn local_weights_are_local_averages() {
    let activations = [1.0, 0.5, 0.25, 1.0];
    let found = locally_weighted(&activations, 2, &[1.0, 1.0], &[10.0, 20.0], 0.0).unwrap();
    // sum psi y / sum psi: (10 + 5)/1.25 and (5 + 20)/1.5.
    assert_close(&found, &[12.0, 25.0 / 1.5], 1e-14);
}

#[test]
fn local_weights_of_a_proportional_profile_are_its_slope() {
    let basis = basis(0.6);
    let mut activations = vec![0.0; 100 * N];
    let inputs: Vec<f64> = (0..100).map(|i| (-decay() * f64::from(i) / 99.0).exp()).collect();
    for (row, &s) in activations.chunks_exact_mut(N).zip(&inputs) {
        basis.activations_into(s, row);
    }
    let values: Vec<f64> = inputs.iter().map(|s| -7.0 * s).collect();
    // The same terms in both sums but for the factor: rounding alone.
    assert_close(&locally_weighted(&activations, N, &inputs, &values, 0.0).unwrap(), &[-7.0; N], 1e-13);
}

#[test]
fn local_weights_shrink_with_the_penalty_and_a_silent_function_gets_zero() {
    let activations = [1.0, 0.0, 1.0, 0.0];
    // xi = 2: sums 2 * 2 * y and 2 * 4 + 8.
    let found = locally_weighted(&activations, 2, &[2.0, 2.0], &[3.0, 5.0], 8.0).unwrap();
    assert_close(&found, &[16.0 / 16.0, 0.0], 1e-15);
}

#[test]
fn tables_of_the_wrong_length_are_refused_by_name() {
    let wrong = |name, found, expected| Err(FitError::Length { name, found, expected });
    assert_eq!(ridge(&[1.0; 5], 2, &[1.0; 3], 0.0), wrong("features", 5, 6));
    assert_eq!(locally_weighted(&[1.0; 7], 2, &[1.0; 3], &[1.0; 3], 0.0), wrong("activations", 7, 6));
    assert_eq!(locally_weighted(&[1.0; 6], 2, &[1.0; 2], &[1.0; 3], 0.0), wrong("inputs", 2, 3));
    assert_eq!(
        ridge(&[1.0; 5], 2, &[1.0; 3], 0.0).unwrap_err().to_string(),
        "features has 5 numbers, 6 are needed",
        "the message names the table and both lengths"
    );
}

#[test]
fn data_that_do_not_determine_the_weights_are_refused_without_a_penalty() {
    let too_few: Vec<f64> = (0..3 * 8).map(|i| (0.7 * f64::from(i * i)).sin()).collect();
    assert_eq!(ridge(&too_few, 8, &[1.0, 2.0, 3.0], 0.0), Err(FitError::Singular), "3 samples of 8 features");
    let twice = [0.1, 0.1, 0.7, 0.7, 0.3, 0.3];
    assert_eq!(ridge(&twice, 2, &[1.0, 2.0, 3.0], 0.0), Err(FitError::Singular), "one feature twice");
    let third: Vec<f64> = (0..10).flat_map(|i| [0.1 * f64::from(i), 1.0 / 3.0, 0.3 * f64::from(i) + 1.0]).collect();
    assert_eq!(ridge(&third, 3, &[1.0; 10], 0.0), Err(FitError::Singular), "a feature that is a sum of two others");
    assert_eq!(ridge(&[0.0; 4], 2, &[1.0, 2.0], 0.0), Err(FitError::Singular), "features of zero");
    assert_eq!(locally_weighted(&[1.0, 0.0], 2, &[1.0], &[1.0], 0.0), Err(FitError::Singular), "a silent function");
    for penalty in [1e-6, 1.0] {
        assert!(ridge(&too_few, 8, &[1.0, 2.0, 3.0], penalty).is_ok());
        assert!(ridge(&twice, 2, &[1.0, 2.0, 3.0], penalty).is_ok());
    }
}

#[test]
fn data_that_are_not_finite_are_refused() {
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(ridge(&[1.0, bad], 1, &[1.0, 1.0], 1.0).is_err());
        assert!(ridge(&[1.0, 1.0], 1, &[1.0, bad], 1.0).is_err());
        assert!(locally_weighted(&[1.0, bad], 1, &[1.0; 2], &[1.0; 2], 1.0).is_err());
        assert!(locally_weighted(&[1.0; 2], 1, &[1.0; 2], &[1.0, bad], 1.0).is_err());
    }
}

#[test]
fn the_forcing_of_a_parabola_is_its_equation_of_motion() {
    // Central differences of a parabola are exact, but for the mean of two positions: c h^2/4 of it, times p^2.
    let (c, h, goal) = (0.8, 0.01, 0.5);
    let positions: Vec<f64> = (0..=40).map(|i| c * (h * f64::from(i)).powi(2)).collect();
    let forcing = movement_forcing(&positions, goal, ALPHA, h);
    assert_eq!(forcing.len(), 40);
    for (i, found) in forcing.iter().enumerate().take(39).skip(1) {
        let t = h * (i as f64 + 0.5);
        let exact = 2.0 * c - ALPHA * (0.25 * ALPHA * (goal - c * t * t) - 2.0 * c * t);
        let mean = 0.25 * ALPHA * ALPHA * c * h * h / 4.0;
        // 1e-16 over h^2, and a margin.
        assert!((found - exact - mean).abs() < 1e-10, "{found} {exact} at step {i}");
    }
    // At rest at the start: exact there too. The end of a parabola moves, and is taken to turn back.
    let exact = 2.0 * c - ALPHA * (0.25 * ALPHA * (goal - c * h * h / 4.0) - c * h);
    let mean = 0.25 * ALPHA * ALPHA * c * h * h / 4.0;
    assert!((forcing[0] - exact - mean).abs() < 1e-10, "{} {exact}", forcing[0]);
    assert!(movement_forcing(&[], 1.0, ALPHA, 0.1).is_empty() && movement_forcing(&[0.3], 1.0, ALPHA, 0.1).is_empty());
}

fn minimum_jerk(t: f64) -> f64 {
    t * t * t * (10.0 - t * (15.0 - 6.0 * t))
}

/// The largest distance between a minimum-jerk path from `start` to `goal` and the rollout of its fit.
fn rollout_error(steps: usize, count: usize, start: f64, goal: f64) -> f64 {
    let basis = Basis::equally_spaced(decay(), 0.6, vec![0.0; count], vec![0.0; count]).unwrap();
    let dt = 1.0 / steps as f64;
    let path: Vec<f64> = (0..=steps).map(|i| start + (goal - start) * minimum_jerk(i as f64 * dt)).collect();
    let forcing = movement_forcing(&path, goal, ALPHA, dt);
    let phase = Phase::new(1.0, decay()).unwrap();
    let scale = goal - start;
    let middle: Vec<f64> = (0..steps).map(|i| phase.at((i as f64 + 0.5) * dt).s).collect();
    let mut features = vec![0.0; steps * count];
    for (row, &s) in features.chunks_exact_mut(count).zip(&middle) {
        basis.features_into(s, row);
        row.iter_mut().for_each(|phi| *phi *= s * scale);
    }
    let weights = ridge(&features, count, &forcing, 1e-9 * scale * scale).unwrap();
    let movement = Movement::new(start, goal, ALPHA, scale, weights).unwrap();
    let transition = Transition::new(ALPHA, dt);
    let mut state = movement.initial_state();
    let mut worst = 0.0_f64;
    for (s, target) in middle.iter().zip(&path[1..]) {
        let [mixed] = basis.mix(*s, [movement.weights()]);
        transition.apply(&mut state, goal, movement.forcing(*s, mixed));
        worst = worst.max((state.position - target).abs());
    }
    worst / scale.abs()
}

#[test]
fn a_fitted_minimum_jerk_path_rolls_out_to_itself() {
    // The paper's task (500 steps) and the smallest one (100): what 20 functions cannot bend, and the forcing's
    // derivatives at the ends. Measured 4.9e-5 and 8.2e-5 of the travel.
    assert!(rollout_error(500, N, 0.0, 1.0) < 6e-5, "{:e}", rollout_error(500, N, 0.0, 1.0));
    assert!(rollout_error(100, N, 0.0, 1.0) < 1e-4, "{:e}", rollout_error(100, N, 0.0, 1.0));
    // Twice the functions: measured 4.0e-6.
    assert!(rollout_error(500, 2 * N, 0.0, 1.0) < 5e-6, "{:e}", rollout_error(500, 2 * N, 0.0, 1.0));
}

#[test]
fn the_fit_of_a_path_does_not_change_with_its_unit_or_direction() {
    let one = rollout_error(200, N, 0.0, 1.0);
    for (start, goal) in [(0.0, 1e-3), (0.2, -0.8), (5.0, 1005.0)] {
        // Rounding alone, but for the offset of 5: some 1e-12 of it.
        assert!((rollout_error(200, N, start, goal) / one - 1.0).abs() < 1e-6, "{start} {goal}");
    }
}

fn constants() -> Value {
    serde_json::from_str(include_str!("../../hpf-core/tests/data/reference.json")).unwrap()
}

/// Column `column` of a table.
fn column(text: &str, column: usize) -> Vec<f64> {
    text.lines().skip(1).map(|line| line.split(',').nth(column).unwrap().parse().unwrap()).collect()
}

/// Central differences inside, one-sided ones at both ends, the last then set to zero.
fn differences(times: &[f64], values: &[f64]) -> Vec<f64> {
    let last = values.len() - 1;
    let slope = |i: usize, j: usize| (values[j] - values[i]) / (times[j] - times[i]);
    (0..=last).map(|i| if i == last { 0.0 } else { slope(i.saturating_sub(1), i + 1) }).collect()
}

#[test]
fn forcing_and_weights_of_a_demonstration_agree_with_the_stored_ones() {
    let constants = constants();
    let basis = basis(constants["overlap"].as_f64().unwrap());
    let demonstration = include_str!("data/demo_2d.csv");
    let times = column(demonstration, 0);
    let mut features = vec![0.0; times.len() * N];
    for (row, time) in features.chunks_exact_mut(N).zip(&times) {
        let s = (-decay() * time).exp();
        basis.features_into(s, row);
        row.iter_mut().for_each(|phi| *phi *= s);
    }
    for axis in 0..2 {
        let positions = column(demonstration, axis + 1);
        let goal = positions[positions.len() - 1];
        let velocity = differences(&times, &positions);
        let acceleration = differences(&times, &velocity);
        let forcing: Vec<f64> = (0..times.len())
            .map(|i| acceleration[i] - ALPHA * (0.25 * ALPHA * (goal - positions[i]) - velocity[i]))
            .collect();
        // Forces up to 160 N, second differences over 2^-16: the same operations in another order.
        assert_close(&forcing, &column(include_str!("data/target_forces_plain.csv"), axis + 1), 1e-10);

        let weights = ridge(&features, N, &forcing, 1e-6).unwrap();
        let stored: Vec<f64> =
            constants["weights"][axis].as_array().unwrap().iter().map(|w| w.as_f64().unwrap()).collect();
        // Weights up to 2e3, equations of condition 2.6e6: two solvers agree to about 1e-9 (measured 1.2e-9).
        assert_close(&weights, &stored, 1e-6);
    }
}
