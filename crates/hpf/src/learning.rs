//! Learning a task into a folder, from its beginning or from its checkpoint.

#[cfg(feature = "logs")]
mod live_log;

use core::fmt::Display;
use core::time::Duration;
use std::time::Instant;

use hpf_learn::{
    History, LearnError, LearningLoop, Problem, Progress, Record, Session, TellOutcome, TerminationReason,
};
use hpf_sim::task::{Environment, Task};
use hpf_sim::{Metric, Policy, Simulation, Trace};

use crate::checkpoint::{Checkpoint, Input};
use crate::directory::{CHECKPOINT, Unfinished};
use crate::failure::Failure;
use crate::files::{LoadedTask, read_text, sha256};
use crate::outside::{Kind, Maker, Outside};
use crate::process::Process;
use crate::results::{LearningRow, Run, own_tables};
use crate::start::{self, START};
use crate::watch::Watch;

/// The result of learning.
pub struct Learned {
    /// All that is kept of it.
    pub run: Run,
    /// How it went.
    pub history: History,
    /// Measures of its motion.
    pub metrics: Vec<Metric>,
    /// Wall time; of a resumed run, since it was resumed.
    pub time: Duration,
    /// Why learning failed, if it did.
    pub failure: Option<String>,
    /// Why the log that is written during learning failed, if it did.
    pub log_failure: Option<String>,
    /// Whether its motion is the planned one, because the one that was made is not known.
    is_planned: bool,
    /// Whether the cause of a failure can be removed, so that learning can be resumed.
    is_mendable: bool,
}

/// The evaluations so far, and their snapshots.
struct Kept<'l> {
    task: &'l Task,
    simulation: &'l Simulation,
    rows: Vec<LearningRow>,
    snapshots: Vec<(usize, Trace)>,
}

impl Kept<'_> {
    fn take(&mut self, progress: &Progress) -> &LearningRow {
        if self.task.snapshots().contains(&progress.update) {
            self.snapshots.push((progress.update, self.simulation.rollout(&progress.weights)));
        }
        self.rows.push(LearningRow::from(progress));
        self.rows.last().expect("one was added")
    }
}

/// Learns the task of `loaded` in `folder`, from its checkpoint where there is one; or in memory, where there is no folder.
/// Each batch is in the checkpoint, and each update in the log, before learning continues.
///
/// # Errors
/// [`Failure`] where the task cannot be learned, or the folder not be written.
pub fn learn(loaded: &LoadedTask, folder: Option<&mut Unfinished>, watch: &dyn Watch) -> Result<Learned, Failure> {
    let named = folder.as_ref().map(|folder| folder.path(START)).filter(|named| named.is_file());
    let start = start::policy(&loaded.task, named.as_deref())?;
    learn_from(loaded, start, folder, watch, None)
}

/// [`learn`] from the policy `start`, which is the one in `folder` where there is one; where there is a `maker`, it makes
/// the rollouts of a task that hpf does not simulate, in place of the process named there.
///
/// # Errors
/// As for [`learn`].
pub fn learn_from(
    loaded: &LoadedTask,
    start: Policy,
    mut folder: Option<&mut Unfinished>,
    watch: &dyn Watch,
    maker: Option<&dyn Maker>,
) -> Result<Learned, Failure> {
    let task = &loaded.task;
    let simulation = Simulation::new(&task.as_planned(), &start).map_err(|error| bad_task(task, &error))?;
    let weights = simulation.starting_weights(&start).map_err(|error| bad_task(task, &error))?;
    let start = start.with_weights(&weights).map_err(|error| bad_task(task, &error))?;
    if task.environment.is_some() && task.cost.rest.values().iter().any(|weight| *weight > 0.0) {
        watch.note("note: motions made outside of hpf end at the duration: `cost.rest` counts for nothing");
    }
    let mut learned = match (&task.environment, maker) {
        (None, None) => {
            let steps = |session| LearningLoop::new(&simulation, session);
            learn_in(&simulation, steps, (loaded, &start), (&simulation, folder), watch, &|| None)?
        }
        (None, Some(_)) => {
            let message = "its motions are simulated: rollouts made elsewhere need an [environment]";
            return Err(bad_task(task, &message));
        }
        (Some(_), Some(maker)) => {
            let outside = Outside::new(task, &simulation, maker, watch)?;
            let (plan, steps) = (outside.plan(), |session| outside.steps(session));
            let failure = || outside.failure();
            let mut learned = learn_in(plan, steps, (loaded, &start), (&simulation, folder), watch, &failure)?;
            learned.show_motion(maker.kind() == Kind::Trace, |weights| Ok(outside.motion(weights)))?;
            learned
        }
        (Some(Environment::Process(settings)), None) => {
            let process = Process::start(settings, task, &start, &simulation, watch)?;
            let pool = rayon::ThreadPoolBuilder::new().num_threads(process.workers()).build();
            let pool = pool.map_err(|error| Failure::Work(format!("cannot start threads: {error}")))?;
            let mut learned = pool.install(|| {
                let steps = |session| LearningLoop::new(&process, session);
                let failure = || process.failure();
                learn_in(&process, steps, (loaded, &start), (&simulation, folder.take()), watch, &failure)
            })?;
            learned.show_motion(process.leaves_traces(), |weights| process.motion(weights))?;
            learned
        }
    };
    learned.metrics = match &task.environment {
        None => simulation.evaluate(&learned.history.best.weights).1,
        Some(_) => simulation.metrics(&learned.run.trajectory),
    };
    if learned.is_planned {
        // Of a motion that was only planned, the gains are all that can be measured.
        let is_gain = |metric: &Metric| ["stiffness", "damping"].iter().any(|name| metric.name.starts_with(name));
        learned.metrics.retain(is_gain);
    }
    Ok(learned)
}

