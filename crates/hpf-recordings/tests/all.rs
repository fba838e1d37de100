//! All tests of hpf-recordings as one program.

#[cfg(feature = "bags")]
mod bags;
mod cases;
mod mutations;
mod names;
mod sources;
mod treatment;
