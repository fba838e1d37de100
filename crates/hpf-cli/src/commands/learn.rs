//! `hpf learn`: a task in, a run directory out; or a run that was broken off, finished.

use std::path::{Path, PathBuf};
use std::time::Instant;

use hpf_sim::task::{Environment, Process};
use serde_json::Value;

use crate::cli::{Common, Learn};
use crate::directory::Unfinished;
use crate::failure::{Failure, Outcome};
use crate::files::{LoadedTask, in_file, read_task, read_text};
use crate::learning::{Learned, learn as learn_in};
use crate::sinks::told;
use crate::summary::Summary;
use crate::terminal::say;
use crate::{log, overrides, render, results, start};

/// Runs `hpf learn`.
pub fn learn(options: &Learn, common: &Common) -> Result<Outcome, Failure> {
    let started = Instant::now();
    if let Some(run) = options.resume.as_ref().filter(|_| options.task.is_none())
        && let Some(outcome) = name_whole(run, common)?
    {
        return Ok(outcome);
    }
    let (loaded, mut folder, place) = match (&options.task, &options.resume) {
        (Some(task), _) => begin(task, options, common)?,
        (None, Some(run)) => resume(run, common)?,
        (None, None) => return Err(Failure::Input("name a task, or a run to --resume".into())),
    };
    let finished = learn_in(&loaded, &mut folder, common.quiet)
        .and_then(|learned| save(&loaded, &learned, &mut folder, started).map(|saved| (learned, saved)));
    let (learned, (summary, failures)) = match finished {
        Ok(finished) => finished,
        Err(failure) => return Err(folder.abandon(failure)),
    };
    let files = folder.files().to_vec();
    folder.finish(learned.is_open())?;

    let place = place.display().to_string();
    if common.json {
        say(&render::json(&summary, Some(&place), &files))?;
    } else {
        let next = if learned.is_open() {
            format!("hpf learn --resume {place}")
        } else if loaded.task.environment.is_some() {
            // What a process makes of the policy, hpf cannot simulate.
            format!("hpf check {place}")
        } else if loaded.task.has_steps_at(1000.0) {
            format!("hpf run {place} --rate 1000")
        } else {
            format!("hpf run {place}")
        };
        let mut notes: Vec<String> = learned.history.notes.iter().map(ToString::to_string).collect();
        notes.extend(log::time_note(&loaded.task));
        say(&render::learned(&learned.run, &summary, &notes, &place, &files, &next))?;
    }
    match &learned.failure {
        Some(reason) => {
            let failure = Failure::Work(format!("{reason}; the best policy is in {place}"));
            let go_on = format!("go on from there with: hpf learn --resume {place}");
            Err(if learned.is_open() { failure.with(&go_on) } else { failure })
        }
        None if !failures.is_empty() => told(&failures, &place).map(|()| Outcome::Done),
        None if learned.is_open() => Ok(Outcome::Interrupted),
        None if summary.is_missed() => Ok(Outcome::Missed),
        None => Ok(Outcome::Done),
    }
}

/// A task with its overrides, and a folder that has it.
fn begin(task: &Path, options: &Learn, common: &Common) -> Result<(LoadedTask, Unfinished, PathBuf), Failure> {
    let mut changes = options.set.clone();
    changes.extend(common.seed.map(|seed| format!("learning.seed={seed}")));
    let mut loaded = read_task(task, &changes)?;
    let tables = results::own_tables(&mut loaded.task);
    let mut changes: Vec<String> = tables.iter().map(|table| table.change.clone()).collect();
    if let Some(Environment::Process(Process { folder: Some(folder), .. })) = &loaded.task.environment {
        // The run is elsewhere, and its program stays where it is.
        changes.push(format!("environment.folder={}", overrides::quoted(folder)));
    }
    loaded.text = overrides::apply(&loaded.text, &changes)?;
    let start = start::policy(&loaded.task, options.from.as_deref())?;
    let target = common.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(&loaded.task.name));
    let mut folder = Unfinished::begin(&target, common.force)?;
    let written = folder.write("task.toml", &loaded.text);
    let written = written.and_then(|()| tables.iter().try_for_each(|table| folder.write(&table.name, &table.csv)));
    let written = written.and_then(|()| match options.from {
        Some(_) => folder.write(start::START, start.to_json()),
        None => Ok(()),
    });
    match written {
        Ok(()) => Ok((loaded, folder, target)),
        Err(failure) => Err(folder.abandon(failure)),
    }
}

/// The task and the folder of a run that was broken off: all it needs is in there.
fn resume(run: &Path, common: &Common) -> Result<(LoadedTask, Unfinished, PathBuf), Failure> {
    let mut folder = Unfinished::resume(run, common.force)?;
    let mut loaded = read_task(&folder.path("task.toml"), &[])?;
    folder.written("task.toml");
    results::own_tables(&mut loaded.task).iter().for_each(|table| folder.written(&table.name));
    if folder.path(start::START).is_file() {
        folder.written(start::START);
    }
    let place = if run.extension().is_some_and(|extension| extension == "partial") {
        run.with_extension("")
    } else {
        run.to_owned()
    };
    Ok((loaded, folder, place))
}

/// Gives a run its name that was killed when nothing else was left to do, and shows its result; `None` for others.
fn name_whole(run: &Path, common: &Common) -> Result<Option<Outcome>, Failure> {
    let refused = [("--seed", common.seed.is_some()), ("--out", common.out.is_some())];
    if let Some((option, _)) = refused.iter().find(|(_, is_given)| *is_given) {
        let message = format!("{option} does not go with --resume: a run goes on as it began, where it began");
        return Err(Failure::Input(message));
    }
    let folder = Unfinished::resume(run, common.force)?;
    if !folder.is_whole() {
        return Ok(None);
    }
    let path = folder.path("summary.json");
    let summary: Value = serde_json::from_str(&read_text(&path)?).map_err(in_file(&path))?;
    folder.finish(false)?;
    say(&if common.json { format!("{summary:#}\n") } else { render::summary(&summary) })?;
    let is_missed = summary["metrics"].as_array().is_some_and(|all| all.iter().any(|metric| metric["pass"] == false));
    Ok(Some(if is_missed { Outcome::Missed } else { Outcome::Done }))
}

/// Writes everything that was learned; returns its summary, and which log or figures could not be made.
fn save(
    loaded: &LoadedTask,
    learned: &Learned,
    folder: &mut Unfinished,
    started: Instant,
) -> Result<(Summary, Vec<Failure>), Failure> {
    let Learned { run, history, metrics, .. } = learned;
    let mut failures = results::save(run, &loaded.text, metrics, folder)?;
    // Where the log written while learning failed, it is told only if the whole one failed too: that has all of it.
    if !failures.is_empty() {
        failures.extend(learned.log_failure.iter().map(|why| Failure::Work(why.clone())));
    }
    let seconds = [learned.time, started.elapsed()].map(|time| time.as_secs_f64());
    let summary = Summary::of_learning(run, history, metrics.clone(), seconds, learned.failure.as_deref());
    folder.write("summary.json", format!("{:#}\n", summary.to_json()))?;
    Ok((summary, failures))
}
