//! Cost by update: the total, and every term that the task weighs.

use hpf_sim::cost::Term;
use hpf_sim::task::{PerAxis, Task};
use plotters::style::RGBColor;

use super::axis::{Axis, Scale, span};
use super::chart::{Figure, Layer, Mark, Panel, Point};
use super::number::short;
use super::palette::{BLACK, BLUE, BROWN, GREEN, GREY, OLIVE, ORANGE, PURPLE, Pen, SKY, VERMILLION};
use crate::results::{LearningRow, Run};

/// How far below the smallest total a term is still shown: less matters to nobody.
const DEPTH: f64 = 1e-4;
/// A term that never rises above this many times the lower end of the axis is left out: it would
/// only flicker there.
const VISIBLE: f64 = 10.0;
/// Terms jump from update to update: thin lines keep them apart [px].
const TERM_WIDTH: f64 = 3.0;

/// Draws the cost by update, or where nothing was learned what the motion costs.
pub fn cost(run: &Run) -> Figure {
    match run.learning.as_slice() {
        [only] => of_motion(&run.task, only),
        rows => by_update(run, rows),
    }
}

/// Total and terms side by side.
fn of_motion(task: &Task, row: &LearningRow) -> Figure {
    let terms = Term::ALL.into_iter().enumerate().filter(|(i, term)| is_weighed(task, *term) && row.terms[*i] != 0.0);
    let terms = terms.map(|(i, term)| (Term::NAMES[i].replace('_', " "), row.terms[i], colour(term)));
    let all: Vec<_> = [("total".to_owned(), row.total, BLACK)].into_iter().chain(terms).collect();
    let mark = |(i, (name, value, colour)): (usize, &(String, f64, RGBColor))| {
        Layer::marks(Mark::Dot, vec![(i as f64, *value)], Pen::strong(*colour)).labelled(name)
    };
    let panel = Panel {
        heading: String::new(),
        note: String::new(),
        // Names would not fit below: the legend has them, in this order.
        x: Axis::named("", vec![String::new(); all.len()]),
        y: Axis::of_cost(core::iter::once(row.total), all.iter().map(|(_, value, _)| *value)),
        layers: all.iter().enumerate().map(mark).collect(),
    };
    Figure::new("Cost of the motion, total and terms", vec![panel])
}

fn by_update(run: &Run, rows: &[LearningRow]) -> Figure {
    let total = |row: &LearningRow| row.total;
    // The total is named before the terms, and drawn over them once more.
    let mut layers = vec![line(rows, total, Pen::strong(BLACK), "total")];
    let y = axis(rows);
    // What lies below this is too small to be shown; on an axis in proportion nothing is.
    let visible = if y.scale == Scale::Logarithmic { VISIBLE * y.low } else { 0.0 };
    let (mut left_out, mut highest) = (Vec::new(), 0.0_f64);
    for (i, term) in Term::ALL.into_iter().enumerate() {
        let of_term = |row: &LearningRow| row.terms[i];
        let (_, most) = span(rows.iter().map(of_term)).unwrap_or((0.0, 0.0));
        let name = Term::NAMES[i].replace('_', " ");
        if is_weighed(&run.task, term) && most > visible {
            let pen = Pen { width: TERM_WIDTH, ..Pen::plain(colour(term)) };
            layers.push(line(rows, of_term, pen, &name));
        } else if is_weighed(&run.task, term) && most > 0.0 {
            left_out.push(name);
            highest = highest.max(most);
        }
    }
    layers.push(line(rows, total, Pen::strong(BLACK), "total"));
    let note = match left_out.as_slice() {
        [] => String::new(),
        names => format!("at most {}: {}", short(above(highest), 1), names.join(", ")),
    };
    let best = run.policy.provenance.updates;
    let learned = rows.iter().find(|row| row.update == best);
    layers.extend(learned.map(|row| Layer::marks(Mark::Ring, vec![(best as f64, row.total)], Pen::strong(BLUE))));

    let updates = span(rows.iter().map(|row| row.update as f64)).unwrap_or((0.0, 1.0));
    let updates = if updates.0 < updates.1 { updates } else { (updates.0 - 0.5, updates.1 + 0.5) };
    let panel = Panel {
        heading: learned.map_or_else(String::new, |_| format!("ring: learned, update {best}")),
        note,
        x: Axis::linear("update", "", updates).with_scale(Scale::Counted),
        y,
        layers,
    };
    Figure::new("Cost by update, total and terms", vec![panel]).with_direct_labels()
}

