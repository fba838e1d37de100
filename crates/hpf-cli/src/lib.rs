//! `hpf`: learn, run and inspect compliant robot skills.

#![forbid(unsafe_code)]

mod benchmark;
mod checkpoint;
mod cli;
mod commands;
mod comparison;
mod conduct;
mod directory;
mod export;
mod failure;
mod figure;
mod files;
mod interrupt;
mod learning;
mod log;
mod nodes;
mod overrides;
mod packed;
mod process;
mod progress;
pub mod readers;
mod render;
mod report;
mod reproduce;
mod results;
mod side_by_side;
mod sinks;
mod start;
mod statistics;
mod style;
mod summary;
mod sweep;
mod terminal;
mod trial;

use std::io::{Write as _, stdout};
use std::process::ExitCode;

use clap::Parser as _;

use crate::failure::Failure;

/// Reads the command line, runs the command, and says how it ended.
pub fn main() -> ExitCode {
    let arguments = match cli::Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(answer) => return tell_of_arguments(&answer),
    };
    style::choose(arguments.common.color);
    match sinks::last_resort(|| commands::run(&arguments)) {
        Ok(outcome) => outcome.into(),
        Err(failure) => fail(&failure),
    }
}

fn fail(failure: &Failure) -> ExitCode {
    terminal::complain(failure);
    failure.exit_code()
}

/// Prints what clap answers in place of arguments: help and version are results, mistakes are not.
fn tell_of_arguments(answer: &clap::Error) -> ExitCode {
    if answer.use_stderr() {
        let text = answer.render().to_string();
        // Arguments that a terminal would obey are quoted in it: then without colours.
        if terminal::shown(&text) == text {
            let _ = answer.print();
        } else {
            terminal::tell(text.trim_end());
        }
        return ExitCode::from(2);
    }
    match terminal::printed(answer.print().and_then(|()| stdout().flush())) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => fail(&failure),
    }
}
