//! What a record of a motion shows: position and force with noise, beside the loop that moves the tool.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::task::PerAxis;

/// Noise of what is recorded of a motion and learned from. The motion itself, its velocity, and the measures of a learned
/// policy are without it; noise that the controller feels is that of `[sensor]`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Recording {
    /// Standard deviation of each recorded position [axis unit].
    pub position_noise: PerAxis,
    /// Standard deviation of each recorded force, that of the contact too [N or N m].
    pub force_noise: PerAxis,
}
