//! End to end, through the built binary: what a user types, and what comes of it.

mod acceptance;
mod check;
mod directory;
mod info;
mod learn;
mod plot;
mod run;
mod support;
