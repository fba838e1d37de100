//! `hpf check`: is this file right, and what does it hold?

use hpf::words;
use std::path::Path;

use hpf_core::passivity::{Case, Contact};
use hpf_sim::task::Task;
use hpf_sim::{Certificate, Conditions, Metric, Policy, Simulation};
use serde_json::{Value, json};

use crate::cli::{Check, Common};
use crate::deliver::read_task;
use crate::outcome::Outcome;
use crate::render;
use crate::terminal::say;
use hpf::failure::Failure;
use hpf::files::{in_file, policy_path, read_policy};
use hpf::log;

/// Control rate of a policy where neither `--rate` nor a task beside it says one [Hz].
const RATE: f64 = 1000.0;
/// Largest force of the environment where `--load` says none [N or N m]: the one of the paper's tasks.
const LOAD: f64 = 10.0;

/// Runs `hpf check`.
pub fn check(options: &Check, common: &Common) -> Result<Outcome, Failure> {
    let path = &options.file;
    if path.is_dir() || path.extension().is_some_and(|extension| extension == "json") {
        return check_policy(options, common);
    }
    let Check { rate, delay, load, lag, cutoff, tool_mass, contact_mass, contact_damping, .. } = options;
    let conditions = [rate, delay, load, lag, cutoff, tool_mass, contact_mass, contact_damping];
    if conditions.iter().any(|condition| condition.is_some()) {
        let help = "--rate, --delay, --load, --lag, --cutoff, --tool-mass, --contact-mass and --contact-damping are for \
                    policies; a task takes --set rate=HZ";
        return Err(Failure::Input(help.into()));
    }
    let mut changes = options.set.clone();
    changes.extend(common.seed.map(|seed| format!("learning.seed={seed}")));
    let loaded = read_task(path, &changes)?;
    let policy = Policy::initial(&loaded.task).map_err(in_file(path))?;
    let simulation = Simulation::new(&loaded.task.as_planned(), &policy).map_err(in_file(path))?;
    let start = simulation.starting_weights(&policy).map_err(in_file(path))?;
    // Only the process knows the cost of its motions.
    let cost = loaded.task.environment.is_none().then(|| simulation.evaluate(&start).0.total());
    if cost.is_some_and(|cost| !cost.is_finite()) {
        return Err(Failure::Input(format!("{}: the motion before learning has no finite cost", path.display())));
    }
    let warnings = warnings(&loaded.task);
    if common.json {
        let object = json!({
            "format": "hpf-check", "version": 1, "kind": "task", "valid": true,
            "steps": simulation.step_count(), "parameters": start.len(), "initial_cost": cost,
            "most_motions": render::planned_motions(&loaded.task), "least_rate_hz": loaded.task.least_rate(),
            "memory_bytes": loaded.task.memory(rayon::current_num_threads()), "warnings": warnings,
        });
        say(&format!("{object:#}\n"))?;
    } else {
        say(&render::task(&loaded.task, start.len(), cost))?;
        warnings.iter().try_for_each(|warning| say(&format!("  warning     {warning}\n")))?;
    }
    Ok(Outcome::Done)
}

/// Warnings about a valid task.
fn warnings(task: &Task) -> Vec<String> {
    let contact = task.measured_contact().filter(|contact| contact.stiffness >= contact.limit);
    let unstable = contact.map(|contact| {
        format!(
            "the contact is as stiff as {} N/m, and its force is measured: at the least damping the loop is stable below \
             {} N/m only; soften the contact, raise damping.min or the rate, or shorten delay and lag",
            words::number(contact.stiffness),
            words::number(contact.limit)
        )
    });
    unstable.into_iter().chain(log::time_note(task)).collect()
}

/// A policy file, or the policy of a run, with its certificates.
fn check_policy(options: &Check, common: &Common) -> Result<Outcome, Failure> {
    if !options.set.is_empty() {
        return Err(Failure::Input("--set changes tasks; a policy has nothing to set".into()));
    }
    let path = policy_path(&options.file)?;
    let policy = read_policy(&path)?;
    let conditions = conditions(options, &path)?;
    let certificates = policy.certify(&conditions).map_err(in_file(&path))?;
    let rest = rest_in_task(&policy, &path)?;
    if common.json {
        let object = json!({
            "format": "hpf-check", "version": 1, "kind": "policy", "valid": true,
            "rest": rest.iter().map(|metric| (metric.name.to_owned(), json!(metric.value))).collect::<serde_json::Map<_, _>>(),
            "certificates": certified(&policy, &conditions, &certificates),
        });
        say(&format!("{object:#}\n"))?;
    } else {
        let text = render::policy(&policy) + "\n" + &render::certificates(&policy, &conditions, &certificates);
        say(&text)?;
        for Metric { name, value, unit, .. } in rest {
            say(&format!("  {name} {} in the environment of the task beside it\n", words::measure(value, unit)))?;
        }
    }
    Ok(Outcome::Done)
}

