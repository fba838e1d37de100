//! `[environment]`: who makes the rollouts where hpf does not simulate them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Task;

/// Who makes the rollouts; left out, hpf simulates them.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Environment {
    /// A program that hpf starts and talks to: a simulator, a robot (docs/process.md).
    Process(Process),
}

/// A program that makes rollouts.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Process {
    /// The program and its arguments, run where hpf runs.
    #[schemars(length(min = 1))]
    pub command: Vec<String>,
    /// How many of them run at a time, each with one rollout at a time.
    #[serde(default = "default_workers")]
    #[schemars(range(min = 1, max = 256))]
    pub workers: usize,
    /// Longest time for one rollout, and for the start [s].
    #[serde(default = "default_timeout")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1_000_000))]
    pub timeout: f64,
    /// How often one rollout is tried, each time by a new process, before learning gives up.
    #[serde(default = "default_tries")]
    #[schemars(range(min = 1, max = 1000))]
    pub tries: usize,
}

fn default_workers() -> usize {
    1
}

fn default_timeout() -> f64 {
    60.0
}

fn default_tries() -> usize {
    3
}

impl Task {
    /// The same task without its environment: what can be simulated of it is the motion as planned.
    pub fn as_planned(&self) -> Self {
        Self { environment: None, ..self.clone() }
    }
}
