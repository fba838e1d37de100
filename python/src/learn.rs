//! `hpf.learn`, `hpf.resume` and `hpf.load`.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use hpf::files::LoadedTask;
use hpf::job::Finished;
use hpf::learning::learn_from;
use hpf::outside::{Answer, Kind, Plan};
use hpf::start::{START, carried};
use hpf::{Failure, Job, Prepared, Trial, log};
use hpf_learn::{Session, TerminationReason};
use hpf_sim::task::{Environment, Task};
use hpf_sim::{Policy, Simulation};
use pyo3::exceptions::{PyKeyboardInterrupt, PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::callable::{Callable, probe};
use crate::desk::{self, Worked};
use crate::errors;
use crate::policy::{PyPolicy, Source};
use crate::run::PyRun;
use crate::task::PyTask;

/// What stands for a callable in the place of a program: no process is called so.
pub const CALLABLE: &str = "(a Python callable)";

/// The names of the kinds of answers, as Python and task.toml have them.
pub fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Costs => "costs",
        Kind::Trace => "trace",
        Kind::Residuals(_) => "residuals",
    }
}

/// The kind of this name; `residuals` is how many there are.
pub fn kind_of(name: &str, residuals: usize) -> PyResult<Kind> {
    let found =
        [Kind::Costs, Kind::Trace, Kind::Residuals(residuals)].into_iter().find(|kind| kind_name(*kind) == name);
    found.ok_or_else(|| {
        PyValueError::new_err(format!("answers must be \"costs\", \"trace\" or \"residuals\", not {name:?}"))
    })
}

/// `task` as one whose rollouts are made outside of hpf.
pub fn outside(py: Python<'_>, task: &PyTask, kind: Kind, workers: usize) -> PyResult<PyTask> {
    let mut command = format!("\"{CALLABLE}\", \"{}\"", kind_name(kind));
    if let Kind::Residuals(count) = kind {
        command += &format!(", \"{count}\"");
    }
    let environment = format!("environment={{ kind = \"process\", command = [{command}], workers = {workers} }}");
    task.changed(&[environment], &[]).map_err(|failure| {
        let help = "The callable is the whole environment: Task.load(..., contact=None, disturbance=None) leaves out what \
                    hpf would simulate.";
        task.error(py, &failure.with(help))
    })
}

/// The kind of the answers of a run whose rollouts a callable made; `None` of any other.
pub fn kind_of_run(task: &Task) -> Option<Kind> {
    let Some(Environment::Process(process)) = &task.environment else { return None };
    let (program, kind, residuals) = match &process.command[..] {
        [program, kind] => (program, kind, 0),
        [program, kind, residuals] => (program, kind, residuals.parse().ok()?),
        _ => return None,
    };
    (program == CALLABLE).then(|| kind_of(kind, residuals).ok()).flatten()
}

/// What the policies of learning `task` share, and what that learns from.
pub fn source(prepared: &Arc<Prepared>, start: Option<Policy>, kind: Kind) -> Result<Source, Failure> {
    let task = &prepared.loaded.task;
    let bad = |error: &dyn core::fmt::Display| Failure::Input(format!("{}: {error}", task.name));
    let start = match start {
        Some(start) => start,
        None => Policy::initial(task).map_err(|error| bad(&error))?,
    };
    let simulation = Simulation::new(&task.as_planned(), &start).map_err(|error| bad(&error))?;
    let weights = simulation.starting_weights(&start).map_err(|error| bad(&error))?;
    let start = start.with_weights(&weights).map_err(|error| bad(&error))?;
    let plan = Plan::new(task, &simulation, kind)?;
    Ok(Source { prepared: prepared.clone(), start, plan })
}

/// A session of `source`.
pub fn session(source: &Source) -> Result<Session, Failure> {
    let learning = &source.prepared.loaded.task.learning;
    let parameters = source.plan.simulation().parameters(&source.start);
    Session::begin(&source.plan, parameters, &learning.method(), learning.max_rollouts)
        .map_err(|error| Failure::Input(format!("{}: {error}", source.prepared.loaded.task.name)))
}

/// Who shows progress.
fn shown<'py>(progress: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
    let py = progress.py();
    if progress.is_none() || progress.extract().is_ok_and(|is_shown: bool| !is_shown) {
        Ok(None)
    } else if progress.is_callable() {
        Ok(Some(progress.clone()))
    } else if progress.extract().is_ok_and(|is_shown: bool| is_shown) {
        Ok(Some(py.import("hpf._progress")?.getattr("Line")?.call0()?))
    } else {
        Err(PyTypeError::new_err("progress must be True, False or a function of an hpf.Evaluation"))
    }
}

