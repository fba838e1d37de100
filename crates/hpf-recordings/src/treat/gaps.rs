//! Stretches without a sample.

use super::{even_step, range};
use crate::collect::Raw;
use crate::guess::{median_step, short};
use crate::mistake::{MAX_MISTAKES, Mistake};

/// Steps without a sample from which on it is a gap.
const GAP: f64 = 5.0;
/// A gap in which the tool moves by less than this share of its range is filled in unasked.
const STILL: f64 = 0.05;
/// Fewest samples of a recording in which a gap is one.
const LEAST: usize = 20;
/// Of a recording with uneven steps: a step of more than this share of the duration is a gap.
const LONG: f64 = 0.2;
/// Most samples that are filled in, as a multiple of those recorded.
const MOST_FILLED: usize = 4;

/// Fills gaps in, or refuses those that say too little.
pub fn bridge(raw: &mut Raw, is_asked: bool, notes: &mut Vec<String>) -> Result<(), Vec<Mistake>> {
    let count = raw.time.len();
    if count < LEAST {
        return Ok(());
    }
    let (step, least) = match even_step(&raw.time) {
        Some(step) => (step, GAP * step),
        None => (median_step(&raw.time), LONG * raw.time[count - 1]),
    };
    let ranges: Vec<f64> = raw.axes.iter().map(|axis| range(&axis.position)).collect();
    let gaps: Vec<usize> = (0..count - 1).filter(|i| raw.time[i + 1] - raw.time[*i] >= least).collect();
    let mut mistakes = Vec::new();
    for &i in &gaps {
        let share = |(axis, range): (&hpf_sim::demonstration::RecordedAxis, &f64)| {
            if *range > 0.0 { (axis.position[i + 1] - axis.position[i]).abs() / range } else { 0.0 }
        };
        let share = raw.axes.iter().zip(&ranges).map(share).fold(0.0, f64::max);
        let length = raw.time[i + 1] - raw.time[i];
        let words = format!(
            "no sample between lines {} and {}: {} s, {} steps, in which the tool moves by {:.0} % of its range",
            raw.lines[i],
            raw.lines[i + 1],
            short(length),
            (length / step).round(),
            100.0 * share
        );
        if is_asked || share < STILL {
            notes.push(format!("{words}; it is filled in by a cubic, which is a guess"));
        } else {
            mistakes.push(Mistake::at(raw.lines[i + 1], format!("{words}; --bridge fills it in by a cubic")));
        }
    }
    if !mistakes.is_empty() {
        mistakes.truncate(MAX_MISTAKES);
        return Err(mistakes);
    }
    let filled: f64 = gaps.iter().map(|i| (raw.time[i + 1] - raw.time[*i]) / step).sum();
    if filled > (MOST_FILLED * count) as f64 {
        let message = format!("gaps of {} steps among {count} samples: too much is missing", filled.round());
        return Err(vec![Mistake::at(raw.lines[gaps[0] + 1], message)]);
    }
    fill(raw, &gaps, step);
    Ok(())
}

/// Inserts samples into gaps: positions on the cubic with the slopes at both ends, all else on the line.
fn fill(raw: &mut Raw, gaps: &[usize], step: f64) {
    for &i in gaps.iter().rev() {
        let time = raw.time.clone();
        let length = time[i + 1] - time[i];
        let count = (length / step).round() as usize - 1;
        let shares: Vec<f64> = (1..=count).map(|j| j as f64 / (count + 1) as f64).collect();
        for axis in &mut raw.axes {
            let cubic = |x: &[f64]| -> Vec<f64> {
                let slope = |from: usize, to: usize| (x[to] - x[from]) / (time[to] - time[from]);
                let before = if i > 0 { slope(i - 1, i) } else { slope(i, i + 1) };
                let after = if i + 2 < x.len() { slope(i + 1, i + 2) } else { slope(i, i + 1) };
                let (m0, m1, rise) = (length * before, length * after, x[i + 1] - x[i]);
                let at = |s: &f64| x[i] + s * (m0 + s * (3.0 * rise - 2.0 * m0 - m1 + s * (m0 + m1 - 2.0 * rise)));
                shares.iter().map(at).collect()
            };
            let insert = |list: &mut Vec<f64>, new: Vec<f64>| drop(list.splice(i + 1..i + 1, new));
            let new = cubic(&axis.position);
            insert(&mut axis.position, new);
            if let Some(reference) = &mut axis.reference {
                let new = cubic(reference);
                insert(reference, new);
            }
            for list in [&mut axis.stiffness, &mut axis.damping, &mut axis.force, &mut axis.emg].into_iter().flatten() {
                let new = shares.iter().map(|s| list[i] + s * (list[i + 1] - list[i])).collect();
                insert(list, new);
            }
        }
        let line = raw.lines[i];
        raw.lines.splice(i + 1..i + 1, shares.iter().map(|_| line));
        raw.time.splice(i + 1..i + 1, shares.iter().map(|s| time[i] + s * length));
    }
}
