//! An environment that is another program: a simulator, a ROS node, a robot. See docs/process.md.
//!
//! hpf starts `workers` of them once and exchanges lines of JSON with each: it sends a rollout, and receives its costs or
//! its trace. A worker that is late, ends or gives no valid answer is ended with all that it started; then it is replaced,
//! and its rollout made again. A rollout that fails in every try is rejected; learning ends where too many are.

mod group;
mod protocol;
mod worker;

use core::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use core::time::Duration;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;

use hpf_learn::{Block, Cost, Draws, Model, Parameters, Problem, SignalModel, Wants};
use hpf_sim::task::{Process as Settings, Task};
use hpf_sim::{Policy, Simulation, Trace};

use self::protocol::Answer;
use self::worker::{PARTING, Worker};
use crate::answers::{Kind, half_square};
use crate::failure::Failure;
use crate::watch::Watch;

/// A task whose rollouts are made by processes.
pub struct Process<'s> {
    watch: &'s dyn Watch,
    /// What the motion is as planned, and what a trace costs.
    simulation: &'s Simulation,
    settings: Settings,
    hello: protocol::Hello,
    /// What the answers of the workers contain.
    kind: Kind,
    /// The signals of a rollout, where its workers answer with residuals.
    residuals: Option<SignalModel>,
    /// The workers without a rollout.
    free: Mutex<Vec<Worker>>,
    freed: Condvar,
    next: AtomicU64,
    /// Whether a rollout was ever answered.
    answered: AtomicBool,
    /// Rollouts rejected.
    lost: AtomicUsize,
    /// Why no more rollouts are made.
    failure: Mutex<Option<String>>,
}

/// The contents of a lock; a panic elsewhere leaves them whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ends workers side by side, each after it had `patience` to end without a signal.
fn end_all(workers: &mut [Worker], patience: Duration, watch: &dyn Watch) {
    thread::scope(|scope| {
        for worker in workers {
            scope.spawn(move || {
                if let Err(why) = worker.end(patience, watch) {
                    watch.note(&why);
                }
            });
        }
    });
}

/// Starts `workers` and says what all of them answer with.
fn start_all(
    workers: &mut [Worker],
    settings: &Settings,
    hello: &protocol::Hello,
    watch: &dyn Watch,
) -> Result<Kind, String> {
    for worker in workers.iter_mut() {
        if watch.is_asked() {
            return Err("was broken off".into());
        }
        worker.spawn(settings, hello)?;
    }
    let timeout = Duration::from_secs_f64(settings.timeout);
    let kinds = workers.iter_mut().map(|worker| worker.ready(hello, timeout, watch).map_err(|why| worker.blame(&why)));
    let kinds = kinds.collect::<Result<Vec<Kind>, String>>()?;
    match kinds.iter().find(|kind| **kind != kinds[0]) {
        Some(_) => Err(format!("`{}`: its workers do not all answer alike", settings.command[0])),
        None => Ok(kinds[0]),
    }
}

impl<'s> Process<'s> {
    /// Starts the workers of `task`; `policy` is the one that learning starts from.
    ///
    /// # Errors
    /// [`Failure::Input`] that says why a worker did not start, or why the task does not go with what they answer;
    /// [`Failure::Interrupted`].
    pub fn start(
        settings: &Settings,
        task: &Task,
        policy: &Policy,
        simulation: &'s Simulation,
        watch: &'s dyn Watch,
    ) -> Result<Self, Failure> {
        watch.hold(true);
        let hello = protocol::Hello::new(task, policy);
        let mut workers: Vec<Worker> = (1..=settings.workers).map(Worker::new).collect();
        let started = start_all(&mut workers, settings, &hello, watch).and_then(|kind| match kind.misfit(task) {
            Some(why) => Err(format!("`{}` {why}", settings.command[0])),
            None => Ok(kind),
        });
        let kind = started.map_err(|why| {
            end_all(&mut workers, Duration::ZERO, watch);
            watch.hold(false);
            if watch.is_asked() {
                Failure::Interrupted("the processes are ended; no motion was made".into())
            } else {
                Failure::Input(why)
            }
        })?;
        Ok(Self {
            watch,
            simulation,
            settings: settings.clone(),
            hello,
            kind,
            residuals: kind.residual_model(simulation.blocks()),
            free: Mutex::new(workers),
            freed: Condvar::new(),
            next: AtomicU64::new(1),
            answered: AtomicBool::new(false),
            lost: AtomicUsize::new(0),
            failure: Mutex::new(None),
        })
    }

