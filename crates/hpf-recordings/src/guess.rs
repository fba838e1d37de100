//! What columns without names or units of ours may hold, with the reason.

use crate::table::{Column, Table, plain};
use crate::units::{self, UnitWord};

/// A hand or a robot is slower than this [m/s]: faster numbers are in another unit.
const FASTEST: f64 = 10.0;
/// A recording reaches less far than this [m].
const FARTHEST: f64 = 20.0;
/// An angle beyond two turns [rad] is more likely one in degrees.
const WIDEST: f64 = 4.0 * core::f64::consts::PI;

/// Why a unit was taken.
pub struct Reason {
    /// In words.
    pub text: String,
    /// Whether the numbers make no sense in SI units.
    pub is_implausible: bool,
}

fn word(word: &str) -> UnitWord {
    units::of_word(word).expect("this unit is read")
}

/// Words of names that are time.
fn is_time_name(name: &str) -> bool {
    let name = plain(&units::in_name(name).0);
    matches!(name.as_str(), "t" | "time" | "timestamp" | "stamp" | "sec" | "secs" | "seconds" | "clock" | "ros_time")
        || name.starts_with("time")
        || name.ends_with("_time")
        || name.ends_with("timestamp")
        || name.ends_with("_stamp")
}

/// Whether numbers rise from row to row, but for a few.
fn rises(values: &[f64]) -> bool {
    let falls = values.windows(2).filter(|pair| pair[1].is_nan() || pair[1] < pair[0]).count();
    values.len() > 1 && values[0] < values[values.len() - 1] && 10 * falls <= values.len()
}

/// The column that is time: by its name, else the first one if it rises at even steps.
pub fn time_column(table: &Table) -> Option<usize> {
    let named = |at: &usize| is_time_name(&table.columns[*at].name) && rises(&table.columns[*at].values);
    if table.is_named {
        return (0..table.columns.len()).find(named);
    }
    let first = table.columns.first()?;
    (rises(&first.values) && first.values.windows(2).all(|pair| pair[1] > pair[0])).then_some(0)
}

