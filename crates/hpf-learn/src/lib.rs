//! Learning the weights of primitives from a cost, and fitting them to profiles.
//!
//! [`Problem`] is what can be learned: it knows its parameters as [`Block`]s and the cost of a rollout. [`Pi2`] is
//! the learner as ask and tell on plain vectors; [`learn`] drives it with rollouts in parallel. [`fit`] holds the
//! regressions that start a profile from data. No task, no file, no clock.

#![forbid(unsafe_code)]

mod drive;
pub mod fit;
mod noise;
mod pi2;
mod problem;

pub use drive::{History, LearnError, Progress, Stop, learn};
pub use noise::{Anneal, Exploration};
pub use pi2::{Batch, Credit, Pi2, Pi2Error, Pi2Options, Temperature};
pub use problem::{Block, Cost, Parameters, Problem, SignalGroup, SignalModel};
