//! Samples that were held: a position logged faster than it is measured repeats.

use crate::collect::Raw;

/// Fewest changes from which a count of repetitions is one.
const LEAST_CHANGES: usize = 10;
/// The share of runs that must have the usual length, or one more or less.
const REGULAR: f64 = 0.8;
/// Largest count of repetitions.
const MOST: usize = 1000;

/// Leaves out rows that repeat every position of the row before, where they do so at a regular count.
pub fn drop_held(raw: &mut Raw, notes: &mut Vec<String>) {
    let count = raw.time.len();
    let repeats = |i: usize| raw.axes.iter().all(|axis| axis.position[i] == axis.position[i - 1]);
    // Where each run of one position begins.
    let starts: Vec<usize> = (0..count).filter(|i| *i == 0 || !repeats(*i)).collect();
    // Rest before and after the motion is no hold.
    if starts.len() < LEAST_CHANGES + 2 {
        return;
    }
    let inner = &starts[1..];
    let mut lengths: Vec<usize> = inner.windows(2).map(|pair| pair[1] - pair[0]).collect();
    lengths.sort_unstable();
    let usual = lengths[lengths.len() / 2];
    let alike = lengths.iter().filter(|length| length.abs_diff(usual) <= 1).count();
    if !(2..=MOST).contains(&usual) || (alike as f64) < REGULAR * lengths.len() as f64 {
        return;
    }
    let (first, last) = (inner[0], inner[inner.len() - 1]);
    let mut is_kept = vec![true; count];
    for (i, kept) in is_kept.iter_mut().enumerate().take(last).skip(first) {
        *kept = starts.binary_search(&i).is_ok();
    }
    // The held samples before and after are thinned alike.
    for i in (0..first).rev() {
        is_kept[i] = i == 0 || (first - i).is_multiple_of(usual);
    }
    for (i, kept) in is_kept.iter_mut().enumerate().skip(last) {
        *kept = (i - last).is_multiple_of(usual);
    }
    let dropped = is_kept.iter().filter(|kept| !**kept).count();
    notes.push(format!(
        "positions are held over {usual} rows each, from line {} on: {dropped} rows that repeat one are left out",
        raw.lines[first]
    ));
    raw.retain(&is_kept);
}