/// How far from its goal the tool is after the end, where the task that the policy was learned for lies beside it.
fn rest_in_task(policy: &Policy, path: &Path) -> Result<Vec<Metric>, Failure> {
    let task = path.with_file_name("task.toml");
    if !task.is_file() {
        return Ok(Vec::new());
    }
    let task = read_task(&task, &[])?.task;
    // The environment of a process is not simulated.
    if task.environment.is_some() {
        return Ok(Vec::new());
    }
    let simulation = Simulation::new(&task, policy).map_err(in_file(path))?;
    let (_, metrics) = simulation.evaluate(&simulation.parameters(policy));
    Ok(metrics.into_iter().filter(|metric| metric.name.ends_with("_rest_error")).collect())
}

/// What to certify for: as asked, else the rate, sensor and actuator of the task beside the policy, a force one sample late.
fn conditions(options: &Check, policy: &Path) -> Result<Conditions, Failure> {
    let beside = policy.with_file_name("task.toml");
    let task = if beside.is_file() { Some(read_task(&beside, &[])?.task) } else { None };
    let task = task.as_ref();
    let rate = options.rate.or(task.map(|task| task.rate)).unwrap_or(RATE);
    let sensor = task.and_then(|task| task.sensor.as_ref());
    let actuator = task.and_then(|task| task.actuator.as_ref());
    Ok(Conditions {
        rate,
        delay: options.delay.or(sensor.map(|sensor| sensor.delay)).unwrap_or(rate.recip()),
        load: options.load.unwrap_or(LOAD),
        cutoff: options.cutoff,
        lag: options.lag.or(actuator.map(|actuator| actuator.lag)).unwrap_or(0.0),
        contact: Contact {
            tool: options.tool_mass.unwrap_or(0.0),
            mass: options.contact_mass.unwrap_or(0.0),
            damping: options.contact_damping.unwrap_or(0.0),
        },
    })
}

/// The name of what limits a contact.
fn named(case: Case) -> &'static str {
    match case {
        Case::FreeAir => "free_air",
        Case::Carried => "carried",
        Case::Behind => "behind",
    }
}

fn certified(policy: &Policy, conditions: &Conditions, certificates: &[Certificate]) -> Value {
    let axes = policy.axes.iter().zip(certificates).map(|(axis, certificate)| {
        // A law of first order is always stable; what the test for the second does not prove is not disproved.
        let stable = if policy.admittance.order == 1 { Some(true) } else { certificate.decay.map(|_| true) };
        json!({
            "name": axis.name, "unit": axis.unit,
            "passive": certificate.fails_at.is_none(), "not_passive_from_s": certificate.fails_at,
            "stable": stable, "stable_decay_per_s": certificate.decay,
            "largest_offset": certificate.largest_offset, "switched_energy_j": certificate.switched_energy,
            "least_damping": certificate.least_damping, "contact_stiffness_limit": certificate.contact_stiffness,
            "contact_limited_by": named(certificate.contact_case), "contact_limited_at_s": certificate.contact_at,
            "tool_mass_limit": certificate.tool_mass, "safe_tool_mass": certificate.safe_tool_mass,
            "peak_velocity": certificate.peak_velocity, "peak_acceleration": certificate.peak_acceleration,
            "rest_distance": certificate.rest_distance,
        })
    });
    let axes: Vec<Value> = axes.collect();
    json!({
        "order": policy.admittance.order, "rate_hz": conditions.rate, "delay_s": conditions.delay, "load": conditions.load,
        "lag_s": conditions.lag, "cutoff_hz": conditions.cutoff, "tool_mass": conditions.contact.tool,
        "contact_mass": conditions.contact.mass, "contact_damping": conditions.contact.damping,
        "horizon_s": 2.0 * policy.duration_s, "axes": axes,
    })
}