fn bad_task(task: &Task, error: &dyn Display) -> Failure {
    Failure::Input(format!("{}: {error}", task.name))
}

/// What brings a session on: makes the motions that it asks for, and tells what came of them.
pub(crate) trait Steps {
    /// The session, told of all that was handed out.
    fn session(&self) -> &Session;

    /// What came of the motions asked for next; `None` where learning is over.
    fn step(&mut self) -> Result<Option<TellOutcome>, LearnError>;
}

impl<P: Problem> Steps for LearningLoop<'_, P> {
    fn session(&self) -> &Session {
        LearningLoop::session(self)
    }

    fn step(&mut self) -> Result<Option<TellOutcome>, LearnError> {
        LearningLoop::step(self)
    }
}

/// Learns `problem` by `steps`, whose motions as planned are those of `simulation`, until it is over, interrupted, or
/// `failure` says that no more motions can be made.
fn learn_in<P: Problem, S: Steps>(
    problem: &P,
    steps: impl FnOnce(Session) -> S,
    (loaded, start): (&LoadedTask, &Policy),
    (simulation, mut folder): (&Simulation, Option<&mut Unfinished>),
    watch: &dyn Watch,
    failure: &dyn Fn() -> Option<String>,
) -> Result<Learned, Failure> {
    let task = &loaded.task;
    let session =
        Session::begin(problem, simulation.parameters(start), &task.learning.method(), task.learning.max_rollouts);
    let mut session = session.map_err(|error| bad_task(task, &error))?;
    let mut kept = Kept { task, simulation, rows: Vec::new(), snapshots: Vec::new() };
    let mut record = match &mut folder {
        Some(folder) => Some(OnTheWay::open((loaded, start), folder, &mut session, &mut kept, watch)?),
        None => None,
    };
    watch.begun(task);
    let started = Instant::now();
    let mut learning = steps(session);
    let mut broken = None;
    while !(watch.is_asked() && learning.session().is_evaluated()) {
        let outcome = match learning.step() {
            Ok(Some(outcome)) => outcome,
            Ok(None) => break,
            Err(LearnError::Stopped) => match failure() {
                // What a folder keeps can go on; without one there is what was learned until here.
                Some(why) if folder.is_none() && learning.session().history().best.total.is_finite() => {
                    broken = Some((why, learning.session().history()));
                    break;
                }
                Some(why) => return Err(Failure::Work(why)),
                None if learning.session().history().best.total.is_finite() => break,
                None => return Err(Failure::Interrupted("no motion has a cost yet".into())),
            },
            Err(LearnError::Update { reason, history }) => {
                broken = Some((reason.to_string(), *history));
                break;
            }
            Err(refused) => {
                if let Some(folder) = folder.filter(|_| !learning.session().history().best.total.is_finite()) {
                    folder.forget();
                }
                return Err(bad_task(task, &refused));
            }
        };
        let row = outcome.progress.as_ref().map(|progress| kept.take(progress));
        row.inspect(|row| watch.evaluated(row));
        if let (Some(record), Some(folder)) = (&mut record, &mut folder) {
            record.append(&outcome.record, row, watch)?;
            folder.keep_for_resume();
        }
    }
    let time = started.elapsed();
    let log_failure = record.and_then(OnTheWay::log_failure);

    let (failure, history) = match broken {
        Some((reason, history)) => (Some(reason), history),
        None => (None, learning.session().history()),
    };
    let Kept { rows, snapshots, .. } = kept;
    let run = Run::learned(loaded, start.clone(), simulation, &history.best, rows, snapshots);
    Ok(Learned { run, history, metrics: Vec::new(), time, failure, log_failure, is_planned: false, is_mendable: false })
}

