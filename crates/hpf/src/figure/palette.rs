//! Colours and pens: the palette of Okabe and Ito (Color Universal Design, 2008), safe for colour-blind readers.

use plotters::style::RGBColor;

/// Learned, total, what matters most.
pub const BLUE: RGBColor = RGBColor(0, 114, 178);
/// Set-points, goals, references.
pub const VERMILLION: RGBColor = RGBColor(213, 94, 0);
/// Via points, bands that are allowed.
pub const GREEN: RGBColor = RGBColor(0, 158, 115);
/// Of the palette.
pub const ORANGE: RGBColor = RGBColor(230, 159, 0);
/// Of the palette.
pub const SKY: RGBColor = RGBColor(86, 180, 233);
/// Of the palette.
pub const PURPLE: RGBColor = RGBColor(204, 121, 167);
/// The palette's yellow, darkened until a line of it is seen on white.
pub const OLIVE: RGBColor = RGBColor(150, 142, 20);
/// Beside the palette: darker than all of it.
pub const BROWN: RGBColor = RGBColor(110, 58, 14);
/// Neutral.
pub const GREY: RGBColor = RGBColor(128, 128, 128);
/// Total, text.
pub const BLACK: RGBColor = RGBColor(25, 25, 25);
/// Paper.
pub const WHITE: RGBColor = RGBColor(255, 255, 255);
/// Notes that are not read first.
pub const QUIET: RGBColor = RGBColor(100, 100, 100);
/// Grid.
pub const GRID: RGBColor = RGBColor(228, 228, 228);
/// Frame and ticks.
pub const FRAME: RGBColor = RGBColor(90, 90, 90);
/// What lies outside bounds.
pub const SHADE: RGBColor = RGBColor(238, 238, 238);

/// The rest time after a movement.
pub const REST: RGBColor = RGBColor(243, 247, 252);

/// Colours of things of one kind that are compared, in their order.
const SERIES: [RGBColor; 8] = [BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, OLIVE, GREY];
/// Most things of one kind that are told apart: every colour, whole and dashed.
pub const MOST_SERIES: usize = 2 * SERIES.len();

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Colour.
    pub colour: RGBColor,
    /// Width [px].
    pub width: f64,
    /// Lengths of dash and gap [px].
    pub dash: Option<(f64, f64)>,
}

impl Pen {
    /// The line that matters most.
    pub const fn strong(colour: RGBColor) -> Self {
        Self { colour, width: 6.0, dash: None }
    }

    /// A line beside others.
    pub const fn plain(colour: RGBColor) -> Self {
        Self { colour, width: 4.0, dash: None }
    }

    /// The line of the `i`th of things that are compared, up to [`MOST_SERIES`].
    pub fn series(i: usize) -> Self {
        let dash = (i >= SERIES.len()).then_some((22.0, 10.0));
        Self { colour: SERIES[i % SERIES.len()], width: 5.0, dash }
    }

    /// A reference, set-point or bound.
    pub const fn dashed(colour: RGBColor) -> Self {
        Self { colour, width: 3.0, dash: Some((14.0, 8.0)) }
    }

    /// A thin line.
    pub const fn thin(colour: RGBColor) -> Self {
        Self { colour, width: 2.0, dash: None }
    }
}

/// `colour` mixed with white: `share` of it.
pub fn tint(colour: RGBColor, share: f64) -> RGBColor {
    let mix = |channel: u8| (255.0 + share * (f64::from(channel) - 255.0)).round() as u8;
    RGBColor(mix(colour.0), mix(colour.1), mix(colour.2))
}
