//! Signals of a recording: onto equal steps, smoothed without delay, differentiated.

use core::f64::consts::{PI, SQRT_2};

/// How much of a recorded path is smoothed away before it is differentiated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Smoothing {
    /// Cut-off `2 (n - 1)/T`, n basis functions in the duration T: four times what they can follow.
    #[default]
    Basis,
    /// A cut-off of this frequency [Hz].
    CutOff(f64),
    /// None.
    Off,
}

/// Above this share of the sample rate a cut-off leaves nothing to smooth.
const LARGEST_CUT_OFF: f64 = 0.4;

/// Below this many periods of the cut-off in the reflection, its slowest wave passes by less than 1e-12: the line is left.
const LEAST_CUT_OFF: f64 = 1e-3;

/// `values` at `times` (rising) taken at `at`, on cubics with the slopes of parabolas through three samples: exact for
/// parabolas, smooth in the first derivative.
pub fn resample(times: &[f64], values: &[f64], at: impl Iterator<Item = f64>) -> Vec<f64> {
    let last = times.len() - 1;
    let secant = |i: usize| (values[i + 1] - values[i]) / (times[i + 1] - times[i]);
    let slope = |i: usize| match i {
        0 => 2.0 * secant(0) - inner_slope(times, &secant, 1),
        i if i == last => 2.0 * secant(last - 1) - inner_slope(times, &secant, last - 1),
        i => inner_slope(times, &secant, i),
    };
    walk(times, at, |i, share| {
        let h = times[i + 1] - times[i];
        let (m0, m1) = (h * slope(i), h * slope(i + 1));
        let rise = values[i + 1] - values[i];
        values[i] + share * (m0 + share * (3.0 * rise - 2.0 * m0 - m1 + share * (m0 + m1 - 2.0 * rise)))
    })
}

/// The slope at sample `i` of the parabola through its neighbours and itself.
fn inner_slope(times: &[f64], secant: &impl Fn(usize) -> f64, i: usize) -> f64 {
    let (before, after) = (times[i] - times[i - 1], times[i + 1] - times[i]);
    (after * secant(i - 1) + before * secant(i)) / (before + after)
}

/// `values` at `times` (rising) taken at `at`, linear between samples: never beyond them.
pub fn resample_linear(times: &[f64], values: &[f64], at: impl Iterator<Item = f64>) -> Vec<f64> {
    walk(times, at, |i, share| values[i] + share * (values[i + 1] - values[i]))
}

/// `value(interval, share of it)` at each instant of `at`, which must rise; held at both ends.
fn walk(times: &[f64], at: impl Iterator<Item = f64>, value: impl Fn(usize, f64) -> f64) -> Vec<f64> {
    let mut i = 0;
    at.map(|time| {
        while i + 2 < times.len() && times[i + 1] <= time {
            i += 1;
        }
        value(i, ((time - times[i]) / (times[i + 1] - times[i])).clamp(0.0, 1.0))
    })
    .collect()
}

/// `count + 1` equal steps from 0 to `end`.
pub fn grid(count: usize, end: f64) -> impl Iterator<Item = f64> {
    (0..=count).map(move |i| end * (i as f64 / count as f64))
}

