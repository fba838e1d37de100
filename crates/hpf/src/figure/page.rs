//! What a figure is drawn on: an SVG file with the letters as outlines, which looks the same without any font. resvg
//! makes the pixels from it, so that both formats show the same.

use core::fmt::Write as _;
use std::collections::BTreeSet;

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use super::chart::Point;
use super::palette::{Colour, Pen, WHITE};
use super::text;

/// How many of the page's pixels are one of the figure.
const FINENESS: f64 = 2.0;

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
    fn before(self, width: f64) -> f64 {
        match self {
            Self::Start => 0.0,
            Self::Middle => 0.5 * width,
            Self::End => width,
        }
    }
}

/// A page; places are in pixels, y downwards.
pub struct Page {
    size: (f64, f64),
    body: String,
    /// Letters used, defined once each.
    letters: BTreeSet<u16>,
}

/// A number to a hundredth of a pixel, without trailing zeros.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.to_owned() }
}

/// `text` in an attribute; a sign that XML cannot hold is shown as one that is not there.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for sign in text.chars() {
        match sign {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            sign if sign.is_control() => escaped.push('\u{fffd}'),
            sign => escaped.push(sign),
        }
    }
    escaped
}

/// Whether `point` is somewhere.
pub fn is_place(point: &Point) -> bool {
    point.0.is_finite() && point.1.is_finite()
}

/// The path through `points`.
fn outline<'a>(points: impl IntoIterator<Item = &'a Point>) -> String {
    let places = points.into_iter().map(|point| format!("{} {}", number(point.0), number(point.1)));
    format!("M{}", places.collect::<Vec<_>>().join("L"))
}

fn rectangle(area: Area, attributes: &str) -> String {
    let [x, y, width, height] = [area.left, area.top, area.width, area.height].map(number);
    format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"{attributes}/>")
}

impl Page {
    /// A white page of `size` [px].
    pub fn new(size: (f64, f64)) -> Self {
        let mut page = Self { size, body: String::new(), letters: BTreeSet::new() };
        page.fill(page.all(), WHITE);
        page
    }

    /// All of it.
    pub fn all(&self) -> Area {
        Area { left: 0.0, top: 0.0, width: self.size.0, height: self.size.1 }
    }

    /// Fills the whole pixels nearest to `area`.
    pub fn fill(&mut self, area: Area, colour: Colour) {
        let (left, top) = (area.left.round(), area.top.round());
        let (width, height) = (area.right().round() - left, area.bottom().round() - top);
        if width > 0.0 && height > 0.0 {
            let fill = format!(" fill=\"{colour}\"");
            let _ = writeln!(self.body, "{}", rectangle(Area { left, top, width, height }, &fill));
        }
    }

    /// Writes `text` with its baseline at `place`; `upwards` turns it by a quarter to the left.
    pub fn text(&mut self, text: &str, place: Point, size: f64, colour: Colour, anchor: Anchor, upwards: bool) {
        let before = anchor.before(text::width(text, size));
        let turn = if upwards { " rotate(-90)" } else { "" };
        let (x, y) = (number(place.0), number(place.1));
        let scale = text::pixels_per_unit(size);
        let label = escaped(text);
        let _ = writeln!(
            self.body,
            "<g role=\"img\" aria-label=\"{label}\" fill=\"{colour}\" transform=\"translate({x} {y}){turn} scale({scale:.6} {:.6})\">",
            -scale
        );
        for (letter, x) in text::letters(text, size) {
            self.letters.insert(letter);
            let x = number((x - before) / scale);
            let _ = writeln!(self.body, "<use xlink:href=\"#letter{letter}\" x=\"{x}\"/>");
        }
        self.body += "</g>\n";
    }

    /// Draws `points` in order, with round joints, and dashes with round ends; it breaks where one is not finite.
    pub fn stroke(&mut self, points: &[Point], pen: Pen) {
        let (colour, width) = (pen.colour, number(pen.width));
        // Round ends lengthen every dash by the width of the line.
        let dash = pen.dash.map(|(dash, gap)| ((dash - pen.width).max(0.1), gap + pen.width));
        let dash = dash
            .map(|(on, off)| format!(" stroke-linecap=\"round\" stroke-dasharray=\"{} {}\"", number(on), number(off)));
        let dash = dash.unwrap_or_default();
        for part in points.split(|point| !is_place(point)) {
            let _ = match part {
                [] => Ok(()),
                [(x, y)] => {
                    let (x, y, radius) = (number(*x), number(*y), number(0.5 * pen.width));
                    writeln!(self.body, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{colour}\"/>")
                }
                _ => {
                    let line = outline(part);
                    let pen = format!("stroke=\"{colour}\" stroke-width=\"{width}\"{dash}");
                    writeln!(self.body, "<path d=\"{line}\" fill=\"none\" {pen}/>")
                }
            };
        }
    }

