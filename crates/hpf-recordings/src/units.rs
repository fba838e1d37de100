//! Units of columns: their words, what they measure, and their factor to SI.

use hpf_sim::task::Unit;

/// What a column measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Time [s].
    Time,
    /// Length [m].
    Length,
    /// Angle [rad].
    Angle,
    /// Force [N].
    Force,
    /// Torque [N m].
    Torque,
}

impl Dimension {
    /// What the unit of an axis measures.
    pub fn of_axis(unit: Unit) -> Self {
        match unit {
            Unit::M => Self::Length,
            Unit::Rad => Self::Angle,
        }
    }
}

/// A unit: its word, what it measures, and how many SI units it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitWord {
    /// As it is written in names and options.
    pub word: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// SI units in one of it.
    pub factor: f64,
}

const fn unit(word: &'static str, dimension: Dimension, factor: f64) -> UnitWord {
    UnitWord { word, dimension, factor }
}

/// Degrees to radians.
const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// Every unit that is read. Of one dimension the SI unit comes first.
pub const UNITS: [UnitWord; 22] = [
    unit("s", Dimension::Time, 1.0),
    unit("ms", Dimension::Time, 1e-3),
    unit("us", Dimension::Time, 1e-6),
    unit("ns", Dimension::Time, 1e-9),
    unit("min", Dimension::Time, 60.0),
    unit("m", Dimension::Length, 1.0),
    unit("mm", Dimension::Length, 1e-3),
    unit("cm", Dimension::Length, 1e-2),
    unit("um", Dimension::Length, 1e-6),
    unit("km", Dimension::Length, 1e3),
    unit("inch", Dimension::Length, 0.0254),
    unit("ft", Dimension::Length, 0.3048),
    unit("rad", Dimension::Angle, 1.0),
    unit("deg", Dimension::Angle, DEGREE),
    unit("mrad", Dimension::Angle, 1e-3),
    unit("turn", Dimension::Angle, core::f64::consts::TAU),
    unit("n", Dimension::Force, 1.0),
    unit("kn", Dimension::Force, 1e3),
    unit("mn", Dimension::Force, 1e-3),
    unit("nm", Dimension::Torque, 1.0),
    unit("nmm", Dimension::Torque, 1e-3),
    unit("lbf", Dimension::Force, 4.448_221_615_260_5),
];

/// Other spellings of units, in lower case.
const SPELLINGS: [(&str, &str); 29] = [
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("msec", "ms"),
    ("millisecond", "ms"),
    ("milliseconds", "ms"),
    ("usec", "us"),
    ("\u{b5}s", "us"),
    ("\u{3bc}s", "us"),
    ("microseconds", "us"),
    ("nsec", "ns"),
    ("nanosec", "ns"),
    ("nanoseconds", "ns"),
    ("meter", "m"),
    ("meters", "m"),
    ("metre", "m"),
    ("metres", "m"),
    ("millimeter", "mm"),
    ("millimeters", "mm"),
    ("centimeters", "cm"),
    ("in", "inch"),
    ("inches", "inch"),
    ("feet", "ft"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("\u{b0}", "deg"),
];

/// The unit of this word.
pub fn of_word(word: &str) -> Option<UnitWord> {
    let lower = word.trim().to_lowercase();
    let plain: String = lower.chars().filter(|c| !matches!(c, ' ' | '*' | '\u{b7}' | '.')).collect();
    let plain = SPELLINGS.iter().find(|(spelling, _)| *spelling == plain).map_or(plain.as_str(), |(_, word)| word);
    UNITS.iter().copied().find(|unit| unit.word == plain)
}

/// The words of all units of a dimension.
pub fn words(dimension: Dimension) -> String {
    let words = UNITS.iter().filter(|unit| unit.dimension == dimension).map(|unit| unit.word);
    words.collect::<Vec<_>>().join(", ")
}

/// The unit in the name of a column, and the name without it: `x [mm]`, `x (mm)`, `x/mm` or `x_mm`.
pub fn in_name(name: &str) -> (String, Option<UnitWord>) {
    let trimmed = name.trim();
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some(front) = trimmed.strip_suffix(close)
            && let Some((stem, word)) = front.rsplit_once(open)
            && let Some(unit) = of_word(word)
            && !stem.trim().is_empty()
        {
            return (stem.trim().trim_end_matches('_').to_owned(), Some(unit));
        }
    }
    for separator in ['/', '_', ' ', '.'] {
        if let Some((stem, word)) = trimmed.rsplit_once(separator)
            && let Some(unit) = of_word(word)
            && !stem.trim().is_empty()
        {
            return (stem.trim().to_owned(), Some(unit));
        }
    }
    (trimmed.to_owned(), None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_found_at_the_end_of_a_name() {
        let found = |name: &str| {
            let (stem, unit) = in_name(name);
            (stem, unit.map(|unit| unit.word))
        };
        assert_eq!(found("x [mm]"), ("x".into(), Some("mm")));
        assert_eq!(found("p_RS_R_x [m]"), ("p_RS_R_x".into(), Some("m")));
        assert_eq!(found("Time (Seconds)"), ("Time".into(), Some("s")));
        assert_eq!(found("yaw_deg"), ("yaw".into(), Some("deg")));
        assert_eq!(found("x/cm"), ("x".into(), Some("cm")));
        assert_eq!(found("speed [m s^-1]"), ("speed [m s^-1]".into(), None));
        assert_eq!(found("mm"), ("mm".into(), None), "a unit alone is a name");
        // 180 degrees are pi.
        assert_eq!(180.0 * of_word("Degrees").unwrap().factor, core::f64::consts::PI);
        assert_eq!(of_word("N m").unwrap().word, "nm");
        assert_eq!(of_word("parsec"), None);
    }
}
