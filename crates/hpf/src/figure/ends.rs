//! Labels at the ends of lines, at the right of the panel: nothing has to be looked up in a legend.

use super::chart::{Figure, Layer, Point, Shape};
use super::layout::{CAPITAL, SMALL};
use super::palette::{BLACK, Pen};
use super::surface::{Anchor, Area, Surface};
use super::text;

/// Least distance of labels.
const ROW: f64 = 36.0;
/// From the box to a label: the stroke that leads there.
const LEADER: f64 = 36.0;
/// From that stroke to the label.
const GAP: f64 = 10.0;

/// Lines that are labelled at their ends: the first of those that are alike.
fn labelled(figure: &Figure) -> Vec<(&Layer, &str)> {
    let mut found: Vec<(&Layer, &str)> = Vec::new();
    for layer in figure.panels.iter().take(usize::from(figure.direct)).flat_map(|panel| &panel.layers) {
        if let (true, Some(label)) = (is_line(layer), layer.label.as_deref())
            && found.iter().all(|(known, _)| !known.is_alike(layer))
        {
            found.push((layer, label));
        }
    }
    found
}

/// Whether `layer` is a line, so that it has an end to stand at.
pub fn is_line(layer: &Layer) -> bool {
    matches!(layer.shape, Shape::Line(_))
}

/// Room that the labels of `figure` take at the right of its box.
pub fn width(figure: &Figure) -> f64 {
    let widest = labelled(figure).into_iter().map(|(_, label)| text::width(label, SMALL)).reduce(f64::max);
    widest.map_or(0.0, |widest| LEADER + GAP + widest)
}

/// Draws the labels beside `area`.
pub fn draw(surface: &mut dyn Surface, figure: &Figure, area: Area, map: &impl Fn(&Point) -> Point) {
    let tip = |layer: &Layer| match &layer.shape {
        Shape::Line(points) => points.iter().rev().map(map).find(|point| point.1.is_finite()),
        _ => None,
    };
    let mut ends: Vec<_> = labelled(figure)
        .into_iter()
        .filter_map(|(layer, label)| Some((tip(layer)?.1.max(area.top).min(area.bottom()), layer.pen, label)))
        .collect();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    let places = apart(&ends.iter().map(|end| end.0).collect::<Vec<_>>(), (area.top, area.bottom()));
    let all = surface.all();
    for ((tip, pen, label), y) in ends.into_iter().zip(places) {
        let (x, end) = (area.right() + 4.0, area.right() + LEADER);
        let bend = x + 0.5 * (end - x);
        let pen = Pen { width: pen.width.min(3.0), ..pen };
        surface.stroke(&[(x, tip), (bend, y), (end, y)], pen, all);
        surface.text(label, (end + GAP, y + 0.5 * CAPITAL * SMALL), SMALL, BLACK, Anchor::Start, false);
    }
}

/// Places at least [`ROW`] apart, as near to `wanted` (in rising order) as least squares come, between `low` and `high`.
fn apart(wanted: &[f64], (low, high): (f64, f64)) -> Vec<f64> {
    // Without their rows the places have only to rise: neighbours that do not are pooled at their mean.
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (i, place) in wanted.iter().enumerate() {
        let mut pool = (place - ROW * i as f64, 1);
        while let Some(before) = pools.pop_if(|before| before.0 > pool.0) {
            let count = before.1 + pool.1;
            pool = ((before.0 * before.1 as f64 + pool.0 * pool.1 as f64) / count as f64, count);
        }
        pools.push(pool);
    }
    let last = (high - ROW * wanted.len().saturating_sub(1) as f64).max(low);
    let places = pools.into_iter().flat_map(|(place, count)| core::iter::repeat_n(place.clamp(low, last), count));
    places.enumerate().map(|(i, place)| place + ROW * i as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_stay_at_their_lines_where_there_is_room_and_share_the_way_where_not() {
        let places = apart(&[100.0, 300.0, 302.0], (0.0, 500.0));
        assert_eq!(places, [100.0, 301.0 - 0.5 * ROW, 301.0 + 0.5 * ROW]);
        let crowded = apart(&[500.0; 4], (0.0, 500.0));
        assert_eq!(crowded[3], 500.0);
        assert!(crowded.windows(2).all(|pair| pair[1] - pair[0] == ROW));
    }
}
