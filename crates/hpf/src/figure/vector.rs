//! Lines: the same figure as SVG, with the letters as outlines, so that it looks the same without any font.

use core::fmt::Write as _;
use std::collections::BTreeSet;

use plotters::style::RGBColor;

use super::chart::Point;
use super::palette::{Pen, WHITE};
use super::surface::{Anchor, Area, Column, Surface};
use super::text;

/// How many of the bitmap's pixels are one of the figure.
const FINENESS: usize = 2;

/// A drawing that becomes an SVG file.
pub struct Vector {
    size: (usize, usize),
    body: String,
    /// Letters used, defined once each.
    letters: BTreeSet<u16>,
    /// Clips used, named by their place in the list.
    clips: Vec<Area>,
}

/// A number to a hundredth of a pixel, without trailing zeros.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.to_owned() }
}

fn hex(colour: RGBColor) -> String {
    format!("#{:02x}{:02x}{:02x}", colour.0, colour.1, colour.2)
}

fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for sign in text.chars() {
        match sign {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            // What XML cannot hold would spoil the whole file.
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            sign if sign.is_control() => escaped.push('\u{fffd}'),
            sign => escaped.push(sign),
        }
    }
    escaped
}

/// The path through `points`.
fn outline<'a>(points: impl IntoIterator<Item = &'a Point>) -> String {
    let places = points.into_iter().map(|point| format!("{} {}", number(point.0), number(point.1)));
    format!("M{}", places.collect::<Vec<_>>().join("L"))
}

impl Vector {
    /// A white drawing of `size` [px].
    pub fn new(size: (usize, usize)) -> Self {
        let mut vector = Self { size, body: String::new(), letters: BTreeSet::new(), clips: Vec::new() };
        vector.fill(vector.all(), WHITE);
        vector
    }

    /// The attribute that keeps a shape inside `clip`.
    fn clipped(&mut self, clip: Area) -> String {
        if clip == self.all() {
            return String::new();
        }
        let known = self.clips.iter().position(|known| *known == clip);
        let index = known.unwrap_or_else(|| {
            self.clips.push(clip);
            self.clips.len() - 1
        });
        format!(" clip-path=\"url(#clip{index})\"")
    }

    fn definitions(&self) -> String {
        let mut text = String::new();
        for (i, clip) in self.clips.iter().enumerate() {
            let _ = writeln!(text, "<clipPath id=\"clip{i}\">{}</clipPath>", rectangle(*clip, ""));
        }
        for letter in &self.letters {
            let _ = writeln!(text, "<path id=\"letter{letter}\" d=\"{}\"/>", text::outline(*letter));
        }
        text
    }
}

fn rectangle(area: Area, attributes: &str) -> String {
    let [x, y, width, height] = [area.left, area.top, area.width, area.height].map(number);
    format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"{attributes}/>")
}

impl Surface for Vector {
    fn all(&self) -> Area {
        Area { left: 0.0, top: 0.0, width: self.size.0 as f64, height: self.size.1 as f64 }
    }

    fn fill(&mut self, area: Area, colour: RGBColor) {
        let (left, top) = (area.left.round(), area.top.round());
        let (width, height) = (area.right().round() - left, area.bottom().round() - top);
        if width > 0.0 && height > 0.0 {
            let fill = format!(" fill=\"{}\"", hex(colour));
            let _ = writeln!(self.body, "{}", rectangle(Area { left, top, width, height }, &fill));
        }
    }

    fn text(&mut self, text: &str, place: Point, size: f64, colour: RGBColor, anchor: Anchor, upwards: bool) {
        let before = anchor.before(text::width(text, size));
        let turn = if upwards { " rotate(-90)" } else { "" };
        let (x, y) = (number(place.0), number(place.1));
        let scale = text::pixels_per_unit(size);
        let label = escaped(text);
        let _ = writeln!(
            self.body,
            "<g role=\"img\" aria-label=\"{label}\" fill=\"{}\" transform=\"translate({x} {y}){turn} scale({scale:.6} {:.6})\">",
            hex(colour),
            -scale
        );
        for (letter, x) in text::letters(text, size) {
            self.letters.insert(letter);
            let x = number((x - before) / scale);
            let _ = writeln!(self.body, "<use xlink:href=\"#letter{letter}\" x=\"{x}\"/>");
        }
        self.body += "</g>\n";
    }

    fn stroke(&mut self, points: &[Point], pen: Pen, clip: Area) {
        let clip = self.clipped(clip);
        let (colour, width) = (hex(pen.colour), number(pen.width));
        // Round ends lengthen every dash by the width of the line.
        let dash = pen.dash.map(|(dash, gap)| ((dash - pen.width).max(0.1), gap + pen.width));
        let dash = dash.map(|(on, off)| format!(" stroke-dasharray=\"{} {}\"", number(on), number(off)));
        let dash = dash.unwrap_or_default();
        for part in points.split(|point| !(point.0.is_finite() && point.1.is_finite())) {
            let _ = match part {
                [] => Ok(()),
                [(x, y)] => {
                    let (x, y, radius) = (number(*x), number(*y), number(0.5 * pen.width));
                    writeln!(self.body, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{colour}\"{clip}/>")
                }
                _ => {
                    let line = outline(part);
                    let pen = format!("stroke=\"{colour}\" stroke-width=\"{width}\"{dash}{clip}");
                    writeln!(self.body, "<path d=\"{line}\" fill=\"none\" {pen}/>")
                }
            };
        }
    }

    fn band(&mut self, columns: &[Column], colour: RGBColor, opacity: f64, clip: Area) {
        let clip = self.clipped(clip);
        let there = columns.iter().map(|column| (column.x, column.top));
        let back = columns.iter().rev().map(|column| (column.x, column.bottom));
        let points: Vec<Point> = there.chain(back).collect();
        let paint = format!("fill=\"{}\" fill-opacity=\"{}\"{clip}", hex(colour), number(opacity));
        let _ = writeln!(self.body, "<path d=\"{}Z\" {paint}/>", outline(&points));
    }

    fn encode(self: Box<Self>) -> Result<Vec<u8>, String> {
        let (width, height) = self.size;
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"{}\" \
             height=\"{}\" viewBox=\"0 0 {width} {height}\">\n<defs>\n{}</defs>\n\
             <g stroke-linecap=\"round\" stroke-linejoin=\"round\">\n{}</g>\n</svg>\n",
            width / FINENESS,
            height / FINENESS,
            self.definitions(),
            self.body
        );
        Ok(text.into_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::escaped;

    #[test]
    fn a_label_holds_what_xml_can_hold() {
        assert_eq!(
            escaped("a<b> & \"c\"\u{1b}\u{0}\u{ffff}"),
            "a&lt;b&gt; &amp; &quot;c&quot;\u{fffd}\u{fffd}\u{fffd}"
        );
    }
}
