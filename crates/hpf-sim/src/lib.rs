#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod certificate;
pub mod cost;
pub mod demonstration;
pub mod environment;
mod metrics;
mod model;
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
pub use task::{Diagnostic, Mistakes, Task};
pub use trace::{AxisTrace, ContactTrace, Trace};
