//! The commands, one file each: arguments to options to engine to text.

mod benchmark;
mod check;
mod completions;
mod export;
mod imitate;
mod info;
mod init;
mod learn;
mod manual;
mod plot;
mod recover;
mod report;
mod reproduce;
mod schema;
mod simulate;
mod sweep;

use crate::cli::{Arguments, Command, Common};
use crate::outcome::Outcome;
use hpf::failure::Failure;

/// Runs the command asked for, on as many threads as asked for.
///
/// # Errors
/// [`Failure`] with the message for the user.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let common = &arguments.common;
    refuse_meaningless(&arguments.command, common)?;
    let threads = common.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| Failure::Work(format!("cannot start threads: {error}")))?;
    pool.install(|| match &arguments.command {
        Command::Learn(options) => learn::learn(options, common),
        Command::Run(options) => simulate::simulate(options, common),
        Command::Imitate(options) => imitate::imitate(options, common),
        Command::Plot(options) => plot::plot(options, common),
        Command::Report(options) => report::report(options, common),
        Command::Check(options) => check::check(options, common),
        Command::Export(options) => export::export(options, common),
        Command::Sweep(options) => sweep::sweep(options, common),
        Command::Reproduce(options) => reproduce::reproduce(options, common),
        Command::Benchmark(options) => benchmark::benchmark(options, common),
        Command::Info(options) => info::info(options, common),
        Command::Recover(options) => recover::recover(options, common),
        Command::Init(options) => init::init(options, common),
        Command::Schema => schema::schema(common),
        Command::Completions(options) => completions::completions(options, common),
        Command::Manual => manual::manual(common),
    })
}

/// An option for a result that the command does not have is a mistake, and is refused. The other common options are valid
/// for every command; where nothing is drawn, rolled out or replaced, they change nothing.
fn refuse_meaningless(command: &Command, common: &Common) -> Result<(), Failure> {
    let (name, has_out, has_json) = match command {
        Command::Check(_) => ("check", false, true),
        Command::Info(_) => ("info", false, true),
        Command::Completions(_) => ("completions", true, false),
        _ => return Ok(()),
    };
    let given = [("--out", common.out.is_some() && !has_out), ("--json", common.json && !has_json)];
    match given.into_iter().find(|(_, is_refused)| *is_refused) {
        Some((option, _)) => Err(Failure::Input(format!("{option} means nothing to hpf {name}: leave it out"))),
        None => Ok(()),
    }
}
