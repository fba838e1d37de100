//! One task learned many times: with several seeds, and with every combination of some settings.
//!
//! The plan says which runs there are and where each belongs; the work learns those that are not there yet; the outcome
//! is read back from their directories, so that it does not matter when a run was made.

mod outcome;
mod plan;
mod render;
mod work;

pub use self::outcome::{Outcome, Sample};
pub use self::plan::{Plan, Setting};
pub use self::render::render;
pub use self::work::learn_all;
