//! Drawing a figure: title, legend, panels with their frames, and what is in them.

use super::axis::Tick;
use super::chart::{Figure, Layer, Mark, Panel, Point, Shape};
use super::layout::{CAPITAL, FOOT, LABEL, Layout, MARGIN, SMALL, TICK_GAP, TICK_LENGTH, TITLE};
use super::palette::{BLACK, FRAME, GRID, Pen, QUIET, WHITE};
use super::surface::{Anchor, Area, Column, Format, Surface};
use super::{ends, legend, text};

/// How much a band covers what it lies on: two of them still show through each other.
const BAND_OPACITY: f64 = 0.3;

/// Draws `figure`, which belongs to `subject`: the bytes of its file.
///
/// # Errors
/// What the encoder says.
pub fn draw(mut figure: Figure, subject: &str, format: Format) -> Result<Vec<u8>, String> {
    let layout = Layout::new(&mut figure);
    let mut surface = format.surface(layout.size);
    let canvas = &mut *surface;
    let right = layout.size.0 as f64 - MARGIN;
    let left = layout.boxes[0].left;

    let title = text::fit(&figure.title, TITLE, right - left);
    let baseline = MARGIN + CAPITAL * TITLE;
    canvas.text(&title, (left, baseline), TITLE, BLACK, Anchor::Start, false);
    let room = right - left - text::width(&title, TITLE) - 60.0;
    if room > 100.0 {
        canvas.text(&text::fit(subject, SMALL, room), (right, baseline), SMALL, QUIET, Anchor::End, false);
    }
    for (layer, place) in figure.legend().into_iter().zip(&layout.legend) {
        legend::entry(canvas, layer, *place);
    }
    for ((panel, area), ticks) in figure.panels.iter().zip(&layout.boxes).zip(&layout.y_ticks) {
        draw_panel(canvas, panel, *area, ticks, &layout.x_ticks, figure.panels.len() == 1);
    }
    let (panel, area) = (&figure.panels[0], layout.boxes.last().expect("a figure has a panel"));
    for tick in &layout.x_ticks {
        let x = horizontal(panel, *area, tick.value).round();
        let place = (x, area.bottom() + TICK_LENGTH + TICK_GAP + CAPITAL * SMALL);
        canvas.text(&tick.label, place, SMALL, BLACK, Anchor::Middle, false);
    }
    let map = |point: &Point| (horizontal(panel, *area, point.0), vertical(panel, *area, point.1));
    ends::draw(canvas, &figure, *area, &map);
    let place = (area.left + 0.5 * area.width, area.bottom() + FOOT - MARGIN + 4.0);
    canvas.text(&panel.x.title(), place, LABEL, BLACK, Anchor::Middle, false);
    surface.encode()
}

fn horizontal(panel: &Panel, area: Area, value: f64) -> f64 {
    area.left + (panel.x.share(value) * area.width).clamp(-1e5, 1e5)
}

fn vertical(panel: &Panel, area: Area, value: f64) -> f64 {
    area.bottom() - (panel.y.share(value) * area.height).clamp(-1e5, 1e5)
}

