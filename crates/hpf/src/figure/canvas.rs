//! Drawing a figure: title, legend, panels with their frames, and what is in them.

use super::axis::Tick;
use super::chart::{Figure, Layer, Mark, Panel, Point, Shape};
use super::layout::{CAPITAL, FOOT, LABEL, Layout, MARGIN, SMALL, TICK_GAP, TICK_LENGTH, TITLE};
use super::page::{Anchor, Area, Format, Page, is_place};
use super::palette::{BLACK, FRAME, GRID, Pen, QUIET, WHITE};
use super::{ends, legend, text};

/// How much a band covers what it lies on: two of them still show through each other.
const BAND_OPACITY: f64 = 0.3;

/// Draws `figure`, which belongs to `subject`: the bytes of its file.
///
/// # Errors
/// What the page says, or that the figure has no panel.
pub fn draw(mut figure: Figure, subject: &str, format: Format) -> Result<Vec<u8>, String> {
    if figure.panels.is_empty() {
        return Err("the figure has no panel".into());
    }
    let layout = Layout::new(&mut figure);
    let mut page = Page::new(layout.size);
    let right = layout.size.0 - MARGIN;
    let left = layout.boxes[0].left;

    let title = text::fit(&figure.title, TITLE, right - left);
    let baseline = MARGIN + CAPITAL * TITLE;
    page.text(&title, (left, baseline), TITLE, BLACK, Anchor::Start, false);
    let room = right - left - text::width(&title, TITLE) - 60.0;
    if room > 100.0 {
        page.text(&text::fit(subject, SMALL, room), (right, baseline), SMALL, QUIET, Anchor::End, false);
    }
    for (layer, place) in figure.legend().into_iter().zip(&layout.legend) {
        legend::entry(&mut page, layer, *place);
    }
    for ((panel, area), ticks) in figure.panels.iter().zip(&layout.boxes).zip(&layout.y_ticks) {
        draw_panel(&mut page, panel, *area, ticks, &layout.x_ticks, figure.panels.len() == 1);
    }
    let (panel, area) = (&figure.panels[0], &layout.boxes[figure.panels.len() - 1]);
    for tick in &layout.x_ticks {
        let x = horizontal(panel, *area, tick.value).round();
        let place = (x, area.bottom() + TICK_LENGTH + TICK_GAP + CAPITAL * SMALL);
        page.text(&tick.label, place, SMALL, BLACK, Anchor::Middle, false);
    }
    let map = |point: &Point| (horizontal(panel, *area, point.0), vertical(panel, *area, point.1));
    ends::draw(&mut page, &figure, *area, &map);
    let place = (area.left + 0.5 * area.width, area.bottom() + FOOT - MARGIN + 4.0);
    page.text(&panel.x.title(), place, LABEL, BLACK, Anchor::Middle, false);
    page.encode(format)
}

fn horizontal(panel: &Panel, area: Area, value: f64) -> f64 {
    area.left + (panel.x.share(value) * area.width).clamp(-1e5, 1e5)
}

fn vertical(panel: &Panel, area: Area, value: f64) -> f64 {
    area.bottom() - (panel.y.share(value) * area.height).clamp(-1e5, 1e5)
}

