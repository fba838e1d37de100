//! `hpf sweep`: a task learned with several seeds and settings; a table, a summary and figures of all.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::{Value, json};

use crate::cli::{Common, Sweep};
use crate::outcome::Outcome as Exit;
use crate::sweep::{Outcome, Plan, Sample, Setting, learn_all, render};
use crate::terminal::say;
use hpf::failure::Failure;
use hpf::figure::{self, Drawing, Format, Group, Measure, Member};
use hpf::files::{self, make_folder, read_text, while_writing};
use hpf::nodes;
use hpf::sinks::told;

/// The file that a sweep under way holds locked; one that was broken off leaves it.
const LOCK: &str = ".lock";

/// More failures than this are counted, not shown; the table has all.
const MOST_SHOWN: usize = 10;

/// Runs `hpf sweep`.
pub fn sweep(options: &Sweep, common: &Common) -> Result<Exit, Failure> {
    let started = Instant::now();
    let plan = Plan::new(options, common.seed)?;
    let folder = common.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(format!("{}-sweep", plan.task)));
    let lock = claim(&folder)?;
    let done = learn_all(&plan, &folder, options.full, common.force, common.quiet)?;
    let outcome = Outcome::read(&plan, &done, &folder)?;

    let mut files = vec!["results.csv".to_owned(), "summary.json".to_owned()];
    files::write(&folder.join("results.csv"), outcome.csv()?)?;
    let summary = outcome.to_json();
    files::write(&folder.join("summary.json"), format!("{summary:#}\n"))?;
    let mut failures = Vec::new();
    if outcome.samples.iter().any(Option::is_some) {
        let groups = groups(&plan, &outcome);
        let varied = plan.factors.iter().map(|factor| factor.key.as_str()).collect::<Vec<_>>().join(" / ");
        let drawings = [
            Drawing::new("cost", || figure::sweep_cost(&groups)),
            Drawing::new("metrics", || figure::sweep_measures(&groups, &varied)),
        ];
        match figure::draw(&drawings, &plan.task, Format::Png, &folder.join("plots")) {
            Ok(drawn) => files.extend(drawn.into_iter().map(|name| format!("plots/{name}"))),
            Err(failure) => failures.push(failure),
        }
    }
    drop(lock);
    fs::remove_file(folder.join(LOCK)).map_err(while_writing(&folder))?;

    if common.json {
        let mut object = summary;
        object["directory"] = json!(folder);
        object["files"] = json!(files);
        say(&format!("{object:#}\n"))?;
    } else {
        let seconds = started.elapsed().as_secs_f64();
        say(&render(&summary, done.kept, seconds, &folder.display().to_string(), &files))?;
    }
    if done.interrupted {
        return Ok(Exit::Interrupted);
    }
    told(&failures, &folder.display().to_string())?;
    let failed: Vec<String> = outcome.failed().map(|(run, why)| format!("{run}: {why}")).collect();
    let shown = failed.iter().take(MOST_SHOWN).cloned().collect::<Vec<_>>().join("\n");
    match (failed.is_empty(), outcome.missed()) {
        (false, _) => Err(Failure::Work(format!("{} of {} runs failed\n{}", failed.len(), plan.jobs.len(), shown))),
        (true, 0) => Ok(Exit::Done),
        (true, _) => Ok(Exit::Missed),
    }
}

/// Makes the directory of a sweep, or takes the one of a sweep that stands there, for as long as the lock is held.
fn claim(folder: &Path) -> Result<File, Failure> {
    let refuse = |why: &str| Err(Failure::Input(format!("{} {why}", folder.display())));
    let is_empty = fs::read_dir(folder).map_or(true, |mut entries| entries.next().is_none());
    let summary = read_text(&folder.join("summary.json")).unwrap_or_default();
    let summary: Value = serde_json::from_str(&summary).unwrap_or_default();
    let is_sweep = summary["format"] == json!("hpf-sweep") || folder.join(LOCK).is_file();
    if !(is_empty && !folder.is_file() || is_sweep) {
        return refuse("is no sweep and is left as it is; pass another --out");
    }
    make_folder(folder)?;
    let path = folder.join(LOCK);
    let lock = nodes::replaceable(&path).and_then(|()| File::create(&path)).map_err(while_writing(&path))?;
    match lock.try_lock() {
        Ok(()) => Ok(lock),
        Err(_) => refuse("belongs to a sweep that is going on; wait for it, or pass another --out"),
    }
}

/// The finished runs by setting, as figures want them.
fn groups(plan: &Plan, outcome: &Outcome<'_>) -> Vec<Group> {
    let member = |sample: &Sample| Member {
        costs: sample.learning.iter().map(|row| (row.rollouts as f64, row.total)).collect(),
        measures: measures(sample),
    };
    let settings = plan.settings.iter().enumerate();
    let group = |(index, setting): (usize, &Setting)| Group {
        name: plan.label(setting),
        short: plan.short_name(setting),
        members: outcome.of_setting(index).map(member).collect(),
    };
    settings.map(group).collect()
}

/// The cost, and every measure but those that repeat it or only say where the gains went.
fn measures(sample: &Sample) -> Vec<Measure> {
    let target = sample.metrics().find(|metric| metric.0 == "max_cost").and_then(|metric| metric.3);
    let cost = Measure { name: "cost".into(), unit: String::new(), value: sample.total(), target };
    let told = |name: &str| name != "max_cost" && !name.starts_with("stiffness") && !name.starts_with("damping");
    let others = sample.metrics().filter(|metric| told(metric.0)).map(|(name, unit, value, target)| Measure {
        name: name.into(),
        unit: unit.into(),
        value,
        target,
    });
    [cost].into_iter().chain(others).collect()
}
