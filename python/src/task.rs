//! `hpf.Task`: a task as it will run, complete in itself.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use hpf::failure::in_text;
use hpf::files::{self, LoadedTask, parse_task, read_limited};
use hpf::{Failure, Prepared, overrides};
use hpf_sim::environment::Disturbance;
use hpf_sim::task::{Environment, MAX_TASK_BYTES, Process};
use hpf_sim::{Task, environment::Contact};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use toml_edit::{DocumentMut, TableLike};

use crate::errors;
use crate::learn::CALLABLE;

/// What to learn, in which environment, at what price: a task file, read and checked. It never changes;
/// `replace(**changes)` makes another one.
///
/// Units are SI: m, s, N, N/m, N s/m; of an axis in rad: rad, N m, N m/rad, N m s/rad. Keys: docs/task-file.md.
#[pyclass(frozen, module = "hpf", name = "Task")]
pub struct PyTask {
    pub prepared: Arc<Prepared>,
    /// The file it was read from.
    pub file: Option<String>,
}

/// Changes to a task: `key.path=value`, and keys that are left out.
struct Changes {
    set: Vec<String>,
    removed: Vec<String>,
}

impl Changes {
    fn of(py: Python<'_>, changes: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let Some(changes) = changes else { return Ok(Self { set: Vec::new(), removed: Vec::new() }) };
        let made = py.import("hpf._values")?.getattr("changes")?.call1((changes,))?;
        let (set, removed) = made.extract()?;
        Ok(Self { set, removed })
    }
}

/// `text` without the keys `removed`, dotted paths of tables; one that is not there is as it is to be.
fn without(text: &str, removed: &[String]) -> Result<String, Failure> {
    if removed.is_empty() {
        return Ok(text.to_owned());
    }
    let mut document: DocumentMut = text.parse().map_err(|error| Failure::Input(format!("{error}")))?;
    for path in removed {
        remove(document.as_table_mut(), path).map_err(|part| {
            Failure::Input(format!("{path}: `{part}` is no table, and None leaves out keys of tables only"))
        })?;
    }
    Ok(document.to_string())
}

/// Takes the key at the end of `path` out of `table`; `Err` is what is no table on the way.
fn remove<'p>(table: &mut dyn TableLike, path: &'p str) -> Result<(), &'p str> {
    match path.split_once('.') {
        None => {
            table.remove(path);
            Ok(())
        }
        Some((part, rest)) => match table.get_mut(part) {
            None => Ok(()),
            Some(item) => remove(item.as_table_like_mut().ok_or(part)?, rest),
        },
    }
}

/// The task of `text`, whose force tables are `tables` or lie in `folder`.
fn reread(text: String, tables: &[(String, String)], folder: &Path) -> Result<LoadedTask, Failure> {
    let mut task = Task::parse(&text).map_err(in_text("the task"))?;
    for disturbance in &mut task.disturbance {
        if let Disturbance::Table(table) = disturbance {
            let own = tables.iter().find(|(name, _)| *name == table.file);
            let csv = match own {
                Some((_, csv)) => csv.clone(),
                None => files::read_text(&folder.join(&table.file))?,
            };
            table.samples = files::parse_table(&csv)
                .map_err(|(line, column, what)| Failure::Input(format!("{}:{line}:{column}: {what}", table.file)))?;
        }
    }
    Ok(LoadedTask { task, text, notes: Vec::new() })
}

/// A task that is complete in itself: its force tables beside it, the folder of its process in full.
fn own(mut loaded: LoadedTask) -> Result<Prepared, Failure> {
    if let Some(Environment::Process(Process { folder: Some(folder), .. })) = &loaded.task.environment {
        loaded.text = overrides::apply(&loaded.text, &[format!("environment.folder={}", overrides::quoted(folder))])?;
    }
    Prepared::own(loaded)
}

impl PyTask {
    pub fn new(loaded: LoadedTask, file: Option<String>) -> Result<Self, Failure> {
        Ok(Self { prepared: Arc::new(own(loaded)?), file })
    }

