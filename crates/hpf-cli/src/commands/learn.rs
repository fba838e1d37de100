//! `hpf learn`: a task in, a run directory out; or an interrupted run, resumed.

use std::path::{Path, PathBuf};

use hpf::directory::Unfinished;
use hpf::failure::Failure;
use hpf::files::{self, in_file, read_text};
use hpf::job::{Finished, Job};
use hpf::log;
use hpf::sinks::combined;
use hpf::words::typed;
use serde_json::Value;

use super::report;
use crate::cli::{Common, Learn};
use crate::outcome::Outcome;
use crate::progress::{Meter, OnTerminal};
use crate::render;
use crate::terminal::{say, tell};

/// Runs `hpf learn`.
pub fn learn(options: &Learn, common: &Common) -> Result<Outcome, Failure> {
    if let Some(run) = options.resume.as_ref().filter(|_| options.task.is_none())
        && let Some(outcome) = name_whole(run, options.report, common)?
    {
        return Ok(outcome);
    }
    let job = match (&options.task, &options.resume) {
        (Some(task), _) => {
            let mut changes = options.set.clone();
            changes.extend(common.seed.map(|seed| format!("learning.seed={seed}")));
            Job::begin(task, &changes, options.from.as_deref(), common.out.as_deref(), common.force)?
        }
        (None, Some(run)) => Job::resume(run, common.force)?,
        (None, None) => return Err(Failure::Input("name a task, or a run to --resume".into())),
    };
    job.loaded.notes.iter().for_each(|note| tell(&format!("note: {note}")));
    let task = job.loaded.task.clone();
    let terminal = OnTerminal::<Meter>::new(common.quiet);
    let finished = job.learn(&terminal);
    terminal.finish();
    let Finished { learned, summary, mut failures, mut files, place } = finished?;
    if options.report {
        match write_report(&place) {
            Ok(()) => files.push(report::NAME.into()),
            Err(failure) => failures.push(failure),
        }
    }

    let place = place.display().to_string();
    let named = typed(&place);
    if common.json {
        say(&render::json(&summary, Some(&place), &files))?;
    } else {
        let next = if learned.is_open() {
            format!("hpf learn --resume {named}")
        } else if task.environment.is_some() {
            // hpf cannot simulate the environment of a process.
            format!("hpf check {named}")
        } else if task.has_steps_at(1000.0) {
            format!("hpf run {named} --rate 1000")
        } else {
            format!("hpf run {named}")
        };
        let mut notes: Vec<String> = learned.history.notes.iter().map(ToString::to_string).collect();
        notes.extend(log::time_note(&task));
        say(&render::learned(&learned.run, &summary, &notes, &place, &files, &next))?;
    }
    match &learned.failure {
        Some(reason) => {
            let failure = Failure::Work(format!("{reason}; the best policy is in {place}"));
            let go_on = format!("go on from there with: hpf learn --resume {named}");
            Err(if learned.is_open() { failure.with(&go_on) } else { failure })
        }
        None if !failures.is_empty() => combined(&failures, &place).map(|()| Outcome::Done),
        None if learned.is_open() => Ok(Outcome::Interrupted),
        None if summary.is_missed() => Ok(Outcome::Missed),
        None => Ok(Outcome::Done),
    }
}

/// Writes the page of the run `place` into it.
fn write_report(place: &Path) -> Result<(), Failure> {
    let html = report::of(&[place.to_owned()])?;
    files::write(&place.join(report::NAME), html)
}

/// Gives a run its name that was killed when nothing else was left to do, and shows its result; `None` for others.
fn name_whole(run: &Path, with_report: bool, common: &Common) -> Result<Option<Outcome>, Failure> {
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
    if with_report {
        let is_partial = run.extension().is_some_and(|extension| extension == "partial");
        let place: PathBuf = if is_partial { run.with_extension("") } else { run.to_owned() };
        write_report(&place)?;
    }
    say(&if common.json { format!("{summary:#}\n") } else { render::summary(&summary) })?;
    let is_missed = summary["metrics"].as_array().is_some_and(|all| all.iter().any(|metric| metric["pass"] == false));
    Ok(Some(if is_missed { Outcome::Missed } else { Outcome::Done }))
}
