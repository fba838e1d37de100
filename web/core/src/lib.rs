//! HPF inside a web page: tasks, rollouts, learning and the controller, for JavaScript.
//!
//! What learns and what controls is hpf-core, hpf-learn and hpf-sim as they are; here are only names and conversions.
//! Policies are those of the program `hpf`, to the byte.

mod learn;
mod motion;
mod task;
mod touch;

pub use learn::{WebLearned, learn};
pub use motion::{WebTrace, rollout};
pub use task::{WebTask, schema};
pub use touch::{Environment, Request, Touch, WebTouch};

use wasm_bindgen::prelude::wasm_bindgen;

/// Version of HPF, as in the policies that it writes.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// An error as JavaScript sees it.
fn refused(error: impl core::fmt::Display) -> wasm_bindgen::JsError {
    wasm_bindgen::JsError::new(&error.to_string())
}
