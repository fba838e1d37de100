//! Where everything goes in a figure.
//!
//! All sizes are in pixels of a bitmap twice as fine as the figure is meant to be shown.

use super::axis::{Scale, Tick};
use super::chart::{Figure, Panel, Point};
use super::surface::Area;
use super::{ends, legend, text};

const WIDTH: f64 = 1600.0;
const HEIGHT: f64 = 1000.0;
/// Free border of the figure.
pub const MARGIN: f64 = 40.0;
/// Size of the title.
pub const TITLE: f64 = 38.0;
/// Size of the titles of axes.
pub const LABEL: f64 = 30.0;
/// Size of tick labels, legend, headings and notes.
pub const SMALL: f64 = 27.0;
/// Height over a line of capitals, as a fraction of their size.
pub const CAPITAL: f64 = 0.73;
/// Length of a tick.
pub const TICK_LENGTH: f64 = 9.0;
/// From a tick to its label.
pub const TICK_GAP: f64 = 9.0;
/// Below the last panel: tick labels and the title of the axis.
pub const FOOT: f64 = 112.0;
/// Width of the strip of the legend: what the widest tick labels leave of the figure.
const STRIP: f64 = 1340.0;
/// Left of a box, before its tick labels are known.
const USUAL_LEFT: f64 = 200.0;
/// From a box to a legend at its right.
const BESIDE: f64 = 30.0;
/// Least distance of ticks along the horizontal axis.
const X_SPACING: f64 = 125.0;
/// Height of the line above a box that holds heading and note.
const HEADING: f64 = 50.0;
/// Between panels.
const GAP: f64 = 26.0;
/// Least height of one of many panels.
const LEAST_PANEL: f64 = 220.0;
/// Least width of a box with equal units, as a fraction of its height.
const LEAST_ASPECT: f64 = 0.75;

/// Places and ticks of a figure.
pub struct Layout {
    /// Size of the figure.
    pub size: (usize, usize),
    /// The box of each panel.
    pub boxes: Vec<Area>,
    /// Ticks of each vertical axis.
    pub y_ticks: Vec<Vec<Tick>>,
    /// Ticks of the horizontal axis.
    pub x_ticks: Vec<Tick>,
    /// Left end of each entry of the legend.
    pub legend: Vec<Point>,
}

impl Layout {
    /// The layout of `figure`; where units are to be equal, its axes become wider.
    pub fn new(figure: &mut Figure) -> Self {
        let entries = figure.legend();
        let samples: Vec<f64> = entries.iter().filter_map(|entry| entry.label.as_deref()).map(legend::width).collect();
        let count = figure.panels.len();
        let headed = figure.panels.iter().any(|panel| !(panel.heading.is_empty() && panel.note.is_empty()));
        let heading = if headed || count > 1 { HEADING } else { 0.0 };
        let title_end = MARGIN + TITLE + 22.0;
        let strip = |left: f64| legend::strip(&samples, (left, title_end), STRIP);
        let top = title_end + if figure.equal || samples.is_empty() { 0.0 } else { strip(0.0).1 + 14.0 };

        let share = (HEIGHT - top - FOOT - (count - 1) as f64 * GAP) / count as f64 - heading;
        let height = share.max(if count > 1 { LEAST_PANEL } else { 0.0 }).floor();
        let column = samples.iter().copied().fold(0.0, f64::max) + BESIDE;
        let square = figure.equal.then(|| square(&mut figure.panels[0], height, WIDTH - USUAL_LEFT - column - MARGIN));
        let y_ticks: Vec<_> =
            figure.panels.iter().map(|panel| panel.y.ticks(y_pieces(figure.equal, panel, height))).collect();
        let labels = y_ticks.iter().map(|ticks| widest(ticks)).fold(0.0, f64::max);
        let axis_title = if count == 1 { LABEL + 22.0 } else { 0.0 };
        let left = (MARGIN + axis_title + labels + TICK_GAP + TICK_LENGTH).ceil();

        let x = &figure.panels[0].x;
        let beside = ends::width(figure);
        let room = square.unwrap_or(WIDTH - left - beside - MARGIN);
        let mut x_ticks = x.ticks(pieces(room, X_SPACING));
        if x.scale == Scale::Named {
            let slot = room / x_ticks.len().max(1) as f64;
            x_ticks.iter_mut().for_each(|tick| tick.label = text::fit(&tick.label, SMALL, slot - 16.0));
        } else if widest(&x_ticks) + 40.0 > X_SPACING {
            x_ticks = x.ticks(pieces(room, widest(&x_ticks) + 60.0));
        }
        // The last label is centred on its tick and must not be cut off; names stay inside the box.
        let last = x_ticks.last().filter(|_| x.scale != Scale::Named);
        let overhang = 0.5 * last.map_or(0.0, |tick| text::width(&tick.label, SMALL)) + 12.0 - MARGIN - beside;
        let width = square.unwrap_or((room - overhang.max(0.0)).floor());

        let panel_top = |i: usize| (top + heading + i as f64 * (height + GAP + heading)).floor();
        let boxes: Vec<_> = (0..count).map(|i| Area { left, top: panel_top(i), width, height }).collect();
        let bottom = boxes[count - 1].bottom();
        let (right, legend) = match square {
            Some(width) => {
                (left + width + column + MARGIN, legend::column(samples.len(), (left + width + BESIDE, boxes[0].top)))
            }
            None => (WIDTH, strip(left).0),
        };
        Self { size: (right.ceil() as usize, (bottom + FOOT).ceil() as usize), boxes, y_ticks, x_ticks, legend }
    }
}