    /// Lays `colour` thinly over what `points` enclose.
    pub fn cover(&mut self, points: &[Point], colour: Colour, opacity: f64) {
        if points.is_empty() {
            return;
        }
        let paint = format!("fill=\"{colour}\" fill-opacity=\"{}\"", number(opacity));
        let _ = writeln!(self.body, "<path d=\"{}Z\" {paint}/>", outline(points));
    }

    /// The bytes of its file.
    ///
    /// # Errors
    /// What resvg says of a page that it cannot draw, or the encoder.
    pub fn encode(self, format: Format) -> Result<Vec<u8>, String> {
        let (width, height) = self.size;
        let letter = |letter: &u16| format!("<path id=\"letter{letter}\" d=\"{}\"/>\n", text::outline(*letter));
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"{}\" \
             height=\"{}\" viewBox=\"0 0 {width} {height}\">\n<defs>\n{}</defs>\n\
             <g stroke-linejoin=\"round\">\n{}</g>\n</svg>\n",
            number(width / FINENESS),
            number(height / FINENESS),
            self.letters.iter().map(letter).collect::<String>(),
            self.body
        );
        match format {
            Format::Svg => Ok(text.into_bytes()),
            Format::Png => pixels(&text, (width, height)),
        }
    }
}

/// The PNG file of what `text`, an SVG file, shows at `size` [px].
fn pixels(text: &str, size: (f64, f64)) -> Result<Vec<u8>, String> {
    let tree = Tree::from_str(text, &Options::default()).map_err(|error| error.to_string())?;
    let (width, height) = (size.0.ceil() as u32, size.1.ceil() as u32);
    let mut pixmap = Pixmap::new(width, height).ok_or_else(|| format!("no room for {width} x {height} pixels"))?;
    let scale = Transform::from_scale(FINENESS as f32, FINENESS as f32);
    resvg::render(&tree, scale, &mut pixmap.as_mut());
    // The page covers all of it: nothing shines through.
    let pixels: Vec<u8> = pixmap.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Fastest);
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels));
    written.map_err(|error| error.to_string()).map(|()| bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::palette::{BLACK, BLUE};

    #[test]
    fn pixels_show_what_the_lines_say() {
        let page = |width| {
            let mut page = Page::new((width, 60.0));
            page.fill(Area { left: 10.0, top: 10.0, width: 20.0, height: 10.0 }, BLUE);
            page.stroke(&[(40.0, 30.0), (60.0, 30.0)], Pen::strong(BLACK));
            page.encode(Format::Png).unwrap()
        };
        for width in [100.0, 101.0] {
            let image = Pixmap::decode_png(&page(width)).unwrap();
            let at = |x, y| image.pixel(x, y).map(|pixel| Colour(pixel.red(), pixel.green(), pixel.blue())).unwrap();
            assert_eq!((f64::from(image.width()), image.height()), (width, 60));
            assert_eq!([at(10, 10), at(29, 19), at(41, 28), at(59, 32)], [BLUE, BLUE, BLACK, BLACK]);
            assert_eq!([at(9, 10), at(30, 19), at(39, 30), at(61, 30), at(50, 26)], [WHITE; 5]);
        }
    }

    #[test]
    fn any_text_is_written() {
        let mut page = Page::new((100.0, 60.0));
        page.text("a < b & \"c\"\u{1}\n\u{ffff}\u{1f600}", (0.0, 30.0), 20.0, BLACK, Anchor::Start, false);
        assert!(page.body.contains("aria-label=\"a &lt; b &amp; &quot;c&quot;\u{fffd}\u{fffd}\u{fffd}\u{1f600}\""));
        assert!(page.encode(Format::Png).is_ok());
    }

    #[test]
    fn a_page_without_room_is_an_error() {
        assert!(Page::new((0.0, 60.0)).encode(Format::Png).is_err());
    }
}
