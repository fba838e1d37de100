//! The path of a tool with two linear axes, in their plane.

use hpf_sim::Task;
use hpf_sim::task::ViaPoint;

use super::axis::{Axis, padded, span};
use super::chart::{Figure, Layer, Mark, Panel, Point};
use super::motions::{Length, by_update, motions};
use super::palette::{BLACK, GREEN, Pen, VERMILLION};
use crate::results::Run;

/// Corners of a circle.
const CORNERS: u32 = 90;

/// What is near enough to the via points of `task`, where positions are multiplied by `factor`.
pub fn discs(task: &Task, factor: f64, pen: Pen) -> impl Iterator<Item = Layer> {
    let disc = move |via: &ViaPoint| {
        let radius = via.radius.filter(|radius| *radius > 0.0)?;
        let rim = |corner: u32| {
            let (sin, cos) = (core::f64::consts::TAU * f64::from(corner) / f64::from(CORNERS)).sin_cos();
            (factor * (via.position[0] + radius * cos), factor * (via.position[1] + radius * sin))
        };
        Some(Layer::line((0..=CORNERS).map(rim).collect(), pen).labelled("near enough"))
    };
    task.via_point.iter().filter_map(disc)
}

/// Draws the path of every motion in the plane.
pub fn path(run: &Run) -> Figure {
    let task = &run.task;
    let [across, upwards] = [&task.axis[0], &task.axis[1]];
    let motions = motions(run);
    let start = (across.start, upwards.start);
    let goal = (across.goal, upwards.goal);
    let via: Vec<Point> = task.via_point.iter().map(|via| (via.position[0], via.position[1])).collect();
    let of = |position: &[&Vec<f64>; 2]| -> Vec<Point> {
        position[0].iter().copied().zip(position[1].iter().copied()).collect()
    };
    let axes = &run.trajectory.axes;
    let reference = of(&[&axes[0].reference_position, &axes[1].reference_position]);
    let paths: Vec<Vec<Point>> =
        motions.iter().map(|motion| of(&[&motion.trace.axes[0].position, &motion.trace.axes[1].position])).collect();

    let all = || paths.iter().flatten().chain(&reference).chain(&via).copied().chain([start, goal]);
    let most = span(all().flat_map(|point| [point.0.abs(), point.1.abs()])).map_or(1.0, |(_, high)| high);
    let length = Length::fitting(across, most);
    let shown = |points: Vec<Point>| -> Vec<Point> {
        points.into_iter().map(|point| (length.factor * point.0, length.factor * point.1)).collect()
    };
    let x = Axis::linear(across.name.as_str(), length.unit, padded(shown(all().collect()).iter().map(|point| point.0)));
    let y =
        Axis::linear(upwards.name.as_str(), length.unit, padded(shown(all().collect()).iter().map(|point| point.1)));

    let mut layers: Vec<Layer> = motions
        .into_iter()
        .zip(paths)
        .map(|(motion, path)| Layer::line(shown(path), motion.pen).labelled(motion.label))
        .collect();
    layers.push(Layer::line(shown(reference), Pen::dashed(VERMILLION)).labelled("reference"));
    layers.push(Layer::marks(Mark::Ring, shown(vec![start]), Pen::thin(BLACK)).labelled("start"));
    layers.extend(discs(task, length.factor, Pen::thin(GREEN)));
    if !via.is_empty() {
        layers.push(Layer::marks(Mark::Dot, shown(via), Pen::thin(GREEN)).labelled("via point"));
    }
    layers.push(Layer::marks(Mark::Dot, shown(vec![goal]), Pen::thin(VERMILLION)).labelled("goal"));
    let panel = Panel { heading: String::new(), note: String::new(), x, y, layers };
    Figure { equal: true, ..Figure::new(format!("Tool path in the plane{}", by_update(run)), vec![panel]) }
}
