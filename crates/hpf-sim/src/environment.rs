//! What acts on the tool: forces over time, things to touch, and what lies between them and the tool.
//!
//! Force is counted as the environment's on the tool. A contact answers affinely, `F_c = K_e (y - y_s)` on the inner
//! side of its surface and 0 beyond it, so that the step solves it together with the admittance law.

pub mod cantilever;
pub mod disturbance;
mod quantity;
mod recording;
mod sensor;
pub mod wall;

pub use cantilever::Cantilever;
pub use disturbance::Disturbance;
pub use quantity::{Distribution, Quantity};
pub use recording::Recording;
pub use sensor::{Actuator, Sensor};
pub use wall::Wall;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[contact]`: what the tool touches.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Contact {
    /// A clamped beam that the tool travels along and presses down.
    Cantilever(Cantilever),
    /// A spring behind a gap.
    Wall(Wall),
}

/// A contact at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// +1 where the contact lies at larger positions, -1 where it lies at smaller ones.
    pub direction: f64,
    /// Position of the undeformed surface [m].
    pub position: f64,
    /// Stiffness K_e towards the tool [N/m].
    pub stiffness: f64,
    /// How far the surface yields under the set-point force [m]: what a deviation is measured from.
    pub deflection: f64,
    /// Force that the tool is to press with [N].
    pub set_point: f64,
}

impl Surface {
    /// How deep a tool at `position` presses [m]; negative in the gap.
    #[inline]
    pub fn depth(&self, position: f64) -> f64 {
        self.direction * (position - self.position)
    }

    /// Force with which the tool at `position` presses [N].
    pub fn contact_force(&self, position: f64) -> f64 {
        self.stiffness * self.depth(position).max(0.0)
    }

    /// Deviation of a tool at `position` from the surface under the set-point force [m], along the direction.
    pub fn deviation(&self, position: f64) -> f64 {
        self.depth(position) - self.deflection
    }
}

impl Contact {
    /// Its kind, as in the task file.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Cantilever(_) => "cantilever",
            Self::Wall(_) => "wall",
        }
    }

    /// The axis it acts on.
    pub fn axis(&self) -> &str {
        match self {
            Self::Cantilever(beam) => &beam.axis,
            Self::Wall(wall) => &wall.axis,
        }
    }

    /// The contact at `progress` = t/T of the movement of an axis that starts at `start` [m].
    pub fn surface(&self, progress: f64, start: f64) -> Surface {
        match self {
            Self::Cantilever(beam) => beam.surface(progress, start),
            Self::Wall(wall) => wall.surface(),
        }
    }

    /// How far along the contact the tool is at `progress` = t/T [m].
    pub fn travel(&self, progress: f64) -> f64 {
        match self {
            Self::Cantilever(beam) => beam.travel_at(progress),
            Self::Wall(_) => 0.0,
        }
    }

    /// Where the tool of an axis that starts at `start` is at the beginning [m].
    pub fn initial_position(&self, start: f64) -> f64 {
        match self {
            Self::Cantilever(beam) => beam.initial_position(start),
            Self::Wall(_) => start,
        }
    }
}
