//! Fits of a profile: the weights of a basis that come nearest to data.
//!
//! For samples `y_t = sum_i w_i x_{t,i}` with features `x_{t,i}` (movement: s A phi_i; gains: phi_i):
//! - [`ridge`]: all weights at once, `w = (X^T X + lambda I)^-1 X^T y`;
//! - [`bounded_ridge`]: the same within a box, for the weights of stiffness and damping;
//! - [`locally_weighted`]: each weight by its own neighbourhood, `w_i = sum_t psi_i xi y / (sum_t psi_i xi^2 + lambda)`
//!   (the paper's regression; Ijspeert et al. 2013, doi 10.1162/NECO_a_00393).

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::box_step::box_step;

/// Why a fit was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// A table does not have one row per sample.
    #[error("{name} has {found} numbers, {expected} are needed")]
    Length {
        /// Which one.
        name: &'static str,
        /// Numbers found.
        found: usize,
        /// Numbers needed.
        expected: usize,
    },
    /// The equations have no unique finite solution: too few samples for a penalty of zero, or numbers that are not
    /// finite.
    #[error("the data do not determine the weights; give more samples or a positive penalty")]
    Singular,
    /// The weights leave the domain of a controller.
    #[error(
        "the path takes a weight of {weight:.3e}, and a movement has at most {most:.3e}; lower alpha, or raise overlap"
    )]
    Domain {
        /// The largest one.
        weight: f64,
        /// What it may be.
        most: f64,
    },
}

/// A pivot this many roundings per feature above zero, relative to its diagonal entry, counts as zero.
const PIVOT_ROUNDING: f64 = 10.0;

fn expect(name: &'static str, found: usize, expected: usize) -> Result<(), FitError> {
    if found == expected { Ok(()) } else { Err(FitError::Length { name, found, expected }) }
}

/// The factor of normal equations that determine the weights.
fn determined(normal: DMatrix<f64>) -> Result<Cholesky<f64, Dyn>, FitError> {
    let diagonal = normal.diagonal();
    let factor = normal.cholesky().ok_or(FitError::Singular)?;
    // A dependent feature leaves a pivot of zero, or of what rounding made of it.
    let rounding = PIVOT_ROUNDING * diagonal.len() as f64 * f64::EPSILON;
    if factor.l_dirty().diagonal().iter().zip(&diagonal).any(|(root, whole)| root * root <= rounding * whole) {
        return Err(FitError::Singular);
    }
    Ok(factor)
}

/// Ridge regression: the weights that minimise `|X w - y|^2 + penalty |w|^2`.
///
/// `features` is samples x `count`, one row per sample; `values` one number per sample; `penalty` at least 0.
///
/// ```
/// let features = [1.0, 0.0, 0.0, 1.0, 1.0, 1.0]; // three samples of two features
/// let weights = hpf_learn::fit::ridge(&features, 2, &[2.0, 3.0, 5.0], 0.0)?;
/// assert!((weights[0] - 2.0).abs() < 1e-12 && (weights[1] - 3.0).abs() < 1e-12);
/// # Ok::<(), hpf_learn::fit::FitError>(())
/// ```
///
/// # Errors
/// [`FitError`] for tables that do not match and data that do not determine the weights.
pub fn ridge(features: &[f64], count: usize, values: &[f64], penalty: f64) -> Result<Vec<f64>, FitError> {
    expect("features", features.len(), values.len() * count)?;
    let x = DMatrix::from_row_slice(values.len(), count, features);
    let y = DVector::from_column_slice(values);
    let normal = x.tr_mul(&x) + DMatrix::identity(count, count) * penalty;
    let factor = determined(normal)?;
    let solution = factor.solve(&x.tr_mul(&y));
    if solution.iter().all(|w| w.is_finite()) { Ok(solution.as_slice().to_vec()) } else { Err(FitError::Singular) }
}

