//! Rollouts made outside of hpf and in the same program: by a function, a binding to a simulator, a person with a robot.
//!
//! The task has an `[environment]` as one whose rollouts a process makes ([`crate::process`]), and the same answers: costs,
//! traces or residuals. A [`Plan`] is what can be known without a motion, and prices answers; a [`Maker`] makes the motions that
//! learning asks for, a whole batch at a time.

use core::cell::RefCell;
use core::slice;

use hpf_learn::{Block, Cost, Draws, LearnError, Model, Parameters, Problem, Session, SignalModel, TellOutcome, Wants};
use hpf_sim::task::{ExplorationKind, Method, Preset, Task};
use hpf_sim::{Simulation, Trace};

pub use crate::answers::Kind;
use crate::answers::half_square;
use crate::failure::Failure;
use crate::learning::Steps;
use crate::watch::Watch;

/// A motion that is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Under which circumstances.
    pub draws: Draws,
    /// With which parameters, in the order of [`Simulation::parameters`].
    pub weights: Vec<f64>,
}

/// What was measured of one axis: at the start and after every step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Position of the tool [m].
    pub position: Vec<f64>,
    /// Its velocity [m/s].
    pub velocity: Vec<f64>,
    /// Force of the environment on it [N].
    pub force: Vec<f64>,
}

/// What came of a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// Its total cost.
    Total(f64),
    /// The cost of each step, and of the end.
    Steps(Vec<f64>, f64),
    /// What was measured, axis by axis.
    Trace(Vec<Measured>),
    /// Numbers, half the sum of whose squares is the cost.
    Residuals(Vec<f64>),
    /// Nothing, and why: the rollout is rejected.
    Failed(String),
}

impl Answer {
    /// What it is, in words.
    fn words(&self) -> &'static str {
        match self {
            Self::Total(_) | Self::Steps(..) => "costs",
            Self::Trace(_) => "a trace",
            Self::Residuals(_) => "residuals",
            Self::Failed(_) => "a failure",
        }
    }
}

/// Why motions were not made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Broken {
    /// Learning is to end: what was learned stays, and can go on.
    Asked,
    /// No more motions can be made, and why.
    Failed(String),
}

/// Who makes motions.
pub trait Maker: Sync {
    /// What the answers are.
    fn kind(&self) -> Kind;

    /// Makes `motions` and answers each, in their order.
    ///
    /// # Errors
    /// [`Broken`] where there are no answers.
    fn make(&self, motions: &[Motion]) -> Result<Vec<Answer>, Broken>;
}

/// What can be known of a task without making a motion.
#[derive(Clone, Debug)]
pub struct Plan {
    simulation: Simulation,
    kind: Kind,
    /// The signals of a rollout, where answers are residuals.
    residuals: Option<SignalModel>,
}

impl Plan {
    /// Of `task`, whose motions as planned are those of `simulation` and are answered by `kind`.
    ///
    /// # Errors
    /// [`Failure::Input`] where such answers do not go with the task, or its parameters change at every step.
    pub fn new(task: &Task, simulation: &Simulation, kind: Kind) -> Result<Self, Failure> {
        let refuse = |why: &str| Err(Failure::Input(format!("{}: {why}", task.name)));
        if let Some(why) = kind.misfit(task) {
            return refuse(&format!("the environment {why}"));
        }
        let learning = &task.learning;
        let explores_in_flight = match learning.exploration {
            Some(exploration) => exploration != ExplorationKind::Rollout,
            None => learning.preset == Preset::Paper,
        };
        if learning.method == Method::Pi2 && explores_in_flight {
            return refuse(
                "parameters that change at every step are no policy: set learning.exploration to \"rollout\"",
            );
        }
        Ok(Self { simulation: simulation.clone(), kind, residuals: kind.residual_model(simulation.blocks()) })
    }

    /// The simulation of motions as planned.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// What answers are.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The motions that `session` asks for next, and what it wants to know of them beside their cost; `None` where learning
    /// is over.
    pub fn ask(&self, session: &mut Session) -> Option<(Vec<Motion>, Wants)> {
        let ask = session.ask()?;
        let motion = |sample: &Parameters<'_>| Motion { draws: ask.draws, weights: sample.at(0).to_vec() };
        Some((ask.samples.iter().map(motion).collect(), ask.wants))
    }

