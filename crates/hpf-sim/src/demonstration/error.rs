//! Why demonstrations were refused.

use hpf_core::ConfigError;
use hpf_learn::fit::FitError;

use crate::task::MIN_GOAL_DISTANCE;

/// Why demonstrations were refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImitationError {
    /// A demonstration moves other axes.
    #[error("it moves the axes {found}, {expected} are wanted")]
    Axes {
        /// Which demonstration, counted from 0.
        demonstration: usize,
        /// Names and units in the demonstration.
        found: String,
        /// Names and units wanted.
        expected: String,
    },
    /// A signal that was asked for is missing.
    #[error("axis `{axis}` has no column {column}, which {purpose} needs")]
    Missing {
        /// Which demonstration, counted from 0.
        demonstration: usize,
        /// The axis.
        axis: String,
        /// The missing column.
        column: String,
        /// What it was wanted for.
        purpose: &'static str,
    },
    /// Goal scaling of a demonstration that ends where it starts.
    #[error(
        "axis `{axis}` ends within {MIN_GOAL_DISTANCE:e} of its start: goal scaling has nothing to scale by; \
         scale by unit or range"
    )]
    NoTravel {
        /// Which demonstration, counted from 0.
        demonstration: usize,
        /// The axis.
        axis: String,
    },
    /// The movement has fewer steps than weights.
    #[error("{steps} steps cannot determine {basis} basis functions; take fewer, or a higher rate")]
    TooFewSteps {
        /// Steps of the task.
        steps: usize,
        /// Basis functions of one primitive.
        basis: usize,
    },
    /// One demonstration has no spread.
    #[error("stiffness from spread needs at least two demonstrations, there is one")]
    OneDemonstration,
    /// The force of one demonstration says nothing without a reference.
    #[error("gains from force need a reference column, such as {axis}_reference_m, or at least two demonstrations")]
    NoReference {
        /// An axis without.
        axis: String,
    },
    /// The data say nothing about a gain.
    #[error("axis `{axis}`: {reason}")]
    Uninformative {
        /// The axis.
        axis: String,
        /// Why.
        reason: &'static str,
    },
    /// A profile could not be fitted.
    #[error("axis `{axis}`: {reason}")]
    Fit {
        /// The axis.
        axis: String,
        /// Why.
        reason: FitError,
    },
    /// The task's numbers are refused.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

impl ImitationError {
    /// The demonstration at fault, counted from 0, where it is one's.
    pub fn demonstration(&self) -> Option<usize> {
        match self {
            Self::Axes { demonstration, .. }
            | Self::Missing { demonstration, .. }
            | Self::NoTravel { demonstration, .. } => Some(*demonstration),
            _ => None,
        }
    }
}