/// Ridge regression within a box: the weights in `[min, max]` that minimise `|X w - y|^2 + penalty |w - prior|^2`.
///
/// `features` and `values` as for [`ridge`]; `prior`, brought within the box, is what weights without data become.
///
/// ```
/// let features = [1.0, 0.0, 0.0, 1.0];
/// let weights = hpf_learn::fit::bounded_ridge(&features, 2, &[2.0, 9.0], 0.0, 3.0, [1.0, 5.0])?;
/// assert!((weights[0] - 2.0).abs() < 1e-12 && weights[1] == 5.0);
/// # Ok::<(), hpf_learn::fit::FitError>(())
/// ```
///
/// # Errors
/// [`FitError`] for tables that do not match and data that do not determine the weights.
pub fn bounded_ridge(
    features: &[f64],
    count: usize,
    values: &[f64],
    penalty: f64,
    prior: f64,
    [min, max]: [f64; 2],
) -> Result<Vec<f64>, FitError> {
    expect("features", features.len(), values.len() * count)?;
    let prior = prior.max(min).min(max);
    let x = DMatrix::from_row_slice(values.len(), count, features);
    let residual = DVector::from_column_slice(values) - &x * DVector::from_element(count, prior);
    let normal = x.tr_mul(&x) + DMatrix::identity(count, count) * penalty;
    determined(normal.clone())?;
    let slope = -x.tr_mul(&residual);
    let from_prior = |bound: f64| vec![bound - prior; count];
    let step = box_step(&normal, &slope, &from_prior(min), &from_prior(max)).ok_or(FitError::Singular)?;
    // Adding the prior again may pass a bound by a rounding.
    let weights: Vec<f64> = step.iter().map(|step| (prior + step).max(min).min(max)).collect();
    if step.iter().all(|step| step.is_finite()) { Ok(weights) } else { Err(FitError::Singular) }
}

/// Locally weighted regression: each weight from the samples its function is active at.
///
/// `activations` is samples x `count` (psi), `inputs` the feature scale xi per sample (movement: s A; gains: 1),
/// `values` one number per sample.
///
/// ```
/// let activations = [1.0, 0.0, 1.0, 0.0, 0.0, 1.0]; // two functions, three samples
/// let weights = hpf_learn::fit::locally_weighted(&activations, 2, &[1.0; 3], &[2.0, 4.0, 7.0], 0.0)?;
/// assert_eq!(weights, [3.0, 7.0]);
/// # Ok::<(), hpf_learn::fit::FitError>(())
/// ```
///
/// # Errors
/// [`FitError`] for tables that do not match and a function that no sample activates.
pub fn locally_weighted(
    activations: &[f64],
    count: usize,
    inputs: &[f64],
    values: &[f64],
    penalty: f64,
) -> Result<Vec<f64>, FitError> {
    expect("activations", activations.len(), values.len() * count)?;
    expect("inputs", inputs.len(), values.len())?;
    (0..count)
        .map(|i| {
            let (mut above, mut below) = (0.0, penalty);
            for ((row, xi), value) in activations.chunks_exact(count).zip(inputs).zip(values) {
                above += row[i] * xi * value;
                below += row[i] * xi * xi;
            }
            let weight = above / below;
            if below > 0.0 && weight.is_finite() { Ok(weight) } else { Err(FitError::Singular) }
        })
        .collect()
}

/// The forcing, one value per step, that makes the discrete movement pass through `positions` (one more than steps)
/// from rest, in the least-squares sense of its equation of motion.
///
/// Each value is what `tau^2 x'' - alpha (beta (g - x) - tau x')` asks for, with the derivatives of a path sampled
/// at equal steps of `normalised_dt = dt/tau` taken by central differences at mid-step. The path starts and ends at rest:
/// beyond its ends it is taken to go back as it came.
pub fn movement_forcing(positions: &[f64], goal: f64, alpha: f64, normalised_dt: f64) -> Vec<f64> {
    let last = positions.len().saturating_sub(1) as isize;
    let at = |i: isize| positions[(last - (last - i.abs()).abs()) as usize];
    (0..last)
        .map(|i| {
            let middle = 0.5 * (at(i) + at(i + 1));
            let velocity = (at(i + 1) - at(i)) / normalised_dt;
            let acceleration = (at(i + 2) - at(i + 1) - at(i) + at(i - 1)) / (2.0 * normalised_dt * normalised_dt);
            acceleration - alpha * (0.25 * alpha * (goal - middle) - velocity)
        })
        .collect()
}
