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
    /// The program and its arguments; relative paths are looked for in `folder`.
    #[schemars(length(min = 1))]
    pub command: Vec<String>,
    /// Where it runs, from the folder of the task file, which it is where left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub folder: Option<String>,
    /// How many of them run at a time, each with one rollout at a time.
    #[serde(default = "default_workers")]
    #[schemars(range(min = 1, max = 256))]
    pub workers: usize,
    /// Longest time for one rollout, and for the start [s].
    #[serde(default = "default_timeout")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1_000_000))]
    pub timeout: f64,
    /// How often one rollout is tried, each time by a new process, before it is given up.
    #[serde(default = "default_tries")]
    #[schemars(range(min = 1, max = 1000))]
    pub tries: usize,
    /// How many rollouts may be given up until learning ends; a resumed run counts anew.
    #[serde(default = "default_max_lost")]
    #[schemars(range(max = 1_000_000))]
    pub max_lost: usize,
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

fn default_max_lost() -> usize {
    20
}

impl Process {
    /// The keys that say how rollouts are made, and not which: a run with others has the same results.
    pub const HOW: [&str; 5] = ["folder", "workers", "timeout", "tries", "max_lost"];
}

impl Task {
    /// The same task without its environment: what can be simulated of it is the motion as planned, which ends at the
    /// duration as those of the process do.
    pub fn as_planned(&self) -> Self {
        Self { ends_at_duration: self.environment.is_some(), environment: None, ..self.clone() }
    }
}