fn draw_panel(surface: &mut dyn Surface, panel: &Panel, area: Area, y_ticks: &[Tick], x_ticks: &[Tick], single: bool) {
    let map = |point: &Point| (horizontal(panel, area, point.0), vertical(panel, area, point.1));
    let all = surface.all();
    let layers = |surface: &mut dyn Surface, wanted: fn(&Shape) -> bool| {
        for layer in panel.layers.iter().filter(|layer| wanted(&layer.shape)) {
            draw_layer(surface, layer, area, &map);
        }
    };
    layers(surface, |shape| matches!(shape, Shape::Block(..)));
    let grid = Pen::thin(GRID);
    let length = |tick: &Tick| if tick.label.is_empty() { 0.5 * TICK_LENGTH } else { TICK_LENGTH };
    for tick in x_ticks {
        let x = horizontal(panel, area, tick.value).round();
        surface.stroke(&[(x, area.bottom()), (x, area.bottom() + length(tick))], Pen::thin(FRAME), all);
        if !tick.label.is_empty() {
            surface.stroke(&[(x, area.top), (x, area.bottom())], grid, area);
        }
    }
    for tick in y_ticks {
        let y = vertical(panel, area, tick.value).round();
        surface.stroke(&[(area.left - length(tick), y), (area.left, y)], Pen::thin(FRAME), all);
        if !tick.label.is_empty() {
            surface.stroke(&[(area.left, y), (area.right(), y)], grid, area);
            let place = (area.left - TICK_LENGTH - TICK_GAP, y + 0.5 * CAPITAL * SMALL);
            surface.text(&tick.label, place, SMALL, BLACK, Anchor::End, false);
        }
    }
    layers(surface, |shape| matches!(shape, Shape::Between(_)));
    layers(surface, |shape| matches!(shape, Shape::Line(_)));
    let (right, bottom) = (area.right(), area.bottom());
    let frame = [(area.left, area.top), (right, area.top), (right, bottom), (area.left, bottom), (area.left, area.top)];
    surface.stroke(&frame, Pen::thin(FRAME), all);
    // A goal at the end of the time stands on the frame.
    layers(surface, |shape| matches!(shape, Shape::Marks(..)));

    let title = panel.y.title();
    let mut heading = panel.heading.clone();
    if single {
        let place = (MARGIN + CAPITAL * LABEL, area.top + 0.5 * area.height);
        surface.text(&text::fit(&title, LABEL, area.height), place, LABEL, BLACK, Anchor::Middle, true);
    } else {
        heading = [heading, title].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(": ");
    }
    let baseline = area.top - 17.0;
    let note = text::fit(&panel.note, SMALL, area.width);
    let heading = text::fit(&heading, SMALL, (area.width - text::width(&note, SMALL) - 30.0).max(0.0));
    if heading != "…" {
        surface.text(&heading, (area.left, baseline), SMALL, BLACK, Anchor::Start, false);
    }
    surface.text(&note, (right, baseline), SMALL, QUIET, Anchor::End, false);
}

fn draw_layer(surface: &mut dyn Surface, layer: &Layer, area: Area, map: &impl Fn(&Point) -> Point) {
    match &layer.shape {
        Shape::Line(points) => surface.stroke(&thinned(points.iter().map(map)), layer.pen, area),
        Shape::Between(curves) => {
            let column = |(x, low, high): &(f64, f64, f64)| {
                let (bottom, top) = (map(&(*x, *low)), map(&(*x, *high)));
                Column { x: top.0, top: top.1, bottom: bottom.1 }
            };
            let columns: Vec<Column> = curves.iter().map(column).collect();
            surface.band(&columns, layer.pen.colour, BAND_OPACITY, area);
        }
        Shape::Marks(mark, points) => {
            for point in points {
                draw_mark(surface, *mark, map(point), layer.pen);
            }
        }
        Shape::Block(from, to) => {
            let (from, to) = (map(from), map(to));
            let x = |value: f64| value.max(area.left).min(area.right());
            let y = |value: f64| value.max(area.top).min(area.bottom());
            let (left, top) = (x(from.0.min(to.0)), y(from.1.min(to.1)));
            let (width, height) = (x(from.0.max(to.0)) - left, y(from.1.max(to.1)) - top);
            surface.fill(Area { left, top, width, height }, layer.pen.colour);
        }
    }
}

/// Draws a mark around `place` [px].
pub fn draw_mark(surface: &mut dyn Surface, mark: Mark, place: Point, pen: Pen) {
    let all = surface.all();
    let dot = |surface: &mut dyn Surface, width: f64, colour| {
        surface.stroke(&[place], Pen { colour, width, dash: None }, all);
    };
    match mark {
        Mark::Dot => {
            dot(surface, 26.0, WHITE);
            dot(surface, 20.0, pen.colour);
        }
        Mark::Speck => {
            dot(surface, 15.0, WHITE);
            dot(surface, 11.0, pen.colour);
        }
        Mark::Target => {
            dot(surface, 28.0, pen.colour);
            dot(surface, 20.0, WHITE);
            dot(surface, 11.0, pen.colour);
        }
        Mark::Ring => {
            dot(surface, 24.0, pen.colour);
            dot(surface, 14.0, WHITE);
        }
    }
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
}
