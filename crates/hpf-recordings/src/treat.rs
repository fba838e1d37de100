//! What is mended in a recording, each by a rule, with a note; and what is refused instead.
//!
//! ```text
//! doubled rows    the second of two equal rows with one time is left out
//! wrong stamps    of even recordings: stamps off the even steps by more than 0.4 of one are put on them, where the
//!                 stamps around them fit; else a stamp with which the tool would jump is refused
//! gaps            5 steps or more without a sample: filled in where the tool moves by less than 5 % of its range in it,
//!                 or where asked for; else refused
//! held samples    rows that repeat a position at a regular count are left out, but for the first
//! wrapped angles  jumps beyond half a turn of an angle within one turn are taken as steps over its end
//! ```
//! A step is the median of the time between samples. A recording is even where seven of ten steps are within a quarter of
//! it.

mod angles;
mod gaps;
mod holds;
mod rest;
mod stamps;

pub use angles::align_turns;

use crate::collect::{MIN_SAMPLES, Raw};
use crate::guess;
use crate::mapping::Mapping;
use crate::mistake::Mistake;

/// Fewest samples in which steps are called even.
const LEAST_EVEN: usize = 10;
/// Steps within this share of the median are alike.
const ALIKE: f64 = 0.25;
/// The share of steps that must be alike.
const EVEN_SHARE: f64 = 0.7;

/// Mends `raw`.
///
/// # Errors
/// What cannot be mended, with its line.
pub fn treat(raw: &mut Raw, mapping: &Mapping, notes: &mut Vec<String>) -> Result<(), Vec<Mistake>> {
    stamps::drop_doubled(raw, notes);
    stamps::mend(raw, notes).map_err(|mistake| vec![mistake])?;
    holds::drop_held(raw, notes);
    angles::unwrap(raw, notes);
    gaps::bridge(raw, mapping.bridge, notes)?;
    rest::ends(raw, mapping.trim, notes);
    rest::speeds(raw, notes);
    if raw.time.len() < MIN_SAMPLES {
        let last = raw.lines.last().copied().unwrap_or(1);
        let message = format!("{} samples are left; at least {MIN_SAMPLES} are needed", raw.time.len());
        return Err(vec![Mistake::at(last, message)]);
    }
    Ok(())
}

/// The step of an even recording [s].
fn even_step(time: &[f64]) -> Option<f64> {
    if time.len() < LEAST_EVEN {
        return None;
    }
    let step = guess::median_step(time);
    let alike = time.windows(2).filter(|pair| (pair[1] - pair[0] - step).abs() <= ALIKE * step).count();
    (step > 0.0 && alike as f64 >= EVEN_SHARE * (time.len() - 1) as f64).then_some(step)
}

/// Largest less least.
fn range(values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (v.min(a), v.max(b)));
    high - low
}
