//! A force that swings: `f(t) = amplitude sin(2 pi t/period + phase)`, for ever or for a length of time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Side, has_jumped};
use crate::environment::Quantity;

/// A force that swings.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Sine {
    /// Axis it acts on.
    pub axis: String,
    /// Largest force [N].
    pub amplitude: Quantity,
    /// Time of one swing [s]; not drawn from a normal distribution.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub period: Quantity,
    /// Phase at the start [rad].
    #[serde(default = "super::zero")]
    pub phase: Quantity,
    /// How long it swings [s], not drawn from a normal distribution; left out, for ever.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: Option<Quantity>,
}

impl Sine {
    pub(super) fn force(&self, time: f64, side: Side) -> f64 {
        if self.length.as_ref().is_some_and(|length| has_jumped(length.mean(), time, side)) {
            return 0.0;
        }
        self.amplitude.mean() * libm::sin(2.0 * core::f64::consts::PI * time / self.period.mean() + self.phase.mean())
    }
}
