#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod auto;
mod box_step;
mod cma_es;
mod covariance;
mod descent;
mod distance;
mod drive;
mod exhausted;
pub mod fit;
mod gauss_newton;
mod gram;
mod history;
pub mod instructions;
mod method;
mod model;
mod noise;
mod pi2;
mod problem;
mod record;
mod response;
mod rollouts;
mod session;
mod shape;
mod step;
mod step_costs;
mod weighting;

pub use auto::{AutoOptions, Note};
pub use cma_es::{CmaEs, CmaEsOptions};
pub use covariance::{ADAPTATION_RATE, Covariance};
pub use descent::{Begin, Computed, Descent, Effort};
pub use distance::Distance;
pub use drive::{LearningLoop, learn, learn_with};
pub use exhausted::Exhausted;
pub use gauss_newton::{GaussNewton, GaussNewtonOptions};
pub use gram::gram;
pub use history::{History, LearnError, Progress, TerminationReason};
pub use method::Method;
pub use model::{Model, ModelLearner, Proposal};
pub use noise::{Anneal, Exploration};
pub use pi2::{Batch, Credit, Pi2, Pi2Error, Pi2Options};
pub use problem::{Block, Cost, Draws, Parameters, Problem, SignalGroup, SignalModel, Wants};
pub use record::{Price, Record};
pub use session::{Ask, Session, TellOutcome};
pub use shape::ShapeError;
pub use weighting::Temperature;
