//! Stiffness and damping where nobody recorded them: from spread, muscle activity, or force.
//!
//! ```text
//! spread   k = k_max - (k_max - k_min) (sigma - sigma_min)/(sigma_max - sigma_min)
//! emg      k = k_min + (k_max - k_min) m/m_max
//! force    least squares of f = k e + d e' over a window, k and d within their bounds
//! ratio    d = 2 zeta sqrt(m k)
//! ```
//! sigma: standard deviation of the recordings; m: envelope of the muscle activity, m_max its largest value in all
//! recordings; e: the tool less its reference, or less the mean of the recordings.

use super::path::{Aligned, mean};
use super::signal::differences;

/// Where stiffness comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StiffnessFrom {
    /// The recordings' own columns.
    Columns,
    /// The spread of several recordings: stiff where they agree.
    Spread,
    /// Muscle activity.
    Emg,
    /// The recorded force and how far the tool gave way.
    Force,
    /// The task's initial value.
    Constant,
}

/// Where damping comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DampingFrom {
    /// The recordings' own columns.
    Columns,
    /// The recorded force and how fast the tool gave way.
    Force,
    /// A ratio to the critical damping of a mass on the stiffness.
    Ratio,
    /// The task's initial value.
    Constant,
}

/// Bounds of a gain.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub min: f64,
    pub max: f64,
}

impl Bounds {
    /// The value a `share` of the way from the least to the largest.
    fn at(&self, share: f64) -> f64 {
        self.min + (self.max - self.min) * share
    }

    fn hold(&self, value: f64) -> f64 {
        value.max(self.min).min(self.max)
    }
}

/// Spreads that differ by less than this share of their largest say nothing about stiffness.
const LEAST_CONTRAST: f64 = 1e-6;

/// Stiffness from the spread of paths; `None` where the paths spread alike everywhere.
pub fn from_spread(paths: &[&[f64]], bounds: Bounds) -> Option<Vec<f64>> {
    let middle = mean(paths.iter().copied());
    let deviation = |i: usize| {
        let squares: f64 = paths.iter().map(|path| (path[i] - middle[i]).powi(2)).sum();
        (squares / (paths.len() - 1) as f64).sqrt()
    };
    let sigma: Vec<f64> = (0..middle.len()).map(deviation).collect();
    let (least, most) = sigma.iter().fold((f64::INFINITY, 0.0), |(a, b), s| (s.min(a), s.max(b)));
    if most - least <= LEAST_CONTRAST * most {
        return None;
    }
    Some(sigma.iter().map(|s| bounds.at(1.0 - (s - least) / (most - least))).collect())
}

/// Stiffness from envelopes of muscle activity, the mean of the recordings; `None` where there is no activity.
pub fn from_emg(envelopes: &[&[f64]], bounds: Bounds) -> Option<Vec<f64>> {
    let most = envelopes.iter().copied().flatten().copied().fold(0.0, f64::max);
    if most <= 0.0 {
        return None;
    }
    Some(mean(envelopes.iter().copied()).into_iter().map(|m| bounds.at(m / most)).collect())
}

/// What a force says at each sample: stiffness and damping, or nothing.
pub type Identified = Vec<Option<(f64, f64)>>;

/// A window says nothing where offset or velocity is this small a share of the largest window's, as squares.
const LEAST_EXCITATION: f64 = 1e-6;
/// A window says nothing where offset and velocity are this near to proportional: `1 - cos^2` of their angle.
const LEAST_ANGLE: f64 = 1e-3;

/// Stiffness and damping at each sample by least squares of `f = k e + d e'` over the samples within `half` of it, all
/// recordings together.
///
/// Where each recording of `axis` has a reference, e is the distance from it. Else e is the distance from the mean of
/// the recordings and f the force less its mean: the law is linear, so it holds for them whatever the reference was.
pub fn from_force(recordings: &[Aligned], axis: usize, half: usize, stiffness: Bounds, damping: Bounds) -> Identified {
    let axes = || recordings.iter().map(|recording| &recording.axes[axis]);
    let has_reference = axes().all(|axis| axis.reference.is_some());
    let middle = mean(axes().map(|axis| axis.position.as_slice()));
    let middle_force = mean(axes().filter_map(|axis| axis.force.as_deref()));
    let samples = middle.len();
    // Sums of e e, e e', e' e', e f, e' f before each sample.
    let mut sums = vec![[0.0; 5]; samples + 1];
    for (recording, axis) in recordings.iter().zip(axes()) {
        let Some(force) = &axis.force else { continue };
        let reference = axis.reference.as_ref().filter(|_| has_reference).unwrap_or(&middle);
        let error: Vec<f64> = axis.position.iter().zip(reference).map(|(x, r)| x - r).collect();
        let velocity = differences(&error, recording.dt);
        let mut total = [0.0; 5];
        for i in 0..samples {
            let (e, v) = (error[i], velocity[i]);
            let f = if has_reference { force[i] } else { force[i] - middle_force[i] };
            for (total, product) in total.iter_mut().zip([e * e, e * v, v * v, e * f, v * f]) {
                *total += product;
            }
            sums[i + 1].iter_mut().zip(total).for_each(|(sum, total)| *sum += total);
        }
    }
    let window = |i: usize| -> [f64; 5] {
        let (from, to) = (i.saturating_sub(half), (i + half + 1).min(samples));
        core::array::from_fn(|j| sums[to][j] - sums[from][j])
    };
    let windows: Vec<[f64; 5]> = (0..samples).map(window).collect();
    let most = |j: usize| windows.iter().map(|window| window[j]).fold(0.0, f64::max);
    let (most_offset, most_velocity) = (most(0), most(2));
    let says = |window: &&[f64; 5]| {
        let [ee, ev, vv, ..] = **window;
        ee > LEAST_EXCITATION * most_offset
            && vv > LEAST_EXCITATION * most_velocity
            && ee * vv - ev * ev > LEAST_ANGLE * ee * vv
    };
    windows.iter().map(|window| Some(window).filter(says).map(|window| solve(*window, stiffness, damping))).collect()
}

