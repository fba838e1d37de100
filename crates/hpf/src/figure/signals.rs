//! Signals of every axis over time, one panel per axis: positions, and forces.

use core::iter;

use hpf_sim::environment::disturbance::Side;
use hpf_sim::environment::wall::Side as WallSide;
use hpf_sim::environment::{Contact, Disturbance};
use hpf_sim::task::Unit;

use super::axis::{Axis, padded, span};
use super::chart::{Figure, Layer, Mark, Panel, Point};
use super::motions::{Length, by_update, motions};
use super::palette::{BLUE, GREEN, GREY, Pen, REST, SHADE, VERMILLION, tint};
use crate::results::Run;

/// Most draws of a disturbance in one figure.
const MOST_DRAWS: usize = 20;

/// The time axis of a run.
pub fn time_axis(run: &Run) -> Axis {
    Axis::linear("time", "s", (0.0, end(run)))
}

/// When the motion of `run` ends, its rest time included [s].
pub fn end(run: &Run) -> f64 {
    run.trajectory.time.last().map_or(run.task.duration, |&last| last.max(run.task.duration))
}

/// `figure` with the rest time marked, from when all `runs` are at their durations.
pub fn with_rest<'r>(mut figure: Figure, runs: impl Iterator<Item = &'r Run> + Clone) -> Figure {
    let duration = runs.clone().map(|run| run.task.duration).fold(0.0, f64::max);
    if runs.map(end).fold(0.0, f64::max) > duration {
        let block = ((duration, f64::NEG_INFINITY), (f64::INFINITY, f64::INFINITY));
        for panel in &mut figure.panels {
            panel
                .layers
                .insert(0, Layer::block(block.0, block.1, Pen::thin(REST)).labelled("rest time, after the end"));
        }
    }
    figure
}

/// What sets the panel of an axis apart from those of the others: nothing, where there is only one.
pub fn axis_heading(run: &Run, axis: usize) -> String {
    if run.task.axis.len() > 1 { format!("axis {}", run.task.axis[axis].name) } else { String::new() }
}

/// Which axes a title speaks of.
pub fn axis_phrase(run: &Run) -> String {
    match run.task.axis.as_slice() {
        [axis] => format!(" of axis {}", axis.name),
        _ => " of each axis".into(),
    }
}

/// The sum of those of `disturbances` that act on axis `i`, over the time of `run`.
pub fn force_over_time(run: &Run, disturbances: &[Disturbance], i: usize) -> Vec<Point> {
    let at = |time, side| {
        let acting = disturbances.iter().filter(|disturbance| disturbance.axis() == run.task.axis[i].name);
        (time, acting.map(|disturbance| disturbance.force(time, side)).sum::<f64>())
    };
    // Both sides of every instant, so that a jump is upright.
    run.trajectory.time.iter().flat_map(|time| [at(*time, Side::Before), at(*time, Side::After)]).collect()
}

/// Draws the disturbances; where they are drawn, those of some motions that the policy is measured by.
pub fn disturbance(run: &Run) -> Figure {
    let mut met = hpf_sim::disturbances(&run.task);
    met.dedup();
    let panels = run.task.axis.iter().enumerate().map(|(i, axis)| {
        let (quantity, unit) = if axis.unit == Unit::M { ("force", "N") } else { ("torque", "N m") };
        let forces = met.iter().take(MOST_DRAWS).map(|met| force_over_time(run, met, i));
        let mut lines: Vec<Layer> = forces.map(|force| Layer::line(force, Pen::thin(tint(GREY, 0.6)))).collect();
        lines.reverse();
        let others = lines.len().saturating_sub(1);
        if let [.., shown] = &mut lines[..] {
            shown.pen = Pen::strong(BLUE);
        }
        if let [.., other, shown] = &mut lines[..] {
            other.label = Some(format!("the next {others} of {} draws", met.len()));
            shown.label = Some("first draw, that of the other figures".into());
        }
        Panel {
            heading: axis_heading(run, i),
            note: String::new(),
            x: time_axis(run),
            y: Axis::linear(
                quantity,
                unit,
                padded(lines.iter().flat_map(Layer::points).map(|point| point.1).chain([0.0])),
            ),
            layers: lines,
        }
    });
    let what = if run.task.axis.iter().all(|axis| axis.unit == Unit::M) { "force" } else { "force or torque" };
    let place = match run.task.axis.as_slice() {
        [axis] => format!("axis {}", axis.name),
        _ => "each axis".into(),
    };
    with_rest(Figure::new(format!("Disturbing {what} on {place}"), panels.collect()), iter::once(run))
}

/// The wall across axis `i`, if there is one, in a panel where positions are multiplied by `factor`.
pub fn wall(run: &Run, i: usize, factor: f64) -> Option<Layer> {
    let across = |contact: &&Contact| contact.axis() == run.task.axis[i].name;
    let Some(Contact::Wall(wall)) = run.task.contact.as_ref().filter(across) else { return None };
    let end = if wall.side == WallSide::Above { f64::INFINITY } else { f64::NEG_INFINITY };
    Some(Layer::band(factor * wall.position, end, Pen::thin(SHADE)).labelled("wall"))
}

/// Draws the position of every axis over time, for every motion.
pub fn position(run: &Run) -> Figure {
    let task = &run.task;
    let panels = task.axis.iter().enumerate().map(|(i, axis)| {
        let mut values = vec![axis.start, axis.goal];
        values.extend(task.via_point.iter().map(|via| via.position[i]));
        for motion in motions(run) {
            values.extend(&motion.trace.axes[i].position);
        }
        let reference = &run.trajectory.axes[i].reference_position;
        values.extend(reference);
        let (low, high) = span(values.iter().copied()).unwrap_or((0.0, 1.0));
        let length = Length::fitting(axis, low.abs().max(high.abs()));
        let shown = padded(values.iter().map(|value| length.factor * value));

        let mut layers = Vec::new();
        layers.extend(wall(run, i, length.factor));
        for motion in motions(run) {
            let signal = &motion.trace.axes[i].position;
            layers.push(Layer::signal(&motion.trace.time, signal, length.factor, motion.pen).labelled(motion.label));
        }
        let pen = Pen::dashed(VERMILLION);
        layers.push(Layer::signal(&run.trajectory.time, reference, length.factor, pen).labelled("reference"));
        let via = task.via_point.iter().filter_map(|via| Some((via.time?, length.factor * via.position[i])));
        let via: Vec<_> = via.collect();
        if !via.is_empty() {
            layers.push(Layer::marks(Mark::Dot, via, Pen::thin(GREEN)).labelled("via point"));
        }
        // To be passed at any time.
        for via in task.via_point.iter().filter(|via| via.time.is_none()) {
            let (ends, place) = ([0.0, task.duration], [via.position[i]; 2]);
            let pen = Pen::dashed(GREEN);
            layers.push(Layer::signal(&ends, &place, length.factor, pen).labelled("via point, at any time"));
        }
        let goal = vec![(task.duration, length.factor * axis.goal)];
        layers.push(Layer::marks(Mark::Dot, goal, Pen::thin(VERMILLION)).labelled("goal"));
        Panel {
            heading: axis_heading(run, i),
            note: String::new(),
            x: time_axis(run),
            y: Axis::linear("position", length.unit, shown),
            layers,
        }
    });
    let title = format!("Tool position{} over time{}", axis_phrase(run), by_update(run));
    with_rest(Figure::new(title, panels.collect()), iter::once(run))
}
