//! `hpf.Session`: learning as a conversation, over days where it has to be.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use hpf::checkpoint::{Checkpoint, Input};
use hpf::directory::{CHECKPOINT, Unfinished};
use hpf::files::sha256;
use hpf::outside::{Kind, Motion};
use hpf::start::{START, carried};
use hpf::{Failure, LearningRow, Prepared, read_policy, read_task};
use hpf_learn::{Progress, Record, Session, TerminationReason, Wants};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyList;

use crate::callable::read;
use crate::errors;
use crate::learn::{kind_name, kind_of, outside, session, source};
use crate::policy::{PyPolicy, Source};
use crate::run::history_of;
use crate::task::PyTask;

/// Learning by asking and telling: `ask()` for policies, make a motion with each, `tell()` what came of them.
///
/// answers: "costs", "trace" or "residuals", as hpf.learn has them for a callable; residuals: how many, where answers are
/// such; start: the hpf.Policy to learn from. What is saved is all answers so far: a session that is loaded goes on to the
/// same numbers.
#[pyclass(module = "hpf", name = "Session")]
pub struct PySession {
    source: Arc<Source>,
    /// The policy to start from, where one was given.
    from: Option<String>,
    session: Session,
    records: Vec<Record>,
    rows: Vec<LearningRow>,
    /// What was asked for and is not answered yet.
    asked: Option<(Vec<Motion>, Wants)>,
    /// Where it was saved to or loaded from.
    place: Option<PathBuf>,
}

impl PySession {
    fn prepared(&self) -> &Prepared {
        &self.source.prepared
    }

    fn inputs(&self) -> Vec<Input> {
        let mut inputs = vec![("task.toml".to_owned(), self.prepared().loaded.sha256())];
        inputs.extend(self.prepared().tables.iter().map(|table| (table.name.clone(), sha256(&table.csv))));
        inputs.extend(self.from.iter().map(|start| (START.to_owned(), sha256(start))));
        inputs
    }

    fn take(&mut self, record: Record, progress: Option<&Progress>) {
        self.records.push(record);
        self.rows.extend(progress.map(LearningRow::from));
    }

    fn write(&self, folder: &mut Unfinished) -> Result<(), Failure> {
        folder.write("task.toml", &self.prepared().loaded.text)?;
        self.prepared().tables.iter().try_for_each(|table| folder.write(&table.name, &table.csv))?;
        if let Some(start) = &self.from {
            folder.write(START, start)?;
        }
        let mut checkpoint = Checkpoint::create(&folder.path(CHECKPOINT), &self.inputs())?;
        self.records.iter().try_for_each(|record| checkpoint.append(record))
    }

    fn read(path: &Path) -> Result<Self, Failure> {
        let loaded = read_task(&path.join("task.toml"), &[])?;
        let kind = crate::learn::kind_of_run(&loaded.task).ok_or_else(|| {
            Failure::Input(format!("{}: no saved hpf.Session: its rollouts are made by hpf.learn", path.display()))
        })?;
        let prepared = Arc::new(Prepared::own(loaded)?);
        let start = path.join(START);
        let start = if start.is_file() { Some(read_policy(&start)?) } else { None };
        let from = start.as_ref().map(hpf_sim::Policy::to_json);
        let source = Arc::new(source(&prepared, start, kind)?);
        let session = session(&source)?;
        let (records, rows) = (Vec::new(), Vec::new());
        let mut made = Self { source, from, session, records, rows, asked: None, place: Some(path.to_owned()) };
        let inputs = made.inputs();
        Checkpoint::open(&path.join(CHECKPOINT), &inputs, |record| {
            let progress = made.session.replay(&record);
            let progress = progress.map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?;
            made.take(record, progress.as_ref());
            Ok(())
        })?;
        Ok(made)
    }
}

#[pymethods]
impl PySession {
    #[new]
    #[pyo3(signature = (task, *, answers = "costs", residuals = None, start = None, seed = None))]
    fn new(
        py: Python<'_>,
        task: &Bound<'_, PyTask>,
        answers: &str,
        residuals: Option<usize>,
        start: Option<&Bound<'_, PyPolicy>>,
        seed: Option<u64>,
    ) -> PyResult<Self> {
        let kind = kind_of(answers, residuals.unwrap_or(0))?;
        if matches!(kind, Kind::Residuals(_)) != residuals.is_some_and(|count| count > 0) {
            let message = "residuals is how many there are, 1 or more, and belongs to answers=\"residuals\"";
            return Err(PyValueError::new_err(message));
        }
        let seed: Vec<String> = seed.map(|seed| format!("learning.seed={seed}")).into_iter().collect();
        let task = task.get();
        let task = task.changed(&seed, &[]).map_err(|failure| task.error(py, &failure))?;
        let task = outside(py, &task, kind, 1)?;
        let start = start.map(|start| carried(start.get().get(), task.task())).transpose();
        let start = start.map_err(|failure| errors::of(py, &failure, "PolicyError", None))?;
        let from = start.as_ref().map(hpf_sim::Policy::to_json);
        let source = source(&task.prepared, start, kind).map_err(|failure| task.error(py, &failure))?;
        let session = session(&source).map_err(|failure| task.error(py, &failure))?;
        let (records, rows) = (Vec::new(), Vec::new());
        Ok(Self { source: Arc::new(source), from, session, records, rows, asked: None, place: None })
    }