    pub fn task(&self) -> &Task {
        &self.prepared.loaded.task
    }

    fn tables(&self) -> Vec<(String, String)> {
        self.prepared.tables.iter().map(|table| (table.name.clone(), table.csv.clone())).collect()
    }

    /// The same task with `changes`, each `key.path=value`.
    pub fn changed(&self, changes: &[String], removed: &[String]) -> Result<Self, Failure> {
        if changes.is_empty() && removed.is_empty() {
            return Ok(Self { prepared: self.prepared.clone(), file: self.file.clone() });
        }
        let text = without(&self.prepared.loaded.text, removed)?;
        let text = overrides::apply(&text, changes)?;
        let folder = self.file.as_deref().and_then(|file| Path::new(file).parent()).unwrap_or(Path::new(""));
        Self::new(reread(text, &self.tables(), folder)?, self.file.clone())
    }

    /// Whether a callable is to make the rollouts.
    pub fn is_callables(&self) -> bool {
        let Some(Environment::Process(process)) = &self.task().environment else { return false };
        process.command.first().is_some_and(|program| program == CALLABLE)
    }

    /// The task in a form of its own: what [`LoadedTask`] is, which is not to be cloned.
    pub fn loaded(&self) -> LoadedTask {
        let LoadedTask { task, text, notes } = &self.prepared.loaded;
        LoadedTask { task: task.clone(), text: text.clone(), notes: notes.clone() }
    }

    pub fn error(&self, py: Python<'_>, failure: &Failure) -> PyErr {
        errors::of(py, failure, "TaskError", self.file.as_deref())
    }
}

#[pymethods]
impl PyTask {
    /// Reads and checks the task file `path`, with changes: `learning={"method": "auto"}`, `axis={0: {"goal": 0.4}}`;
    /// None leaves a key out.
    ///
    /// Raises TaskError with every mistake, its line and column.
    #[staticmethod]
    #[pyo3(signature = (path, /, **changes))]
    fn load(py: Python<'_>, path: PathBuf, changes: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let file = path.display().to_string();
        let fail = |failure: Failure| errors::of(py, &failure, "TaskError", Some(&file));
        let text = read_limited(&path, MAX_TASK_BYTES as u64).map_err(fail)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::read(py, text, &file, folder, changes)
    }

    /// Reads and checks the text of a task file, as load() does; the files it names lie in `folder`.
    #[staticmethod]
    #[pyo3(signature = (text, /, folder = PathBuf::new(), **changes))]
    fn parse(py: Python<'_>, text: String, folder: PathBuf, changes: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let task = Self::read(py, text, "task", &folder, changes)?;
        Ok(Self { file: None, ..task })
    }

    /// The same task with other keys, as load() takes them.
    #[pyo3(signature = (**changes))]
    fn replace(&self, py: Python<'_>, changes: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        self.replace_with(py, changes)
    }

    /// The text of the task as it will run, TOML.
    #[getter]
    fn text(&self) -> &str {
        &self.prepared.loaded.text
    }

    /// The file it was read from; None for a text.
    #[getter]
    fn file(&self) -> Option<&str> {
        self.file.as_deref()
    }

    /// Its name, and that of its run directory.
    #[getter]
    fn name(&self) -> &str {
        &self.task().name
    }

    /// Duration of the movement [s].
    #[getter]
    fn duration_s(&self) -> f64 {
        self.task().duration
    }

    /// Control and logging rate [Hz].
    #[getter]
    fn rate_hz(&self) -> f64 {
        self.task().rate
    }

    /// Steps of the movement, N; a signal of it has N + 1 samples.
    #[getter]
    fn steps(&self) -> usize {
        self.task().steps()
    }