    /// Whether rollouts leave traces.
    pub fn leaves_traces(&self) -> bool {
        self.kind == Kind::Trace
    }

    /// Workers at work at the same time.
    pub fn workers(&self) -> usize {
        self.settings.workers
    }

    /// Why no more rollouts are made, once that is so.
    pub fn failure(&self) -> Option<String> {
        lock(&self.failure).clone()
    }

    /// One more motion, for its trace; `Err` in the answer says why it failed.
    ///
    /// # Errors
    /// [`Failure::Work`] where no motion can be made, [`Failure::Interrupted`].
    pub fn motion(&self, weights: &[f64]) -> Result<Result<Trace, String>, Failure> {
        let mut trace = self.simulation.blank_trace();
        match self.answer(Draws::HeldOut, Parameters::Constant(weights), &mut trace) {
            Some(Answer::Trace) if !self.simulation.cost(&trace).total().is_finite() => {
                Ok(Err("its trace has no finite cost".into()))
            }
            Some(Answer::Trace) => Ok(Ok(trace)),
            Some(Answer::Failed(why)) => Ok(Err(why)),
            _ => Err(match self.failure() {
                Some(why) => Failure::Work(why),
                None => Failure::Interrupted("what was learned is not moved yet".into()),
            }),
        }
    }

    /// Makes one rollout; `trace` is as planned before it and as measured after it. `None` where no worker is left.
    fn answer(&self, draws: Draws, parameters: Parameters<'_>, trace: &mut Trace) -> Option<Answer> {
        if self.is_stopped() {
            return None;
        }
        self.simulation.rollout_into(parameters, trace);
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        let request = protocol::request(id, draws, parameters, self.simulation.blocks(), trace, &self.hello);
        let mut worker = self.take();
        let answer = self.answer_of(&mut worker, id, &request, trace);
        lock(&self.free).push(worker);
        self.freed.notify_one();
        answer
    }

    /// The answer of `worker`, or of those that replace it, to rollout `id`.
    fn answer_of(&self, worker: &mut Worker, id: u64, request: &str, trace: &mut Trace) -> Option<Answer> {
        let Settings { timeout, tries, .. } = self.settings;
        let timeout = Duration::from_secs_f64(timeout);
        let (mut starts, mut attempts) = (0, 0);
        let mut is_misshapen = false;
        // Nothing is started and nothing is moved any more where it is to end.
        while !self.is_stopped() {
            let is_start = !worker.is_running();
            let done = if is_start {
                worker.start(&self.settings, &self.hello, self.kind, timeout, self.watch).map(|()| None)
            } else {
                let line = worker.ask(request, timeout, self.watch);
                let answer = line.map(|line| protocol::answer(&line, id, self.kind, trace));
                is_misshapen = matches!(answer, Ok(Err(_)));
                answer.flatten().map(Some)
            };
            let why = match done {
                Ok(None) => continue,
                Ok(Some(answer)) => {
                    self.answered.store(true, Ordering::Relaxed);
                    if let Answer::Failed(why) = &answer {
                        self.watch.note(&worker.blame(&format!("rollout {id} failed: {why}")));
                    }
                    return Some(answer);
                }
                Err(why) => worker.blame(&why),
            };
            // The old one must be gone, with all it started, before a new one takes hold of the same robot.
            if let Err(left) = worker.end(Duration::ZERO, self.watch) {
                self.give_up(format!("{why}; {left}"));
                return None;
            }
            let count = if is_start { &mut starts } else { &mut attempts };
            *count += 1;
            let (is_last, is_stopped) = (*count == tries, self.is_stopped());
            match (is_start, is_last) {
                _ if is_stopped => self.watch.note(&why),
                (true, true) => self.give_up(format!("{why}; it was started {tries} times")),
                (true, false) => self.watch.note(&format!("{why}; it is started again")),
                // Another motion would be answered like that too.
                (false, true) if is_misshapen && !self.answered.load(Ordering::Relaxed) => self
                    .give_up(format!("{why}; rollout {id} was tried {tries} times, and none was ever answered right")),
                (false, true) => return self.lose(&why, id),
                (false, false) => self.watch.note(&format!("{why}; rollout {id} is made again by a new one")),
            }
        }
        None
    }