/// The median of the steps of a column that rises.
pub fn median_step(values: &[f64]) -> f64 {
    let mut steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The unit of time stamps by their step: robots are recorded at 1 Hz to some kHz.
pub fn time_unit(column: &Column) -> (UnitWord, String) {
    let step = median_step(&column.values);
    let unit = word(match step {
        step if step < 0.9 => "s",
        step if step < 100.0 => "ms",
        step if step < 1e5 => "us",
        _ => "ns",
    });
    let rate = 1.0 / (step * unit.factor);
    let reason = format!("its steps of {} would be {} Hz", short(step), short(rate));
    (unit, reason)
}

/// Whether a name is that of an angle.
pub fn is_angle(name: &str) -> bool {
    let plain = plain(name);
    let words: Vec<&str> = plain.split('_').collect();
    let is_joint = |word: &&str| {
        let letters = word.trim_end_matches(|c: char| c.is_ascii_digit());
        matches!(letters, "q" | "j" | "joint" | "joints" | "theta" | "angle" | "yaw" | "pitch" | "roll" | "phi" | "psi")
            || letters.ends_with("joint")
    };
    words.iter().any(is_joint)
}

/// The unit of a position without one.
pub fn position_unit(table: &Table, at: usize, time: Option<(usize, f64)>) -> (UnitWord, Reason) {
    let column = &table.columns[at];
    let (low, high) = column.range().unwrap_or_default();
    let is_angle = is_angle(&column.name);
    let time = time.or_else(|| {
        let at = time_column(table)?;
        Some((at, time_unit(&table.columns[at]).0.factor))
    });
    let speed = time.map_or(0.0, |(time, factor)| fastest(&table.columns[time].values, factor, &column.values));
    if is_angle {
        let is_wide = high - low > WIDEST || low.abs().max(high.abs()) > 2.0 * WIDEST;
        let unit = word(if is_wide { "deg" } else { "rad" });
        let text = format!("its name is that of an angle, its numbers are from {} to {}", short(low), short(high));
        return (unit, Reason { text, is_implausible: is_wide });
    }
    let is_far = high - low > FARTHEST;
    if speed > FASTEST || is_far {
        let text = format!(
            "in m it would move at up to {} m/s over {} m, which is likely in mm",
            short(speed),
            short(high - low)
        );
        return (word("mm"), Reason { text, is_implausible: true });
    }
    let text = format!("nothing says another unit, and it moves {} at up to {} per s", short(high - low), short(speed));
    (word("m"), Reason { text, is_implausible: false })
}

/// The speed that a tenth of a percent of the steps exceeds: single wrong stamps are no speed.
pub fn fastest(time: &[f64], factor: f64, values: &[f64]) -> f64 {
    let step = median_step(time);
    let speeds = time.windows(2).zip(values.windows(2)).filter_map(|(t, x)| {
        let dt = (t[1] - t[0]) * factor;
        let speed = ((x[1] - x[0]) / dt).abs();
        (dt > 0.5 * step * factor && speed.is_finite()).then_some(speed)
    });
    speeds.fold(0.0, f64::max)
}

/// A number with few digits.
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.1e}");
    }
    let digits = (3 - 1 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// What a column without one of our names may be: the name of an axis.
pub fn axis_name(table: &Table, at: usize) -> Option<String> {
    let column = &table.columns[at];
    let name = plain(&units::in_name(&column.name).0);
    let words: Vec<&str> = name.split('_').collect();
    const OTHERS: [&str; 40] = [
        "vel",
        "velocity",
        "acc",
        "acceleration",
        "force",
        "torque",
        "tau",
        "effort",
        "current",
        "qx",
        "qy",
        "qz",
        "qw",
        "quat",
        "quaternion",
        "orientation",
        "rotation",
        "rx",
        "ry",
        "rz",
        "id",
        "index",
        "frame",
        "seq",
        "emg",
        "speed",
        "twist",
        "linear",
        "angular",
        "temperature",
        "voltage",
        "status",
        "mode",
        "v",
        "a",
        "w",
        "b",
        "dq",
        "error",
        "phase",
    ];
    let is_other = words.iter().any(|word| OTHERS.contains(word) || word.starts_with("quat"));
    let (low, high) = column.range()?;
    if is_other || high <= low || column.values.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let letter = |word: &str| {
        let last = match word {
            "x" | "px" | "tx" | "posx" => "x",
            "y" | "py" | "ty" | "posy" => "y",
            "z" | "pz" | "tz" | "posz" => "z",
            _ => return None,
        };
        Some(last.to_owned())
    };
    if !table.is_named {
        return (table.time_guess() != Some(at)).then(|| format!("a{}", at + 1));
    }
    if let Some(axis) = words.iter().rev().find_map(|word| letter(word)) {
        return Some(axis);
    }
    if is_angle(&column.name) {
        let stem = name.trim_end_matches("_position").trim_end_matches("_pos");
        let stem: String = stem.chars().take(32).collect();
        return crate::mapping::is_axis_name(&stem).then_some(stem);
    }
    let is_position = words.iter().any(|word| matches!(*word, "pos" | "position" | "pose" | "tcp"));
    let stem: String = name.chars().take(32).collect();
    (is_position && crate::mapping::is_axis_name(&stem)).then_some(stem)
}

impl Table {
    /// The column that is time, by its format or as far as can be guessed.
    pub fn time_guess(&self) -> Option<usize> {
        self.time.or_else(|| time_column(self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_of_time_is_guessed_by_the_step() {
        let unit = |step: f64| {
            let values = (0..10).map(|i| f64::from(i) * step).collect();
            time_unit(&Column::of("t", values)).0.word
        };
        assert_eq!([0.01, 2.0, 1e4, 1e7].map(unit), ["s", "ms", "us", "ns"]);
        let column = Column::of("stamp", (0..10).map(|i| f64::from(i) * 1e7).collect());
        assert!(time_unit(&column).1.contains("1.0e7 would be 100 Hz"), "{}", time_unit(&column).1);
    }

    #[test]
    fn a_hand_at_36_meters_per_second_is_in_mm() {
        let time: Vec<f64> = (0..11).map(|i| f64::from(i) * 0.01).collect();
        let path: Vec<f64> = time.iter().map(|t| 36.0 * t).collect();
        let table = Table {
            lines: (1..=11).collect(),
            columns: vec![Column::of("t", time), Column::of("px", path)],
            is_named: true,
            ..Table::default()
        };
        let (unit, reason) = position_unit(&table, 1, Some((0, 1.0)));
        assert_eq!((unit.word, reason.is_implausible), ("mm", true));
        assert!(reason.text.contains("36 m/s"), "{}", reason.text);
        assert_eq!(axis_name(&table, 1).as_deref(), Some("x"));
    }

    #[test]
    fn numbers_are_written_short() {
        assert_eq!([0.0, 36.0, 0.05, 1e7, 123.456].map(short), ["0", "36", "0.05", "1.0e7", "123"]);
    }
}
