//! End to end, through the built binary: what a user types, and what comes of it.

mod acceptance;
mod check;
mod continuous;
mod directory;
mod docs_commands;
mod export;
mod info;
mod init;
mod layouts;
mod learn;
mod options;
mod plot;
mod recover;
mod run;
#[path = "../crates/hpf-sim/tests/solver/mod.rs"]
mod solver;
mod stochastic;
mod support;
