//! What rollouts made outside of hpf are answered with, by a process or by a function.

use hpf_learn::{Block, SignalGroup, SignalModel};
use hpf_sim::task::{Accept, CostWeights, Task};

/// What the answers to rollouts contain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A total, or the cost of each step.
    Costs,
    /// Positions, velocities and forces, of which hpf makes costs and signals.
    Trace,
    /// So many numbers, half the sum of whose squares is the cost.
    Residuals(usize),
}

impl Kind {
    /// Why answers of this kind do not go with `task`.
    pub fn misfit(self, task: &Task) -> Option<&'static str> {
        let (has_targets, has_weights) = (task.accept != Accept::default(), task.cost != CostWeights::default());
        match self {
            Self::Costs if has_targets => Some("answers with costs, and the targets of [accept] need traces"),
            Self::Residuals(_) if has_targets => {
                Some("answers with residuals, and the targets of [accept] need traces")
            }
            Self::Trace if !has_weights => Some("answers with traces, and no term of [cost] has a weight"),
            _ => None,
        }
    }

    /// What the answers are, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Costs => "costs",
            Self::Trace => "traces",
            Self::Residuals(_) => "residuals",
        }
    }

    /// What is known of residuals: nothing but that each may answer to every parameter. `None` of other kinds.
    pub(crate) fn residual_model(self, blocks: &[Block]) -> Option<SignalModel> {
        let Self::Residuals(count) = self else { return None };
        let parameters = blocks.iter().map(|block| block.count).sum();
        let group = SignalGroup { parameters: 0..parameters, signals: 0..count };
        Some(SignalModel { groups: vec![group], price: vec![Vec::new(); blocks.len()], distances: Vec::new() })
    }
}

/// Half the sum of the squares of `residuals`.
pub(crate) fn half_square(residuals: &[f64]) -> f64 {
    0.5 * residuals.iter().map(|residual| residual * residual).sum::<f64>()
}
