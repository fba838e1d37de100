//! `hpf check`: is this file right, and what does it come to?

use hpf_sim::{Policy, Simulation};
use serde_json::json;

use crate::cli::{Check, Common};
use crate::failure::{Failure, Outcome};
use crate::files::{in_file, read_policy, read_task, say};
use crate::render;

/// Runs `hpf check`.
pub fn check(options: &Check, common: &Common) -> Result<Outcome, Failure> {
    let path = &options.file;
    if path.extension().is_some_and(|extension| extension == "json") {
        if !options.set.is_empty() {
            return Err(Failure::Input("--set changes tasks; a policy has nothing to set".into()));
        }
        let policy = read_policy(path)?;
        if common.json {
            let object = json!({ "format": "hpf-check", "version": 1, "kind": "policy", "valid": true });
            say(&format!("{object:#}\n"))?;
        } else {
            say(&render::policy(&policy))?;
        }
        return Ok(Outcome::Done);
    }
    let mut changes = options.set.clone();
    changes.extend(common.seed.map(|seed| format!("learning.seed={seed}")));
    let loaded = read_task(path, &changes)?;
    let policy = Policy::initial(&loaded.task).map_err(in_file(path))?;
    let simulation = Simulation::new(&loaded.task, &policy).map_err(in_file(path))?;
    let trace = simulation.rollout(&simulation.starting_weights(&policy).map_err(in_file(path))?);
    let cost = simulation.cost(&trace).total();
    if !cost.is_finite() {
        return Err(Failure::Input(format!("{}: the motion before learning has no finite cost", path.display())));
    }
    if common.json {
        let object = json!({
            "format": "hpf-check", "version": 1, "kind": "task", "valid": true,
            "steps": simulation.step_count(), "parameters": policy.weights().len(), "initial_cost": cost,
        });
        say(&format!("{object:#}\n"))?;
    } else {
        say(&render::task(&loaded.task, policy.weights().len(), cost))?;
    }
    Ok(Outcome::Done)
}