    /// What `answers` to `motions` cost, and what is wanted of each beside.
    ///
    /// # Errors
    /// Which answer is none, and why.
    pub fn price(
        &self,
        motions: &[Motion],
        wants: Wants,
        answers: Vec<Answer>,
    ) -> Result<(Vec<Cost>, Vec<Vec<f64>>), String> {
        if answers.len() != motions.len() {
            return Err(format!("{} answers to {} motions", answers.len(), motions.len()));
        }
        let (mut costs, mut signals) = (Vec::new(), Vec::new());
        for (k, (motion, answer)) in motions.iter().zip(answers).enumerate() {
            let blame = |why: String| if motions.len() == 1 { why } else { format!("rollout {k} of the batch: {why}") };
            let (cost, of_motion) = self.price_one(motion, wants, answer).map_err(blame)?;
            costs.push(cost);
            signals.push(of_motion);
        }
        Ok((costs, signals))
    }

    fn price_one(&self, motion: &Motion, wants: Wants, answer: Answer) -> Result<(Cost, Vec<f64>), String> {
        let steps = self.simulation.step_count();
        let blank = || Cost { running: vec![0.0; steps], terminal: 0.0, terms: vec![0.0; self.terms().len()] };
        let mut signals = Vec::new();
        let cost = match (self.kind, answer) {
            (Kind::Costs, Answer::Total(terminal)) => Cost { terminal, ..blank() },
            (Kind::Costs, Answer::Steps(running, terminal)) => {
                if running.len() != steps {
                    return Err(format!("{} costs for {steps} steps", running.len()));
                }
                Cost { running, terminal, ..blank() }
            }
            (Kind::Trace, Answer::Trace(axes)) => {
                let trace = self.measured(&motion.weights, axes)?;
                self.show(&trace, wants, &mut signals);
                self.simulation.cost(&trace)
            }
            (Kind::Residuals(count), Answer::Residuals(residuals)) => {
                if residuals.len() != count {
                    return Err(format!("{} residuals, where {count} were answered before", residuals.len()));
                }
                let terminal = half_square(&residuals);
                signals = if wants == Wants::Costs { Vec::new() } else { residuals };
                Cost { terminal, ..blank() }
            }
            (kind, Answer::Failed(_)) => {
                match kind {
                    Kind::Trace => self.show(&self.simulation.rollout(&motion.weights), wants, &mut signals),
                    Kind::Residuals(count) if wants != Wants::Costs => signals = vec![0.0; count],
                    Kind::Residuals(_) | Kind::Costs => {}
                }
                Cost { terminal: f64::NAN, ..blank() }
            }
            (kind, answer) => return Err(format!("{}, where {} were answered before", answer.words(), kind.words())),
        };
        Ok((cost, signals))
    }

    /// Writes what is wanted of `trace`.
    fn show(&self, trace: &Trace, wants: Wants, shown: &mut Vec<f64>) {
        match wants {
            Wants::Costs => shown.clear(),
            Wants::Signals => self.simulation.signals_into(trace, shown),
            Wants::Motion => self.simulation.motion_into(trace, shown),
        }
    }

    /// The trace of the motion with `weights` and what was measured of it.
    ///
    /// # Errors
    /// What does not fit the task.
    pub fn measured(&self, weights: &[f64], axes: Vec<Measured>) -> Result<Trace, String> {
        let mut trace = self.simulation.rollout(weights);
        let samples = trace.steps() + 1;
        if axes.len() != trace.axes.len() {
            return Err(format!("a trace of {} axes, where the task has {}", axes.len(), trace.axes.len()));
        }
        for (signals, Measured { position, velocity, force }) in trace.axes.iter_mut().zip(axes) {
            let lists = [
                ("position", position, &mut signals.position),
                ("velocity", velocity, &mut signals.velocity),
                ("force", force, &mut signals.force),
            ];
            for (name, list, signal) in lists {
                if list.len() != samples {
                    let steps = samples - 1;
                    return Err(format!(
                        "{} numbers of {name}, where {steps} steps have {samples} samples",
                        list.len()
                    ));
                }
                *signal = list;
            }
        }
        Ok(trace)
    }
}

/// Who describes the problem to a session; the rollouts that learning counts are made elsewhere, these are as planned.
impl Problem for Plan {
    type Workspace = Trace;

    fn blocks(&self) -> &[Block] {
        self.simulation.blocks()
    }

    fn steps(&self) -> usize {
        Problem::steps(&self.simulation)
    }

