//! Work on a thread of its own, while the thread that called from Python stays with Python: it sees Ctrl-C, shows
//! progress and makes the rollouts that a callable makes.

use core::sync::atomic::{AtomicUsize, Ordering};
use core::time::Duration;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

use hpf::outside::{Answer, Broken, Kind, Maker, Motion};
use hpf::sinks::reason;
use hpf::{LearningRow, Watch};
use hpf_sim::cost::Term;
use pyo3::prelude::*;

use crate::callable::Callable;
use crate::errors;

/// Time between looks for Ctrl-C.
const GLANCE: Duration = Duration::from_millis(30);

/// What the work has to say to the thread that called.
enum Message {
    Row(LearningRow),
    Make(Vec<Motion>),
    Done,
}

/// The contents of a lock: what panicked elsewhere has left them whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Who looks on: notes are kept, rows are handed to who shows them.
struct Desk {
    messages: Mutex<Sender<Message>>,
    answers: Mutex<Receiver<Result<Vec<Answer>, Broken>>>,
    notes: Mutex<Vec<String>>,
    /// How often it was asked to end.
    asked: AtomicUsize,
    shows_progress: bool,
}

impl Watch for Desk {
    fn note(&self, sentence: &str) {
        lock(&self.notes).push(sentence.to_owned());
    }

    fn evaluated(&self, row: &LearningRow) {
        if self.shows_progress {
            // Where nobody listens any more, it is about to end.
            let _ = lock(&self.messages).send(Message::Row(row.clone()));
        }
    }

    fn is_asked(&self) -> bool {
        self.asked.load(Ordering::SeqCst) > 0
    }

    fn is_urgent(&self) -> bool {
        self.asked.load(Ordering::SeqCst) > 1
    }
}

/// A [`Maker`] whose motions the thread that called makes.
struct Bridge<'d> {
    desk: &'d Desk,
    kind: Kind,
}

impl Maker for Bridge<'_> {
    fn kind(&self) -> Kind {
        self.kind
    }

    fn make(&self, motions: &[Motion]) -> Result<Vec<Answer>, Broken> {
        let sent = lock(&self.desk.messages).send(Message::Make(motions.to_vec()));
        sent.ok().and_then(|()| lock(&self.desk.answers).recv().ok()).unwrap_or(Err(Broken::Asked))
    }
}

/// What came of work.
pub struct Worked<T> {
    /// What it came to.
    pub result: T,
    /// What it had to say.
    pub notes: Vec<String>,
    /// What Python raised meanwhile: Ctrl-C, an error of the callable or of who shows progress.
    pub raised: Option<PyErr>,
}

/// Does `work` on `threads` threads, as many as there are processors for 0; it is given who looks on, and who makes its
/// rollouts where that is `callable`. `progress` is called with each evaluation.
///
/// # Errors
/// A fault of hpf itself.
pub fn work<T: Send>(
    py: Python<'_>,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
    callable: Option<&Callable>,
    work: impl FnOnce(&dyn Watch, Option<&dyn Maker>) -> T + Send,
) -> PyResult<Worked<T>> {
    let (messages, inbox) = channel();
    let (answer, answers) = channel();
    let desk = Desk {
        messages: Mutex::new(messages.clone()),
        answers: Mutex::new(answers),
        notes: Mutex::default(),
        asked: AtomicUsize::new(0),
        shows_progress: progress.is_some(),
    };
    let kind = callable.map(Callable::kind);
    let serving = Serving { desk: &desk, answer, progress: progress.map(|one| one.clone().unbind()), callable };
    let watch = &desk;
    let (result, raised) = py.detach(move || {
        thread::scope(|scope| {
            let handle = scope.spawn(move || {
                let result = catch_unwind(AssertUnwindSafe(|| {
                    let bridge = kind.map(|kind| Bridge { desk: watch, kind });
                    let maker = bridge.as_ref().map(|bridge| bridge as &dyn Maker);
                    // A pool of its own: a process that forks has no threads of it.
                    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                    pool.map_err(|error| format!("cannot start threads: {error}"))
                        .map(|pool| pool.install(|| work(watch, maker)))
                }));
                let _ = messages.send(Message::Done);
                result.unwrap_or_else(|panic| Err(format!("a fault of hpf itself: {}", reason(&*panic))))
            });
            let raised = serving.serve(&inbox);
            let result = handle.join().unwrap_or_else(|panic| Err(reason(&*panic).to_owned()));
            (result, raised)
        })
    });
    let notes = lock(&desk.notes).drain(..).collect();
    if let Some(close) = progress.map(|progress| progress.getattr_opt("close")).transpose()?.flatten() {
        close.call0()?;
    }
    let result = result.map_err(|fault| errors::plain(py, "WorkError", &fault))?;
    Ok(Worked { result, notes, raised })
}

/// The thread that called.
struct Serving<'d> {
    desk: &'d Desk,
    answer: Sender<Result<Vec<Answer>, Broken>>,
    progress: Option<Py<PyAny>>,
    callable: Option<&'d Callable>,
}

impl Serving<'_> {
    /// Serves until the work is done; returns what Python raised first.
    fn serve(&self, inbox: &Receiver<Message>) -> Option<PyErr> {
        let mut raised = None;
        loop {
            match inbox.recv_timeout(GLANCE) {
                Ok(Message::Done) | Err(RecvTimeoutError::Disconnected) => break,
                Ok(Message::Row(row)) => {
                    // Nothing more is shown of work that is to end.
                    if !self.desk.is_asked()
                        && let Err(error) = Python::attach(|py| self.show(py, &row))
                    {
                        self.ask(&mut raised, error);
                    }
                }
                Ok(Message::Make(motions)) => {
                    let answers = Python::attach(|py| {
                        let made = self.callable.map_or(Ok(Vec::new()), |callable| callable.make(py, &motions));
                        made.map_err(|error| {
                            if Callable::is_interrupt(py, &error) {
                                self.ask(&mut raised, error);
                                return Broken::Asked;
                            }
                            let why = Callable::described(py, &error);
                            raised.get_or_insert(error);
                            Broken::Failed(why)
                        })
                    });
                    // Where nobody listens any more, it is about to end.
                    let _ = self.answer.send(answers);
                }
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(error) = Python::attach(|py| py.check_signals()) {
                        self.ask(&mut raised, error);
                    }
                }
            }
        }
        raised
    }

    /// Asks the work to end because of `error`.
    fn ask(&self, raised: &mut Option<PyErr>, error: PyErr) {
        self.desk.asked.fetch_add(1, Ordering::SeqCst);
        raised.get_or_insert(error);
    }

    fn show(&self, py: Python<'_>, row: &LearningRow) -> PyResult<()> {
        let Some(progress) = &self.progress else { return Ok(()) };
        progress.call1(py, (evaluation(py, row)?,)).map(drop)
    }
}

/// An evaluation as `hpf.Evaluation`.
pub fn evaluation<'py>(py: Python<'py>, row: &LearningRow) -> PyResult<Bound<'py, PyAny>> {
    let terms: Vec<(&str, f64)> = Term::NAMES.iter().copied().zip(row.terms.iter().copied()).collect();
    let numbers = (row.update, row.rollouts, row.total, terms, row.exploration);
    py.import("hpf.records")?.getattr("evaluation")?.call1(numbers)
}
