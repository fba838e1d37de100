//! `hpf learn`: a task in, a run directory out.

use core::sync::atomic::{AtomicBool, Ordering};
use core::time::Duration;
use std::path::PathBuf;
use std::time::Instant;

use hpf_learn::{History, LearnError, Progress, Stop};
use hpf_sim::task::Task;
use hpf_sim::{Policy, Simulation};

use super::start;
use crate::cli::{Common, Learn};
use crate::directory::Unfinished;
use crate::failure::{Failure, Outcome};
use crate::files::{LoadedTask, read_task, say, sha256, while_writing};
use crate::log::{Head, Log};
use crate::progress::Meter;
use crate::results::{LearningRow, Run};
use crate::summary::Summary;
use crate::{overrides, render, results};

/// Set by Ctrl-C: learning ends after the running update.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Runs `hpf learn`.
pub fn learn(options: &Learn, common: &Common) -> Result<Outcome, Failure> {
    let started = Instant::now();
    let mut changes = options.set.clone();
    changes.extend(common.seed.map(|seed| format!("learning.seed={seed}")));
    let mut loaded = read_task(&options.task, &changes)?;
    let tables = results::own_tables(&mut loaded.task);
    loaded.text = overrides::apply(&loaded.text, &tables.iter().map(|table| table.change.clone()).collect::<Vec<_>>())?;
    let start = start::policy(&loaded.task, options.from.as_deref())?;

    let target = common.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(&loaded.task.name));
    let mut folder = Unfinished::begin(&target, common.force)?;
    let finished = (|| {
        folder.write("task.toml", &loaded.text)?;
        for table in &tables {
            folder.write(&table.name, &table.csv)?;
        }
        if options.from.is_some() {
            folder.write(start::START, start.to_json())?;
        }
        let learned = Learned::from(&loaded, start, &folder, common.quiet)?;
        let summary = save(&loaded, &learned, &mut folder, started)?;
        Ok((learned, summary))
    })();
    let (learned, summary) = match finished {
        Ok(finished) => finished,
        Err(failure) => return Err(folder.abandon(failure)),
    };
    let files = folder.files().to_vec();
    folder.finish()?;

    let place = target.display().to_string();
    if common.json {
        say(&render::json(&summary, Some(&place), &files))?;
    } else {
        let next = format!("hpf run {place} --rate 1000");
        let notes: Vec<String> = learned.history.notes.iter().map(ToString::to_string).collect();
        say(&render::learned(&loaded.task, &summary, &notes, &place, &files, &next))?;
    }
    match learned.failure {
        Some(reason) => Err(Failure::Work(format!("{reason}; the best policy before that is in {place}"))),
        None if learned.history.stop == Stop::Asked => Ok(Outcome::Interrupted),
        None if summary.is_missed() => Ok(Outcome::Missed),
        None => Ok(Outcome::Done),
    }
}

/// What learning came to.
struct Learned {
    run: Run,
    history: History,
    simulation: Simulation,
    time: Duration,
    /// Why learning broke off, if it did.
    failure: Option<String>,
}

impl Learned {
    /// Learns the task from the policy `start`, logging each update to the folder as it comes.
    fn from(loaded: &LoadedTask, start: Policy, folder: &Unfinished, quiet: bool) -> Result<Self, Failure> {
        let task = &loaded.task;
        let bad_task = |error: &dyn core::fmt::Display| Failure::Input(format!("{}: {error}", task.name));
        let simulation = Simulation::new(task, &start).map_err(|error| bad_task(&error))?;
        let weights = simulation.starting_weights(&start).map_err(|error| bad_task(&error))?;

        let log_path = folder.path("log.mcap.partial");
        let first_policy = start.clone().with_weights(&weights).to_json();
        let head = Head::new(task, &loaded.text, &first_policy);
        let mut log = Log::create(&log_path, &head).map_err(while_writing(&log_path))?;
        let mut meter = Meter::new(&task.name, task.learning.updates, task.learning.rollouts, quiet);
        let (mut rows, mut kept, mut log_failure) = (Vec::new(), Vec::new(), None);
        let observe = |progress: &Progress| {
            meter.show(progress);
            let row = LearningRow::from(progress);
            log_failure = log.update(&row).err();
            rows.push(row);
            if task.output.snapshots.contains(&progress.update) {
                kept.push((progress.update, simulation.rollout(&progress.weights)));
            }
            log_failure.is_none() && !INTERRUPTED.load(Ordering::Relaxed)
        };
        watch_for_ctrl_c();
        let started = Instant::now();
        let method = task.learning.method();
        let learned = hpf_learn::learn_with(&simulation, weights, &method, task.learning.max_rollouts, observe);
        let time = started.elapsed();
        meter.finish();
        if let Some(error) = log_failure {
            return Err(while_writing(&log_path)(error));
        }
        let (history, failure) = match learned {
            Ok(history) => (history, None),
            Err(refused @ (LearnError::BadStart | LearnError::NoSignals)) => return Err(bad_task(&refused)),
            Err(LearnError::Update { reason, history }) => (*history, Some(reason.to_string())),
        };
        let mut policy = start.with_weights(&history.best.weights);
        policy.provenance.task_sha256 = sha256(&loaded.text);
        policy.provenance.updates = history.best.update;
        policy.provenance.cost = history.best.total;
        let trajectory = simulation.rollout(&history.best.weights);
        let run = Run { task: task.clone(), policy, learning: rows, trajectory, snapshots: kept };
        Ok(Self { run, history, simulation, time, failure })
    }

    fn stopped_because(&self, task: &Task) -> String {
        match (&self.failure, self.history.stop) {
            (Some(reason), _) => reason.clone(),
            (None, Stop::Updates) => "all updates were made".into(),
            (None, Stop::Rollouts) => {
                format!("the next update would pass max_rollouts = {}", task.learning.max_rollouts.unwrap_or_default())
            }
            (None, Stop::Asked) => "it was interrupted".into(),
            (None, Stop::Settled(reason)) => reason.to_string(),
        }
    }
}

/// Writes everything that was learned, and says what it came to.
fn save(loaded: &LoadedTask, learned: &Learned, folder: &mut Unfinished, started: Instant) -> Result<Summary, Failure> {
    let Learned { run, history, simulation, .. } = learned;
    let (_, metrics) = simulation.evaluate(&history.best.weights);
    let policy = results::save(run, &loaded.text, &metrics, folder)?;
    let summary = Summary {
        task: run.task.name.clone(),
        task_sha256: sha256(&loaded.text),
        policy_sha256: sha256(&policy),
        method: run.task.learning.method.name(),
        seed: run.task.learning.seed,
        threads: rayon::current_num_threads(),
        updates: history.updates,
        best_update: history.best.update,
        rollouts: history.rollouts,
        learning_s: learned.time.as_secs_f64(),
        total_s: started.elapsed().as_secs_f64(),
        initial: (history.initial.total, history.initial.terms.clone()),
        last: (history.best.total, history.best.terms.clone()),
        metrics,
        rejected: history.rejected,
        stopped_because: learned.stopped_because(&run.task),
    };
    folder.write("summary.json", format!("{:#}\n", summary.to_json()))?;
    Ok(summary)
}

/// From now on the first Ctrl-C ends learning after the running update, the second ends the program.
fn watch_for_ctrl_c() {
    let handler = || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    };
    // Without a handler Ctrl-C still ends the program: nothing under a final name is half-written.
    let _ = ctrlc::set_handler(handler);
}
