//! A Python callable as the environment: a policy in, a trace, residuals or costs out.

use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use core::time::Duration;
use std::collections::HashMap;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use hpf::outside::{Answer, Kind, Measured, Motion};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods as _, PyUntypedArrayMethods as _};
use pyo3::exceptions::{PyKeyboardInterrupt, PySystemExit, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::policy::{PyPolicy, Source};

/// Time between looks for Ctrl-C while threads make rollouts.
const GLANCE: Duration = Duration::from_millis(30);

/// A callable, and how it is called.
pub struct Callable {
    function: Py<PyAny>,
    source: Arc<Source>,
    /// Whether it takes a list of policies.
    is_batch: bool,
    /// Calls at the same time.
    workers: usize,
    /// A motion that was made already, and its answer.
    first: Mutex<Option<(Motion, Answer)>>,
}

impl Callable {
    pub fn new(function: Py<PyAny>, source: Arc<Source>, is_batch: bool, workers: usize) -> Self {
        Self { function, source, is_batch, workers, first: Mutex::new(None) }
    }

    /// The same with a motion that was made already.
    pub fn having_made(self, motion: Motion, answer: Answer) -> Self {
        Self { first: Mutex::new(Some((motion, answer))), ..self }
    }

    pub fn kind(&self) -> Kind {
        self.source.plan.kind()
    }

    /// What is said of `error`.
    pub fn described(py: Python<'_>, error: &PyErr) -> String {
        let name = error.get_type(py).name().map_or_else(|_| "an exception".into(), |name| name.to_string());
        format!("the rollout raised {name}: {}", error.value(py))
    }

    /// Whether `error` asks to end, and is no fault.
    pub fn is_interrupt(py: Python<'_>, error: &PyErr) -> bool {
        error.is_instance_of::<PyKeyboardInterrupt>(py) || error.is_instance_of::<PySystemExit>(py)
    }

    /// Makes `motions`.
    ///
    /// # Errors
    /// What the callable raises, but for RolloutFailed; a TypeError or ValueError for what is no answer.
    pub fn make(&self, py: Python<'_>, motions: &[Motion]) -> PyResult<Vec<Answer>> {
        py.check_signals()?;
        let first = self.first.lock().unwrap_or_else(PoisonError::into_inner).take();
        let (made, left) = match first {
            Some((motion, answer)) if motions.first() == Some(&motion) => (Some(answer), &motions[1..]),
            _ => (None, motions),
        };
        let mut answers: Vec<Answer> = made.into_iter().collect();
        if left.is_empty() {
            return Ok(answers);
        }
        if self.is_batch {
            answers.extend(self.call_batch(py, left)?);
        } else if self.workers > 1 && left.len() > 1 {
            answers.extend(py.detach(|| self.call_in_threads(left))?);
        } else {
            for motion in left {
                answers.push(self.call(py, motion)?);
            }
        }
        Ok(answers)
    }

    fn policy(&self, motion: &Motion) -> PyPolicy {
        PyPolicy::asked(&self.source, motion.weights.clone(), motion.draws)
    }

    fn call(&self, py: Python<'_>, motion: &Motion) -> PyResult<Answer> {
        match self.function.bind(py).call1((self.policy(motion),)) {
            Ok(answer) => read(&answer, self.kind()),
            Err(error) => failed(py, error),
        }
    }

    fn call_batch(&self, py: Python<'_>, motions: &[Motion]) -> PyResult<Vec<Answer>> {
        let policies = PyList::new(py, motions.iter().map(|motion| self.policy(motion)).collect::<Vec<_>>())?;
        let answers = self.function.bind(py).call1((policies,))?;
        let answers: Vec<Bound<'_, PyAny>> = answers.try_iter()?.collect::<PyResult<_>>()?;
        if answers.len() != motions.len() {
            let message = format!("{} answers to a batch of {} policies", answers.len(), motions.len());
            return Err(PyValueError::new_err(message));
        }
        answers.iter().map(|answer| read(answer, self.kind())).collect()
    }

    /// Calls from several threads; on Ctrl-C the calls under way see a KeyboardInterrupt too.
    fn call_in_threads(&self, motions: &[Motion]) -> PyResult<Vec<Answer>> {
        let (next, is_over) = (AtomicUsize::new(0), AtomicBool::new(false));
        let under_way: Mutex<HashMap<usize, u64>> = Mutex::default();
        let lock = || under_way.lock().unwrap_or_else(PoisonError::into_inner);
        let call = |worker: usize, motion: &Motion| {
            Python::attach(|py| {
                let ident = py.import("threading")?.getattr("get_ident")?.call0()?.extract()?;
                lock().insert(worker, ident);
                // Who comes too late for the interrupt does not begin.
                if is_over.load(Ordering::SeqCst) {
                    return Err(PyKeyboardInterrupt::new_err(()));
                }
                let answer = self.call(py, motion);
                lock().remove(&worker);
                answer
            })
        };
        let take = || {
            let k = next.fetch_add(1, Ordering::SeqCst);
            motions.get(k).filter(|_| !is_over.load(Ordering::SeqCst)).map(|motion| (k, motion))
        };
        let mut found: Vec<Option<Answer>> = vec![None; motions.len()];
        let mut raised: Option<PyErr> = None;
        let mut give_up = |error: PyErr| {
            is_over.store(true, Ordering::SeqCst);
            raised.get_or_insert(error);
        };
        thread::scope(|scope| {
            let (sender, answers) = channel();
            for worker in 0..self.workers.min(motions.len()) {
                let (sender, take, call) = (sender.clone(), &take, &call);
                scope.spawn(move || {
                    while let Some((k, motion)) = take() {
                        if sender.send((k, call(worker, motion))).is_err() {
                            break;
                        }
                    }
                });
            }
            drop(sender);
            loop {
                match answers.recv_timeout(GLANCE) {
                    Ok((k, Ok(answer))) => found[k] = Some(answer),
                    Ok((_, Err(error))) => give_up(error),
                    Err(RecvTimeoutError::Disconnected) => break,
                    Err(RecvTimeoutError::Timeout) => Python::attach(|py| {
                        if let Err(error) = py.check_signals() {
                            give_up(error);
                            let idents: Vec<u64> = lock().values().copied().collect();
                            let interrupt = py.import("hpf._threads").and_then(|threads| threads.getattr("interrupt"));
                            if let Err(error) = interrupt.and_then(|interrupt| interrupt.call1((idents,))) {
                                give_up(error);
                            }
                        }
                    }),
                }
            }
        });
        match raised {
            Some(error) => Err(error),
            None => Ok(found.into_iter().flatten().collect()),
        }
    }
}

/// The motion that tells what the answers are, made by `function`: its answer, and what it is.
///
/// # Errors
/// What the callable raises.
pub fn probe(
    py: Python<'_>,
    function: &Bound<'_, PyAny>,
    policy: PyPolicy,
    is_batch: bool,
) -> PyResult<Option<(Answer, Kind)>> {
    let policy = policy.into_pyobject(py)?;
    let answer = if is_batch {
        let answers = function.call1((PyList::new(py, [policy])?,))?;
        let answers: Vec<Bound<'_, PyAny>> = answers.try_iter()?.collect::<PyResult<_>>()?;
        let [answer] = &answers[..] else {
            return Err(PyValueError::new_err(format!("{} answers to a batch of 1 policy", answers.len())));
        };
        answer.clone()
    } else {
        match function.call1((policy,)) {
            Ok(answer) => answer,
            Err(error) => return failed(py, error).map(|_| None),
        }
    };
    let kind = if signal(&answer, "position")?.is_some() {
        Kind::Trace
    } else if let Some(list) = residuals(&answer)? {
        Kind::Residuals(list.len())
    } else {
        Kind::Costs
    };
    match read(&answer, kind)? {
        Answer::Failed(_) => Ok(None),
        answer => Ok(Some((answer, kind))),
    }
}

/// A rollout that failed by itself is an answer; any other exception is an error.
fn failed(py: Python<'_>, error: PyErr) -> PyResult<Answer> {
    let class = py.import("hpf.errors")?.getattr("RolloutFailed")?;
    if error.value(py).is_instance(&class)? { Ok(Answer::Failed(error.value(py).to_string())) } else { Err(error) }
}

/// A key or an attribute of an answer.
fn signal<'py>(answer: &Bound<'py, PyAny>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
    if let Ok(dict) = answer.cast::<PyDict>() {
        return dict.get_item(name);
    }
    answer.getattr_opt(name)
}