    /// Rejects rollout `id`, whose last try failed because of `why`, or ends learning.
    fn lose(&self, why: &str, id: u64) -> Option<Answer> {
        let Settings { tries, max_lost, .. } = self.settings;
        let what = format!("{why}; rollout {id} was tried {tries} times");
        let lost = self.lost.fetch_add(1, Ordering::Relaxed) + 1;
        if lost > max_lost {
            self.give_up(format!("{what}, and environment.max_lost = {max_lost} were given up before"));
            return None;
        }
        self.watch.note(&format!("{what} and is given up, as {lost} of at most {max_lost}"));
        Some(Answer::Failed(what))
    }

    fn take(&self) -> Worker {
        let mut free = lock(&self.free);
        loop {
            if let Some(worker) = free.pop() {
                return worker;
            }
            free = self.freed.wait(free).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn give_up(&self, why: String) {
        lock(&self.failure).get_or_insert(why);
    }
}

impl Drop for Process<'_> {
    fn drop(&mut self) {
        end_all(&mut lock(&self.free), PARTING, self.watch);
        self.watch.hold(false);
    }
}

/// What a rollout left.
#[derive(Debug)]
pub struct Motion {
    /// As measured; as planned, where nothing was.
    trace: Trace,
    residuals: Vec<f64>,
}

impl Problem for Process<'_> {
    type Workspace = Motion;

    fn blocks(&self) -> &[Block] {
        self.simulation.blocks()
    }

    fn steps(&self) -> usize {
        self.simulation.steps()
    }

    fn terms(&self) -> &[&'static str] {
        self.simulation.terms()
    }

    fn workspace(&self) -> Motion {
        Motion { trace: self.simulation.blank_trace(), residuals: Vec::new() }
    }

    fn rollout(&self, draws: Draws, parameters: Parameters<'_>, motion: &mut Motion, cost: &mut Cost) {
        let blank = || Cost { running: vec![0.0; self.steps()], terminal: 0.0, terms: vec![0.0; self.terms().len()] };
        *cost = match self.answer(draws, parameters, &mut motion.trace) {
            Some(Answer::Trace) => self.simulation.cost(&motion.trace),
            Some(Answer::Total(terminal)) => Cost { terminal, ..blank() },
            Some(Answer::Steps(running, terminal)) => Cost { running, terminal, ..blank() },
            Some(Answer::Residuals(residuals)) => {
                motion.residuals = residuals;
                Cost { terminal: half_square(&motion.residuals), ..blank() }
            }
            Some(Answer::Failed(_)) | None => Cost { terminal: f64::NAN, ..blank() },
        };
    }

    fn is_stopped(&self) -> bool {
        self.watch.is_asked() || lock(&self.failure).is_some()
    }

    fn may_start_fail(&self) -> bool {
        true
    }

    fn signals(&self) -> Option<&SignalModel> {
        match self.kind {
            Kind::Trace => Problem::signals(self.simulation),
            Kind::Residuals(_) => self.residuals.as_ref(),
            Kind::Costs => None,
        }
    }

    fn measure(
        &self,
        draws: Draws,
        parameters: Parameters<'_>,
        motion: &mut Motion,
        cost: &mut Cost,
        signals: &mut Vec<f64>,
    ) {
        self.rollout(draws, parameters, motion, cost);
        // Of a failed rollout these are of the plan, or of another rollout; its cost says that they are none.
        match self.kind {
            Kind::Residuals(count) => {
                signals.clone_from(&motion.residuals);
                signals.resize(count, 0.0);
            }
            Kind::Trace | Kind::Costs => self.simulation.signals_into(&motion.trace, signals),
        }
    }

    fn model(&self) -> Option<Box<dyn Model>> {
        if self.leaves_traces() { self.simulation.model() } else { None }
    }

    fn observe(
        &self,
        (draws, _): (Draws, usize),
        parameters: Parameters<'_>,
        wants: Wants,
        motion: &mut Motion,
        cost: &mut Cost,
        shown: &mut Vec<f64>,
    ) {
        match wants {
            Wants::Costs => {
                self.rollout(draws, parameters, motion, cost);
                shown.clear();
            }
            Wants::Signals => self.measure(draws, parameters, motion, cost, shown),
            Wants::Motion => {
                self.rollout(draws, parameters, motion, cost);
                self.simulation.motion_into(&motion.trace, shown);
            }
        }
    }
}