    /// Names of the axes, in their order.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.task().axis.iter().map(|axis| axis.name.as_str()))
    }

    /// Units of the axes: "m" or "rad".
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.task().axis.iter().map(|axis| axis.unit.symbol()))
    }

    /// Where the movement of each axis starts [axis unit], shape (axes,).
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        numpy::PyArray1::from_iter(py, self.task().axis.iter().map(|axis| axis.start))
    }

    /// Where the movement of each axis ends [axis unit], shape (axes,).
    #[getter]
    fn goal<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        numpy::PyArray1::from_iter(py, self.task().axis.iter().map(|axis| axis.goal))
    }

    /// The learning method.
    #[getter]
    fn method(&self) -> &'static str {
        self.task().learning.method.name()
    }

    /// Seed of all random numbers.
    #[getter]
    fn seed(&self) -> u64 {
        self.task().learning.seed
    }

    /// What the tool touches: "wall", "cantilever" or None.
    #[getter]
    fn contact(&self) -> Option<&'static str> {
        match &self.task().contact {
            None => None,
            Some(Contact::Wall(_)) => Some("wall"),
            Some(Contact::Cantilever(_)) => Some("cantilever"),
        }
    }

    /// Who makes the rollouts: "simulation", "process" or "callable".
    #[getter]
    fn environment(&self) -> &'static str {
        match &self.task().environment {
            None => "simulation",
            Some(_) if self.is_callables() => "callable",
            Some(Environment::Process(_)) => "process",
        }
    }

    /// All keys with their values, as the task file has them: dicts, lists, numbers and texts.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let json =
            serde_json::to_string(self.task()).map_err(|error| errors::plain(py, "WorkError", &error.to_string()))?;
        py.import("json")?.getattr("loads")?.call1((json,))
    }

    fn __repr__(&self) -> String {
        let task = self.task();
        let axes: Vec<String> =
            task.axis.iter().map(|axis| format!("{} [{}]", axis.name, axis.unit.symbol())).collect();
        let contact = self.contact().map_or_else(String::new, |contact| format!(", contact {contact}"));
        format!(
            "<hpf.Task {:?}: axes {}, {} s at {} Hz{contact}, {}, method {}>",
            task.name,
            axes.join(", "),
            task.duration,
            task.rate,
            self.environment(),
            self.method()
        )
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| {
            let other = other.get();
            self.prepared.loaded.text == other.prepared.loaded.text && self.tables() == other.tables()
        })
    }

    fn __hash__(&self) -> u64 {
        use core::hash::{Hash as _, Hasher as _};
        let mut hasher = std::hash::DefaultHasher::new();
        self.prepared.loaded.text.hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, PickledTask)> {
        let restore = py.import("hpf._restore")?.getattr("task")?;
        Ok((restore, (self.prepared.loaded.text.clone(), self.tables(), self.file.clone())))
    }

    #[staticmethod]
    fn _restore(py: Python<'_>, text: String, tables: Vec<(String, String)>, file: Option<String>) -> PyResult<Self> {
        let restored = reread(text, &tables, Path::new("")).and_then(|loaded| Self::new(loaded, file.clone()));
        restored.map_err(|failure| errors::of(py, &failure, "TaskError", file.as_deref()))
    }
}

/// What a pickle holds: text, force tables, file.
type PickledTask = (String, Vec<(String, String)>, Option<String>);

impl PyTask {
    pub fn replace_with(&self, py: Python<'_>, changes: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let Changes { set, removed } = Changes::of(py, changes)?;
        self.changed(&set, &removed).map_err(|failure| self.error(py, &failure))
    }

    fn read(
        py: Python<'_>,
        text: String,
        name: &str,
        folder: &Path,
        changes: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let Changes { set, removed } = Changes::of(py, changes)?;
        let fail = |failure: Failure| errors::of(py, &failure, "TaskError", Some(name));
        // Only with all changes is it what is meant; a text that is no TOML is reported as it stands.
        let loaded = match without(&text, &removed).and_then(|text| overrides::apply(&text, &set)) {
            Ok(text) => parse_task(text, name, folder, &[]),
            Err(failure) => parse_task(text, name, folder, &[]).and(Err(failure)),
        };
        let loaded = loaded.map_err(fail)?;
        Self::new(loaded, Some(name.to_owned())).map_err(fail)
    }
}
