//! `hpf`: all of it is in the library, so that its readers can be tested and fuzzed.

#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    hpf_cli::main()
}
