//! An environment that is another program: a simulator, a ROS node, a robot. See docs/process.md.
//!
//! hpf starts `workers` of them once and talks JSON lines with each: a rollout out, its costs or its trace back. A worker
//! that is late, ends or answers what is no answer is replaced, and its rollout made again.

mod protocol;
mod worker;

use core::sync::atomic::{AtomicU64, Ordering};
use core::time::Duration;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use hpf_learn::{Block, Cost, Draws, Parameters, Problem, SignalModel};
use hpf_sim::task::{Process as Settings, Task};
use hpf_sim::{Policy, Simulation, Trace};

use self::protocol::{Answer, Kind};
use self::worker::Worker;
use crate::failure::Failure;
use crate::progress::tell;

/// A task whose rollouts are made by processes.
pub struct Process<'s> {
    /// What the motion is as planned, and what a trace costs.
    simulation: &'s Simulation,
    settings: Settings,
    hello: protocol::Hello,
    /// What the workers answer with.
    kind: Kind,
    /// The workers without a rollout.
    free: Mutex<Vec<Worker>>,
    freed: Condvar,
    next: AtomicU64,
    /// Why no more rollouts are made.
    failure: Mutex<Option<String>>,
}

/// The contents of a lock: what panicked elsewhere has left them whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<'s> Process<'s> {
    /// Starts the workers of `task`; `policy` is the one that learning starts from.
    ///
    /// # Errors
    /// [`Failure::Input`] that says why a worker did not start, or why the task does not go with what they answer.
    pub fn start(
        settings: &Settings,
        task: &Task,
        policy: &Policy,
        simulation: &'s Simulation,
    ) -> Result<Self, Failure> {
        let hello = protocol::Hello::new(task, policy);
        let workers = (1..=settings.workers).map(|number| Worker::spawn(number, settings, &hello));
        let mut workers = workers.collect::<Result<Vec<Worker>, String>>().map_err(Failure::Input)?;
        let timeout = Duration::from_secs_f64(settings.timeout);
        let kinds = workers.iter_mut().map(|worker| worker.ready(timeout).map_err(|why| worker.blame(&why)));
        let kinds = kinds.collect::<Result<Vec<Kind>, String>>().map_err(Failure::Input)?;
        let kind = kinds[0];
        if kinds.iter().any(|other| *other != kind) {
            return Err(Failure::Input(format!("`{}`: its workers do not all answer alike", settings.command[0])));
        }
        let has_targets = task.accept != hpf_sim::task::Accept::default();
        if kind == Kind::Costs && has_targets {
            let why = "answers with costs, and the targets of [accept] need traces";
            return Err(Failure::Input(format!("`{}` {why}", settings.command[0])));
        }
        if kind == Kind::Trace && task.cost == hpf_sim::task::CostWeights::default() {
            let why = "answers with traces, and no term of [cost] has a weight";
            return Err(Failure::Input(format!("`{}` {why}", settings.command[0])));
        }
        Ok(Self {
            simulation,
            settings: settings.clone(),
            hello,
            kind,
            free: Mutex::new(workers),
            freed: Condvar::new(),
            next: AtomicU64::new(1),
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

    /// One more motion, for its trace.
    ///
    /// # Errors
    /// [`Failure::Work`] where it failed.
    pub fn motion(&self, weights: &[f64]) -> Result<Trace, Failure> {
        let mut trace = self.simulation.blank_trace();
        match self.answer(Draws::HeldOut, Parameters::Constant(weights), &mut trace) {
            Some(Answer::Trace) => Ok(trace),
            Some(Answer::Failed(why)) => Err(Failure::Work(format!("the motion that was learned failed: {why}"))),
            _ => Err(Failure::Work(self.failure().unwrap_or_default())),
        }
    }

    /// Makes one rollout; `trace` is as planned before it and as measured after it. `None` where nobody can make it.
    fn answer(&self, draws: Draws, parameters: Parameters<'_>, trace: &mut Trace) -> Option<Answer> {
        if self.failure().is_some() {
            return None;
        }
        self.simulation.rollout_into(parameters, trace);
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        let request = protocol::request(id, draws, parameters, self.simulation.blocks(), trace, &self.hello);
        let mut worker = self.take();
        let timeout = Duration::from_secs_f64(self.settings.timeout);
        for attempt in 1..=self.settings.tries {
            let answer = worker.ask(&request, timeout).and_then(|line| protocol::answer(&line, id, self.kind, trace));
            let why = match answer {
                Ok(answer) => {
                    if let Answer::Failed(why) = &answer {
                        tell(&worker.blame(&format!("rollout {id} failed: {why}")));
                    }
                    self.give(worker);
                    return Some(answer);
                }
                Err(why) => worker.blame(&why),
            };
            if attempt == self.settings.tries {
                self.give_up(format!("{why}; rollout {id} was tried {attempt} times"), worker);
                return None;
            }
            tell(&format!("{why}; rollout {id} is made again by a new one"));
            if let Err(why) = worker.replace(&self.settings, &self.hello, self.kind, timeout) {
                self.give_up(why, worker);
                return None;
            }
        }
        None
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

    fn give(&self, worker: Worker) {
        lock(&self.free).push(worker);
        self.freed.notify_one();
    }

    fn give_up(&self, why: String, worker: Worker) {
        lock(&self.failure).get_or_insert(why);
        self.give(worker);
    }
}

impl Problem for Process<'_> {
    type Workspace = Trace;

    fn blocks(&self) -> &[Block] {
        self.simulation.blocks()
    }

    fn steps(&self) -> usize {
        self.simulation.steps()
    }

    fn terms(&self) -> &[&'static str] {
        self.simulation.terms()
    }

    fn workspace(&self) -> Trace {
        self.simulation.blank_trace()
    }

    fn rollout(&self, draws: Draws, parameters: Parameters<'_>, trace: &mut Trace, cost: &mut Cost) {
        let blank = || Cost { running: vec![0.0; self.steps()], terminal: 0.0, terms: vec![0.0; self.terms().len()] };
        *cost = match self.answer(draws, parameters, trace) {
            Some(Answer::Trace) => self.simulation.cost(trace),
            Some(Answer::Total(terminal)) => Cost { terminal, ..blank() },
            Some(Answer::Steps(running, terminal)) => Cost { running, terminal, ..blank() },
            Some(Answer::Failed(_)) | None => Cost { terminal: f64::NAN, ..blank() },
        };
    }

    fn signals(&self) -> Option<&SignalModel> {
        if self.leaves_traces() { Problem::signals(self.simulation) } else { None }
    }

    fn measure(
        &self,
        draws: Draws,
        parameters: Parameters<'_>,
        trace: &mut Trace,
        cost: &mut Cost,
        signals: &mut Vec<f64>,
    ) {
        self.rollout(draws, parameters, trace, cost);
        // Of a failed rollout these are of the plan; its cost says that they are none.
        self.simulation.signals_into(trace, signals);
    }
}
