//! Learning the weights of primitives from a cost, and fitting them to profiles.
//!
//! [`Problem`] is what can be learned: it knows its parameters as [`Block`]s, the cost of a rollout and, where it has
//! them, the signals that the cost is the squares of. [`Pi2`] learns from costs, [`GaussNewton`] from signals, both as
//! ask and tell on plain vectors; [`learn_with`] drives any [`Method`] with rollouts in parallel. [`fit`] holds the
//! regressions that start a profile from data. No task, no file, no clock.

#![forbid(unsafe_code)]

mod auto;
mod box_step;
mod covariance;
mod drive;
pub mod fit;
mod gauss_newton;
mod noise;
mod pi2;
mod problem;
mod response;
mod rollouts;
mod weighting;

pub use auto::{AutoOptions, Note};
pub use covariance::{ADAPTATION_RATE, Covariance};
pub use drive::{History, LearnError, Method, Progress, Stop, learn, learn_with};
pub use gauss_newton::{GaussNewton, GaussNewtonOptions, Settled};
pub use noise::{Anneal, Exploration};
pub use pi2::{Batch, Credit, Pi2, Pi2Error, Pi2Options};
pub use problem::{Block, Cost, Draws, Parameters, Problem, SignalGroup, SignalModel};
pub use weighting::Temperature;
