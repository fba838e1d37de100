//! `hpf imitate`: demonstrations in, a policy and its run directory out.

mod saved;

use std::path::{Path, PathBuf};
use std::time::Instant;

use hpf_sim::demonstration::{Demonstration, Imitated};
use hpf_sim::task::Task;
use hpf_sim::{Metric, Simulation};

use crate::cli::Common;
use crate::cli::imitate::Options;
use crate::deliver::read_task;
use crate::outcome::Outcome;
use crate::terminal::say;
use hpf::failure::{Failure, in_text};
use hpf::files::{LoadedTask, in_file, sha256};
use hpf::results::{LearningRow, Run};
use hpf::save::Whole;
use hpf::sinks::combined;
use hpf::summary::Summary;
use hpf::{Nobody, log, overrides, recordings, results};

/// A demonstration and the file it was read from.
struct Source {
    path: PathBuf,
    sha256: String,
}

/// Runs `hpf imitate`.
pub fn imitate(options: &Options, common: &Common) -> Result<Outcome, Failure> {
    let started = Instant::now();
    let (sources, demonstrations, mut notes) = read(options)?;
    let mut loaded = task(options, common, &sources, &demonstrations)?;
    if options.task.is_none() {
        notes.extend(options.outline(String::new()).note(&demonstrations));
    }
    let tables = results::own_tables(&mut loaded.task);
    loaded.text = overrides::apply(&loaded.text, &tables.iter().map(|table| table.change.clone()).collect::<Vec<_>>())?;

    let imitated = options.imitation().of(&demonstrations, &loaded.task).map_err(|error| {
        let place = error.demonstration().map(|i| sources[i].path.display().to_string());
        Failure::Input(format!("{}: {error}", place.unwrap_or_else(|| loaded.task.name.clone())))
    })?;
    let (run, mut summary, errors) = simulate(&loaded, &imitated)?;
    notes.extend(log::time_note(&loaded.task));
    notes.extend(imitated.notes.iter().cloned());
    notes.extend(recordings::notes_outside(&imitated, &run.trajectory));
    let account = saved::Account::new(&sources, &imitated, &errors, notes);

    let target = common.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(&loaded.task.name));
    let metrics = summary.metrics.clone();
    let whole = Whole {
        run: &run,
        task_text: &loaded.text,
        tables: &tables,
        metrics: &metrics,
        others: Vec::new(),
        in_full: true,
    };
    let (files, failures) = whole.write(&target, common.force, &Nobody, || {
        summary.total_s = started.elapsed().as_secs_f64();
        account.in_json(summary.to_json())
    })?;

    let place = target.display().to_string();
    if common.json {
        let mut object = account.in_json(summary.to_json());
        object["directory"] = place.as_str().into();
        object["files"] = files.into();
        say(&format!("{object:#}\n"))?;
    } else {
        say(&account.text(&run, &summary, &place, &files))?;
    }
    combined(&failures, &place)?;
    Ok(if summary.is_missed() { Outcome::Missed } else { Outcome::Done })
}

/// Files, what they record, and notes on them.
type Recordings = (Vec<Source>, Vec<Demonstration>, Vec<String>);

/// Reads the demonstrations, and says of which file a mistake is.
fn read(options: &Options) -> Result<Recordings, Failure> {
    let mapping = options.mapping();
    let (mut sources, mut notes) = (Vec::new(), Vec::new());
    let mut demonstrations: Vec<Demonstration> = Vec::new();
    for path in &options.demonstrations {
        let loaded = recordings::load(path, &mapping)?;
        notes.extend(loaded.notes);
        sources.push(Source { sha256: loaded.sha256, path: loaded.path });
        demonstrations.push(loaded.recording);
    }
    notes.extend(recordings::align_turns(&mut demonstrations));
    let axes = |one: &Demonstration| {
        let mut names: Vec<_> = one.axes.iter().map(|axis| format!("{} [{:?}]", axis.name, axis.unit)).collect();
        names.sort();
        names.join(", ").to_lowercase()
    };
    for (one, source) in demonstrations.iter().zip(&sources).skip(1) {
        let (found, expected) = (axes(one), axes(&demonstrations[0]));
        if found != expected {
            let first = sources[0].path.display();
            let message = format!("it moves the axes {found}, {first} moves {expected}");
            return Err(in_file(&source.path)(message));
        }
    }
    Ok((sources, demonstrations, notes))
}