/// Reads an answer of `kind`: a number, N costs, (N costs, end), residuals, or position, velocity and force by time and
/// axis.
///
/// # Errors
/// TypeError or ValueError that says what belongs there.
pub fn read(answer: &Bound<'_, PyAny>, kind: Kind) -> PyResult<Answer> {
    let answer = read_numbers(answer, kind)?;
    let is_finite = match &answer {
        Answer::Total(cost) => cost.is_finite(),
        Answer::Steps(costs, end) => end.is_finite() && costs.iter().all(|cost| cost.is_finite()),
        Answer::Residuals(residuals) => residuals.iter().all(|residual| residual.is_finite()),
        Answer::Trace(_) | Answer::Failed(_) => true,
    };
    Ok(if is_finite { answer } else { Answer::Failed("its cost is not finite".into()) })
}

fn read_numbers(answer: &Bound<'_, PyAny>, kind: Kind) -> PyResult<Answer> {
    let py = answer.py();
    let class = py.import("hpf.errors")?.getattr("RolloutFailed")?;
    if answer.is_instance(&class)? {
        return Ok(Answer::Failed(answer.to_string()));
    }
    if let Ok(costs) = answer.cast::<PyArray1<f64>>()
        && costs.is_c_contiguous()
    {
        return Ok(Answer::Steps(costs.to_vec()?, 0.0));
    }
    if let Some(position) = signal(answer, "position")? {
        return trace(answer, &position);
    }
    if let Some(residuals) = residuals(answer)? {
        return Ok(Answer::Residuals(residuals));
    }
    if let Ok(pair) = answer.cast::<PyTuple>()
        && pair.len() == 2
        && let Ok(end) = pair.get_item(1)?.extract::<f64>()
        && pair.get_item(0)?.extract::<f64>().is_err()
    {
        return Ok(Answer::Steps(numbers(&pair.get_item(0)?)?, end));
    }
    let is_array = answer.hasattr("ndim")? && answer.getattr("ndim")?.extract::<usize>()? > 0;
    if !is_array && let Ok(total) = answer.extract::<f64>() {
        return Ok(Answer::Total(total));
    }
    if is_array || answer.is_instance_of::<PyList>() || answer.is_instance_of::<PyTuple>() {
        return Ok(Answer::Steps(numbers(answer)?, 0.0));
    }
    let wanted = match kind {
        Kind::Costs => "a cost, N costs of the steps or (costs, cost of the end)",
        Kind::Trace => "hpf.Trace(position, velocity, force)",
        Kind::Residuals(_) => "hpf.Residuals(values)",
    };
    Err(PyTypeError::new_err(format!("the rollout returned {}, where {wanted} belongs", answer.get_type().name()?)))
}

