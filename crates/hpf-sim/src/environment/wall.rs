//! A wall: a linear spring behind a gap, `F_c = K max(0, depth)`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Surface;

/// A spring behind a gap.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Wall {
    /// Axis along which the tool meets it.
    pub axis: String,
    /// Where its surface is [m].
    pub position: f64,
    /// Its stiffness [N/m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
    /// On which side of its surface it lies.
    #[serde(default)]
    pub side: Side,
    /// Force the tool is to press with [N].
    #[serde(default)]
    #[schemars(range(min = 0))]
    pub force: f64,
}

/// On which side of its surface a wall lies.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// At larger positions: a tool moving up runs into it.
    #[default]
    Above,
    /// At smaller positions: a tool moving down runs into it.
    Below,
}

impl Wall {
    /// The wall, the same at every instant.
    pub fn surface(&self) -> Surface {
        Surface {
            direction: if self.side == Side::Above { 1.0 } else { -1.0 },
            position: self.position,
            stiffness: self.stiffness,
            deflection: self.force / self.stiffness,
            set_point: self.force,
        }
    }
}
