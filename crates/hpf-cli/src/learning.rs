//! Learning a task into a folder, from its beginning or from where it was broken off.

use core::fmt::Display;
use core::sync::atomic::{AtomicBool, Ordering};
use core::time::Duration;
use std::fs;
use std::time::Instant;

use hpf_learn::{Driver, History, LearnError, Problem, Progress, Session, Stop};
use hpf_sim::task::Task;
use hpf_sim::{Policy, Simulation, Trace};

use crate::checkpoint::Checkpoint;
use crate::directory::{CHECKPOINT, Unfinished};
use crate::failure::Failure;
use crate::files::{LoadedTask, sha256, while_writing};
use crate::log::{Head, Log};
use crate::progress::{Meter, tell};
use crate::results::{LearningRow, Run};

/// Set by Ctrl-C: learning ends after the running update.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// What learning came to.
pub struct Learned {
    /// All that is kept of it.
    pub run: Run,
    /// How it went.
    pub history: History,
    /// What was learned in.
    pub simulation: Simulation,
    /// Wall time, of this session if there were several.
    pub time: Duration,
    /// Why learning broke off, if it did.
    pub failure: Option<String>,
}

/// The evaluations so far, and what is kept of them.
struct Kept<'l> {
    task: &'l Task,
    simulation: &'l Simulation,
    rows: Vec<LearningRow>,
    snapshots: Vec<(usize, Trace)>,
}

impl Kept<'_> {
    fn take(&mut self, progress: &Progress) {
        self.rows.push(LearningRow::from(progress));
        if self.task.output.snapshots.contains(&progress.update) {
            self.snapshots.push((progress.update, self.simulation.rollout(&progress.weights)));
        }
    }
}

/// Learns the task of `loaded` in `folder`, from its checkpoint where there is one. Each batch is in the checkpoint, and
/// each update in the log, before the next begins.
///
/// # Errors
/// [`Failure`] where the task cannot be learned, or the folder not be written.
pub fn learn(loaded: &LoadedTask, folder: &mut Unfinished, quiet: bool) -> Result<Learned, Failure> {
    let task = &loaded.task;
    let bad_task = |error: &dyn Display| Failure::Input(format!("{}: {error}", task.name));
    let start = Policy::initial(task).map_err(|error| bad_task(&error))?;
    let simulation = Simulation::new(task, &start).map_err(|error| bad_task(&error))?;
    let weights = simulation.starting_weights(&start).map_err(|error| bad_task(&error))?;
    let first_policy = start.clone().with_weights(&weights).to_json();
    let head = Head::new(task, &loaded.text, &first_policy);

    let method = task.learning.method();
    let session = Session::begin(&simulation, weights, &method, task.learning.max_rollouts);
    let mut session = session.map_err(|error| bad_task(&error))?;
    let mut kept = Kept { task, simulation: &simulation, rows: Vec::new(), snapshots: Vec::new() };
    let mut checkpoint = restore(loaded, folder, &mut session, &mut kept)?;

    watch_for_ctrl_c();
    let mut meter = Meter::new(&task.name, task.learning.updates, task.learning.rollouts, quiet);
    let started = Instant::now();
    let learned = go_on(&simulation, &mut session, &mut kept, (&mut checkpoint, &head), folder, &mut meter);
    let time = started.elapsed();
    meter.finish();
    let (history, failure) = match learned? {
        Ok(()) => (session.history(), None),
        Err(LearnError::Update { reason, history }) => (*history, Some(reason.to_string())),
        Err(refused) => return Err(bad_task(&refused)),
    };
    let Kept { rows, snapshots, .. } = kept;
    let mut policy = start.with_weights(&history.best.weights);
    policy.provenance.task_sha256 = sha256(&loaded.text);
    policy.provenance.updates = history.best.update;
    policy.provenance.cost = history.best.total;
    let trajectory = simulation.rollout(&history.best.weights);
    let run = Run { task: task.clone(), policy, learning: rows, trajectory, snapshots };
    Ok(Learned { run, history, simulation, time, failure })
}

/// Brings `session` to where the checkpoint of the folder is; begins one where there is none.
fn restore(
    loaded: &LoadedTask,
    folder: &mut Unfinished,
    session: &mut Session,
    kept: &mut Kept<'_>,
) -> Result<Checkpoint, Failure> {
    let path = folder.path(CHECKPOINT);
    let task = sha256(&loaded.text);
    if !path.is_file() {
        let checkpoint = Checkpoint::create(&path, &task)?;
        folder.ready()?;
        return Ok(checkpoint);
    }
    let (checkpoint, damaged) = Checkpoint::open(&path, &task, |record| {
        let progress = session.replay(&record);
        let progress = progress.map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?;
        progress.iter().for_each(|progress| kept.take(progress));
        Ok(())
    })?;
    if damaged > 0 {
        let update = session.history().updates;
        let what = "the motions after that are made again";
        tell(&format!("{}: the last {damaged} bytes, after update {update}, are damaged; {what}", path.display()));
    }
    Ok(checkpoint)
}

/// Learns until it is over or interrupted.
fn go_on<P: Problem>(
    problem: &P,
    session: &mut Session,
    kept: &mut Kept<'_>,
    (checkpoint, head): (&mut Checkpoint, &Head<'_>),
    folder: &mut Unfinished,
    meter: &mut Meter,
) -> Result<Result<(), LearnError>, Failure> {
    let path = folder.path("log.mcap.partial");
    let mut log = log_so_far(head, &kept.rows, folder)?;
    let mut driver = Driver::new(problem);
    while !(INTERRUPTED.load(Ordering::Relaxed) && session.is_evaluated()) {
        let told = match driver.step(session) {
            Ok(Some(told)) => told,
            Ok(None) => break,
            Err(error) => return Ok(Err(error)),
        };
        if let Some(progress) = &told.progress {
            meter.show(progress);
            kept.take(progress);
            let row = kept.rows.last().expect("one was added");
            log.update(row).map_err(while_writing(&path))?;
        }
        checkpoint.append(&told.record)?;
        folder.keep_for_resume();
    }
    Ok(Ok(()))
}

/// The log of learning with the updates so far: under its own name only once they are all in it.
fn log_so_far(head: &Head<'_>, rows: &[LearningRow], folder: &Unfinished) -> Result<Log, Failure> {
    let (own, begun) = (folder.path("log.mcap.partial"), folder.path("log.mcap.partial.begun"));
    let write = || {
        let mut log = Log::create(&begun, head)?;
        rows.iter().try_for_each(|row| log.update(row))?;
        fs::rename(&begun, &own)?;
        Ok(log)
    };
    write().map_err(while_writing::<std::io::Error>(&own))
}

impl Learned {
    /// Whether it was interrupted and can go on.
    pub fn is_open(&self) -> bool {
        self.failure.is_none() && self.history.stop == Stop::Asked
    }

    /// Why it ended, for the summary.
    pub fn stopped_because(&self, task: &Task) -> String {
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
