//! What a figure is drawn on: strokes, bands, rectangles and text, whatever the file becomes.

use plotters::style::RGBColor;

use super::bitmap::Bitmap;
use super::chart::Point;
use super::palette::Pen;
use super::vector::Vector;

/// What a figure is written as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// Pixels, at twice the size of the figure
    #[default]
    Png,
    /// Lines and outlines of letters; needs no font
    Svg,
}

impl Format {
    /// The ending of its files.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Svg => "svg",
        }
    }

    /// An empty white surface of `size` [px].
    pub fn surface(self, size: (usize, usize)) -> Box<dyn Surface> {
        match self {
            Self::Png => Box::new(Bitmap::new(size)),
            Self::Svg => Box::new(Vector::new(size)),
        }
    }
}

/// A surface; places are in pixels, y downwards.
pub trait Surface {
    /// All of it.
    fn all(&self) -> Area;

    /// Fills the whole pixels nearest to `area`.
    fn fill(&mut self, area: Area, colour: RGBColor);

    /// Writes `text` with its baseline at `place`; `upwards` turns it by a quarter to the left.
    fn text(&mut self, text: &str, place: Point, size: f64, colour: RGBColor, anchor: Anchor, upwards: bool);

    /// Draws `points` in order, inside `clip`, with round ends and joints; it breaks where one is not finite.
    fn stroke(&mut self, points: &[Point], pen: Pen, clip: Area);

    /// Lays `colour` thinly over what is between upper and lower edge, inside `clip`: the columns go from left to right.
    fn band(&mut self, columns: &[Column], colour: RGBColor, opacity: f64, clip: Area);

    /// The bytes of the file.
    ///
    /// # Errors
    /// What the encoder says.
    fn encode(self: Box<Self>) -> Result<Vec<u8>, String>;
}

/// Upper and lower edge of a band at one place [px].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Where.
    pub x: f64,
    /// Upper edge.
    pub top: f64,
    /// Lower edge.
    pub bottom: f64,
}

/// A rectangle [px], y downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
}

impl Area {
    /// Right edge.
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Lower edge.
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }
}

/// Which end of a text its place is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The place is where it starts.
    Start,
    /// The place is its middle.
    Middle,
    /// The place is where it ends.
    End,
}

impl Anchor {
    /// How much of a text of `width` stands before its place.
    pub fn before(self, width: f64) -> f64 {
        match self {
            Self::Start => 0.0,
            Self::Middle => 0.5 * width,
            Self::End => width,
        }
    }
}
