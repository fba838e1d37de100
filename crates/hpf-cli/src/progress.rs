//! The progress of learning, on stderr.

use core::time::Duration;
use std::io::{IsTerminal as _, stderr};
use std::sync::{Mutex, PoisonError};
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

    /// Takes the bar away.
    pub fn finish(self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// Learning as the terminal shows it; signals end it.
pub struct OnTerminal {
    is_quiet: bool,
    meter: Mutex<Meter>,
}

impl OnTerminal {
    /// From now on signals are noted. Where it `is_quiet`, only notes are printed.
    pub fn new(is_quiet: bool) -> Self {
        interrupt::watch();
        Self { is_quiet, meter: Mutex::new(Meter::Quiet) }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        core::mem::replace(&mut *self.meter.lock().unwrap_or_else(PoisonError::into_inner), Meter::Quiet).finish();
    }
}

impl Watch for OnTerminal {
    fn note(&self, sentence: &str) {
        tell(sentence);
    }

    fn begun(&self, task: &Task) {
        let meter = Meter::new(&task.name, task.learning.updates, task.learning.rollouts, self.is_quiet);
        *self.meter.lock().unwrap_or_else(PoisonError::into_inner) = meter;
    }

    fn evaluated(&self, row: &LearningRow) {
        self.meter.lock().unwrap_or_else(PoisonError::into_inner).show(row);
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

/// Many runs as the terminal shows them: how many are done; signals end them.
pub struct ManyOnTerminal {
    is_quiet: bool,
    tally: Mutex<Tally>,
}

impl ManyOnTerminal {
    /// From now on signals are noted. Where it `is_quiet`, only notes are printed.
    pub fn new(is_quiet: bool) -> Self {
        interrupt::watch();
        Self { is_quiet, tally: Mutex::new(Tally::Quiet) }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        core::mem::replace(&mut *self.tally.lock().unwrap_or_else(PoisonError::into_inner), Tally::Quiet).finish();
    }
}

impl Watch for ManyOnTerminal {
    fn note(&self, sentence: &str) {
        tell(sentence);
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

impl StudyWatch for ManyOnTerminal {
    fn planned(&self, name: &str, all: usize, done: usize) {
        *self.tally.lock().unwrap_or_else(PoisonError::into_inner) = Tally::new(name, all, done, self.is_quiet);
    }

    fn run_ended(&self, name: &str, failure: Option<&str>) {
        self.tally.lock().unwrap_or_else(PoisonError::into_inner).count(name, failure);
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

    /// Takes the bar away.
    pub fn finish(self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}
