//! Setting text in the bundled font.
//!
//! Glyphs are set with their side bearings and kerning at fractions of a pixel, which the plotting library's own text
//! leaves out; and no system font is needed.

use std::sync::LazyLock;

use ab_glyph::{Font as _, FontRef, Glyph, GlyphId, OutlineCurve, PxScale, ScaleFont as _, point};

static FONT: LazyLock<FontRef<'static>> = LazyLock::new(|| {
    FontRef::try_from_slice(include_bytes!("font/DejaVuSans-subset.ttf")).expect("the bundled font is whole")
});

/// The scale at which one em is `size` [px].
fn scale(size: f64) -> PxScale {
    let em = FONT.units_per_em().expect("the bundled font has a size");
    PxScale::from(size as f32 * FONT.height_unscaled() / em)
}

/// Glyphs of `text` with the place of each [px], and where the next one would be.
fn set(text: &str, size: f64) -> (Vec<(GlyphId, f32)>, f32) {
    let font = FONT.as_scaled(scale(size));
    let (mut glyphs, mut x) = (Vec::new(), 0.0);
    for sign in text.chars() {
        let id = font.glyph_id(sign);
        x += glyphs.last().map_or(0.0, |(before, _)| font.kern(*before, id));
        glyphs.push((id, x));
        x += font.h_advance(id);
    }
    (glyphs, x)
}

/// Width of `text` [px] where one em is `size` [px].
pub fn width(text: &str, size: f64) -> f64 {
    set(text, size).1.into()
}

/// Pixels that one unit of [`outline`] takes where one em is `size` [px].
pub fn pixels_per_unit(size: f64) -> f64 {
    size / f64::from(FONT.units_per_em().expect("the bundled font has a size"))
}

/// The letters of `text` that have an outline, each with its place along the baseline [px].
pub fn letters(text: &str, size: f64) -> impl Iterator<Item = (u16, f64)> {
    let letters = set(text, size).0.into_iter();
    letters.filter(|(id, _)| FONT.outline(*id).is_some()).map(|(id, x)| (id.0, x.into()))
}

/// The outline of a letter as an SVG path, in units of the font, y upwards.
pub fn outline(letter: u16) -> String {
    let mut path = String::new();
    let mut end = None;
    for curve in FONT.outline(GlyphId(letter)).into_iter().flat_map(|outline| outline.curves) {
        let points = match curve {
            OutlineCurve::Line(from, to) => vec![from, to],
            OutlineCurve::Quad(from, bend, to) => vec![from, bend, to],
            OutlineCurve::Cubic(from, bend, other, to) => vec![from, bend, other, to],
        };
        if end != Some(points[0]) {
            path += &format!("M{} {}", points[0].x, points[0].y);
        }
        path.push(['L', 'Q', 'C'][points.len() - 2]);
        path += &points[1..].iter().map(|point| format!("{} {}", point.x, point.y)).collect::<Vec<_>>().join(" ");
        end = points.last().copied();
    }
    path
}

/// `text`, cut to `room` [px] with an ellipsis where it is wider.
pub fn fit(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut signs: Vec<char> = text.chars().collect();
    loop {
        signs.pop();
        let cut = signs.iter().collect::<String>() + "…";
        if signs.is_empty() || width(&cut, size) <= room {
            return cut;
        }
    }
}

/// Calls `cover` with every pixel that `text` touches and how much of it: column and row from the start of its
/// baseline, `shift` [px] to the right of it.
pub fn rasterise(text: &str, size: f64, shift: f64, mut cover: impl FnMut(i32, i32, f32)) {
    for (id, x) in set(text, size).0 {
        let glyph = Glyph { id, scale: scale(size), position: point(x + shift as f32, 0.0) };
        if let Some(outline) = FONT.outline_glyph(glyph) {
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, share| cover(corner.x as i32 + x as i32, corner.y as i32 + y as i32, share));
        }
    }
}

/// Whether the bundled font has every sign of `text`.
#[cfg(test)]
pub fn has_glyphs(text: &str) -> bool {
    text.chars().all(|sign| FONT.glyph_id(sign).0 != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_text_is_as_wide_as_its_advances() {
        // Of DejaVu Sans: every digit is 1303 of 2048 units wide.
        assert!((width("0123456789", 2048.0) - 13030.0).abs() < 0.5);
        assert_eq!(width("", 20.0), 0.0);
    }

    #[test]
    fn what_is_too_wide_is_cut_with_an_ellipsis() {
        assert_eq!(fit("stiffness", 20.0, 1000.0), "stiffness");
        let cut = fit("a_very_long_name_of_an_axis", 20.0, 100.0);
        assert!(cut.ends_with('…') && width(&cut, 20.0) <= 100.0, "{cut}");
        assert_eq!(fit("name", 20.0, 0.0), "…");
    }

    #[test]
    fn text_stands_on_its_baseline() {
        let (mut top, mut bottom) = (i32::MAX, i32::MIN);
        rasterise("H", 40.0, 0.0, |_, y, share| {
            if share > 0.5 {
                (top, bottom) = (top.min(y), bottom.max(y));
            }
        });
        // A capital of DejaVu Sans is 1493 of 2048 units high.
        assert_eq!((top, bottom), (-29, -1));
    }
}