    fn terms(&self) -> &[&'static str] {
        self.simulation.terms()
    }

    fn workspace(&self) -> Trace {
        self.simulation.blank_trace()
    }

    fn rollout(&self, _: Draws, parameters: Parameters<'_>, trace: &mut Trace, cost: &mut Cost) {
        self.simulation.rollout_into(parameters, trace);
        *cost = self.simulation.cost(trace);
    }

    fn may_start_fail(&self) -> bool {
        true
    }

    fn signals(&self) -> Option<&SignalModel> {
        match self.kind {
            Kind::Trace => Problem::signals(&self.simulation),
            Kind::Residuals(_) => self.residuals.as_ref(),
            Kind::Costs => None,
        }
    }

    fn model(&self) -> Option<Box<dyn Model>> {
        if self.kind == Kind::Trace { self.simulation.model() } else { None }
    }
}

/// A task whose rollouts a [`Maker`] makes.
pub(crate) struct Outside<'m> {
    plan: Plan,
    maker: &'m dyn Maker,
    watch: &'m dyn Watch,
    /// Why no more rollouts are made.
    failure: RefCell<Option<String>>,
}

impl<'m> Outside<'m> {
    pub(crate) fn new(
        task: &Task,
        simulation: &Simulation,
        maker: &'m dyn Maker,
        watch: &'m dyn Watch,
    ) -> Result<Self, Failure> {
        let plan = Plan::new(task, simulation, maker.kind())?;
        Ok(Self { plan, maker, watch, failure: RefCell::new(None) })
    }

    pub(crate) fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Why no more rollouts are made, once that is so.
    pub(crate) fn failure(&self) -> Option<String> {
        self.failure.borrow().clone()
    }

    /// The steps of `session` by rollouts of the maker.
    pub(crate) fn steps(&self, session: Session) -> OutsideSteps<'_, 'm> {
        OutsideSteps { outside: self, session }
    }

    /// Makes `motions`; `None` where no more can be made.
    fn make(&self, motions: &[Motion]) -> Option<Vec<Answer>> {
        if self.watch.is_asked() {
            return None;
        }
        match self.maker.make(motions) {
            Ok(answers) => {
                let failed = answers.iter().filter_map(|answer| match answer {
                    Answer::Failed(why) => Some(why),
                    _ => None,
                });
                failed.for_each(|why| self.watch.note(&format!("a rollout failed: {why}")));
                Some(answers)
            }
            Err(Broken::Asked) => None,
            Err(Broken::Failed(why)) => self.give_up(why),
        }
    }

    fn give_up<T>(&self, why: String) -> Option<T> {
        self.failure.borrow_mut().get_or_insert(why);
        None
    }

    /// One more motion, for its trace; `Err` in the answer says why it failed.
    pub(crate) fn motion(&self, weights: &[f64]) -> Result<Trace, String> {
        let motion = Motion { draws: Draws::HeldOut, weights: weights.to_vec() };
        let answer = self.make(slice::from_ref(&motion)).and_then(|mut answers| answers.pop());
        match answer {
            Some(Answer::Trace(axes)) => {
                let trace = self.plan.measured(weights, axes)?;
                let is_finite = self.plan.simulation.cost(&trace).total().is_finite();
                if is_finite { Ok(trace) } else { Err("its trace has no finite cost".into()) }
            }
            Some(Answer::Failed(why)) => Err(why),
            Some(answer) => Err(format!("{}, where {} were answered before", answer.words(), Kind::Trace.words())),
            None => Err(self.failure().unwrap_or_else(|| "it was asked to end".into())),
        }
    }
}

/// A session and who makes its rollouts.
pub(crate) struct OutsideSteps<'o, 'm> {
    outside: &'o Outside<'m>,
    session: Session,
}

impl Steps for OutsideSteps<'_, '_> {
    fn session(&self) -> &Session {
        &self.session
    }

    fn step(&mut self) -> Result<Option<TellOutcome>, LearnError> {
        let Self { outside, session } = self;
        let Some((motions, wants)) = outside.plan.ask(session) else { return Ok(None) };
        let priced = outside.make(&motions).and_then(|answers| {
            outside.plan.price(&motions, wants, answers).map_err(|why| outside.give_up::<()>(why)).ok()
        });
        let (costs, signals) = priced.ok_or(LearnError::Stopped)?;
        session.tell(&costs, &signals).map(Some)
    }
}
