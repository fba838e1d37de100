//! Setting text in the bundled font.
//!
//! Letters become outlines, set with their side bearings and kerning: no viewer of the figure needs a font.

use std::sync::LazyLock;

use ab_glyph::{Font as _, FontRef, GlyphId, OutlineCurve, PxScale, ScaleFont as _};

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
    fn letters_stand_on_their_baseline() {
        // A capital of DejaVu Sans is 1493 of 2048 units high.
        let letter = letters("H", 40.0).next().unwrap().0;
        let path = outline(letter);
        let numbers = path.split(|sign: char| !(sign.is_ascii_digit() || matches!(sign, '-' | '.')));
        let numbers: Vec<f64> = numbers.filter_map(|number| number.parse().ok()).collect();
        let heights = || numbers.iter().skip(1).step_by(2).copied();
        assert_eq!([heights().fold(f64::MAX, f64::min), heights().fold(f64::MIN, f64::max)], [0.0, 1493.0], "{path}");
    }
}
