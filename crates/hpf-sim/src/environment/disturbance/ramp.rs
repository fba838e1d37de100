//! A force that grows from 0 at `start` to `amplitude` after `length`, and stays.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A force that grows and stays.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Ramp {
    /// Axis it acts on.
    pub axis: String,
    /// Force at the end of the ramp and after it [N].
    pub amplitude: f64,
    /// When it begins [s].
    #[schemars(range(min = 0))]
    pub start: f64,
    /// How long it grows [s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: f64,
}

impl Ramp {
    pub(super) fn force(&self, time: f64) -> f64 {
        self.amplitude * ((time - self.start) / self.length).clamp(0.0, 1.0)
    }
}
