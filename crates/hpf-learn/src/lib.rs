//! Learning the weights of primitives from a cost, and fitting them to profiles.
//!
//! [`Problem`] is what can be learned: it knows its parameters as [`Block`]s, the cost of a rollout and, where it has
//! them, the signals that the cost is the squares of. [`Pi2`] and [`CmaEs`] learn from costs, [`GaussNewton`] from
//! signals, all as ask and tell on plain vectors. A [`Session`] is a whole run of any [`Method`] as ask and tell, which
//! can be stopped and come back to; [`learn_with`] drives one with rollouts in parallel. [`fit`] holds the regressions
//! that start a profile from data. No task, no file, no clock.

#![forbid(unsafe_code)]

mod auto;
mod box_step;
mod cma_es;
mod covariance;
mod distance;
mod drive;
mod elites;
pub mod fit;
mod gauss_newton;
mod noise;
mod pi2;
mod problem;
mod record;
mod response;
mod rollouts;
mod session;
mod squares;
mod step;
mod weighting;

pub use auto::{AutoOptions, Note};
pub use cma_es::{CmaEs, CmaEsOptions};
pub use covariance::{ADAPTATION_RATE, Covariance};
pub use distance::Distance;
pub use drive::{Driver, History, LearnError, Method, Progress, Stop, learn, learn_with};
pub use elites::Elite;
pub use gauss_newton::{GaussNewton, GaussNewtonOptions, Settled};
pub use noise::{Anneal, Exploration};
pub use pi2::{Batch, Credit, Pi2, Pi2Error, Pi2Options};
pub use problem::{Block, Cost, Draws, Parameters, Problem, SignalGroup, SignalModel};
pub use record::{Price, Record};
pub use session::{Ask, Session, Told};
pub use weighting::Temperature;