/// How many pieces ticks at least `spacing` apart cut an axis of `length` into; a few it gets in any case.
fn pieces(length: f64, spacing: f64) -> f64 {
    (length / spacing).max(3.0)
}

fn y_pieces(equal: bool, panel: &Panel, height: f64) -> f64 {
    let spacing = match panel.y.scale {
        // The same as across, so that both axes have the same steps.
        _ if equal => X_SPACING,
        _ if height < 2.0 * LEAST_PANEL => 54.0,
        Scale::Logarithmic => 60.0,
        _ => 74.0,
    };
    pieces(height, spacing)
}

fn widest(ticks: &[Tick]) -> f64 {
    ticks.iter().map(|tick| text::width(&tick.label, SMALL)).fold(0.0, f64::max)
}

/// Widens the axes of `panel` until a unit is as long on both; returns the width of its box.
fn square(panel: &mut Panel, height: f64, room: f64) -> f64 {
    let (x, y) = (&mut panel.x, &mut panel.y);
    let ratio = (x.high - x.low) / (y.high - y.low);
    let width = (height * ratio).clamp((LEAST_ASPECT * height).min(room), room).floor();
    let unit = (width / (x.high - x.low)).min(height / (y.high - y.low));
    for (axis, length) in [(x, width), (y, height)] {
        let room = 0.5 * (length / unit - (axis.high - axis.low));
        axis.low -= room;
        axis.high += room;
    }
    width
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::axis::Axis;

    fn panel(x: (f64, f64), y: (f64, f64)) -> Panel {
        let [heading, note] = [String::new(), String::new()];
        Panel { heading, note, x: Axis::linear("x", "m", x), y: Axis::linear("y", "m", y), layers: Vec::new() }
    }

    #[test]
    fn equal_units_are_equally_long_and_keep_the_data_in_view() {
        for (x, y) in [((0.0, 1.0), (0.0, 1.0)), ((0.0, 80.0), (0.0, 1.0)), ((-0.1, 0.1), (0.0, 3.0))] {
            let mut panel = panel(x, y);
            let width = square(&mut panel, 800.0, 1000.0);
            let units = [width / (panel.x.high - panel.x.low), 800.0 / (panel.y.high - panel.y.low)];
            assert!((units[0] / units[1] - 1.0).abs() < 1e-9 && width <= 1000.0);
            // Rounding of the last bit apart.
            let holds = |axis: &Axis, (low, high)| axis.low <= low + 1e-9 && axis.high >= high - 1e-9;
            assert!(holds(&panel.x, x) && holds(&panel.y, y));
        }
    }

    #[test]
    fn no_label_leaves_the_figure() {
        for count in 1..=7 {
            let panels = vec![panel((0.0, 100_000.0), (-1e-9, 1000.0)); count];
            let layout = Layout::new(&mut Figure::new("", panels));
            let (last, area) = (layout.x_ticks.last().unwrap(), layout.boxes[count - 1]);
            assert!(area.right() + 0.5 * text::width(&last.label, SMALL) < layout.size.0 as f64);
            assert!(area.left - widest(&layout.y_ticks[0]) > 0.0 && area.bottom() + FOOT <= layout.size.1 as f64);
            assert!(area.height >= LEAST_PANEL);
        }
    }
}