fn draw_panel(page: &mut Page, panel: &Panel, area: Area, y_ticks: &[Tick], x_ticks: &[Tick], single: bool) {
    let map = |point: &Point| (horizontal(panel, area, point.0), vertical(panel, area, point.1));
    let layers = |page: &mut Page, wanted: fn(&Shape) -> bool| {
        for layer in panel.layers.iter().filter(|layer| wanted(&layer.shape)) {
            draw_layer(page, layer, area, &map);
        }
    };
    layers(page, |shape| matches!(shape, Shape::Block(..)));
    let grid = Pen::thin(GRID);
    let length = |tick: &Tick| if tick.label.is_empty() { 0.5 * TICK_LENGTH } else { TICK_LENGTH };
    for tick in x_ticks {
        let x = horizontal(panel, area, tick.value).round();
        page.stroke(&[(x, area.bottom()), (x, area.bottom() + length(tick))], Pen::thin(FRAME));
        if !tick.label.is_empty() {
            page.stroke(&[(x, area.top), (x, area.bottom())], grid);
        }
    }
    for tick in y_ticks {
        let y = vertical(panel, area, tick.value).round();
        page.stroke(&[(area.left - length(tick), y), (area.left, y)], Pen::thin(FRAME));
        if !tick.label.is_empty() {
            page.stroke(&[(area.left, y), (area.right(), y)], grid);
            let place = (area.left - TICK_LENGTH - TICK_GAP, y + 0.5 * CAPITAL * SMALL);
            page.text(&tick.label, place, SMALL, BLACK, Anchor::End, false);
        }
    }
    layers(page, |shape| matches!(shape, Shape::Between(_)));
    layers(page, |shape| matches!(shape, Shape::Line(_)));
    let (right, bottom) = (area.right(), area.bottom());
    let corners = [(area.left, area.top), (right, area.top), (right, bottom), (area.left, bottom)];
    // Once round and on, so that every corner is joined.
    page.stroke(&corners.into_iter().cycle().take(6).collect::<Vec<_>>(), Pen::thin(FRAME));
    // A goal at the end of the time stands on the frame.
    layers(page, |shape| matches!(shape, Shape::Marks(..)));

    let title = panel.y.title();
    let mut heading = panel.heading.clone();
    if single {
        let place = (MARGIN + CAPITAL * LABEL, area.top + 0.5 * area.height);
        page.text(&text::fit(&title, LABEL, area.height), place, LABEL, BLACK, Anchor::Middle, true);
    } else {
        heading = [heading, title].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(": ");
    }
    let baseline = area.top - 17.0;
    let note = text::fit(&panel.note, SMALL, area.width);
    let heading = text::fit(&heading, SMALL, (area.width - text::width(&note, SMALL) - 30.0).max(0.0));
    if heading != "…" {
        page.text(&heading, (area.left, baseline), SMALL, BLACK, Anchor::Start, false);
    }
    page.text(&note, (right, baseline), SMALL, QUIET, Anchor::End, false);
}

fn draw_layer(page: &mut Page, layer: &Layer, area: Area, map: &impl Fn(&Point) -> Point) {
    match &layer.shape {
        Shape::Line(points) => {
            for part in inside(points.iter().map(map), area) {
                page.stroke(&thinned(part.into_iter()), layer.pen);
            }
        }
        Shape::Between(curves) => {
            let place = |x: f64, y: f64| {
                let (x, y) = map(&(x, y));
                (x.max(area.left).min(area.right()), y.max(area.top).min(area.bottom()))
            };
            let is_known = |(x, low, high): &&(f64, f64, f64)| [x, low, high].iter().all(|value| !value.is_nan());
            let curves: Vec<_> = curves.iter().filter(is_known).collect();
            let above = curves.iter().map(|(x, _, high)| place(*x, *high));
            let below = curves.iter().rev().map(|(x, low, _)| place(*x, *low));
            page.cover(&above.chain(below).collect::<Vec<_>>(), layer.pen.colour, BAND_OPACITY);
        }
        Shape::Marks(mark, points) => {
            for point in points {
                draw_mark(page, *mark, map(point), layer.pen);
            }
        }
        Shape::Block(from, to) => {
            let (from, to) = (map(from), map(to));
            let x = |value: f64| value.max(area.left).min(area.right());
            let y = |value: f64| value.max(area.top).min(area.bottom());
            let (left, top) = (x(from.0.min(to.0)), y(from.1.min(to.1)));
            let (width, height) = (x(from.0.max(to.0)) - left, y(from.1.max(to.1)) - top);
            page.fill(Area { left, top, width, height }, layer.pen.colour);
        }
    }
}

/// Draws a mark around `place` [px].
pub fn draw_mark(page: &mut Page, mark: Mark, place: Point, pen: Pen) {
    let dot = |page: &mut Page, width: f64, colour| {
        page.stroke(&[place], Pen { colour, width, dash: None });
    };
    match mark {
        Mark::Dot => {
            dot(page, 26.0, WHITE);
            dot(page, 20.0, pen.colour);
        }
        Mark::Speck => {
            dot(page, 15.0, WHITE);
            dot(page, 11.0, pen.colour);
        }
        Mark::Target => {
            dot(page, 28.0, pen.colour);
            dot(page, 20.0, WHITE);
            dot(page, 11.0, pen.colour);
        }
        Mark::Ring => {
            dot(page, 24.0, pen.colour);
            dot(page, 14.0, WHITE);
        }
    }
}

