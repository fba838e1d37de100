//! A figure as plain data: panels one below the other, layers in them, and what the legend says.

use super::axis::Axis;
use super::ends;
use super::palette::Pen;

/// Two numbers: a place in a panel, in the units of its axes, or on the bitmap.
pub type Point = (f64, f64);

/// A figure.
#[derive(Clone, Debug)]
pub struct Figure {
    /// What is seen.
    pub title: String,
    /// One below the other; they share the horizontal axis.
    pub panels: Vec<Panel>,
    /// Whether one unit is as long on the vertical as on the horizontal axis; the legend then stands at the right.
    pub equal: bool,
    /// Whether lines are labelled at their ends, in a figure of one panel.
    pub direct: bool,
}

/// One diagram.
#[derive(Clone, Debug)]
pub struct Panel {
    /// What sets it apart from the other panels.
    pub heading: String,
    /// What is to be known besides.
    pub note: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is drawn: rectangles under the grid, bands and lines over it, marks over all; within these, the lowest first.
    pub layers: Vec<Layer>,
}

/// One thing in a panel.
#[derive(Clone, Debug)]
pub struct Layer {
    /// What is drawn.
    pub shape: Shape,
    /// How.
    pub pen: Pen,
    /// What the legend says; without one, the legend leaves it out.
    pub label: Option<String>,
}

/// What a layer draws.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A line through points.
    Line(Vec<Point>),
    /// A mark at each point.
    Marks(Mark, Vec<Point>),
    /// A filled rectangle between two corners, which may lie endlessly far outside.
    Block(Point, Point),
    /// What lies between two curves, lightly covered: where, the lower and the upper one.
    Between(Vec<(f64, f64, f64)>),
}

/// A mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A filled circle.
    Dot,
    /// A circle with a hole.
    Ring,
    /// A circle in a ring.
    Target,
    /// One of many small circles.
    Speck,
}

impl Layer {
    /// Whether one entry of a legend says both: what a run is called may be what something else is.
    pub fn is_alike(&self, other: &Self) -> bool {
        let is_alike = match (&self.shape, &other.shape) {
            (Shape::Line(_), Shape::Line(_)) => self.pen == other.pen,
            (Shape::Marks(mark, _), Shape::Marks(other, _)) => mark == other,
            (Shape::Block(..) | Shape::Between(_), Shape::Block(..) | Shape::Between(_)) => true,
            _ => false,
        };
        is_alike && self.label == other.label
    }

    /// A line.
    pub fn line(points: Vec<Point>, pen: Pen) -> Self {
        Self { shape: Shape::Line(points), pen, label: None }
    }

    /// A signal over another, such as time.
    pub fn signal(x: &[f64], y: &[f64], factor: f64, pen: Pen) -> Self {
        Self::line(x.iter().zip(y).map(|(x, y)| (*x, factor * y)).collect(), pen)
    }

    /// A level line.
    pub fn level(y: f64, pen: Pen) -> Self {
        // Far beyond any axis, yet finite, so that the line has places to go through.
        Self::line(vec![(-1e300, y), (1e300, y)], pen)
    }

    /// Marks.
    pub fn marks(mark: Mark, points: Vec<Point>, pen: Pen) -> Self {
        Self { shape: Shape::Marks(mark, points), pen, label: None }
    }

    /// A rectangle.
    pub fn block(from: Point, to: Point, pen: Pen) -> Self {
        Self { shape: Shape::Block(from, to), pen, label: None }
    }

    /// What lies between two curves: where, the lower and the upper one.
    pub fn between(curves: Vec<(f64, f64, f64)>, pen: Pen) -> Self {
        Self { shape: Shape::Between(curves), pen, label: None }
    }

    /// Everything from `low` to `high`.
    pub fn band(low: f64, high: f64, pen: Pen) -> Self {
        Self::block((f64::NEG_INFINITY, low), (f64::INFINITY, high), pen)
    }

    /// The points that a line or marks go through.
    pub fn points(&self) -> &[Point] {
        match &self.shape {
            Shape::Line(points) | Shape::Marks(_, points) => points,
            Shape::Block(..) | Shape::Between(_) => &[],
        }
    }

    /// The same layer, in the legend.
    pub fn labelled(mut self, label: impl Into<String>) -> Self {
        self.label = Some(label.into());
        self
    }
}

impl Figure {
    /// A figure of panels that share the horizontal axis.
    pub fn new(title: impl Into<String>, panels: Vec<Panel>) -> Self {
        Self { title: title.into(), panels, equal: false, direct: false }
    }

    /// The same figure with its lines labelled at their ends.
    pub fn with_direct_labels(mut self) -> Self {
        self.direct = true;
        self
    }

    /// The layers that the legend shows: the first with each label, those labelled elsewhere left out.
    pub fn legend(&self) -> Vec<&Layer> {
        let mut entries: Vec<&Layer> = Vec::new();
        for layer in self.panels.iter().flat_map(|panel| &panel.layers) {
            let elsewhere = self.direct && ends::is_line(layer);
            if layer.label.is_some() && !elsewhere && entries.iter().all(|entry| !entry.is_alike(layer)) {
                entries.push(layer);
            }
        }
        entries
    }
}
