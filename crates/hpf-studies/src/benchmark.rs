//! Methods beside each other on every shipped task: what is learned, and what comes of it.

mod history;
mod page;
mod study;

pub use self::history::History;
pub use self::page::{figures, json, markdown};
pub use self::study::{Reached, Result, Study, TARGETS, Target};
