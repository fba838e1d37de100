//! Time stamps that are not those of their samples.

use super::{even_step, range};
use crate::collect::Raw;
use crate::guess::{median_step, short};
use crate::mistake::Mistake;

/// A stamp off the even steps by more than this share of one is put on them.
const OFF: f64 = 0.4;
/// Of a recording with uneven steps: a step shorter than this share of the usual one may be a wrong stamp.
const SHORT: f64 = 0.25;
/// It is one where the tool would be so many times faster in it than around it,
const FASTER: f64 = 4.0;
/// and would move by more than this share of its range.
const MOVES: f64 = 1e-3;
/// Samples on each side that say how fast the tool is around a step.
const AROUND: usize = 5;
/// Stamps that arrive in bursts are spread evenly where none moves by more than this share of the duration.
const MOST_SPREAD: f64 = 0.05;

/// Leaves out a row that repeats the one before, time and all.
pub fn drop_doubled(raw: &mut Raw, notes: &mut Vec<String>) {
    let count = raw.time.len();
    let mut is_kept = vec![true; count];
    for i in 1..count {
        let same = |values: &Vec<f64>| values[i] == values[i - 1];
        is_kept[i] = raw.time[i] != raw.time[i - 1] || !raw.signals_mut().all(|values| same(values));
    }
    let dropped = is_kept.iter().filter(|kept| !**kept).count();
    if dropped > 0 {
        let first = is_kept.iter().position(|kept| !kept).map_or(0, |i| raw.lines[i]);
        notes.push(format!("{dropped} rows repeat the row before, from line {first} on, and are left out"));
        raw.retain(&is_kept);
    }
}

/// Mends time stamps.
pub fn mend(raw: &mut Raw, notes: &mut Vec<String>) -> Result<(), Mistake> {
    if let Some(step) = even_step(&raw.time) {
        put_on_steps(raw, step, notes);
    }
    let Some((at, faster)) = jump(raw) else { return Ok(()) };
    if let Some(most) = spread(raw) {
        let rate = (raw.time.len() - 1) as f64 / raw.time[raw.time.len() - 1];
        notes.push(format!(
            "time stamps arrive in bursts, as at line {}; the samples are taken as even, at {} Hz: a stamp moves by up to \
             {} s",
            raw.lines[at],
            short(rate),
            short(most)
        ));
        return Ok(());
    }
    let dt = raw.time[at] - raw.time[at - 1];
    let twice = raw.twice.iter().find(|mistake| mistake.line == raw.lines[at]);
    Err(if let Some(twice) = twice {
        twice.clone()
    } else {
        let message = format!(
            "the time rises by {} s here, in which the tool would move {} times as fast as around it: the stamp is not that \
             of the sample; correct it, or read the rows as even with --sample-rate HZ",
            short(dt),
            short(faster)
        );
        Mistake::at(raw.lines[at], message)
    })
}

/// Puts stamps between stamps that fit even steps on those.
fn put_on_steps(raw: &mut Raw, step: f64, notes: &mut Vec<String>) {
    let time = &mut raw.time;
    let is_off = |time: &[f64], i: usize| (time[i + 1] - time[i] - step).abs() > OFF * step;
    let (mut moved, mut most, mut first) = (0, 0.0_f64, 0);
    let mut i = 0;
    while i + 1 < time.len() {
        if !is_off(time, i) {
            i += 1;
            continue;
        }
        let mut end = i + 1;
        while end + 1 < time.len() && is_off(time, end) {
            end += 1;
        }
        let count = end - i;
        let whole = time[end] - time[i];
        if count >= 2 && (whole - count as f64 * step).abs() <= OFF * step {
            for inner in i + 1..end {
                let even = time[i] + whole * (inner - i) as f64 / count as f64;
                if (time[inner] - even).abs() > OFF * step {
                    if moved == 0 {
                        first = raw.lines[inner];
                    }
                    moved += 1;
                }
                most = most.max((time[inner] - even).abs());
                time[inner] = even;
            }
        }
        i = end;
    }
    if moved > 0 {
        notes.push(format!(
            "{moved} time stamps, the first in line {first}, are off the even steps of {} s by up to {} s and put on them",
            short(step),
            short(most)
        ));
    }
}

/// The first sample whose stamp makes the tool jump, and how many times as fast as around it.
fn jump(raw: &Raw) -> Option<(usize, f64)> {
    let time = &raw.time;
    let last = time.len() - 1;
    let mean = time[last] / last as f64;
    let usual = median_step(time).max(0.5 * mean);
    let ranges: Vec<f64> = raw.axes.iter().map(|axis| range(&axis.position)).collect();
    for i in 1..=last {
        let dt = time[i] - time[i - 1];
        if dt == 0.0 {
            return Some((i, f64::INFINITY));
        }
        if dt >= SHORT * usual {
            continue;
        }
        let (from, to) = (i.saturating_sub(AROUND + 1), (i + AROUND).min(last));
        for (axis, range) in raw.axes.iter().zip(&ranges) {
            let x = &axis.position;
            let moved = (x[i] - x[i - 1]).abs();
            let way: f64 = x[from..=to].windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
            let around = way / (time[to] - time[from]).max(f64::MIN_POSITIVE);
            let faster = moved / dt / around.max(f64::MIN_POSITIVE);
            if moved > MOVES * range && faster > FASTER {
                return Some((i, faster));
            }
        }
    }
    None
}

/// Spreads all stamps evenly where that moves none far; the most that one moved [s].
fn spread(raw: &mut Raw) -> Option<f64> {
    let last = raw.time.len() - 1;
    if last < super::LEAST_EVEN {
        return None;
    }
    let duration = raw.time[last];
    let even = |i: usize| duration * i as f64 / last as f64;
    let most = raw.time.iter().enumerate().map(|(i, time)| (time - even(i)).abs()).fold(0.0, f64::max);
    if most > MOST_SPREAD * duration {
        return None;
    }
    raw.time = (0..=last).map(even).collect();
    Some(most)
}