/// The least of `|f - k e - d e'|^2` with k and d in their bounds: inside, or on one of the four edges.
fn solve([ee, ev, vv, ef, vf]: [f64; 5], stiffness: Bounds, damping: Bounds) -> (f64, f64) {
    let determinant = ee * vv - ev * ev;
    let (k, d) = ((ef * vv - vf * ev) / determinant, (vf * ee - ef * ev) / determinant);
    if stiffness.hold(k) == k && damping.hold(d) == d {
        return (k, d);
    }
    let on_stiffness = [stiffness.min, stiffness.max].map(|k| (k, damping.hold((vf - ev * k) / vv)));
    let on_damping = [damping.min, damping.max].map(|d| (stiffness.hold((ef - ev * d) / ee), d));
    let cost = |&(k, d): &(f64, f64)| k * (k * ee + 2.0 * d * ev - 2.0 * ef) + d * (d * vv - 2.0 * vf);
    let edges = on_stiffness.into_iter().chain(on_damping);
    edges.min_by(|a, b| cost(a).total_cmp(&cost(b))).expect("a box has four edges")
}

/// Damping at a ratio to the critical damping of `mass` on the stiffness.
pub fn from_ratio(stiffness: &[f64], ratio: f64, mass: f64) -> Vec<f64> {
    stiffness.iter().map(|k| 2.0 * ratio * (mass * k).sqrt()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const STIFFNESS: Bounds = Bounds { min: 30.0, max: 400.0 };
    const DAMPING: Bounds = Bounds { min: 10.0, max: 100.0 };

    #[test]
    fn stiffness_falls_with_the_spread_from_bound_to_bound() {
        // Two paths a distance 2 c apart have the standard deviation c sqrt 2: shares 0, 1/4 and 1 of the way.
        let (a, b) = ([0.1, 0.2, 0.5], [0.3, 0.6, 1.3]);
        let found = from_spread(&[&a, &b], STIFFNESS).unwrap();
        let expected = [400.0, 400.0 - 370.0 * (0.2 - 0.1) / (0.4 - 0.1), 30.0];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-11, "{found} {expected}");
        }
        assert_eq!(from_spread(&[&a, &a], STIFFNESS), None, "no spread");
        assert_eq!(from_spread(&[&[0.0; 3], &[0.5; 3]], STIFFNESS), None, "the same spread everywhere");
    }

    #[test]
    fn stiffness_rises_with_muscle_activity_from_the_lower_bound() {
        // Largest activity 4: means 0, 1 and 3 of it are 0, a quarter and three quarters.
        let found = from_emg(&[&[0.0, 0.0, 4.0], &[0.0, 2.0, 2.0]], STIFFNESS).unwrap();
        assert_eq!(found, [30.0, 30.0 + 370.0 * 0.25, 30.0 + 370.0 * 0.75]);
        assert_eq!(from_emg(&[&[0.0; 4]], STIFFNESS), None);
    }

    #[test]
    fn damping_at_ratio_one_is_critical() {
        assert_eq!(from_ratio(&[100.0, 400.0], 1.0, 1.0), [20.0, 40.0]);
        assert_eq!(from_ratio(&[100.0], 0.7, 4.0), [2.0 * 0.7 * 20.0]);
    }

    #[test]
    fn the_least_within_bounds_is_that_of_a_fine_grid() {
        for sums in [
            [1.0, 0.2, 0.5, 90.0, 20.0],
            [1.0, 0.9, 1.0, 500.0, 440.0],
            [1.0, -0.5, 0.4, 10.0, 90.0],
            [2.0, 0.3, 0.5, 10.0, 1.0],
        ] {
            let [ee, ev, vv, ef, vf] = sums;
            let cost = |k: f64, d: f64| k * k * ee + 2.0 * k * d * ev + d * d * vv - 2.0 * (k * ef + d * vf);
            let (k, d) = solve(sums, STIFFNESS, DAMPING);
            for i in 0..=200 {
                for j in 0..=200 {
                    let other = cost(STIFFNESS.at(f64::from(i) / 200.0), DAMPING.at(f64::from(j) / 200.0));
                    // Rounding of sums near 1e5.
                    assert!(cost(k, d) <= other + 1e-9, "{sums:?}: ({k}, {d})");
                }
            }
        }
    }
}
