//! Pixels: strokes, bands, rectangles and text on plotters' bitmap.
//!
//! plotters lends rectangles and blending, `png` the file. Strokes are made here, from the distance of each pixel to the
//! line: plotters draws thick lines on whole pixels and without anti-aliasing.

use plotters::backend::{BitMapBackend, DrawingBackend};
use plotters::style::{Color as _, RGBColor};

use super::chart::Point;
use super::palette::{Pen, WHITE};
use super::surface::{Anchor, Area, Column, Surface};
use super::text;

/// A bitmap that becomes a PNG file.
pub struct Bitmap {
    /// Red, green and blue of each pixel, row by row.
    pixels: Vec<u8>,
    size: (usize, usize),
    /// How much of each pixel the stroke at hand covers, in 255ths; zero between strokes.
    coverage: Vec<u8>,
}

impl Bitmap {
    /// A white bitmap of `size` [px].
    pub fn new(size: (usize, usize)) -> Self {
        let area = size.0 * size.1;
        let mut surface = Self { pixels: vec![0; 3 * area], size, coverage: vec![0; area] };
        let all = surface.all();
        surface.fill(all, WHITE);
        surface
    }

    /// The bitmap as plotters draws on it.
    fn bitmap(&mut self) -> BitMapBackend<'_> {
        BitMapBackend::with_buffer(&mut self.pixels, (self.size.0 as u32, self.size.1 as u32))
    }

    fn blend(&mut self, x: i32, y: i32, colour: RGBColor, share: f64) {
        self.bitmap()
            .draw_pixel((x, y), colour.mix(share).to_backend_color())
            .expect("a bitmap in memory takes pixels");
    }

    fn cover(&mut self, points: &[Point], width: f64, clip: Area, touched: &mut Touched) {
        if let [point] = *points {
            self.cover_segment(point, point, width, clip, touched);
        }
        for pair in points.windows(2) {
            self.cover_segment(pair[0], pair[1], width, clip, touched);
        }
    }

    fn cover_segment(&mut self, from: Point, to: Point, width: f64, clip: Area, touched: &mut Touched) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let square = dx * dx + dy * dy;
        let reach = 0.5 * width + 0.5;
        let (top, bottom) = (clip.top.max(0.0), clip.bottom().min(self.size.1 as f64));
        let (left, right) = (clip.left.max(0.0), clip.right().min(self.size.0 as f64));
        // A box squeezed to nothing, or one that lies outside, shows nothing.
        if !(top < bottom && left < right) {
            return;
        }
        let first = (from.1.min(to.1) - reach).floor().clamp(top, bottom) as usize;
        let last = (from.1.max(to.1) + reach).ceil().clamp(top, bottom) as usize;
        for y in first..last {
            let middle = y as f64 + 0.5;
            // Only the part of the segment that comes within reach of this row can cover pixels of it.
            let near = |edge: f64| ((edge - from.1) / dy).clamp(0.0, 1.0);
            let (a, b) = if dy.abs() < 1e-9 { (0.0, 1.0) } else { (near(middle - reach), near(middle + reach)) };
            let (a, b) = (from.0 + a * dx, from.0 + b * dx);
            let start = (a.min(b) - reach).floor().clamp(left, right) as usize;
            let end = (a.max(b) + reach).ceil().clamp(left, right) as usize;
            for x in start..end {
                let (px, py) = (x as f64 + 0.5 - from.0, middle - from.1);
                let share = if square > 0.0 { ((px * dx + py * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
                let distance = (px - share * dx).hypot(py - share * dy);
                let covered = ((reach - distance).clamp(0.0, 1.0) * 255.0).round() as u8;
                let slot = &mut self.coverage[y * self.size.0 + x];
                *slot = covered.max(*slot);
            }
            touched.columns = (touched.columns.0.min(start), touched.columns.1.max(end));
        }
        touched.rows = (touched.rows.0.min(first), touched.rows.1.max(last));
    }
}

impl Surface for Bitmap {
    fn all(&self) -> Area {
        Area { left: 0.0, top: 0.0, width: self.size.0 as f64, height: self.size.1 as f64 }
    }

    fn fill(&mut self, area: Area, colour: RGBColor) {
        let all = self.all();
        let pixel = |value: f64, most: f64| value.round().clamp(0.0, most) as i32;
        let from = (pixel(area.left, all.width), pixel(area.top, all.height));
        let to = (pixel(area.right(), all.width), pixel(area.bottom(), all.height));
        if from.0 < to.0 && from.1 < to.1 {
            self.bitmap().draw_rect(from, to, &colour, true).expect("a bitmap in memory takes pixels");
        }
    }

    fn text(&mut self, text: &str, place: Point, size: f64, colour: RGBColor, anchor: Anchor, upwards: bool) {
        let width = text::width(text, size);
        let before = anchor.before(width);
        let (along, across) = if upwards { (-place.1, place.0) } else { place };
        let start = (along - before).floor();
        let (column, row) = (start as i32, across.round() as i32);
        text::rasterise(text, size, along - before - start, |x, y, share| {
            let (x, y) = (column + x, row + y);
            let (x, y) = if upwards { (y, -x) } else { (x, y) };
            self.blend(x, y, colour, share.into());
        });
    }

    fn stroke(&mut self, points: &[Point], pen: Pen, clip: Area) {
        let mut touched = Touched::default();
        for part in points.split(|point| !(point.0.is_finite() && point.1.is_finite())) {
            match pen.dash {
                Some(dash) => {
                    for piece in dashes(part, dash, pen.width) {
                        self.cover(&piece, pen.width, clip, &mut touched);
                    }
                }
                None => self.cover(part, pen.width, clip, &mut touched),
            }
        }
        for y in touched.rows.0..touched.rows.1 {
            for x in touched.columns.0..touched.columns.1 {
                let share = core::mem::take(&mut self.coverage[y * self.size.0 + x]);
                if share > 0 {
                    self.blend(x as i32, y as i32, pen.colour, f64::from(share) / 255.0);
                }
            }
        }
    }

    fn band(&mut self, columns: &[Column], colour: RGBColor, opacity: f64, clip: Area) {
        for pair in columns.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            // A pixel belongs to the pair that its middle lies in.
            let first = (from.x - 0.5).ceil().max(clip.left.round());
            let last = (to.x - 0.5).ceil().min(clip.right().round());
            for x in first as i32..last as i32 {
                let share = (f64::from(x) + 0.5 - from.x) / (to.x - from.x);
                let top = (from.top + share * (to.top - from.top)).max(clip.top);
                let bottom = (from.bottom + share * (to.bottom - from.bottom)).min(clip.bottom());
                for y in top.floor() as i32..bottom.ceil() as i32 {
                    let covered = (f64::from(y) + 1.0).min(bottom) - f64::from(y).max(top);
                    if covered > 0.0 {
                        self.blend(x, y, colour, opacity * covered);
                    }
                }
            }
        }
    }

    fn encode(self: Box<Self>) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.size.0 as u32, self.size.1 as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        encoder.set_filter(png::FilterType::Sub);
        encoder.set_adaptive_filter(png::AdaptiveFilterType::Adaptive);
        let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&self.pixels));
        written.map_err(|error| error.to_string()).map(|()| bytes)
    }
}

/// The rows and columns a stroke has touched: first, and one past the last.
struct Touched {
    rows: (usize, usize),
    columns: (usize, usize),
}

impl Default for Touched {
    fn default() -> Self {
        Self { rows: (usize::MAX, 0), columns: (usize::MAX, 0) }
    }
}

/// The dashes along `points`, shortened by the round ends that a line of `width` adds.
fn dashes(points: &[Point], (dash, gap): (f64, f64), width: f64) -> Vec<Vec<Point>> {
    let (on, off) = ((dash - width).max(0.1), gap + width);
    let mut pieces: Vec<Vec<Point>> = points.first().map(|first| vec![*first]).into_iter().collect();
    let (mut drawn, mut left) = (true, on);
    for pair in points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let at = (from.0 + done / length * (to.0 - from.0), from.1 + done / length * (to.1 - from.1));
            match pieces.last_mut() {
                Some(piece) if drawn => piece.push(at),
                _ => pieces.push(vec![at]),
            }
            drawn = !drawn;
            left = if drawn { on } else { off };
        }
        left -= length - done;
        if let Some(piece) = pieces.last_mut().filter(|_| drawn) {
            piece.push(to);
        }
    }
    pieces
}