/// The task, and what makes its rollouts where that is `function`.
fn with_callable(
    py: Python<'_>,
    task: &PyTask,
    start: Option<&Policy>,
    function: Py<PyAny>,
    answers: Option<&str>,
    (workers, is_batch): (usize, bool),
) -> PyResult<(PyTask, Callable)> {
    let fits = |kind: &Kind| kind.misfit(task.task()).is_none();
    let kinds: Vec<Kind> = [Kind::Trace, Kind::Costs, Kind::Residuals(0)].into_iter().filter(fits).collect();
    // How many residuals there are the first motion tells.
    let wanted = answers.map(|name| kind_of(name, 0)).transpose()?;
    let of_kind = |kind: Kind| -> PyResult<(PyTask, Arc<Source>)> {
        let task = outside(py, task, kind, workers)?;
        let start = start.cloned();
        let source = source(&task.prepared, start, kind).map_err(|failure| task.error(py, &failure))?;
        Ok((task, Arc::new(source)))
    };
    let known = wanted.or(if let [kind] = kinds[..] { Some(kind) } else { None });
    match known.filter(|kind| !matches!(kind, Kind::Residuals(_))) {
        Some(kind) => {
            let (task, source) = of_kind(kind)?;
            Ok((task, Callable::new(function, source, is_batch, workers)))
        }
        None => {
            // Whether its motions have signals decides how a session begins: the first motion tells, and counts.
            let (_, source) = of_kind(if fits(&Kind::Trace) { Kind::Trace } else { Kind::Residuals(1) })?;
            let mut session = session(&source).map_err(|failure| task.error(py, &failure))?;
            let asked = source.plan.ask(&mut session).and_then(|(motions, _)| motions.into_iter().next());
            let Some(motion) = asked else { return Err(PyValueError::new_err("nothing is to be learned")) };
            let policy = PyPolicy::asked(&source, motion.weights.clone(), motion.draws);
            let probed: Option<(Answer, Kind)> = probe(py, function.bind(py), policy, is_batch)
                .map_err(|error| broken(py, Some(error), "RolloutError", "the first rollout failed", None))?;
            let Some((answer, kind)) = probed else {
                let message = "the first rollout failed, so that nobody knows what the answers are: pass answers=\"trace\" \
                               or \"costs\", or begin with a motion that succeeds";
                return Err(errors::plain(py, "RolloutError", message));
            };
            if known.is_some() && !matches!(kind, Kind::Residuals(_)) {
                let message = format!("the rollout returned {}, where hpf.Residuals belongs", kind.words());
                return Err(errors::plain(py, "RolloutError", &message));
            }
            let (task, source) = of_kind(kind)?;
            let callable = Callable::new(function, source, is_batch, workers);
            Ok((task, callable.having_made(motion, answer)))
        }
    }
}

/// The exception of learning that broke off: what Python raised, or `class` of it; what there is goes with it.
fn broken(py: Python<'_>, raised: Option<PyErr>, class: &str, text: &str, run: Option<Py<PyRun>>) -> PyErr {
    let error = match raised {
        Some(raised) if Callable::is_interrupt(py, &raised) => raised,
        Some(raised) => {
            let description = Callable::described(py, &raised);
            let text = if text.contains(&description) { text.to_owned() } else { format!("{text}: {description}") };
            let error = errors::plain(py, class, &text);
            error.set_cause(py, Some(raised));
            error
        }
        None => errors::plain(py, class, text),
    };
    if let Some(run) = run {
        // Where it cannot be put there, the error itself is what counts.
        let _ = error.value(py).setattr("run", run);
    }
    error
}

