//! `basis = 20` or `basis = { family = "time", count = 20 }`: the basis functions of a primitive.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Basis functions where a task says nothing.
const DEFAULT_COUNT: usize = 20;

/// Basis functions: their number, or their family with it.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(untagged)]
pub enum BasisFunctions {
    /// So many of the family in phase.
    Count(#[schemars(range(min = 2, max = 1000))] usize),
    /// Of a family.
    Of(BasisTable),
}

/// Basis functions of a family: both families have centers equally spaced in time.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct BasisTable {
    /// What the functions are Gaussians of.
    pub family: BasisFamily,
    /// Number of functions.
    #[schemars(range(min = 2, max = 1000))]
    pub count: usize,
}

/// What basis functions are Gaussians of.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum BasisFamily {
    /// The phase, as in the paper.
    #[default]
    Phase,
    /// Time: one exponential a step, whatever their number.
    Time,
}

impl Default for BasisTable {
    fn default() -> Self {
        Self { family: BasisFamily::Phase, count: DEFAULT_COUNT }
    }
}

impl Default for BasisFunctions {
    fn default() -> Self {
        Self::Count(DEFAULT_COUNT)
    }
}

impl BasisFunctions {
    /// Number of functions.
    pub fn count(self) -> usize {
        match self {
            Self::Count(count) | Self::Of(BasisTable { count, .. }) => count,
        }
    }

    /// Their family.
    pub fn family(self) -> BasisFamily {
        match self {
            Self::Count(_) => BasisFamily::Phase,
            Self::Of(table) => table.family,
        }
    }
}
