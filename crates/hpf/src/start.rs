//! The policy that learning starts from: the initial one of the task, or one that was demonstrated or learned before.

use std::path::Path;

use hpf_sim::Policy;
use hpf_sim::task::{InitialPath, Task};

use crate::failure::Failure;
use crate::files::{in_file, policy_path, read_policy};

/// The name of the policy that learning started from, in the run directory.
pub const START: &str = "start_policy.json";

/// The policy that learning of `task` starts from: that of the file or run `from`, where one is named.
///
/// # Errors
/// [`Failure::Input`] that names every difference between policy and task.
pub fn policy(task: &Task, from: Option<&Path>) -> Result<Policy, Failure> {
    let Some(from) = from else {
        return Policy::initial(task).map_err(|error| Failure::Input(format!("{}: {error}", task.name)));
    };
    if task.learning.initial_path != InitialPath::Pull {
        let message = "--from brings a path of its own; set learning.initial_path to \"pull\", or leave --from out";
        return Err(Failure::Input(message.into()));
    }
    let path = policy_path(from)?;
    read_policy(&path)?.carried_to(task).map_err(in_file(&path))
}

/// The policy that learning of `task` starts from where it is to be `policy`.
///
/// # Errors
/// [`Failure::Input`] that names every difference between policy and task.
pub fn carried(policy: &Policy, task: &Task) -> Result<Policy, Failure> {
    if task.learning.initial_path != InitialPath::Pull {
        let message = "the policy to start from brings a path of its own; set learning.initial_path to \"pull\"";
        return Err(Failure::Input(message.into()));
    }
    policy.carried_to(task).map_err(|error| Failure::Input(error.to_string()))
}
