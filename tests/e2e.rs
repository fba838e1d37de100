//! End to end, through the built binary: what a user types, and what comes of it.

mod acceptance;
mod check;
mod continuous;
mod directory;
mod export;
mod info;
mod kill;
mod learn;
mod plot;
mod process;
mod resume;
mod run;
#[path = "../crates/hpf-sim/tests/solver/mod.rs"]
mod solver;
mod support;
