//! A force that jumps at `start` and stays.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Side, has_jumped};

/// A force that jumps and stays.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Step {
    /// Axis it acts on.
    pub axis: String,
    /// Force after the jump [N].
    pub amplitude: f64,
    /// When it jumps [s].
    #[schemars(range(min = 0))]
    pub start: f64,
}

impl Step {
    pub(super) fn force(&self, time: f64, side: Side) -> f64 {
        if has_jumped(self.start, time, side) { self.amplitude } else { 0.0 }
    }
}
