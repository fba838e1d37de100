//! Signals of several runs over time: one panel per axis, or one for the contact.

use hpf_sim::task::{Axis as TaskAxis, Gain, Unit};
use hpf_sim::{AxisTrace, ContactTrace};

use super::super::axis::{Axis, padded, span};
use super::super::chart::{Figure, Layer, Mark, Panel, Point};
use super::super::gain::{WIDEST_BOUNDS, bounds, damping_unit, stiffness_unit};
use super::super::motions::{Length, that_learned};
use super::super::number::short;
use super::super::palette::{GREEN, GREY, Pen, SHADE, tint};
use super::super::signals::{axis_heading, axis_phrase, end, force_over_time, wall, with_rest};
use super::{Named, common, lines, shared};
use crate::paper::paper_deviation;
use crate::results::Run;

/// The time axis that holds every run.
fn time_axis(runs: &[Named<'_>]) -> Axis {
    let most = runs.iter().map(|named| end(named.run)).fold(0.0, f64::max);
    Axis::linear("time", "s", (0.0, most))
}

/// A figure of `runs` over time.
fn resting(title: impl Into<String>, panels: Vec<Panel>, runs: &[Named<'_>]) -> Figure {
    with_rest(Figure::new(title, panels), runs.iter().map(|named| named.run))
}

/// Draws the stiffness that each run learned.
pub fn stiffness(runs: &[Named<'_>]) -> Figure {
    gain(runs, "Stiffness", |run| &run.task.stiffness, stiffness_unit, |axis| &axis.stiffness)
}

/// Draws the damping that each run learned.
pub fn damping(runs: &[Named<'_>]) -> Figure {
    gain(runs, "Damping", |run| &run.task.damping, damping_unit, |axis| &axis.damping)
}

fn gain(
    runs: &[Named<'_>],
    name: &str,
    gain: fn(&Run) -> &Gain,
    unit: fn(&TaskAxis) -> &'static str,
    signal: fn(&AxisTrace) -> &Vec<f64>,
) -> Figure {
    let panel = |i: usize, axis: &TaskAxis| {
        let values = || runs.iter().flat_map(|named| signal(&named.run.trajectory.axes[i])).copied();
        let (low, high) = span(values()).unwrap_or((0.0, 1.0));
        let limits = shared(runs, |run| (gain(run).min.of(i), gain(run).max.of(i)));
        let shown = limits.filter(|(min, max)| max - min <= WIDEST_BOUNDS * (high - low).max(0.1 * high.abs()));
        let mut layers = Vec::new();
        if let Some((min, max)) = shown.filter(|(min, max)| min < max) {
            let shade = Pen::thin(SHADE);
            layers.push(Layer::band(f64::NEG_INFINITY, min, shade).labelled("outside the bounds"));
            layers.push(Layer::band(max, f64::INFINITY, shade));
            layers.extend([min, max].map(|bound| Layer::level(bound, Pen::thin(GREY))));
        }
        layers.extend(lines(runs).map(|(name, run, pen)| {
            Layer::signal(&run.trajectory.time, signal(&run.trajectory.axes[i]), 1.0, pen).labelled(name)
        }));
        Panel {
            heading: axis_heading(runs[0].run, i),
            note: limits.map_or_else(|| "bounds differ".into(), |(min, max)| bounds(min, max, unit(axis))),
            x: time_axis(runs),
            y: Axis::linear(
                name.to_lowercase(),
                unit(axis),
                shown.map_or_else(|| padded(values()), |(min, max)| padded([min, max])),
            ),
            layers,
        }
    };
    let axes = runs[0].run.task.axis.iter().enumerate();
    let phrase = axis_phrase(runs[0].run);
    let learned = that_learned(runs.iter().map(|named| named.run));
    resting(format!("{name}{phrase}{learned}"), axes.map(|(i, axis)| panel(i, axis)).collect(), runs)
}

/// Draws the disturbances of each run; where they are drawn, those of its trajectory.
pub fn disturbance(runs: &[Named<'_>]) -> Figure {
    let force = |run: &Run, i: usize| -> Vec<Point> {
        let met = hpf_sim::disturbances(&run.task);
        met.first().map(|shown| force_over_time(run, shown, i)).unwrap_or_default()
    };
    let panel = |i: usize, axis: &TaskAxis| {
        let forces: Vec<_> = lines(runs).map(|(name, run, pen)| (name, force(run, i), pen)).collect();
        let values = forces.iter().flat_map(|(_, points, _)| points).map(|point| point.1).chain([0.0]);
        let (quantity, unit) = if axis.unit == Unit::M { ("force", "N") } else { ("torque", "N m") };
        Panel {
            heading: axis_heading(runs[0].run, i),
            note: String::new(),
            x: time_axis(runs),
            y: Axis::linear(quantity, unit, padded(values)),
            layers: if shared(runs, |run| force(run, i)).is_some() {
                let points = forces.into_iter().next().map(|(_, points, _)| points).unwrap_or_default();
                vec![Layer::line(points, Pen { dash: None, ..common(true) }).labelled("all runs")]
            } else {
                forces.into_iter().map(|(name, points, pen)| Layer::line(points, pen).labelled(name)).collect()
            },
        }
    };
    let axes = runs[0].run.task.axis.iter().enumerate();
    let title = format!("Disturbance{}", axis_phrase(runs[0].run));
    resting(title, axes.map(|(i, axis)| panel(i, axis)).collect(), runs)
}

/// Draws the position of every axis, as each run learned it, with via points and goals.
pub fn position(runs: &[Named<'_>]) -> Figure {
    let panel = |i: usize, axis: &TaskAxis| {
        let marks = |run: &Run| {
            let via = run.task.via_point.iter().filter_map(|via| Some((via.time?, via.position[i])));
            (via.collect::<Vec<_>>(), vec![(run.task.duration, run.task.axis[i].goal)])
        };
        let mut values: Vec<f64> = vec![];
        for named in runs {
            let (via, goal) = marks(named.run);
            values.extend(via.iter().chain(&goal).map(|point| point.1));
            values.extend(&named.run.trajectory.axes[i].position);
        }
        let (low, high) = span(values.iter().copied()).unwrap_or((0.0, 1.0));
        let length = Length::fitting(axis, low.abs().max(high.abs()));
        let scaled = |points: Vec<Point>| points.into_iter().map(|(t, y)| (t, length.factor * y)).collect();
        let mut layers = Vec::new();
        if shared(runs, |run| run.task.contact.clone()).is_some() {
            layers.extend(wall(runs[0].run, i, length.factor));
        }
        layers.extend(lines(runs).map(|(name, run, pen)| {
            let signal = &run.trajectory.axes[i].position;
            Layer::signal(&run.trajectory.time, signal, length.factor, pen).labelled(name)
        }));
        let one = shared(runs, |run| marks(run));
        for (_, run, pen) in lines(runs).take(if one.is_some() { 1 } else { runs.len() }) {
            let (via, goal) = marks(run);
            let pen = if one.is_some() { common(false) } else { pen };
            let mark = |mark, points, label: &str| Layer::marks(mark, scaled(points), pen).labelled(label);
            layers.extend((!via.is_empty()).then(|| mark(Mark::Dot, via, "via point")));
            layers.push(mark(Mark::Target, goal, "goal"));
        }
        Panel {
            heading: axis_heading(runs[0].run, i),
            note: String::new(),
            x: time_axis(runs),
            y: Axis::linear("position", length.unit, padded(values.iter().map(|value| length.factor * value))),
            layers,
        }
    };
    let axes = runs[0].run.task.axis.iter().enumerate();
    let learned = that_learned(runs.iter().map(|named| named.run));
    let title = format!("Tool position{} over time{learned}", axis_phrase(runs[0].run));
    resting(title, axes.map(|(i, axis)| panel(i, axis)).collect(), runs)
}

/// Draws the deviation from the surface under load.
pub fn deviation(runs: &[Named<'_>]) -> Figure {
    let band = shared(runs, |run| paper_deviation(&run.task)).flatten();
    let most = contacts(runs).flat_map(|contact| &contact.deviation).map(|value| value.abs()).chain(band);
    let axis = &runs[0].run.task.axis[contacts(runs).next().map_or(0, |contact| contact.axis)];
    let length = Length::fitting(axis, most.fold(0.0, f64::max));
    let mut panel =
        contact_panel(runs, "deviation", length, band.map(|band| [-band, band]), |contact| &contact.deviation);
    if let Some(band) = band {
        let shown = length.factor * band;
        let label = format!("±{} {}, the paper's claim", short(shown, 2), length.unit);
        panel.layers.insert(0, Layer::band(-shown, shown, Pen::thin(tint(GREEN, 0.18))).labelled(label));
    }
    resting("Deviation of the tool from the surface under load", vec![panel], runs)
}

/// Draws the contact force.
pub fn contact_force(runs: &[Named<'_>]) -> Figure {
    let newton = Length { factor: 1.0, unit: "N" };
    let mut panel = contact_panel(runs, "contact force", newton, None, |contact| &contact.force);
    let set_point = shared(runs, |run| run.trajectory.contact.as_ref().map(|contact| contact.set_point)).flatten();
    if let Some(set_point) = set_point {
        let label = format!("set-point, {} N", short(set_point, 3));
        panel.layers.push(Layer::level(set_point, common(true)).labelled(label));
    }
    resting("Contact force", vec![panel], runs)
}

fn contacts<'r>(runs: &'r [Named<'r>]) -> impl Iterator<Item = &'r ContactTrace> {
    runs.iter().filter_map(|named| named.run.trajectory.contact.as_ref())
}

fn contact_panel(
    runs: &[Named<'_>],
    quantity: &str,
    length: Length,
    also: Option<[f64; 2]>,
    signal: fn(&ContactTrace) -> &Vec<f64>,
) -> Panel {
    let values = contacts(runs).flat_map(signal).copied().chain(also.into_iter().flatten());
    let layers = lines(runs).zip(contacts(runs)).map(|((name, run, pen), contact)| {
        Layer::signal(&run.trajectory.time, signal(contact), length.factor, pen).labelled(name)
    });
    Panel {
        heading: String::new(),
        note: String::new(),
        x: time_axis(runs),
        y: Axis::linear(quantity, length.unit, padded(values.map(|value| length.factor * value))),
        layers: layers.collect(),
    }
}
