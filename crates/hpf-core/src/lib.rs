//! The mathematics of a compliant skill, for loops that must never fail.
//!
//! A skill is three primitives driven by one phase: a [`Movement`] primitive (where to go), a stiffness and a
//! damping primitive (two [`Gain`]s: how softly to hold it). The [`Law`] of an axis, an [`admittance`] of first or
//! second order, turns contact force into give. [`HybridPrimitive`] is the whole skill; the simulator rolls out the same kernels.
//!
//! No standard library, no allocation, no clock, no randomness. Constructors return [`ConfigError`]; stepping cannot
//! fail. Parameters never change in a step; state is plain `Copy` data. SI units: a linear axis is in m and N, a
//! rotary one in rad and N m.
//!
//! Source of the framework: Li et al., Sensors 2024, 24(12), 3964, doi 10.3390/s24123964 ("the paper").

#![no_std]
#![forbid(unsafe_code)]

pub mod admittance;
pub mod basis;
mod compensated;
pub mod conditioning;
pub mod controller;
pub mod domain;
mod error;
mod gain;
mod hybrid;
mod lanes;
pub mod limits;
pub mod movement;
pub mod packed;
pub mod passivity;
pub mod phase;
mod real;

pub use admittance::{Damping, Law};
pub use basis::Basis;
pub use error::ConfigError;
pub use gain::Gain;
pub use hybrid::{AxisCommand, AxisPrimitives, AxisState, HybridPrimitive, HybridState, Profile};
pub use lanes::Lanes;
pub use movement::{Movement, MovementState, Transition};
pub use phase::Phase;
pub use real::Real;
