//! What lies between the forces and the tool on a real robot: a force sensor, and an actuator.
//!
//! With either of them the admittance is stepped as a controller steps it: the force it sees is read once a step and
//! held over it, contact forces too. Reading at t:
//! `f_m = q round((f(t - delay) + bias + noise)/q)`, q the quantisation; a reading that is lost repeats the one before.
//! Lag: `lag y' = y_c - y`, y_c the commanded position, exact for a command that runs linearly over the step.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Quantity;

/// How the force of the environment is measured, once a step, and held over it.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Sensor {
    /// Standard deviation of each reading [N].
    #[schemars(range(min = 0))]
    pub noise: f64,
    /// Added to all readings of a motion [N].
    pub bias: Quantity,
    /// Age of a reading [s], at most 1000 steps.
    #[schemars(range(min = 0))]
    pub delay: f64,
    /// Share of the readings that are lost; the one before is then read again.
    #[schemars(range(min = 0), extend("exclusiveMaximum" = 1))]
    pub dropout: f64,
    /// Readings are multiples of this [N]; 0 for any.
    #[schemars(range(min = 0))]
    pub quantisation: f64,
}

impl Default for Sensor {
    fn default() -> Self {
        Self { noise: 0.0, bias: Quantity::Fixed(0.0), delay: 0.0, dropout: 0.0, quantisation: 0.0 }
    }
}

impl Sensor {
    /// Whether two motions may read differently.
    pub fn is_random(&self) -> bool {
        self.noise > 0.0 || self.dropout > 0.0 || !self.bias.is_fixed()
    }
}

/// How the tool follows its command; the force is then read once a step, as with a sensor that does not err.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Actuator {
    /// Time constant of a first-order lag [s].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub lag: f64,
}