/// Low-pass without delay: a second-order Butterworth filter forwards and backwards, `cut_off` as a share of the sample
/// rate. Each way halves the power at the cut-off, both ways halve the amplitude.
///
/// Both ends are continued by reflection through their sample, without end, so that they keep their values whatever the
/// cut-off: what is left beside the line from the first to the last sample then repeats itself, and the filter is brought
/// to where that leads it. A cut-off far below 1/T leaves the line.
pub fn low_pass(values: &[f64], cut_off: f64) -> Vec<f64> {
    if cut_off >= LARGEST_CUT_OFF {
        return values.to_vec();
    }
    let last = values.len() - 1;
    let rise = (values[last] - values[0]) / last as f64;
    let line = |i: usize| values[0] + rise * i as f64;
    if cut_off * 2.0 * (last as f64) < LEAST_CUT_OFF {
        return (0..=last).map(|i| if i == last { values[last] } else { line(i) }).collect();
    }
    // One period: there, and back with the sign turned.
    let there: Vec<f64> = values.iter().enumerate().map(|(i, value)| value - line(i)).collect();
    let back = there[1..last].iter().rev().map(|value| -value);
    let mut period: Vec<f64> = there[..last].iter().copied().chain([0.0]).chain(back).collect();
    let filter = Filter::new(cut_off);
    for _ in 0..2 {
        filter.repeat(&mut period);
        period.reverse();
    }
    // Rounding apart both ends are 0 there.
    (0..=last).map(|i| if i == 0 || i == last { values[i] } else { line(i) + period[i] }).collect()
}

/// A second-order Butterworth low-pass by the bilinear transform, as two integrators in a loop: unlike a recursion over
/// the last outputs it is well conditioned however low the cut-off.
struct Filter {
    a1: f64,
    a2: f64,
    a3: f64,
}

impl Filter {
    fn new(cut_off: f64) -> Self {
        // libm: the same bits on every platform.
        let g = libm::tan(PI * cut_off);
        let a1 = 1.0 / (1.0 + g * (g + SQRT_2));
        Self { a1, a2: g * a1, a3: g * g * a1 }
    }

    /// One step from the state of the integrators: the output, and the next state.
    fn step(&self, [first, second]: [f64; 2], input: f64) -> (f64, [f64; 2]) {
        let rest = input - second;
        let band = self.a1 * first + self.a2 * rest;
        let low = second + self.a2 * first + self.a3 * rest;
        (low, [2.0 * band - first, 2.0 * low - second])
    }

    /// The state that repeats itself after `period`: `s = A s + c`, with the state c that one period leads to from rest.
    fn repeating(&self, period: &[f64]) -> [f64; 2] {
        let run =
            |state: [f64; 2], factor: f64| period.iter().fold(state, |state, input| self.step(state, factor * input).1);
        let c = run([0.0; 2], 1.0);
        let (x, y) = (run([1.0, 0.0], 0.0), run([0.0, 1.0], 0.0));
        let (p, q, r, s) = (1.0 - x[0], -y[0], -x[1], 1.0 - y[1]);
        let determinant = p * s - q * r;
        [(s * c[0] - q * c[1]) / determinant, (p * c[1] - r * c[0]) / determinant]
    }

    /// Filters a signal that repeats itself, in its settled state.
    fn repeat(&self, period: &mut [f64]) {
        let mut state = self.repeating(period);
        for value in period {
            (*value, state) = self.step(state, *value);
        }
    }
}

