//! Methods beside each other on every shipped task: what is learned, and what comes of it.

mod page;
mod study;

pub use self::page::{figures, json, markdown};
pub use self::study::Study;
