//! The progress of learning, on stderr.

use core::time::Duration;
use std::io::{IsTerminal as _, stderr};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use hpf::escape::{line, shown};
use hpf::results::LearningRow;
use hpf::watch::Watch;
use hpf::words::number;
use hpf_sim::Task;
use hpf_studies::StudyWatch;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::interrupt;
use crate::terminal::tell;

/// Time between plain lines.
const INTERVAL: Duration = Duration::from_secs(2);

/// A bar on a terminal, a plain line now and then elsewhere, nothing when quiet.
pub enum Meter {
    /// Nothing.
    Quiet,
    /// A bar.
    Bar(ProgressBar),
    /// Lines.
    Lines {
        /// Planned updates.
        updates: usize,
        /// When the last line was written.
        last: Instant,
    },
}

impl Meter {
    /// A meter for `updates` of task `name`.
    pub fn new(name: &str, updates: usize, rollouts: usize, quiet: bool) -> Self {
        if quiet {
            return Self::Quiet;
        }
        if !stderr().is_terminal() {
            tell(&format!("learning {name}: {updates} updates of {rollouts} rollouts"));
            return Self::Lines { updates, last: Instant::now() };
        }
        let bar = ProgressBar::with_draw_target(Some(updates as u64), ProgressDrawTarget::stderr());
        let template = "learning {prefix} {wide_bar} {pos}/{len} updates, {rate}/s, {eta} left, cost {msg}";
        let style = ProgressStyle::with_template(template).expect("the template is valid");
        let rate = |state: &ProgressState, line: &mut dyn core::fmt::Write| {
            // A write into the bar's own line cannot fail.
            let _ = write!(line, "{:.0}", state.per_sec());
        };
        let style = style.with_key("rate", rate);
        Self::Bar(bar.with_style(style).with_prefix(line(name).into_owned()))
    }

    /// Shows an evaluation.
    pub fn show(&mut self, progress: &LearningRow) {
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                bar.set_position(progress.update as u64);
                bar.set_message(number(progress.total));
            }
            Self::Lines { updates, last } => {
                let is_last = progress.update == *updates;
                if progress.update == 0 || is_last || last.elapsed() >= INTERVAL {
                    tell(&format!("update {}/{updates}: cost {}", progress.update, number(progress.total)));
                    *last = Instant::now();
                }
            }
        }
    }
}

/// What is shown of work that goes on.
pub trait Shown {
    /// Nothing is shown.
    const QUIET: Self;

    /// The bar that is to be taken away in the end, where there is one.
    fn bar(self) -> Option<ProgressBar>;

    /// Learning of `task` begins.
    fn begun(&mut self, _task: &Task, _is_quiet: bool) {}

    /// Learning has come so far.
    fn evaluated(&mut self, _row: &LearningRow) {}
}

impl Shown for Meter {
    const QUIET: Self = Self::Quiet;

    fn bar(self) -> Option<ProgressBar> {
        if let Self::Bar(bar) = self { Some(bar) } else { None }
    }

    fn begun(&mut self, task: &Task, is_quiet: bool) {
        *self = Self::new(&task.name, task.learning.updates, task.learning.rollouts, is_quiet);
    }

    fn evaluated(&mut self, row: &LearningRow) {
        self.show(row);
    }
}

impl Shown for Tally {
    const QUIET: Self = Self::Quiet;

    fn bar(self) -> Option<ProgressBar> {
        if let Self::Bar(bar) = self { Some(bar) } else { None }
    }
}

/// Work as the terminal shows it, by a [`Meter`] or, of many runs, a [`Tally`]; signals end it.
pub struct OnTerminal<M> {
    is_quiet: bool,
    shown: Mutex<M>,
}

impl<M: Shown> OnTerminal<M> {
    /// From now on signals are noted. Where it `is_quiet`, only notes are printed.
    pub fn new(is_quiet: bool) -> Self {
        interrupt::watch();
        Self { is_quiet, shown: Mutex::new(M::QUIET) }
    }

    fn shown(&self) -> MutexGuard<'_, M> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = core::mem::replace(&mut *self.shown(), M::QUIET).bar() {
            bar.finish_and_clear();
        }
    }
}

impl<M: Shown + Send> Watch for OnTerminal<M> {
    fn note(&self, sentence: &str) {
        tell(sentence);
    }

    fn begun(&self, task: &Task) {
        self.shown().begun(task, self.is_quiet);
    }

    fn evaluated(&self, row: &LearningRow) {
        self.shown().evaluated(row);
    }

    fn is_asked(&self) -> bool {
        interrupt::is_asked()
    }

    fn is_urgent(&self) -> bool {
        interrupt::is_urgent()
    }

    fn hold(&self, is_held: bool) {
        interrupt::hold(is_held);
    }
}

impl StudyWatch for OnTerminal<Tally> {
    fn planned(&self, name: &str, all: usize, done: usize) {
        *self.shown() = Tally::new(name, all, done, self.is_quiet);
    }

    fn run_ended(&self, name: &str, failure: Option<&str>) {
        self.shown().count(name, failure);
    }
}

/// How many of some runs are done.
pub enum Tally {
    /// Nothing is shown.
    Quiet,
    /// A bar.
    Bar(ProgressBar),
    /// Lines.
    Lines {
        /// All runs.
        all: usize,
        /// Runs done.
        done: usize,
        /// When the last line was written.
        last: Instant,
    },
}

impl Tally {
    /// A tally of `all` runs of `name`, of which `done` are done already.
    pub fn new(name: &str, all: usize, done: usize, quiet: bool) -> Self {
        if quiet {
            return Self::Quiet;
        }
        if !stderr().is_terminal() {
            return Self::Lines { all, done, last: Instant::now() };
        }
        let bar = ProgressBar::with_draw_target(Some(all as u64), ProgressDrawTarget::stderr());
        let template = "{prefix} [{bar:30}] {pos}/{len} runs, {elapsed} gone, {eta} left";
        let style = ProgressStyle::with_template(template).expect("the template is valid");
        let bar = bar.with_style(style).with_prefix(line(name).into_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
        bar.set_position(done as u64);
        bar.reset_eta();
        Self::Bar(bar)
    }

    /// Counts the run `name`, and says why it failed, if it did.
    pub fn count(&mut self, name: impl core::fmt::Display, failure: Option<&str>) {
        let complaint = failure.map(|why| format!("{name} failed: {why}"));
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                bar.inc(1);
                if let Some(complaint) = complaint {
                    bar.println(shown(&complaint));
                }
            }
            Self::Lines { all, done, last } => {
                *done += 1;
                if let Some(complaint) = complaint {
                    tell(&complaint);
                }
                if done == all || last.elapsed() >= INTERVAL {
                    tell(&format!("{done}/{all} runs"));
                    *last = Instant::now();
                }
            }
        }
    }
}