/// Derivative by central differences, one-sided at both ends.
pub fn differences(values: &[f64], dt: f64) -> Vec<f64> {
    let last = values.len() - 1;
    let slope = |i: usize, j: usize| (values[j] - values[i]) / (dt * (j - i) as f64);
    (0..=last).map(|i| slope(i.saturating_sub(1), (i + 1).min(last))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_resampled_exactly_from_unequal_steps() {
        let times = [0.0, 0.1, 0.35, 0.4, 0.9, 1.0];
        let parabola = |t: f64| 2.0 - 3.0 * t + 5.0 * t * t;
        let values: Vec<f64> = times.iter().map(|t| parabola(*t)).collect();
        let found = resample(&times, &values, grid(50, 1.0));
        for (found, t) in found.iter().zip(grid(50, 1.0)) {
            assert!((found - parabola(t)).abs() < 1e-14, "{found} at {t}");
        }
    }

    #[test]
    fn linear_resampling_is_linear_and_held_at_the_ends() {
        let found = resample_linear(&[0.0, 1.0, 3.0], &[1.0, 3.0, 2.0], [-1.0, 0.5, 2.0, 4.0].into_iter());
        assert_eq!(found, [1.0, 2.0, 2.5, 2.0]);
    }

    #[test]
    fn samples_on_their_own_grid_are_left_alone() {
        let values: Vec<f64> = (0..=40).map(|i| (0.2 * f64::from(i)).sin()).collect();
        let times: Vec<f64> = grid(40, 2.0).collect();
        assert_eq!(resample(&times, &values, grid(40, 2.0)), values);
    }

    #[test]
    fn smoothing_keeps_a_line_and_halves_a_wave_at_the_cut_off_without_delay() {
        let line: Vec<f64> = (0..200).map(|i| 3.0 + 0.5 * f64::from(i)).collect();
        for (smooth, line) in low_pass(&line, 0.05).iter().zip(&line) {
            // Rounding of values to 200.
            assert!((smooth - line).abs() < 1e-9, "{smooth} {line}");
        }
        let wave: Vec<f64> = (0..2001).map(|i| (2.0 * PI * 0.05 * f64::from(i)).sin()).collect();
        let smooth = low_pass(&wave, 0.05);
        for i in 500..1500 {
            assert!((smooth[i] - 0.5 * wave[i]).abs() < 1e-9, "{} {}", smooth[i], wave[i]);
        }
    }

    #[test]
    fn smoothing_lets_a_slow_wave_pass_and_stops_a_fast_one() {
        // |H|^2 = 1/(1 + (K/K_c)^4) with K = tan(pi f/rate).
        let amplitude = |f: f64| {
            let wave: Vec<f64> = (0..4001).map(|i| (2.0 * PI * f * f64::from(i)).cos()).collect();
            low_pass(&wave, 0.05)[2000]
        };
        for f in [0.005, 0.02, 0.25] {
            let expected = 1.0 / (1.0 + ((PI * f).tan() / (PI * 0.05).tan()).powi(4));
            assert!((amplitude(f) - expected).abs() < 1e-9, "{f}: {} {expected}", amplitude(f));
        }
    }

    #[test]
    fn any_cut_off_keeps_the_ends_and_lowers_every_wave_of_the_reflection_by_its_own_share() {
        // Beside the line of its ends, the endless reflection of a half wave sin(pi j i/n) is that wave: it passes by
        // |H|^2 = 1/(1 + (K/K_c)^4), K = tan(pi j/(2 n)) of its frequency j/(2 n).
        let n = 100;
        let line = |i: usize| 0.2 + 0.3 * i as f64 / n as f64;
        let wave = |j: usize, i: usize| (PI * (j * i) as f64 / n as f64).sin();
        let values: Vec<f64> = (0..=n).map(|i| line(i) + 0.1 * wave(1, i) - 0.05 * wave(7, i)).collect();
        for cut_off in [1e-9, 1e-6, 5e-4, 1e-3, 3e-3, 0.005, 0.02, 0.1, 0.3] {
            let share =
                |j: usize| 1.0 / (1.0 + ((PI * j as f64 / (2 * n) as f64).tan() / (PI * cut_off).tan()).powi(4));
            let smooth = low_pass(&values, cut_off);
            assert_eq!([smooth[0], smooth[n]], [values[0], values[n]], "at {cut_off}");
            for (i, smooth) in smooth.iter().enumerate() {
                let expected = line(i) + 0.1 * share(1) * wave(1, i) - 0.05 * share(7) * wave(7, i);
                assert!((smooth - expected).abs() < 1e-9, "{smooth} {expected} at {i}, cut-off {cut_off}");
            }
        }
    }

    #[test]
    fn differences_of_a_parabola_are_its_slope_inside() {
        let values: Vec<f64> = (0..10).map(|i| (0.1 * f64::from(i)).powi(2)).collect();
        let slopes = differences(&values, 0.1);
        for (i, slope) in slopes.iter().enumerate().take(9).skip(1) {
            assert!((slope - 0.2 * i as f64).abs() < 1e-13);
        }
        assert!((slopes[0] - 0.1).abs() < 1e-13, "one-sided at the start");
    }
}
