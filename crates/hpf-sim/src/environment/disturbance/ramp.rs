//! A force that grows from 0 at `start` to `amplitude` after `length`, and stays.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::environment::Quantity;

/// A force that grows and stays.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Ramp {
    /// Axis it acts on.
    pub axis: String,
    /// Force at the end of the ramp and after it [N].
    pub amplitude: Quantity,
    /// When it begins [s]; not drawn from a normal distribution.
    #[schemars(extend("minimum" = 0))]
    pub start: Quantity,
    /// How long it grows [s]; not drawn from a normal distribution.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: Quantity,
}

impl Ramp {
    pub(super) fn force(&self, time: f64) -> f64 {
        self.amplitude.mean() * ((time - self.start.mean()) / self.length.mean()).clamp(0.0, 1.0)
    }
}
