//! Normalised Gaussians over the phase, from the numbers of a policy.

/// `sum_i w_i psi_i / sum_i psi_i`. The centers lie close: some psi is never small.
pub fn mixture(s: f64, centers: &[f64], widths: &[f64], weights: &[f64]) -> f64 {
    let (mut above, mut below) = (0.0, 0.0);
    for ((c, h), w) in centers.iter().zip(widths).zip(weights) {
        let psi = (-h * (s - c).powi(2)).exp();
        above += w * psi;
        below += psi;
    }
    above / below
}
