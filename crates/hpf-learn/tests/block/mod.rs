//! Blocks of parameters on the standard basis.

use hpf_core::Basis;
use hpf_learn::Block;

/// The phase at the middle of `step`.
pub fn phase(step: usize, steps: usize) -> f64 {
    (-100.0_f64.ln() * (step as f64 + 0.5) / steps as f64).exp()
}

/// A block of `count` parameters within `[min, max]` on the standard basis.
pub fn block(name: &str, count: usize, steps: usize, (min, max): (f64, f64), noise: f64) -> Block {
    let basis = Basis::equally_spaced(100.0_f64.ln(), 0.6, vec![0.0; count], vec![0.0; count]).unwrap();
    let mut features = vec![0.0; steps * count];
    let mut activations = features.clone();
    for (t, (phi, psi)) in features.chunks_exact_mut(count).zip(activations.chunks_exact_mut(count)).enumerate() {
        basis.features_into(phase(t, steps), phi);
        basis.activations_into(phase(t, steps), psi);
    }
    Block { name: name.into(), count, features, activations, min, max, noise }
}

/// No bounds.
pub const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
