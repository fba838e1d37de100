//! Rest before and after a motion, and motions that are too fast for their unit.

use hpf_sim::task::Unit;

use super::range;
use crate::collect::{MIN_SAMPLES, Raw};
use crate::guess::{fastest, short};

/// Within this share of its range from its end an axis rests.
const REST: f64 = 0.005;
/// Rest of this share of the duration is noted.
const LONG: f64 = 0.2;
/// Faster than this an axis in m is likely in another unit [m/s].
const FASTEST: f64 = 10.0;

/// Notes long rest at the ends, or cuts it off.
pub fn ends(raw: &mut Raw, is_trimmed: bool, notes: &mut Vec<String>) {
    let count = raw.time.len();
    let moving: Vec<(&[f64], f64)> = raw
        .axes
        .iter()
        .map(|axis| (axis.position.as_slice(), range(&axis.position)))
        .filter(|(_, range)| *range > 0.0)
        .collect();
    if moving.is_empty() || count < 2 * MIN_SAMPLES {
        return;
    }
    let rests = |i: usize, end: usize| moving.iter().all(|(x, range)| (x[i] - x[end]).abs() <= REST * range);
    let first = (0..count).find(|i| !rests(*i, 0)).unwrap_or(count - 1).saturating_sub(1);
    let last = ((0..count).rev().find(|i| !rests(*i, count - 1)).unwrap_or(0) + 1).min(count - 1);
    let duration = raw.time[count - 1];
    let (before, after) = (raw.time[first], duration - raw.time[last]);
    if is_trimmed {
        if last > first + MIN_SAMPLES && (first > 0 || last + 1 < count) {
            notes.push(format!(
                "rest of {} s before and {} s after the motion is cut off",
                short(before),
                short(after)
            ));
            let is_kept: Vec<bool> = (0..count).map(|i| (first..=last).contains(&i)).collect();
            raw.retain(&is_kept);
            let start = raw.time[0];
            raw.time.iter_mut().for_each(|time| *time -= start);
        }
    } else if before.max(after) > LONG * duration {
        notes.push(format!(
            "the recording rests for {} s before and {} s after its motion, of {} s: --trim cuts it off",
            short(before),
            short(after),
            short(duration)
        ));
    }
}

/// Notes motions that are too fast to be in m, and axes that never move.
pub fn speeds(raw: &Raw, notes: &mut Vec<String>) {
    for axis in &raw.axes {
        let speed = fastest(&raw.time, 1.0, &axis.position);
        if axis.unit == Unit::M && speed > FASTEST {
            let name = &axis.name;
            notes.push(format!(
                "axis `{name}` moves at up to {} m/s over {} m: where its numbers are in mm, give --axis {name}=COLUMN:mm",
                short(speed),
                short(range(&axis.position))
            ));
        }
    }
}
