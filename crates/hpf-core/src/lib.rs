#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

pub mod admittance;
pub mod basis;
mod compensated;
pub mod conditioning;
pub mod controller;
pub mod domain;
mod error;
pub mod frame;
mod gain;
mod hybrid;
mod lanes;
pub mod limits;
pub mod movement;
pub mod orientation;
pub mod packed;
pub mod passivity;
pub mod phase;
mod real;
mod reference;
pub mod rhythm;
pub mod rotation;
pub mod symmetric;
pub mod wrench;

pub use admittance::{Damping, Law};
pub use basis::Basis;
pub use error::ConfigError;
pub use gain::{Gain, MatrixGain};
pub use hybrid::{AxisCommand, AxisPrimitives, AxisState, HybridPrimitive, HybridState, Profile};
pub use lanes::Lanes;
pub use movement::{Movement, MovementState, Transition};
pub use phase::{Phase, PhasePoint};
pub use real::Real;
pub use reference::PlannedReference;
pub use symmetric::Symmetric;
