//! Recorded motions, read from the files they come in: what is in a file is read right, mended by a stated rule with a
//! note, or refused with line and column.
//!
//! ```text
//! bytes ─► format (text, npy, bag) ─► table ─► mapping ─► signals ─► treatment ─► recording
//! ```
//!
//! [`read`] takes the bytes of a whole file and a [`Mapping`], which says what its columns are; left empty, columns are
//! read by their names (`time_s`, `x_m`, `x_force_n`). [`inspect`] says what is in a file, what its columns may be and
//! why, and the options that may read it. [`align_turns`] brings several recordings of angles together.
//!
//! Memory: at most [`MAX_CELLS`] numbers of 8 bytes, beside the bytes of the file.

#[cfg(feature = "bags")]
mod bag;
mod collect;
mod guess;
mod mapping;
mod mistake;
mod names;
mod npy;
mod preset;
mod read;
mod refused;
mod saw;
mod select;
mod table;
mod text;
mod treat;
mod units;

pub use collect::MIN_SAMPLES;
pub use mapping::{AxisSource, Mapping, Source, units_of};
pub use mistake::{MAX_MISTAKES, Mistake, Refusal};
pub use preset::{PRESETS, Preset};
pub use read::{Read, inspect, read};
pub use saw::{Saw, SawColumn, Topic};
pub use text::MAX_CELLS;
pub use treat::align_turns;
pub use units::{Dimension, UNITS, UnitWord};
