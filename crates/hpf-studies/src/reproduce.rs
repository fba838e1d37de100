//! The paper in one go: its figures, and a table of its claims beside what comes out here.
//!
//! Li, Han, Hu, Lin, Li, "Robot Learning Method for Human-like Arm Skills Based on the Hybrid Primitive Framework",
//! Sensors 2024, 24(12), 3964, doi 10.3390/s24123964.

mod claims;
mod decisions;
mod figures;
mod folder;
mod page;
mod study;
mod variants;
mod words;

pub use self::claims::{Claim, Number, claims};
pub use self::folder::{refuse_occupied, write};
pub use self::page::{difference, json, markdown, placed};
pub use self::study::{Study, Variant};
pub use self::variants::variants;
pub use self::words::Worst;
