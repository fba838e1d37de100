//! A force that swings: `f(t) = amplitude sin(2 pi t/period + phase)`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A force that swings.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Sine {
    /// Axis it acts on.
    pub axis: String,
    /// Largest force [N].
    pub amplitude: f64,
    /// Time of one swing [s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub period: f64,
    /// Phase at the start [rad].
    #[serde(default)]
    pub phase: f64,
}

impl Sine {
    pub(super) fn force(&self, time: f64) -> f64 {
        self.amplitude * libm::sin(2.0 * core::f64::consts::PI * time / self.period + self.phase)
    }
}
