//! A force that jumps at `start` and stays.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Side, has_jumped};
use crate::environment::Quantity;

/// A force that jumps and stays.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Step {
    /// Axis it acts on.
    pub axis: String,
    /// Force after the jump [N].
    pub amplitude: Quantity,
    /// When it jumps [s]; not drawn from a normal distribution.
    #[schemars(extend("minimum" = 0))]
    pub start: Quantity,
}

impl Step {
    pub(super) fn force(&self, time: f64, side: Side) -> f64 {
        if has_jumped(self.start.mean(), time, side) { self.amplitude.mean() } else { 0.0 }
    }
}
