//! The commands, one file each: arguments to options to engine to text.

mod check;
mod export;
pub mod imitate;
mod info;
mod learn;
mod plot;
mod simulate;
mod start;

use crate::cli::{Arguments, Command};
use crate::failure::{Failure, Outcome};

/// Runs the command asked for, on as many threads as asked for.
///
/// # Errors
/// [`Failure`] with what to tell the user.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let common = &arguments.common;
    let threads = common.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| Failure::Work(format!("cannot start threads: {error}")))?;
    pool.install(|| match &arguments.command {
        Command::Learn(options) => learn::learn(options, common),
        Command::Run(options) => simulate::simulate(options, common),
        Command::Imitate(options) => imitate::imitate(options, common),
        Command::Plot(options) => plot::plot(options, common),
        Command::Check(options) => check::check(options, common),
        Command::Export(options) => export::export(options, common),
        Command::Info(options) => info::info(options, common),
    })
}
