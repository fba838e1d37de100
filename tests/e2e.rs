//! End to end, through the built binary: what a user types, and what comes of it.

mod acceptance;
mod benchmark;
mod certificates;
mod check;
mod continuous;
mod directory;
mod docs_commands;
mod export;
#[path = "../crates/hpf-sim/tests/generator/mod.rs"]
mod generator;
mod imitate;
mod info;
mod init;
mod kill;
mod layouts;
mod learn;
mod nodes;
mod options;
mod plot;
mod process;
mod random_tasks;
mod recordings;
mod recover;
mod report;
mod reproduce;
mod resume;
mod robustness;
mod run;
mod sinks;
#[path = "../crates/hpf-sim/tests/solver/mod.rs"]
mod solver;
mod stochastic;
mod support;
mod sweep;
mod terminal;
#[path = "../crates/hpf-sim/tests/waves/mod.rs"]
mod waves;