/// The files that are written while learning goes on.
struct OnTheWay {
    checkpoint: Checkpoint,
    #[cfg(feature = "logs")]
    log: live_log::LiveLog,
}

impl OnTheWay {
    /// Brings `session` and `kept` to where the folder's checkpoint is, and begins the log anew.
    fn open(
        (loaded, start): (&LoadedTask, &Policy),
        folder: &mut Unfinished,
        session: &mut Session,
        kept: &mut Kept<'_>,
        watch: &dyn Watch,
    ) -> Result<Self, Failure> {
        let checkpoint = restore(loaded, folder, session, kept, watch)?;
        #[cfg(not(feature = "logs"))]
        let _ = start;
        Ok(Self {
            checkpoint,
            #[cfg(feature = "logs")]
            log: live_log::LiveLog::open((&loaded.task, &loaded.text), start, &kept.rows, folder),
        })
    }

    /// Adds the record of a batch, and the row of an evaluation.
    fn append(&mut self, record: &Record, row: Option<&LearningRow>, watch: &dyn Watch) -> Result<(), Failure> {
        #[cfg(feature = "logs")]
        self.log.append(row, watch);
        #[cfg(not(feature = "logs"))]
        let _ = (row, watch);
        self.checkpoint.append(record)
    }

    /// Why the log failed, if it did.
    fn log_failure(self) -> Option<String> {
        #[cfg(feature = "logs")]
        return self.log.failure();
        #[cfg(not(feature = "logs"))]
        None
    }
}

/// Brings `session` to where the checkpoint of the folder is; begins one where there is none.
fn restore(
    loaded: &LoadedTask,
    folder: &mut Unfinished,
    session: &mut Session,
    kept: &mut Kept<'_>,
    watch: &dyn Watch,
) -> Result<Checkpoint, Failure> {
    let path = folder.path(CHECKPOINT);
    let inputs = inputs(loaded, folder)?;
    if !path.is_file() {
        let checkpoint = Checkpoint::create(&path, &inputs)?;
        folder.ready()?;
        return Ok(checkpoint);
    }
    let (checkpoint, damaged) = Checkpoint::open(&path, &inputs, |record| {
        let progress = session.replay(&record);
        let progress = progress.map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?;
        if let Some(progress) = &progress {
            kept.take(progress);
        }
        Ok(())
    })?;
    if damaged > 0 {
        let update = session.history().updates;
        let what = "the motions after that are made again";
        watch
            .note(&format!("{}: the last {damaged} bytes, after update {update}, are damaged; {what}", path.display()));
    }
    Ok(checkpoint)
}

/// What decides, with the checkpoint, how learning continues: the task, its tables and the policy it starts from.
fn inputs(loaded: &LoadedTask, folder: &Unfinished) -> Result<Vec<Input>, Failure> {
    let mut inputs = vec![("task.toml".to_owned(), loaded.sha256())];
    let tables = own_tables(&mut loaded.task.clone());
    inputs.extend(tables.into_iter().map(|table| (table.name, sha256(&table.csv))));
    let start = folder.path(START);
    if start.is_file() {
        inputs.push((START.to_owned(), sha256(&read_text(&start)?)));
    }
    Ok(inputs)
}

impl Learned {
    /// Shows the motion that was learned where it can be made, by `motion`, and was not only planned.
    fn show_motion(
        &mut self,
        leaves_traces: bool,
        motion: impl FnOnce(&[f64]) -> Result<Result<Trace, String>, Failure>,
    ) -> Result<(), Failure> {
        self.is_planned = true;
        if leaves_traces && !self.is_open() && self.failure.is_none() {
            self.history.rollouts += 1;
            match motion(&self.history.best.weights)? {
                Ok(trace) => (self.run.trajectory, self.is_planned) = (trace, false),
                Err(why) => self.failure = Some(format!("the motion that was learned failed: {why}")),
            }
        }
        // An update whose motions all fail is no end of learning where a robot made them.
        self.is_mendable = true;
        Ok(())
    }

    /// Whether it can be resumed: it was interrupted, or the cause of its failure can be removed.
    pub fn is_open(&self) -> bool {
        self.history.stop == TerminationReason::Requested && (self.failure.is_none() || self.is_mendable)
    }
}
