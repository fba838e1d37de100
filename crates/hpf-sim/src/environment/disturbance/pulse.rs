//! A force that jumps at `start` and back after `length`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Side, has_jumped};
use crate::environment::Quantity;

/// A force that jumps and jumps back.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Pulse {
    /// Axis it acts on.
    pub axis: String,
    /// Force of the pulse [N].
    pub amplitude: Quantity,
    /// When it begins [s]; not drawn from a normal distribution.
    #[schemars(extend("minimum" = 0))]
    pub start: Quantity,
    /// How long it lasts [s]; not drawn from a normal distribution.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: Quantity,
}

impl Pulse {
    pub(super) fn force(&self, time: f64, side: Side) -> f64 {
        let on = has_jumped(self.start.mean(), time, side)
            && !has_jumped(self.start.mean() + self.length.mean(), time, side);
        if on { self.amplitude.mean() } else { 0.0 }
    }
}
