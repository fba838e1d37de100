//! `hpf run`: a learned policy, simulated again.

use hpf::words;
use std::path::{Path, PathBuf};
use std::time::Instant;

use hpf_sim::robot::Settings;
use hpf_sim::task::MAX_TASK_BYTES;
use hpf_sim::{Simulation, Task};

use crate::cli::{Common, Simulate};
use crate::deliver::read_task;
use crate::outcome::Outcome;
use crate::render;
use crate::terminal::{say, tell};
use hpf::conduct::Controlled;
use hpf::failure::{Failure, in_text};
use hpf::files::{in_file, read_limited, read_policy, sha256};
use hpf::results::{LearningRow, Run};
use hpf::save::Whole;
use hpf::sinks::combined;
use hpf::summary::Summary;
use hpf::{Nobody, overrides, results};

/// What `--set` may change: the policy decides the rest.
const ENVIRONMENT: [&str; 8] = ["rate", "disturbance", "contact", "sensor", "actuator", "via_point", "cost", "accept"];

/// Runs `hpf run`.
pub fn simulate(options: &Simulate, common: &Common) -> Result<Outcome, Failure> {
    let started = Instant::now();
    let (policy_path, task_path) = paths(options)?;
    let policy = read_policy(&policy_path)?;
    let mut loaded = read_task(&task_path, &changes(options, common)?)?;
    let tables = results::own_tables(&mut loaded.task);
    loaded.text = overrides::apply(&loaded.text, &tables.iter().map(|table| table.change.clone()).collect::<Vec<_>>())?;

    let simulation = Simulation::new(&loaded.task, &policy).map_err(in_file(&policy_path))?;
    let parameters = simulation.parameters(&policy);
    let (trajectory, (cost, metrics), controlled) = match settings(options, &loaded.task)? {
        None => (simulation.rollout(&parameters), simulation.evaluate(&parameters), None),
        Some((settings, text)) => {
            // The policy has made a skill: what the controller refuses now are its settings.
            let of = options.settings.as_ref().unwrap_or(&policy_path);
            if simulation.presses_away(&settings) {
                tell(&format!(
                    "warning: {}: `press` points away from the contact, which lies the other way",
                    of.display()
                ));
            }
            let (shown, conduct) = simulation.controlled(&policy, &settings).map_err(in_file(of))?;
            let (cost, metrics, tally) = simulation.evaluate_controlled(&policy, &settings).map_err(in_file(of))?;
            (shown, (cost, metrics), Some(Controlled { settings, text, conduct, tally }))
        }
    };
    let price = (cost.total(), cost.terms.clone());
    if !price.0.is_finite() {
        return Err(Failure::Input(format!(
            "{}: the motion has no finite cost in this environment",
            policy_path.display()
        )));
    }
    let motions = loaded.task.evaluation_draws();
    let row = LearningRow { update: 0, rollouts: motions, total: price.0, terms: cost.terms, exploration: 0.0 };
    let (snapshots, demonstrations) = (Vec::new(), Vec::new());
    let run = Run { task: loaded.task.clone(), policy, learning: vec![row], trajectory, snapshots, demonstrations };
    let mut summary = Summary {
        task: run.task.name.clone(),
        task_sha256: sha256(&loaded.text),
        policy_sha256: sha256(&run.policy.to_json()),
        method: if controlled.is_some() { "controller" } else { "simulation" },
        seed: run.task.learning.seed,
        threads: rayon::current_num_threads(),
        updates: 0,
        best_update: 0,
        rollouts: motions,
        learning_s: 0.0,
        total_s: started.elapsed().as_secs_f64(),
        initial: price.clone(),
        last: price,
        metrics,
        rejected: 0,
        stopped_because: "a policy was run, nothing learned".into(),
    };

    let time = run.trajectory.time.clone();
    let object = |summary: &Summary| {
        let mut object = summary.to_json();
        if let Some(controlled) = &controlled {
            object["controller"] = controlled.to_json(&time);
        }
        object
    };
    let (mut files, mut failures) = (Vec::new(), Vec::new());
    if let Some(target) = &common.out {
        let metrics = summary.metrics.clone();
        let mut others = Vec::new();
        if let Some(controlled) = &controlled {
            others.push(("controller.csv", controlled.csv(&run.task, &time)));
            others.extend(controlled.text.clone().map(|text| ("settings.toml", text)));
        }
        let whole =
            Whole { run: &run, task_text: &loaded.text, tables: &tables, metrics: &metrics, others, in_full: true };
        (files, failures) = whole.write(target, common.force, &Nobody, || {
            summary.total_s = started.elapsed().as_secs_f64();
            object(&summary)
        })?;
    }

    let place = common.out.as_ref().map(|out| out.display().to_string());
    if common.json {
        say(&render::finished(object(&summary), place.as_deref(), &files))?;
    } else {
        say(&render::simulated(&run, &summary, place.as_deref(), &files))?;
        if let Some(controlled) = &controlled {
            say(&controlled.render(&run.task, &time))?;
        }
    }
    combined(&failures, place.as_deref().unwrap_or_default())?;
    Ok(if summary.is_missed() { Outcome::Missed } else { Outcome::Done })
}

/// The settings of the controller, where it is asked for, and the text of their file.
fn settings(options: &Simulate, task: &Task) -> Result<Option<(Settings, Option<String>)>, Failure> {
    if !options.controller {
        return Ok(None);
    }
    if task.contact.is_some() && task.least_rate().is_none_or(|rate| rate > task.rate) {
        tell(&format!("warning: this loop runs at {} Hz; {}", words::number(task.rate), render::least_rate(task)));
    }
    let Some(path) = &options.settings else { return Ok(Some((Settings::default(), None))) };
    let text = read_limited(path, MAX_TASK_BYTES as u64)?;
    let name = path.display().to_string();
    let settings = Settings::parse(&text, &task.axis).map_err(in_text(&name))?;
    Ok(Some((settings, Some(text))))
}

/// The policy file and the task file it runs in.
fn paths(options: &Simulate) -> Result<(PathBuf, PathBuf), Failure> {
    let is_run = options.policy.is_dir();
    let policy = if is_run { options.policy.join("policy.json") } else { options.policy.clone() };
    let beside = policy.parent().unwrap_or(Path::new("")).join("task.toml");
    match &options.task {
        Some(task) => Ok((policy, task.clone())),
        None if !policy.is_file() || beside.is_file() => Ok((policy, beside)),
        None => {
            let message = format!("{} has no task.toml beside it: name the task with --task", policy.display());
            Err(Failure::Input(message))
        }
    }
}

/// The overrides asked for, if they leave the policy's own part alone.
fn changes(options: &Simulate, common: &Common) -> Result<Vec<String>, Failure> {
    for one in &options.set {
        let root = one.split(['.', '=']).next().unwrap_or_default().trim();
        if !ENVIRONMENT.contains(&root) {
            let allowed = ENVIRONMENT.join(", ");
            let message = format!("--set {one}: the policy decides `{root}`; a run can change: {allowed}");
            return Err(Failure::Input(message));
        }
    }
    let mut changes = options.set.clone();
    changes.extend(options.rate.map(|rate| format!("rate={rate:?}")));
    changes.extend(common.seed.map(|seed| format!("learning.seed={seed}")));
    Ok(changes)
}