/// The next number of one digit, `value` or above it.
fn above(value: f64) -> f64 {
    let digit = 10.0_f64.powf(value.log10().floor());
    (value / digit * (1.0 - 1e-9)).ceil() * digit
}

fn line(rows: &[LearningRow], value: impl Fn(&LearningRow) -> f64, pen: Pen, name: &str) -> Layer {
    let points: Vec<Point> = rows.iter().map(|row| (row.update as f64, value(row))).collect();
    Layer::line(points, pen).labelled(name)
}

/// The axis that shows the totals, and of the terms what matters beside them.
fn axis(rows: &[LearningRow]) -> Axis {
    let totals = rows.iter().map(|row| row.total);
    let terms = rows.iter().flat_map(|row| &row.terms).copied().filter(|value| value.is_finite() && *value != 0.0);
    let least = span(totals.clone().filter(|total| *total > 0.0)).map_or(1.0, |(least, _)| least);
    let is_positive = span(totals.clone()).is_some_and(|(low, _)| low > 0.0);
    let smallest = span(terms.clone().filter(|value| *value > 0.0)).map(|(low, _)| low.max(DEPTH * least));
    let shown: Vec<f64> = if is_positive { smallest.into_iter().collect() } else { terms.collect() };
    Axis::of_cost(totals, shown.into_iter())
}

fn is_weighed(task: &Task, term: Term) -> bool {
    let cost = &task.cost;
    let any = |weight: &PerAxis| weight.values().iter().any(|value| *value > 0.0);
    match term {
        Term::Goal => any(&cost.goal),
        Term::EndVelocity => any(&cost.end_velocity),
        Term::ViaPoint => any(&cost.via_point) || cost.via_distance > 0.0,
        Term::Tracking => cost.tracking > 0.0,
        Term::ContactForce => cost.contact_force > 0.0,
        Term::Acceleration => any(&cost.acceleration),
        Term::Stiffness => any(&cost.stiffness),
        Term::Damping => any(&cost.damping),
        Term::Rest => any(&cost.rest),
    }
}

fn colour(term: Term) -> RGBColor {
    match term {
        Term::Goal => BLUE,
        Term::EndVelocity => SKY,
        Term::ViaPoint => VERMILLION,
        Term::Tracking => GREEN,
        Term::ContactForce => PURPLE,
        Term::Acceleration => ORANGE,
        Term::Stiffness => GREY,
        Term::Damping => OLIVE,
        Term::Rest => BROWN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(update: usize, total: f64, first: f64) -> LearningRow {
        let mut terms = vec![0.0; Term::ALL.len()];
        terms[0] = first;
        LearningRow { update, rollouts: 1, total, terms, exploration: 1.0 }
    }

    #[test]
    fn a_bound_in_one_digit_is_not_below_what_it_bounds() {
        for (value, bound) in [(0.0186, 0.02), (0.02, 0.02), (1.1e-6, 2e-6), (9.3, 10.0), (4e-300, 4e-300)] {
            assert!((above(value) / bound - 1.0).abs() < 1e-12, "{value}: {}", above(value));
        }
    }

    #[test]
    fn a_vanishing_term_does_not_squash_the_others() {
        let Axis { low, high, .. } = axis(&[row(0, 100.0, 50.0), row(1, 1.0, 1e-30)]);
        assert!((1e-5..1e-3).contains(&low) && (100.0..200.0).contains(&high), "{low} {high}");
    }

    #[test]
    fn costs_of_zero_or_less_have_an_axis_in_proportion() {
        for totals in [[0.0, 0.0], [-994.0, -1000.0], [3.0, -2.0], [5.0, 0.0]] {
            let axis = axis(&[row(0, totals[0], 0.0), row(1, totals[1], 0.0)]);
            assert_eq!(axis.scale, Scale::Linear, "{totals:?}");
            assert!(totals.iter().all(|total| axis.low < *total && *total < axis.high), "{totals:?}: {axis:?}");
        }
    }
}
