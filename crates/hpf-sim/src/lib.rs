//! Tasks and their simulation: what is to be learned, where, and what it costs.
//!
//! [`Task`] is the task file, [`Policy`] the learned skill, [`Simulation`] rolls one out in the other and leaves a
//! [`Trace`]; costs and [`metrics`](Simulation::metrics) are functions of the trace. [`Simulation`] is a
//! [`hpf_learn::Problem`], so it can be learned. No files, no terminal.

#![forbid(unsafe_code)]

mod certificate;
pub mod cost;
pub mod demonstration;
pub mod environment;
mod metrics;
mod policy;
mod problem;
pub mod robot;
mod simulation;
mod start;
mod table_end;
pub mod task;
mod trace;

pub use certificate::{Certificate, Conditions, MAX_CERTIFIED_STEPS, MeasuredContact};
pub use demonstration::{Demonstration, Imitated, Imitation, ImitationError};
pub use metrics::Metric;
pub use policy::{
    AdmittancePolicy, AxisPolicy, Family, GainPolicy, MAX_POLICY_BYTES, MovementPolicy, Policy, PolicyBasis,
    PolicyError, Provenance,
};
pub use simulation::{Simulation, SimulationError, Workspace, disturbances};
pub use start::StartError;
pub use table_end::TableEnd;
pub use task::{Diagnostic, Task};
pub use trace::{AxisTrace, ContactTrace, Trace};
