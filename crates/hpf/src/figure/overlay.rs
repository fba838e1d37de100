//! Several runs in the same figures: what each learned, a colour per run.

mod over_time;
mod space;

use hpf_sim::environment::Contact;

use self::over_time::{contact_force, damping, deviation, disturbance, position, stiffness};
use self::space::{beam_path, beams, plane_path};
use super::axis::{Axis, Scale, span};
use super::chart::{Figure, Layer, Panel, Point};
use super::palette::{BLACK, Pen};
use super::{Drawing, is_disturbed, is_plane};
use crate::results::Run;

/// Ends of learning farther apart than this, as a factor, are shown by their logarithm.
const WIDEST_LINEAR: f64 = 10.0;

/// A run and what figures call it.
pub struct Named<'r> {
    /// Its name.
    pub name: String,
    /// The run.
    pub run: &'r Run,
}

/// The figures that `runs` have in common. Their axes have the same names and units; there is at least one run, and no
/// more than [`super::MOST_SERIES`].
pub fn figures<'r>(runs: &'r [Named<'r>]) -> Vec<Drawing<'r>> {
    let all = |holds: fn(&Run) -> bool| runs.iter().all(|named| holds(named.run));
    let mut figures = vec![
        Drawing::new("cost", || cost(runs)),
        Drawing::new("stiffness", || stiffness(runs)),
        Drawing::new("damping", || damping(runs)),
    ];
    if all(is_disturbed) {
        figures.push(Drawing::new("disturbance", || disturbance(runs)));
    }
    if all(|run| matches!(run.task.contact, Some(Contact::Cantilever(_)))) {
        figures.push(Drawing::new("beam", || beams(runs)));
        figures.push(Drawing::new("path", || beam_path(runs)));
    } else if all(|run| run.task.contact.is_none() && is_plane(run)) {
        figures.push(Drawing::new("path", || plane_path(runs)));
    } else {
        figures.push(Drawing::new("path", || position(runs)));
    }
    if all(|run| run.task.contact.is_some()) {
        figures.push(Drawing::new("deviation", || deviation(runs)));
        figures.push(Drawing::new("contact_force", || contact_force(runs)));
    }
    figures
}

/// What all runs agree in.
fn shared<T: PartialEq>(runs: &[Named<'_>], of: impl Fn(&Run) -> T) -> Option<T> {
    let first = of(runs.first()?.run);
    runs.iter().all(|named| of(named.run) == first).then_some(first)
}

/// Every run with its line.
fn lines<'r>(runs: &'r [Named<'r>]) -> impl Iterator<Item = (&'r str, &'r Run, Pen)> {
    runs.iter().enumerate().map(|(i, named)| (named.name.as_str(), named.run, Pen::series(i)))
}

/// Draws the total cost by motions made: what a learner that makes more of them per update pays for its updates. A run
/// that learned nothing is a level line.
fn cost(runs: &[Named<'_>]) -> Figure {
    let learned = runs.iter().filter(|named| named.run.learning.len() > 1);
    let x = motions_axis(learned.filter_map(|named| named.run.learning.last()).map(|row| row.rollouts as f64));
    let points = |run: &Run| match run.learning.as_slice() {
        [only] => vec![(x.low, only.total), (x.high, only.total)],
        rows => steps(rows.iter().map(|row| (row.rollouts as f64, row.total))),
    };
    let layers = lines(runs).map(|(name, run, pen)| Layer::line(points(run), pen).labelled(name));
    let totals = runs.iter().flat_map(|named| &named.run.learning).map(|row| row.total);
    let layers = layers.collect();
    let panel = Panel { heading: String::new(), note: String::new(), x, y: cost_axis(totals), layers };
    Figure::new("Cost by motions made", vec![panel]).with_direct_labels()
}

/// A line that keeps every value until the next one is known.
pub fn steps(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut line: Vec<Point> = Vec::new();
    for point in points {
        line.extend(line.last().map(|before| (point.0, before.1)));
        line.push(point);
    }
    line
}

/// The axis of motions made, to the latest of the `ends` of learning.
pub fn motions_axis(ends: impl Iterator<Item = f64>) -> Axis {
    let (first, last) = span(ends).unwrap_or((1.0, 1.0));
    let axis = Axis::linear("motions made", "", (1.0, last.max(2.0)));
    if last > WIDEST_LINEAR * first.max(1.0) { axis.with_scale(Scale::Logarithmic) } else { axis }
}

/// The axis of cost that shows `totals`.
pub fn cost_axis(totals: impl Iterator<Item = f64>) -> Axis {
    let totals: Vec<f64> = totals.collect();
    Axis::of_cost(totals.iter().copied(), core::iter::empty())
}

/// A line or mark that belongs to no single run.
fn common(dashed: bool) -> Pen {
    if dashed { Pen::dashed(BLACK) } else { Pen::thin(BLACK) }
}