/// Learns `task`, and returns its hpf.Run.
///
/// seed: of all random numbers; None: the task's. start: the hpf.Policy to learn from. progress: True shows a line, a
/// function is called with each hpf.Evaluation. out: the run directory, which holds a checkpoint from the first update on:
/// what is broken off goes on with hpf.resume(out). workers: threads of the simulation, or calls of `rollout` at the same
/// time.
///
/// rollout: a callable that is the environment, in place of the simulation (docs/python.md). It takes an hpf.Policy, with
/// batch=True a list of them, and returns for each a total cost, N costs of the steps, (N costs, cost of the end), or an
/// hpf.Trace or hpf.Residuals; answers: "costs", "trace" or "residuals" where the first rollout is not to tell. A rollout that fails raises
/// hpf.RolloutFailed and is rejected; any other exception ends learning as hpf.RolloutError, with what was learned in its
/// `run`.
///
/// The GIL is released. Raises TaskError, LearningError, RolloutError; KeyboardInterrupt on Ctrl-C.
#[pyfunction]
#[pyo3(signature = (
    task, *, seed = None, start = None, progress = None, rollout = None, answers = None, workers = None, batch = false,
    out = None, force = false
))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn learn(
    py: Python<'_>,
    task: &Bound<'_, PyTask>,
    seed: Option<u64>,
    start: Option<&Bound<'_, PyPolicy>>,
    progress: Option<&Bound<'_, PyAny>>,
    rollout: Option<Py<PyAny>>,
    answers: Option<&str>,
    workers: Option<usize>,
    batch: bool,
    out: Option<PathBuf>,
    force: bool,
) -> PyResult<PyRun> {
    let begun = Instant::now();
    let task = task.get();
    let seed: Vec<String> = seed.map(|seed| format!("learning.seed={seed}")).into_iter().collect();
    let task = task.changed(&seed, &[]).map_err(|failure| task.error(py, &failure))?;
    let start = start.map(|start| carried(start.get().get(), task.task()));
    let start = start.transpose().map_err(|failure| errors::of(py, &failure, "PolicyError", None))?;
    let progress = progress.map(shown).transpose()?.flatten();
    let (task, callable) = match rollout {
        Some(function) => {
            let how = (workers.unwrap_or(1).max(1), batch);
            let (task, callable) = with_callable(py, &task, start.as_ref(), function, answers, how)?;
            (task, Some(callable))
        }
        None if answers.is_some() || batch => {
            return Err(PyTypeError::new_err("answers and batch belong to a rollout of your own"));
        }
        None if task.is_callables() => {
            return Err(PyTypeError::new_err("the rollouts of this task are made by a callable: pass rollout"));
        }
        None => (task, None),
    };
    let threads = if callable.is_some() { 1 } else { workers.unwrap_or(0) };
    if let Some(out) = out {
        let job = Job::of(task.loaded(), start, Some(&out), force).map_err(|failure| task.error(py, &failure))?;
        return in_directory(py, job, threads, progress.as_ref(), callable.as_ref());
    }

    let mut others = Vec::new();
    let from = match start {
        Some(start) => {
            others.push((START, start.to_json()));
            start
        }
        None => hpf::start::policy(task.task(), None).map_err(|failure| task.error(py, &failure))?,
    };
    let loaded: &LoadedTask = &task.prepared.loaded;
    let Worked { result, mut notes, raised } =
        desk::work(py, threads, progress.as_ref(), callable.as_ref(), |watch, maker| {
            learn_from(loaded, from, None, watch, maker)
        })?;
    let class = if callable.is_some() { "RolloutError" } else { "LearningError" };
    let learned = match (result, raised) {
        (Ok(learned), None) => learned,
        (Ok(learned), Some(raised)) => {
            let why = learned.failure.clone().unwrap_or_else(|| "learning was broken off".into());
            let run = PyRun::in_memory(Trial::of(learned, begun), task.prepared.clone(), others, notes);
            return Err(broken(py, Some(raised), class, &why, Py::new(py, run).ok()));
        }
        (Err(failure), raised) => return Err(failed(py, &task, &failure, raised, class)),
    };
    notes.extend(learned.history.notes.iter().map(ToString::to_string));
    notes.extend(log::time_note(task.task()));
    let failure = learned.failure.clone();
    let run = PyRun::in_memory(Trial::of(learned, begun), task.prepared.clone(), others, notes);
    match failure {
        None => Ok(run),
        Some(why) => Err(broken(py, None, class, &why, Py::new(py, run).ok())),
    }
}

/// The exception of learning that led to nothing.
fn failed(py: Python<'_>, task: &PyTask, failure: &Failure, raised: Option<PyErr>, class: &str) -> PyErr {
    let text = failure.to_string();
    let text = text.trim_start_matches("error: ").trim_start_matches("interrupted: ");
    match (failure, raised) {
        (_, Some(raised)) => broken(py, Some(raised), class, text, None),
        (Failure::Interrupted(_), None) => PyKeyboardInterrupt::new_err(text.to_owned()),
        (Failure::Work(_), None) => errors::plain(py, class, text),
        (Failure::Input(_) | Failure::Mistakes(_), None) => task.error(py, failure),
    }
}

