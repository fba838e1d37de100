//! Stiffness and damping over time: initial, learned, and the bounds between which they were learned.

use core::iter;

use hpf_sim::task::{Axis as TaskAxis, Gain, Unit};
use hpf_sim::{AxisTrace, Trace};

use super::axis::{Axis, padded, span};
use super::chart::{Figure, Layer, Panel};
use super::motions::{initial, is_learned, learned};
use super::number::{rounded, short};
use super::palette::{GREY, Pen, SHADE};
use super::signals::{axis_heading, axis_phrase, time_axis, with_rest};
use crate::results::Run;

/// Bounds farther apart than this many times the range of the profile are not all shown: the profile would be flat.
pub const WIDEST_BOUNDS: f64 = 12.0;

/// The unit of stiffness on `axis`.
pub fn stiffness_unit(axis: &TaskAxis) -> &'static str {
    if axis.unit == Unit::M { "N/m" } else { "N m/rad" }
}

/// The unit of damping on `axis`.
pub fn damping_unit(axis: &TaskAxis) -> &'static str {
    if axis.unit == Unit::M { "N s/m" } else { "N m s/rad" }
}

/// Draws stiffness over time.
pub fn stiffness(run: &Run) -> Figure {
    draw(run, "stiffness", &run.task.stiffness, stiffness_unit, |axis| &axis.stiffness)
}

/// Draws damping over time.
pub fn damping(run: &Run) -> Figure {
    draw(run, "damping", &run.task.damping, damping_unit, |axis| &axis.damping)
}

fn draw(
    run: &Run,
    quantity: &str,
    gain: &Gain,
    unit: impl Fn(&TaskAxis) -> &'static str,
    signal: impl for<'t> Fn(&'t AxisTrace) -> &'t Vec<f64>,
) -> Figure {
    let learned = learned(run);
    let mut name = quantity.to_owned();
    name[..1].make_ascii_uppercase();
    // The middle of the profile and half of what it spans.
    let core = |i: usize| {
        let start = gain.initial.of(i);
        let (low, high) = span(signal(&learned.trace.axes[i]).iter().copied().chain([start])).unwrap_or((start, start));
        // A tenth of the value, so that rounding in a constant profile is not blown up.
        (0.5 * (low + high), 0.5 * (high - low).max(0.1 * high.abs()))
    };
    // All panels show their bounds, or none does: profiles are compared by their height.
    let fits = (0..run.task.axis.len()).all(|i| gain.max.of(i) - gain.min.of(i) <= WIDEST_BOUNDS * 2.0 * core(i).1);
    let panels = run.task.axis.iter().enumerate().map(|(i, axis)| {
        let (min, max, start) = (gain.min.of(i), gain.max.of(i), gain.initial.of(i));
        let after = signal(&learned.trace.axes[i]);
        let before = |trace: &Trace, pen| Layer::signal(&trace.time, signal(&trace.axes[i]), 1.0, pen);
        let pen = Pen { width: 5.0, ..Pen::dashed(GREY) };
        let before = match initial(run) {
            Some(trace) => Some(before(trace, pen)),
            None => is_learned(run).then(|| Layer::level(start, pen)),
        };

        let (middle, half) = core(i);
        let range = padded(if fits { [min, max] } else { [middle - half, middle + half] });
        let shade = Pen::thin(SHADE);
        let mut layers = Vec::new();
        if min < max {
            layers.push(Layer::band(f64::NEG_INFINITY, min, shade).labelled("outside the bounds"));
            layers.push(Layer::band(max, f64::INFINITY, shade));
            layers.extend([min, max].map(|bound| Layer::level(bound, Pen::thin(GREY))));
        }
        layers.extend(before.map(|before| before.labelled("initial")));
        let after = Layer::signal(&learned.trace.time, after, 1.0, learned.pen);
        layers.push(after.labelled(learned.label.clone()));
        Panel {
            heading: axis_heading(run, i),
            note: bounds(min, max, unit(axis)),
            x: time_axis(run),
            y: Axis::linear(quantity, unit(axis), range),
            layers,
        }
    });
    let compared = if is_learned(run) { ", initial and learned" } else { "" };
    let title = format!("{name}{}{compared}", axis_phrase(run));
    with_rest(Figure::new(title, panels.collect()), iter::once(run))
}

/// The bounds in words, in as many digits as tell them apart.
pub fn bounds(min: f64, max: f64, unit: &str) -> String {
    if min == max {
        return format!("fixed at {} {unit}", short(min, 4));
    }
    // A hundredth of what lies between them is not missed.
    let error = |value: f64, digits: usize| (rounded(value, digits) - value).abs();
    let enough = |digits: &usize| error(min, *digits) + error(max, *digits) <= 0.01 * (max - min);
    let digits = (4..17).find(enough).unwrap_or(17);
    format!("bounds {} to {} {unit}", short(min, digits), short(max, digits))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_told_apart() {
        assert_eq!(bounds(30.0, 400.0, "N/m"), "bounds 30 to 400 N/m");
        assert_eq!(bounds(99.9999, 100.0001, "N/m"), "bounds 99.9999 to 100.0001 N/m");
        assert_eq!(bounds(50.0, 50.0, "N s/m"), "fixed at 50 N s/m");
    }
}
