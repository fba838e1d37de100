//! Paths of several runs in space: in the plane, or along the beam.

use hpf_sim::Trace;
use hpf_sim::environment::{Cantilever, Contact};

use super::super::axis::{Axis, padded, span};
use super::super::beam::{curve, panel};
use super::super::chart::{Figure, Layer, Mark, Panel, Point};
use super::super::motions::{Length, that_learned};
use super::super::palette::{BLACK, Pen, tint};
use super::super::plane::discs;
use super::{Named, lines, shared};
use crate::results::Run;

fn path(trace: &Trace) -> impl Iterator<Item = Point> {
    trace.axes[0].position.iter().copied().zip(trace.axes[1].position.iter().copied())
}

/// Draws the paths of tools with two linear axes in their plane, with starts, via points and goals.
pub fn plane_path(runs: &[Named<'_>]) -> Figure {
    let marks = |run: &Run| -> [(&str, Mark, Vec<Point>); 3] {
        let [across, upwards] = [&run.task.axis[0], &run.task.axis[1]];
        let via = run.task.via_point.iter().map(|via| (via.position[0], via.position[1]));
        [
            ("start", Mark::Ring, vec![(across.start, upwards.start)]),
            ("via point", Mark::Dot, via.collect()),
            ("goal", Mark::Target, vec![(across.goal, upwards.goal)]),
        ]
    };
    let mut all: Vec<Point> = runs.iter().flat_map(|named| path(&named.run.trajectory)).collect();
    all.extend(runs.iter().flat_map(|named| marks(named.run)).flat_map(|(_, _, points)| points));
    let most = span(all.iter().flat_map(|point| [point.0.abs(), point.1.abs()])).map_or(1.0, |(_, high)| high);
    let [across, upwards] = [&runs[0].run.task.axis[0], &runs[0].run.task.axis[1]];
    let length = Length::fitting(across, most);
    let shown = |point: Point| (length.factor * point.0, length.factor * point.1);

    let line = |(name, run, pen): (&str, &Run, Pen)| {
        Layer::line(path(&run.trajectory).map(shown).collect(), pen).labelled(name)
    };
    let mut layers: Vec<Layer> = lines(runs).map(line).collect();
    if shared(runs, |run| run.task.via_point.clone()).is_some() {
        layers.extend(discs(&runs[0].run.task, length.factor, Pen::thin(BLACK)));
    }
    for kind in 0..3 {
        let mut places: Vec<(Point, Pen)> = Vec::new();
        let (label, mark, _) = marks(runs[0].run)[kind];
        for (_, run, pen) in lines(runs) {
            for point in &marks(run)[kind].2 {
                match places.iter_mut().find(|(known, _)| known == point) {
                    // What several runs share is in no run's colour.
                    Some((_, pen)) => *pen = Pen::thin(BLACK),
                    None => places.push((*point, if runs.len() > 1 { pen } else { Pen::thin(BLACK) })),
                }
            }
        }
        places.sort_by_key(|(_, pen)| pen.colour != BLACK);
        layers
            .extend(places.into_iter().map(|(point, pen)| Layer::marks(mark, vec![shown(point)], pen).labelled(label)));
    }
    let axis = |name: &str, pick: fn(&Point) -> f64| {
        Axis::linear(name, length.unit, padded(all.iter().map(|point| length.factor * pick(point))))
    };
    let (x, y) = (axis(&across.name, |point| point.0), axis(&upwards.name, |point| point.1));
    let panel = Panel { heading: String::new(), note: String::new(), x, y, layers };
    let title = format!("Tool path in the plane{}", that_learned(runs.iter().map(|named| named.run)));
    Figure { equal: true, ..Figure::new(title, vec![panel]) }
}

fn beam(run: &Run) -> Option<&Cantilever> {
    match &run.task.contact {
        Some(Contact::Cantilever(beam)) => Some(beam),
        _ => None,
    }
}

/// The longest beam: all are drawn along it.
fn longest<'r>(runs: &'r [Named<'r>]) -> &'r Cantilever {
    let beams = runs.iter().filter_map(|named| beam(named.run));
    beams.max_by(|a, b| a.length.total_cmp(&b.length)).expect("every run has a beam")
}

/// The curves of the beams under load, each with its run; one that all share stands once.
fn curves<'r>(runs: &'r [Named<'r>]) -> Vec<(&'r str, Pen, Vec<Point>)> {
    let of = |run: &Run| beam(run).map(|beam| curve(beam, beam.curve));
    if let Some(shared) = shared(runs, of).flatten() {
        return vec![("all runs", Pen::strong(BLACK), shared)];
    }
    lines(runs).filter_map(|(name, run, pen)| Some((name, pen, of(run)?))).collect()
}

fn depths(layers: &[Layer]) -> (f64, f64) {
    let points = layers.iter().flat_map(Layer::points);
    padded(points.map(|point| point.1).chain([0.0]))
}

/// Draws the beams under their set-point forces.
pub fn beams(runs: &[Named<'_>]) -> Figure {
    let line = |(name, pen, points): (&str, Pen, Vec<Point>)| Layer::line(points, pen).labelled(name);
    let layers: Vec<Layer> = curves(runs).into_iter().map(line).collect();
    let panel = panel(longest(runs), "deflection downwards", depths(&layers), layers);
    Figure::new("Curve of the beam under the set-point force", vec![panel])
}

/// Draws the paths of the tool along the beam.
pub fn beam_path(runs: &[Named<'_>]) -> Figure {
    // Wide and pale, so that the paths are seen on them.
    let pale = |(_, pen, points): (&str, Pen, Vec<Point>)| {
        Layer::line(points, Pen { width: 16.0, ..Pen::plain(tint(pen.colour, 0.3)) })
    };
    let mut layers: Vec<Layer> = curves(runs).into_iter().map(pale).collect();
    layers.extend(lines(runs).filter_map(|(name, run, pen)| {
        let contact = run.trajectory.contact.as_ref()?;
        let start = run.task.axis[contact.axis].start;
        let depth: Vec<f64> = run.trajectory.axes[contact.axis].position.iter().map(|y| 1e3 * (y - start)).collect();
        Some(Layer::signal(&contact.travel, &depth, 1.0, pen).labelled(name))
    }));
    let mut panel = panel(longest(runs), "tool downwards", depths(&layers), layers);
    panel.note = "pale: the beam under load".into();
    let title = format!("Tool path along the beam{}", that_learned(runs.iter().map(|named| named.run)));
    Figure::new(title, vec![panel])
}
