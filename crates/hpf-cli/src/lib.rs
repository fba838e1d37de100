//! `hpf`: learn, run and inspect compliant robot skills.

#![forbid(unsafe_code)]

mod choice;
mod cli;
mod commands;
mod comparison;
mod deliver;
mod interrupt;
mod outcome;
mod progress;
mod render;
mod style;
mod sweep_table;
mod terminal;

use core::panic::AssertUnwindSafe;
use std::ffi::OsString;
use std::io::{Write as _, stdout};
use std::panic::catch_unwind;
use std::process::ExitCode;

use clap::Parser as _;

use hpf::escape::shown;
use hpf::failure::Failure;
use hpf::sinks::reason;

/// Reads the command line, runs the command, and says how it ended. A result that is to be printed where stdout
/// `was_closed` when the program began is a failure.
pub fn main(was_closed: bool) -> ExitCode {
    terminal::begin(was_closed);
    run(std::env::args_os()).into()
}

/// Runs the command of `arguments`, the first of which is the name of the program, and returns its exit code: for who
/// starts the program inside of another one.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match cli::Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(answer) => return tell_of_arguments(&answer),
    };
    style::choose(arguments.common.color);
    match last_resort(|| commands::run(&arguments)) {
        Ok(outcome) => outcome.exit_code(),
        Err(failure) => fail(&failure),
    }
}

fn fail(failure: &Failure) -> u8 {
    terminal::complain(failure);
    outcome::exit_code(failure)
}

/// Runs a command; a fault of the program itself is a failure, reported in one line without a backtrace.
///
/// # Errors
/// What `command` returns, or its panic.
fn last_resort<T>(command: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map(|place| format!(" at {place}")).unwrap_or_default();
        terminal::tell(&format!("fault of hpf{place}: {}", reason(panic.payload())));
    }));
    catch_unwind(AssertUnwindSafe(command))
        .unwrap_or_else(|panic| Err(Failure::Work(format!("a fault of hpf itself: {}", reason(&*panic)))))
}

/// Prints what clap answers in place of arguments: help and version are results, mistakes are not.
fn tell_of_arguments(answer: &clap::Error) -> u8 {
    if answer.use_stderr() {
        let text = answer.render().to_string();
        // Arguments that a terminal would obey are quoted in it: then without colours.
        if shown(&text) == text {
            let _ = answer.print();
        } else {
            terminal::tell(text.trim_end());
        }
        return 2;
    }
    match terminal::printed(answer.print().and_then(|()| stdout().flush())) {
        Ok(()) => 0,
        Err(failure) => fail(&failure),
    }
}
