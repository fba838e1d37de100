//! The parameters of a policy as the learner sees them: what it learns, a controller takes.

use hpf_core::Basis;
use hpf_core::domain::{LARGEST, LARGEST_FORCING};
use hpf_learn::Block;

use crate::policy::Policy;
use crate::task::Task;

/// Three blocks per axis, and one of its goal where goals are learned; what is not learned has no noise.
pub(super) fn blocks(task: &Task, policy: &Policy, bases: &[Basis<f64, Vec<f64>>; 3], phases: &[f64]) -> Vec<Block> {
    let tables = bases.each_ref().map(|basis| {
        let mut features = vec![0.0; phases.len() * basis.count()];
        let mut activations = features.clone();
        let rows = features.chunks_exact_mut(basis.count()).zip(activations.chunks_exact_mut(basis.count()));
        for ((features, activations), &phase) in rows.zip(phases) {
            basis.features_into(phase, features);
            basis.activations_into(phase, activations);
        }
        (features, activations)
    });
    let noise = &task.learning.noise;
    let mut blocks = Vec::new();
    for (a, axis) in policy.axes.iter().enumerate() {
        // A hair less, for the forcing term is a product.
        let most = LARGEST.min(LARGEST_FORCING / axis.movement.forcing_scale.abs() * (1.0 - 1e-12));
        let primitives = [
            ("movement", (-most, most), &noise.movement),
            ("stiffness", (axis.stiffness.min, axis.stiffness.max), &noise.stiffness),
            ("damping", (axis.damping.min, axis.damping.max), &noise.damping),
        ];
        for ((name, (min, max), own), (basis, (features, activations))) in
            primitives.into_iter().zip(bases.iter().zip(&tables))
        {
            blocks.push(Block {
                name: format!("{}.{name}", axis.name),
                count: basis.count(),
                features: features.clone(),
                activations: activations.clone(),
                min,
                max,
                noise: if task.learns(a, name) { own.of(a) } else { 0.0 },
            });
        }
        if task.learns_goal() {
            blocks.push(Block {
                name: format!("{}.goal", axis.name),
                count: 1,
                features: vec![1.0; phases.len()],
                activations: vec![1.0; phases.len()],
                min: -LARGEST,
                max: LARGEST,
                noise: if task.learns(a, "goal") { noise.goal.of(a) } else { 0.0 },
            });
        }
    }
    blocks
}
