//! A policy run by the real controller: [`Settings`] is its settings file, [`Simulation::controlled`] the run in the
//! environment of a task, [`Conduct`] what the controller did besides moving the tool.
//!
//! The controller is [`hpf_core::controller::Controller`], the one that a robot runs; everything outside it, what the tool
//! touches, the sensor and the actuator, is the simulator's own. Without limits hit, tank, faults and requests the run is
//! the simulation of the same task with `[sensor]`, up to rounding.
//!
//! [`Simulation::controlled`]: crate::Simulation::controlled

mod conduct;
mod settings;

pub use conduct::{Conduct, Refusal, Tally};
pub use settings::{Kind, Limits, Readings, Settings, Tank, TimedRequest, Timing, Trips};
