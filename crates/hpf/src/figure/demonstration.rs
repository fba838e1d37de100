//! Demonstrations and the path that was made of them, one panel per axis.

use core::iter;

use super::axis::{Axis, padded, span};
use super::chart::{Figure, Layer, Panel};
use super::motions::Length;
use super::palette::{BLUE, GREY, Pen, tint};
use super::signals::{axis_heading, axis_phrase, time_axis, with_rest};
use crate::results::Run;

/// Draws the demonstrations of `run` and its reference over them.
pub fn positions(run: &Run) -> Figure {
    let (time, demonstrations) = (&run.trajectory.time, &run.demonstrations);
    let panels = run.task.axis.iter().enumerate().map(|(i, axis)| {
        let reference = &run.trajectory.axes[i].reference_position;
        let recorded = || demonstrations.iter().map(|demonstration| &demonstration[i]);
        let (low, high) = span(recorded().chain([reference]).flatten().copied()).unwrap_or((0.0, 1.0));
        let length = Length::fitting(axis, low.abs().max(high.abs()));
        let label = if demonstrations.len() == 1 { "demonstration" } else { "demonstrations" };
        // One recording stands out under the dashed path; many are a band of thin lines.
        let pen = if demonstrations.len() == 1 { Pen::strong(tint(GREY, 0.7)) } else { Pen::thin(GREY) };
        let mut layers: Vec<Layer> =
            recorded().map(|positions| Layer::signal(time, positions, length.factor, pen).labelled(label)).collect();
        let pen = Pen { width: 4.0, ..Pen::dashed(BLUE) };
        layers.push(Layer::signal(time, reference, length.factor, pen).labelled("policy"));
        Panel {
            heading: axis_heading(run, i),
            note: String::new(),
            x: time_axis(run),
            y: Axis::linear("position", length.unit, padded([low, high].map(|value| length.factor * value))),
            layers,
        }
    });
    let title = format!("Demonstrated and imitated position{}", axis_phrase(run));
    with_rest(Figure::new(title, panels.collect()), iter::once(run))
}
