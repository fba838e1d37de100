//! The beam: its curves, and the path of the tool over the one that the task uses.

use hpf_sim::environment::{Cantilever, cantilever::Curve};

use super::axis::{Axis, Scale, padded};
use super::chart::{Figure, Layer, Panel, Point};
use super::motions::{by_update, motions};
use super::number::short;
use super::palette::{BLUE, GREY, Pen, SHADE, SKY, VERMILLION, tint};
use crate::results::Run;

/// Points of a curve.
const POINTS: u32 = 200;
/// Width of the clamp, as a fraction of the beam.
const CLAMP: f64 = 0.035;
/// Strokes across the clamp.
const HATCHES: f64 = 16.0;

/// The curve of `beam` [m, mm].
pub fn curve(beam: &Cantilever, curve: Curve) -> Vec<Point> {
    let at = |i| beam.length * f64::from(i) / f64::from(POINTS);
    (0..=POINTS).map(|i| (at(i), 1e3 * beam.deflection_of(curve, at(i)))).collect()
}

/// The panel that beam and paths lie in: along the beam, and downwards what it sinks.
pub fn panel(beam: &Cantilever, quantity: &str, deepest: (f64, f64), mut layers: Vec<Layer>) -> Panel {
    let wall = Layer::block((f64::NEG_INFINITY, f64::NEG_INFINITY), (0.0, f64::INFINITY), Pen::thin(SHADE));
    layers.splice(0..0, [wall.labelled("clamp"), hatching(beam, deepest)]);
    Panel {
        heading: String::new(),
        note: String::new(),
        x: Axis::linear("distance from the clamp", "m", (-CLAMP * beam.length, 1.02 * beam.length)),
        y: Axis::linear(quantity, "mm", deepest).with_scale(Scale::Reversed),
        layers,
    }
}

/// Strokes across the clamp; breaks in the line are not numbers.
fn hatching(beam: &Cantilever, (low, high): (f64, f64)) -> Layer {
    let step = (high - low) / HATCHES;
    let strokes = (0..=HATCHES as u32).flat_map(|i| {
        let y = low + f64::from(i) * step;
        [(-CLAMP * beam.length, y + step), (0.0, y), (f64::NAN, f64::NAN)]
    });
    Layer::line(strokes.collect(), Pen::thin(GREY))
}

/// Draws both curves of the beam.
pub fn curves(_run: &Run, beam: &Cantilever) -> Figure {
    let mut shapes = [
        (Curve::MovingLoad, "load where the tool is, F x³/(3 E I)"),
        (Curve::TipLoad, "load at the tip, F x² (3 l − x)/(6 E I)"),
    ];
    // The one that the task uses is drawn last, over the other.
    shapes.sort_by_key(|(kind, _)| *kind == beam.curve);
    let mut layers = vec![Layer::line(vec![(0.0, 0.0), (beam.length, 0.0)], Pen::dashed(GREY)).labelled("unloaded")];
    for (kind, name) in shapes {
        let used = kind == beam.curve;
        let pen = if used { Pen::strong(BLUE) } else { Pen::plain(SKY) };
        let name = if used { format!("{name}, used here") } else { name.to_owned() };
        layers.push(Layer::line(curve(beam, kind), pen).labelled(name));
    }
    let tip = 1e3 * beam.deflection(beam.length);
    let mut panel = panel(beam, "deflection downwards", padded([0.0, tip]), layers);
    panel.note = format!("{} N; the tip sinks by {} mm", short(beam.force, 3), short(tip, 3));
    Figure::new("Curve of the beam under the set-point force", vec![panel])
}

/// Draws the path of the tool at every motion over the curve.
pub fn path(run: &Run, beam: &Cantilever, axis: usize) -> Figure {
    let start = run.task.axis[axis].start;
    let pen = Pen { width: 16.0, ..Pen::plain(tint(VERMILLION, 0.35)) };
    let goal = curve(beam, beam.curve);
    let mut depths: Vec<f64> = goal.iter().map(|point| point.1).collect();
    let mut layers = vec![Layer::line(goal, pen).labelled("beam under load")];
    for motion in motions(run) {
        let contact = motion.trace.contact.as_ref();
        let travel = contact.map(|contact| contact.travel.as_slice()).unwrap_or_default();
        let depth: Vec<f64> =
            motion.trace.axes[axis].position.iter().map(|position| 1e3 * (position - start)).collect();
        layers.push(Layer::signal(travel, &depth, 1.0, motion.pen).labelled(motion.label));
        depths.extend(depth);
    }
    let quantity = format!("{} downwards", run.task.axis[axis].name);
    Figure::new(
        format!("Tool path along the beam{}", by_update(run)),
        vec![panel(beam, &quantity, padded(depths), layers)],
    )
}
