//! `hpf completions`: what a shell completes after `hpf`.

use clap::CommandFactory as _;

use crate::cli::{Arguments, Common, Completions};
use crate::deliver::deliver;
use crate::outcome::Outcome;
use hpf::failure::Failure;

/// Runs `hpf completions`.
pub fn completions(options: &Completions, common: &Common) -> Result<Outcome, Failure> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Arguments::command(), "hpf", &mut script);
    deliver(common, None, &script, |_| None)
}
