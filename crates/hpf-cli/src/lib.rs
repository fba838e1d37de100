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
mod start;
mod statistics;
mod style;
mod summary;
mod sweep;
mod trial;

use std::io::{Write as _, stderr};
use std::process::ExitCode;

use clap::Parser as _;

/// Reads the command line, runs the command, and says how it ended.
pub fn main() -> ExitCode {
    let arguments = cli::Arguments::parse();
    style::choose(arguments.common.color);
    match commands::run(&arguments) {
        Ok(outcome) => outcome.into(),
        Err(failure) => {
            // Where stderr is full or closed, the exit code still tells.
            let _ = writeln!(stderr(), "{failure}");
            failure.exit_code()
        }
    }
}