/// The parts of a line that lie in `area`; it breaks where a point is nowhere.
fn inside(points: impl Iterator<Item = Point>, area: Area) -> Vec<Vec<Point>> {
    let points: Vec<Point> = points.collect();
    let mut parts: Vec<Vec<Point>> = Vec::new();
    for piece in points.split(|point| !is_place(point)) {
        if let [only] = *piece {
            parts.extend(clipped(only, only, area).map(|_| vec![only]));
        }
        for (from, to) in piece.windows(2).filter_map(|pair| clipped(pair[0], pair[1], area)) {
            match parts.last_mut() {
                Some(part) if part.last() == Some(&from) => part.push(to),
                _ => parts.push(vec![from, to]),
            }
        }
    }
    parts
}

/// The part of a straight line that lies in `area` (Liang and Barsky, 1984).
fn clipped(from: Point, to: Point, area: Area) -> Option<(Point, Point)> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let ways = [(from.0, to.0, area.left, area.right()), (from.1, to.1, area.top, area.bottom())];
    for (start, end, low, high) in ways {
        if start == end && !(low..=high).contains(&start) {
            return None;
        } else if start != end {
            let [first, second] = [low, high].map(|edge| (edge - start) / (end - start));
            enter = enter.max(first.min(second));
            leave = leave.min(first.max(second));
        }
    }
    let at = |share: f64| (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
    (enter <= leave).then(|| (if enter > 0.0 { at(enter) } else { from }, if leave < 1.0 { at(leave) } else { to }))
}

/// The same line in at most six points per column of pixels: first, last, and the outermost of each side.
fn thinned(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    let mut column: Vec<Point> = Vec::new();
    let mut flush = |column: &mut Vec<Point>| {
        let outermost = |across: f64, down: f64| {
            let reach = |i: usize| across * column[i].0 + down * column[i].1;
            (0..column.len()).max_by(|a, b| reach(*a).total_cmp(&reach(*b))).unwrap_or(0)
        };
        let [left, right] = [-1.0, 1.0].map(|sign| outermost(sign, 0.0));
        let [top, bottom] = [-1.0, 1.0].map(|sign| outermost(0.0, sign));
        let mut picks = [0, left, right, top, bottom, column.len().saturating_sub(1)];
        picks.sort_unstable();
        let mut before = None;
        for pick in picks.into_iter().filter(|pick| before.replace(*pick) != Some(*pick)) {
            kept.extend(column.get(pick));
        }
        column.clear();
    };
    for point in points {
        if column.last().is_some_and(|last| last.0.floor() != point.0.floor()) {
            flush(&mut column);
        }
        column.push(point);
    }
    flush(&mut column);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dense_line_keeps_its_ends_and_peaks() {
        let dense = (0..1000).map(|i| (f64::from(i) * 0.001, if i == 500 { 9.0 } else { 0.0 }));
        let kept = thinned(dense);
        assert!(kept.len() <= 4 && kept[0].0 == 0.0 && kept[kept.len() - 1].0 == 0.999);
        assert!(kept.iter().any(|point| point.1 == 9.0));
        let turn: Vec<Point> = (-3..=3).map(|i| (0.1 * f64::from(i * i), f64::from(i))).collect();
        assert!(thinned(turn.iter().copied()).contains(&(0.0, 0.0)), "a turn within a column stays round");
        let sparse: Vec<Point> = (0..10).map(|i| (f64::from(i) * 3.0, 1.0)).collect();
        assert_eq!(thinned(sparse.iter().copied()), sparse);
    }
    #[test]
    fn of_a_line_only_what_lies_in_the_panel_is_drawn() {
        let area = Area { left: 0.0, top: 0.0, width: 10.0, height: 10.0 };
        let parts = |points: &[Point]| inside(points.iter().copied(), area);
        assert_eq!(parts(&[(-1e5, 5.0), (1e5, 5.0)]), [[(0.0, 5.0), (10.0, 5.0)]]);
        assert_eq!(
            parts(&[(2.0, 5.0), (4.0, 15.0), (6.0, 5.0), (7.0, 5.0)]),
            [vec![(2.0, 5.0), (3.0, 10.0)], vec![(5.0, 10.0), (6.0, 5.0), (7.0, 5.0)]]
        );
        assert_eq!(parts(&[(-5.0, 3.0), (3.0, 13.0)]), [[(0.0, 9.25), (0.6, 10.0)]]);
        assert_eq!(
            parts(&[(2.0, -5.0), (12.0, 5.0), (f64::NAN, 5.0), (4.0, 4.0)]),
            [vec![(7.0, 0.0), (10.0, 3.0)], vec![(4.0, 4.0)]]
        );
        assert!(parts(&[(-5.0, 8.0), (3.0, 16.0), (f64::NAN, 0.0), (11.0, 4.0)]).is_empty());
    }
}