/// Learns `job` in its directory.
fn in_directory(
    py: Python<'_>,
    job: Job,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
    callable: Option<&Callable>,
) -> PyResult<PyRun> {
    let place = job.place.clone();
    let task =
        PyTask { prepared: Arc::new(Prepared { loaded: clone_of(&job.loaded), tables: Vec::new() }), file: None };
    let Worked { result, mut notes, raised } =
        desk::work(py, threads, progress, callable, |watch, maker| job.learn_with(watch, maker))?;
    let class = if callable.is_some() { "RolloutError" } else { "LearningError" };
    let go_on = format!("go on from there with hpf.resume({:?})", place.display().to_string());
    let Finished { learned, failures, .. } = match result {
        Ok(finished) => finished,
        Err(failure) => {
            let can_go_on = place.with_added_extension("partial").is_dir();
            let failure = if can_go_on { failure.with(&go_on) } else { failure };
            return Err(failed(py, &task, &failure, raised, class));
        }
    };
    notes.extend(learned.history.notes.iter().map(ToString::to_string));
    notes.extend(failures.iter().map(ToString::to_string));
    let run = PyRun::read(&place, notes).map_err(|failure| errors::of_files(py, &failure, &place))?;
    match (&learned.failure, raised) {
        (None, None) if learned.history.stop != TerminationReason::Requested => Ok(run),
        (why, raised) => {
            let why = why.clone().unwrap_or_else(|| "learning was broken off".into());
            let text = if learned.is_open() { format!("{why}; {go_on}") } else { why };
            Err(broken(py, raised, class, &text, Py::new(py, run).ok()))
        }
    }
}

fn clone_of(loaded: &LoadedTask) -> LoadedTask {
    LoadedTask { task: loaded.task.clone(), text: loaded.text.clone(), notes: Vec::new() }
}

/// Goes on with the run `path` that was broken off, to the same bytes; `rollout` and the keywords after it are as for
/// hpf.learn, and needed where its rollouts were made so.
#[pyfunction]
#[pyo3(signature = (path, *, progress = None, rollout = None, workers = None, batch = false, force = false))]
pub fn resume(
    py: Python<'_>,
    path: PathBuf,
    progress: Option<&Bound<'_, PyAny>>,
    rollout: Option<Py<PyAny>>,
    workers: Option<usize>,
    batch: bool,
    force: bool,
) -> PyResult<PyRun> {
    let job = Job::resume(&path, force).map_err(|failure| errors::of_files(py, &failure, &path))?;
    let progress = progress.map(shown).transpose()?.flatten();
    let callable = match (rollout, kind_of_run(&job.loaded.task)) {
        (None, None) => None,
        (None, Some(_)) => {
            return Err(PyTypeError::new_err("the rollouts of this run were made by a callable: pass rollout"));
        }
        (Some(_), None) => {
            return Err(PyTypeError::new_err(
                "the rollouts of this run were made without a callable: leave rollout out",
            ));
        }
        (Some(function), Some(kind)) => {
            let loaded = clone_of(&job.loaded);
            let prepared = Arc::new(Prepared { loaded, tables: Vec::new() });
            let start = [path.join(START), path.with_added_extension("partial").join(START)];
            let start = start.iter().find(|start| start.is_file()).map(|start| hpf::read_policy(start));
            let source = start.transpose().and_then(|start| source(&prepared, start, kind));
            let source = source.map_err(|failure| errors::of_files(py, &failure, &path))?;
            Some(Callable::new(function, Arc::new(source), batch, workers.unwrap_or(1).max(1)))
        }
    };
    let threads = if callable.is_some() { 1 } else { workers.unwrap_or(0) };
    in_directory(py, job, threads, progress.as_ref(), callable.as_ref())
}

/// Reads the run directory `path`: of hpf.learn, run.save or the program. Raises RunError.
#[pyfunction]
pub fn load(py: Python<'_>, path: PathBuf) -> PyResult<PyRun> {
    PyRun::read(Path::new(&path), Vec::new()).map_err(|failure| errors::of_files(py, &failure, &path))
}
