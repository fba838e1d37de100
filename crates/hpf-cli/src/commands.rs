//! The commands, one file each: arguments to options to engine to text.

mod check;
mod completions;
mod export;
mod info;
pub mod init;
mod learn;
mod manual;
mod plot;
mod recover;
mod schema;
mod simulate;

use crate::cli::{Arguments, Command, Common};
use crate::failure::{Failure, Outcome};

/// Runs the command asked for, on as many threads as asked for.
///
/// # Errors
/// [`Failure`] with what to tell the user.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let common = &arguments.common;
    refuse_meaningless(&arguments.command, common)?;
    let threads = common.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| Failure::Work(format!("cannot start threads: {error}")))?;
    pool.install(|| match &arguments.command {
        Command::Learn(options) => learn::learn(options, common),
        Command::Run(options) => simulate::simulate(options, common),
        Command::Plot(options) => plot::plot(options, common),
        Command::Check(options) => check::check(options, common),
        Command::Export(options) => export::export(options, common),
        Command::Info(options) => info::info(options, common),
        Command::Recover(options) => recover::recover(options, common),
        Command::Init(options) => init::init(options, common),
        Command::Schema => schema::schema(common),
        Command::Completions(options) => completions::completions(options, common),
        Command::Manual => manual::manual(common),
    })
}

/// An option that would do nothing is a mistake of the user's, not to be passed over in silence.
fn refuse_meaningless(command: &Command, common: &Common) -> Result<(), Failure> {
    let (name, meant): (_, &[&str]) = match command {
        Command::Plot(_) => ("plot", &["--out", "--force", "--json"]),
        Command::Check(_) => ("check", &["--seed", "--json"]),
        Command::Export(_) => ("export", &["--out", "--force", "--json"]),
        Command::Info(_) => ("info", &["--json"]),
        Command::Recover(_) => ("recover", &["--out", "--force", "--json"]),
        Command::Init(_) => ("init", &["--out", "--force", "--json"]),
        Command::Schema => ("schema", &["--out", "--force", "--json"]),
        Command::Completions(_) => ("completions", &["--out", "--force"]),
        Command::Manual => ("manual", &["--out", "--force", "--json"]),
        // What makes rollouts takes every one.
        _ => return Ok(()),
    };
    let given = [
        ("--seed", common.seed.is_some()),
        ("--threads", common.threads.is_some()),
        ("--out", common.out.is_some()),
        ("--force", common.force),
        ("--json", common.json),
    ];
    match given.into_iter().find(|(option, given)| *given && !meant.contains(option)) {
        Some((option, _)) => Err(Failure::Input(format!("{option} means nothing to hpf {name}: leave it out"))),
        None => Ok(()),
    }
}
