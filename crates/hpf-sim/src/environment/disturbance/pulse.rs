//! A force that jumps at `start` and back after `length`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Side, has_jumped};

/// A force that jumps and jumps back.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Pulse {
    /// Axis it acts on.
    pub axis: String,
    /// Force of the pulse [N].
    pub amplitude: f64,
    /// When it begins [s].
    #[schemars(range(min = 0))]
    pub start: f64,
    /// How long it lasts [s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: f64,
}

impl Pulse {
    pub(super) fn force(&self, time: f64, side: Side) -> f64 {
        let on = has_jumped(self.start, time, side) && !has_jumped(self.start + self.length, time, side);
        if on { self.amplitude } else { 0.0 }
    }
}