/// The task named, or one made for the demonstrations; overrides applied.
fn task(
    options: &Options,
    common: &Common,
    sources: &[Source],
    demonstrations: &[Demonstration],
) -> Result<LoadedTask, Failure> {
    let mut changes = options.set.clone();
    changes.extend(options.name.as_ref().map(|name| format!("name={name:?}")));
    changes.extend(common.seed.map(|seed| format!("learning.seed={seed}")));
    if let Some(path) = &options.task {
        return read_task(path, &changes);
    }
    let name = options.name.clone().unwrap_or_else(|| name_of(&sources[0].path));
    let text = overrides::apply(&options.outline(name).write(demonstrations), &changes)?;
    let task = Task::parse(&text).map_err(in_text("the task of the demonstrations"))?;
    Ok(LoadedTask { task, text, notes: Vec::new() })
}

/// A name for the task of the demonstration in `path`: its own, in letters that a task may have.
fn name_of(path: &Path) -> String {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let allowed = |c: char| if c.is_ascii_alphanumeric() || "_-".contains(c) { c } else { '_' };
    let name: String = stem.chars().map(allowed).take(100).collect();
    if name.is_empty() { "demonstration".into() } else { name }
}

/// The motion of the imitated policy in its task, its cost, and how far it is from the demonstrations by axis: as they were
/// recorded, and as they are aligned.
fn simulate(loaded: &LoadedTask, imitated: &Imitated) -> Result<(Run, Summary, [Vec<f64>; 2]), Failure> {
    let task = &loaded.task;
    let mut policy = imitated.policy.clone();
    let bad_task = |error: &dyn core::fmt::Display| Failure::Input(format!("{}: {error}", task.name));
    let simulation = Simulation::new(task, &policy).map_err(|error| bad_task(&error))?;
    let parameters = simulation.parameters(&policy);
    let trajectory = simulation.rollout(&parameters);
    let (cost, mut metrics) = simulation.evaluate(&parameters);
    let price = (cost.total(), cost.terms.clone());
    if !price.0.is_finite() {
        return Err(bad_task(&"the imitated motion has no finite cost in this task"));
    }
    policy.provenance.task_sha256 = sha256(&loaded.text);
    policy.provenance.cost = price.0;

    let errors = [imitated.errors(&trajectory), imitated.aligned_errors(&trajectory)];
    let units: Vec<&str> = task.axis.iter().map(|axis| axis.unit.symbol()).collect();
    let unit = if units.iter().all(|unit| *unit == units[0]) { units[0] } else { "" };
    let whole = errors[0].iter().map(|error| error * error).sum::<f64>().sqrt();
    metrics.push(Metric { name: "demonstration_rmse", unit, value: whole, target: None });
    let row = LearningRow { update: 0, rollouts: 1, total: price.0, terms: cost.terms, exploration: 0.0 };
    let summary = Summary {
        task: task.name.clone(),
        task_sha256: sha256(&loaded.text),
        policy_sha256: sha256(&policy.to_json()),
        method: "imitation",
        seed: task.learning.seed,
        threads: rayon::current_num_threads(),
        updates: 0,
        best_update: 0,
        rollouts: 1,
        learning_s: 0.0,
        total_s: 0.0,
        initial: price.clone(),
        last: price,
        metrics,
        rejected: 0,
        stopped_because: "a demonstration was fitted, nothing learned".into(),
    };
    let run = Run {
        task: task.clone(),
        policy,
        learning: vec![row],
        trajectory,
        snapshots: Vec::new(),
        demonstrations: imitated.demonstrations.clone(),
    };
    Ok((run, summary, errors))
}