/// The residuals of an answer that has such.
fn residuals(answer: &Bound<'_, PyAny>) -> PyResult<Option<Vec<f64>>> {
    signal(answer, "residuals")?.map(|list| numbers(&list)).transpose()
}

/// A list of numbers from anything that is one.
fn numbers(list: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let array = as_array(list)?;
    if array.ndim() != 1 {
        let shape = array.shape();
        return Err(PyValueError::new_err(format!("numbers of shape {shape:?}, where (N,) belongs")));
    }
    Ok(array.to_vec()?)
}

/// An array of f64, contiguous, of anything that is one.
fn as_array<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    if let Ok(array) = value.cast::<PyArrayDyn<f64>>()
        && array.is_c_contiguous()
    {
        return Ok(array.clone());
    }
    let py = value.py();
    let float = py.import("builtins")?.getattr("float")?;
    let made = py.import("numpy")?.getattr("ascontiguousarray")?.call1((value, float))?;
    Ok(made.cast_into::<PyArrayDyn<f64>>()?)
}

/// A trace: position, velocity and force, each of shape (N + 1, axes), or (N + 1,) of one axis.
fn trace(answer: &Bound<'_, PyAny>, position: &Bound<'_, PyAny>) -> PyResult<Answer> {
    let of = |name: &str| signal(answer, name)?.ok_or_else(|| PyTypeError::new_err(format!("a trace without {name}")));
    let signals = [position.clone(), of("velocity")?, of("force")?];
    let mut axes: Vec<Measured> = Vec::new();
    let mut is_finite = true;
    for (j, signal) in signals.iter().enumerate() {
        let array = as_array(signal)?;
        let (shape, list) = (array.shape().to_vec(), array.to_vec()?);
        let (samples, count) = match shape[..] {
            [samples] => (samples, 1),
            [samples, count] => (samples, count),
            _ => {
                let message = format!("a signal of shape {shape:?}, where (N + 1, axes) belongs");
                return Err(PyValueError::new_err(message));
            }
        };
        is_finite &= list.iter().all(|number| number.is_finite());
        if j == 0 {
            axes = vec![Measured::default(); count];
        } else if count != axes.len() {
            let message = format!("a trace with {} and {count} axes in its signals", axes.len());
            return Err(PyValueError::new_err(message));
        }
        for (a, axis) in axes.iter_mut().enumerate() {
            let column = (0..samples).map(|i| list[i * count + a]).collect();
            *[&mut axis.position, &mut axis.velocity, &mut axis.force][j] = column;
        }
    }
    Ok(if is_finite { Answer::Trace(axes) } else { Answer::Failed("a number of its trace is not finite".into()) })
}
