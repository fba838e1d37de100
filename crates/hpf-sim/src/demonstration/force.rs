//! What a recorded force is, before gains are read from it: its rest level and its sign.
//!
//! ```text
//! f = k e + d e' + f_0     k and d of a window, f_0 of the recording
//! f_0 = sum <1, f> / sum <1, 1>     <a, b> over a window, less what e and e' explain
//! ```
//! A rest level is taken where it leaves less than a quarter of the squares that are left without it. The sign is turned
//! where four windows of five need both negative stiffness and negative damping: no spring pulls away.

use core::ops::Range;

use super::path::Aligned;
use super::signal::differences;

/// What a force is.
pub struct Read {
    /// f_0 [N].
    pub rest: f64,
    /// Whether it is that of the tool on the environment.
    pub is_turned: bool,
    /// Stiffness and damping without bounds: of ten windows the second least and the second largest.
    pub gains: [[f64; 2]; 2],
}

/// A rest level leaves at most this share of the squares.
const LEFT: f64 = 0.25;
/// A rest level below this share of the largest force is none.
const LEAST_REST: f64 = 0.02;
/// The share of windows that turn the sign.
const TURNED: f64 = 0.8;
/// As in `gains`: offset and velocity this near to proportional say nothing, `1 - cos^2` of their angle.
const LEAST_ANGLE: f64 = 1e-3;
/// As in `gains`: the least share of the largest window's squares.
const LEAST_EXCITATION: f64 = 1e-6;

/// Sums of a window, of e, e', f and 1.
const SUMS: usize = 9;

/// Looks at the force of `axis`, whose recordings all have a reference; `None` where it says nothing.
pub fn look(recordings: &[Aligned], axis: usize, half: usize) -> Option<Read> {
    let mut windows: Vec<[f64; SUMS]> = Vec::new();
    let mut largest = 0.0_f64;
    for recording in recordings {
        let one = &recording.axes[axis];
        let (reference, force) = (one.reference.as_ref()?, one.force.as_ref()?);
        let error: Vec<f64> = one.position.iter().zip(reference).map(|(x, r)| x - r).collect();
        let velocity = differences(&error, recording.dt);
        largest = force.iter().fold(largest, |most, f| most.max(f.abs()));
        for i in 0..error.len() {
            let (from, to) = (i.saturating_sub(half), (i + half + 1).min(error.len()));
            windows.push(sums([&error, &velocity, force], from..to));
        }
    }
    let most = |j: usize| windows.iter().map(|window| window[j]).fold(0.0, f64::max);
    let (most_offset, most_velocity) = (most(0), most(2));
    windows.retain(|[ee, ev, vv, ..]| {
        *ee > LEAST_EXCITATION * most_offset
            && *vv > LEAST_EXCITATION * most_velocity
            && ee * vv - ev * ev > LEAST_ANGLE * ee * vv
    });
    if windows.is_empty() {
        return None;
    }
    let rest = rest(&windows, recordings, axis, half).filter(|rest| rest.abs() > LEAST_REST * largest).unwrap_or(0.0);
    let solved: Vec<[f64; 2]> = windows.iter().map(|sums| solve(sums, rest)).collect();
    let turned = solved.iter().filter(|[k, d]| *k < 0.0 && *d < 0.0).count();
    let is_turned = turned as f64 > TURNED * solved.len() as f64;
    let gains = [0, 1].map(|which| {
        let sign = if is_turned { -1.0 } else { 1.0 };
        let mut values: Vec<f64> = solved.iter().map(|gains| sign * gains[which]).collect();
        values.sort_by(f64::total_cmp);
        let outer = values.len() / 10;
        [values[outer], values[values.len() - 1 - outer]]
    });
    Some(Read { rest, is_turned, gains })
}

/// What e and e' explain of the products of two signals with them.
fn explained([ee, ev, vv, ..]: &[f64; SUMS], a: [f64; 2], b: [f64; 2]) -> f64 {
    let determinant = ee * vv - ev * ev;
    (a[0] * (vv * b[0] - ev * b[1]) + a[1] * (ee * b[1] - ev * b[0])) / determinant
}

/// The rest level that leaves least, where it leaves little of what is left without it.
fn rest(windows: &[[f64; SUMS]], recordings: &[Aligned], axis: usize, half: usize) -> Option<f64> {
    let (mut one_one, mut one_force) = (0.0, 0.0);
    for sums in windows {
        let [_, _, _, ef, vf, e, v, f, n] = *sums;
        one_one += n - explained(sums, [e, v], [e, v]);
        one_force += f - explained(sums, [e, v], [ef, vf]);
    }
    let rest = one_force / one_one;
    // The squares that are left, summed sample by sample: their difference would be lost in rounding.
    let left = |rest: f64| {
        let mut left = 0.0;
        for recording in recordings {
            let one = &recording.axes[axis];
            let (Some(reference), Some(force)) = (&one.reference, &one.force) else { continue };
            let error: Vec<f64> = one.position.iter().zip(reference).map(|(x, r)| x - r).collect();
            let velocity = differences(&error, recording.dt);
            for i in (0..error.len()).step_by(half.max(1)) {
                let (from, to) = (i.saturating_sub(half), (i + half + 1).min(error.len()));
                let sums = sums([&error, &velocity, force], from..to);
                let [ee, ev, vv, ..] = sums;
                if ee * vv - ev * ev <= LEAST_ANGLE * ee * vv {
                    continue;
                }
                let [k, d] = solve(&sums, rest);
                left += (from..to).map(|j| (force[j] - rest - k * error[j] - d * velocity[j]).powi(2)).sum::<f64>();
            }
        }
        left
    };
    (rest.is_finite() && left(rest) < LEFT * left(0.0)).then_some(rest)
}

/// Sums over a window of an offset [m], its velocity [m/s] and the force [N].
fn sums([error, velocity, force]: [&[f64]; 3], window: Range<usize>) -> [f64; SUMS] {
    let mut sums = [0.0; SUMS];
    for j in window {
        let (e, v, f) = (error[j], velocity[j], force[j]);
        let products = [e * e, e * v, v * v, e * f, v * f, e, v, f, 1.0];
        sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
    }
    sums
}

/// Stiffness and damping of a window without bounds.
fn solve([ee, ev, vv, ef, vf, e, v, ..]: &[f64; SUMS], rest: f64) -> [f64; 2] {
    let determinant = ee * vv - ev * ev;
    let (ef, vf) = (ef - rest * e, vf - rest * v);
    [(ef * vv - vf * ev) / determinant, (vf * ee - ef * ev) / determinant]
}