    /// The policies to make a motion with, in their order; none where learning is over. The same until they are answered.
    fn ask<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let asked = self.source.plan.ask(&mut self.session);
        let motions = asked.as_ref().map(|(motions, _)| motions.as_slice()).unwrap_or_default();
        let policies = motions.iter().map(|one| PyPolicy::asked(&self.source, one.weights.clone(), one.draws));
        let policies = PyList::new(py, policies.collect::<Vec<_>>())?;
        self.asked = Some(asked.unwrap_or((Vec::new(), Wants::Costs)));
        Ok(policies)
    }

    /// Tells what came of the policies asked for, an answer each, in their order: costs or traces as for hpf.learn; an
    /// hpf.RolloutFailed for a motion that failed. Returns the hpf.Evaluation where one was complete, else None.
    ///
    /// Raises RolloutError for what is no answer, and LearningError where learning cannot go on; nothing has changed then.
    fn tell<'py>(&mut self, py: Python<'py>, answers: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some((motions, wants)) = &self.asked else {
            return Err(PyRuntimeError::new_err("ask() comes before tell()"));
        };
        let wrong = |why: String| errors::plain(py, "RolloutError", &why);
        let answers: Vec<Bound<'_, PyAny>> = answers.try_iter()?.collect::<PyResult<_>>()?;
        let kind = self.source.plan.kind();
        let read = |(k, answer): (usize, &Bound<'_, PyAny>)| {
            read(answer, kind).map_err(|error| wrong(format!("answer {k}: {}", error.value(py))))
        };
        let answers = answers.iter().enumerate().map(read).collect::<PyResult<Vec<_>>>()?;
        let (costs, signals) = self.source.plan.price(motions, *wants, answers).map_err(wrong)?;
        let outcome = self.session.tell(&costs, &signals);
        let outcome = outcome.map_err(|error| errors::plain(py, "LearningError", &error.to_string()))?;
        self.asked = None;
        self.take(outcome.record, outcome.progress.as_ref());
        match (&outcome.progress, self.rows.last()) {
            (Some(_), Some(row)) => Ok(Some(crate::desk::evaluation(py, row)?)),
            _ => Ok(None),
        }
    }

    /// Whether learning is over by itself.
    #[getter]
    fn done(&self) -> bool {
        self.session.is_over()
    }

    /// Why it is over; None where it is not.
    #[getter]
    fn stopped_because(&self) -> Option<String> {
        match self.session.history().stop {
            TerminationReason::Requested => None,
            TerminationReason::Updates => Some("all updates were made".into()),
            TerminationReason::Rollouts => Some("the next update would pass max_rollouts".into()),
            TerminationReason::Exhausted(reason) => Some(reason.to_string()),
        }
    }

    /// The best policy so far.
    #[getter]
    fn policy(&self, py: Python<'_>) -> PyResult<PyPolicy> {
        let best = self.session.history().best;
        let policy = self.source.start.clone().with_weights(&best.weights);
        let mut policy = policy.map_err(|error| errors::of_policy(py, None, &error))?;
        policy.provenance.task_sha256 = self.prepared().loaded.sha256();
        policy.provenance.updates = best.update;
        policy.provenance.cost = if best.total.is_finite() { best.total } else { 0.0 };
        Ok(policy.into())
    }

    /// Cost of the best policy so far; infinite before one is known.
    #[getter]
    fn cost(&self) -> f64 {
        self.session.history().best.total
    }

    /// Motions answered so far.
    #[getter]
    fn rollouts(&self) -> usize {
        self.session.history().rollouts
    }

    /// Updates made.
    #[getter]
    fn updates(&self) -> usize {
        self.session.history().updates
    }

    /// Motions that were rejected: those that failed or had no finite cost.
    #[getter]
    fn rejected(&self) -> usize {
        self.session.history().rejected
    }

    /// The evaluations so far: hpf.History.
    #[getter]
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        history_of(py, &self.rows)
    }

    /// The task, its environment what answers.
    #[getter]
    fn task(&self) -> PyTask {
        PyTask { prepared: self.source.prepared.clone(), file: None }
    }

    /// What answers are: "costs" or "trace".
    #[getter]
    fn answers(&self) -> &'static str {
        kind_name(self.source.plan.kind())
    }

    /// Saves all answers so far as the folder `path`, whole or not at all; over what it saved there before, and
    /// with `force` over another one. Without a path: where it was saved last.
    #[pyo3(signature = (path = None, *, force = false))]
    fn save(&mut self, py: Python<'_>, path: Option<PathBuf>, force: bool) -> PyResult<()> {
        let path = path.or_else(|| self.place.clone());
        let path = path.ok_or_else(|| PyValueError::new_err("it was not saved before: name a folder"))?;
        let force = force || self.place.as_ref() == Some(&path);
        let saved = Unfinished::begin(&path, force).and_then(|mut folder| match self.write(&mut folder) {
            Ok(()) => folder.finish(true),
            Err(failure) => Err(folder.abandon(failure)),
        });
        saved.map_err(|failure| errors::of_files(py, &failure, &path))?;
        self.place = Some(path);
        Ok(())
    }

    /// The session that was saved as the folder `path`. Raises RunError.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::read(&path).map_err(|failure| errors::of_files(py, &failure, &path))
    }

    fn __repr__(&self) -> String {
        let history = self.session.history();
        let task = &self.prepared().loaded.task;
        let cost = hpf::words::number(history.best.total);
        let state = if self.done() { ", over" } else { "" };
        let kind = self.source.plan.kind().words();
        format!(
            "<hpf.Session of {:?}, told {kind}: cost {cost}, {} updates, {} motions{state}>",
            task.name, history.updates, history.rollouts
        )
    }
}
