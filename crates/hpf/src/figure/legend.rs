//! The legend: samples with their labels, in a strip under the title or in a column at the right.

use super::canvas::draw_mark;
use super::chart::{Layer, Point, Shape};
use super::layout::SMALL;
use super::palette::{BLACK, GREY};
use super::surface::{Anchor, Area, Surface};
use super::text;

/// Height of a row.
pub const ROW: f64 = 44.0;
const SAMPLE: f64 = 58.0;
/// From a sample to its label.
const GAP: f64 = 14.0;
/// Between entries of a row.
const BETWEEN: f64 = 40.0;

/// Width of an entry.
pub fn width(label: &str) -> f64 {
    SAMPLE + GAP + text::width(label, SMALL)
}

/// Places of entries in a strip from `corner`, in as many columns as have `room`, and its height.
pub fn strip(widths: &[f64], corner: Point, room: f64) -> (Vec<Point>, f64) {
    let columns = |count: usize| -> Vec<f64> {
        (0..count).map(|c| widths.iter().skip(c).step_by(count).copied().fold(0.0, f64::max) + BETWEEN).collect()
    };
    let fits = |count: &usize| columns(*count).iter().sum::<f64>() - BETWEEN <= room;
    let count = (1..=widths.len()).rev().find(fits).unwrap_or(1);
    let columns = columns(count);
    let place = |i: usize| {
        let left: f64 = columns[..i % count].iter().sum();
        (corner.0 + left, corner.1 + ((i / count) as f64 + 0.5) * ROW)
    };
    ((0..widths.len()).map(place).collect(), widths.len().div_ceil(count) as f64 * ROW)
}

/// Places of `count` entries one below the other, from `corner`.
pub fn column(count: usize, corner: Point) -> Vec<Point> {
    (0..count).map(|i| (corner.0, corner.1 + (i as f64 + 0.5) * ROW)).collect()
}

/// Draws one entry; `place` is the left end of its middle line.
pub fn entry(surface: &mut dyn Surface, layer: &Layer, place: Point) {
    let (x, y) = place;
    match &layer.shape {
        Shape::Line(_) => {
            let all = surface.all();
            let end = 0.5 * layer.pen.width;
            surface.stroke(&[(x + end, y.round()), (x + SAMPLE - end, y.round())], layer.pen, all);
        }
        Shape::Marks(mark, _) => draw_mark(surface, *mark, (x + 0.5 * SAMPLE, y), layer.pen),
        Shape::Block(..) | Shape::Between(_) => {
            surface.fill(Area { left: x, top: y - 14.0, width: SAMPLE, height: 28.0 }, GREY);
            surface.fill(Area { left: x + 2.0, top: y - 12.0, width: SAMPLE - 4.0, height: 24.0 }, layer.pen.colour);
        }
    }
    let label = layer.label.as_deref().unwrap_or_default();
    surface.text(label, (x + SAMPLE + GAP, y + 0.36 * SMALL), SMALL, BLACK, Anchor::Start, false);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_fill_columns_that_fit() {
        let places = strip(&[100.0, 200.0, 100.0], (10.0, 0.0), 500.0).0;
        assert_eq!(places.iter().map(|place| place.0).collect::<Vec<_>>(), [10.0, 150.0, 390.0]);
        let (places, height) = strip(&[100.0, 200.0, 100.0], (10.0, 0.0), 350.0);
        assert_eq!(places[2], (10.0, 1.5 * ROW));
        assert_eq!(height, 2.0 * ROW);
        assert_eq!(strip(&[900.0, 900.0], (0.0, 0.0), 350.0).1, 2.0 * ROW, "too wide is one below the other");
        assert_eq!(strip(&[], (0.0, 0.0), 350.0).1, 0.0);
    }
}
