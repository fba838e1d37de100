//! What is read of a file as what: the columns of time, axes and forces, their units, the topic.

use core::str::FromStr;

use crate::preset::Preset;
use crate::units::{self, Dimension, UnitWord};

/// What is read of a file as what. Left empty, columns are read by their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mapping {
    /// The column of time.
    pub time: Option<Source>,
    /// The axes and the columns of their positions; left empty, those that the names of the columns say.
    pub axes: Vec<AxisSource>,
    /// The axes and the columns of the force of the environment on the tool.
    pub forces: Vec<AxisSource>,
    /// Whether columns that nobody knows are left out.
    pub ignore_rest: bool,
    /// The topic of a bag or the array of an archive; others behind commas are brought to its times.
    pub topic: Option<String>,
    /// Samples per second [Hz], where no column holds time.
    pub sample_rate: Option<f64>,
    /// Units of columns whose name and format say none.
    pub units: Vec<UnitWord>,
    /// Columns as a known program names them.
    pub preset: Option<Preset>,
    /// Whether rows without numbers are left out, and gaps filled in.
    pub bridge: bool,
    /// Whether rest before and after the motion is cut off.
    pub trim: bool,
}

/// A column and its unit: `COLUMN` or `COLUMN:UNIT`.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Name of the column, or `#3` for the third.
    pub column: String,
    /// Its unit, where it is given.
    pub unit: Option<UnitWord>,
}

/// An axis and its column: `AXIS=COLUMN` or `AXIS=COLUMN:UNIT`.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisSource {
    /// Name of the axis.
    pub axis: String,
    /// Its column.
    pub source: Source,
}

impl FromStr for Source {
    type Err = String;

    /// ```
    /// let source: hpf_recordings::Source = "timestamp:ns".parse().unwrap();
    /// assert_eq!((source.column.as_str(), source.unit.unwrap().factor), ("timestamp", 1e-9));
    /// ```
    fn from_str(text: &str) -> Result<Self, String> {
        // A colon may belong to the name: what is behind it is a unit only where it is the word of one.
        if let Some((column, word)) = text.rsplit_once(':') {
            if let Some(unit) = units::of_word(word)
                && !column.is_empty()
            {
                return Ok(Self { column: column.into(), unit: Some(unit) });
            }
            if word.len() <= 4
                && !word.is_empty()
                && word.chars().all(|c| c.is_ascii_alphabetic())
                && !column.contains(':')
            {
                let known = units::UNITS.map(|unit| unit.word).join(", ");
                return Err(format!("`{word}` is no unit that is read; there are {known}"));
            }
        }
        if text.is_empty() {
            return Err("the name of a column is missing".into());
        }
        Ok(Self { column: text.into(), unit: None })
    }
}

impl FromStr for AxisSource {
    type Err = String;

    /// ```
    /// let x: hpf_recordings::AxisSource = "x=pose/px:mm".parse().unwrap();
    /// assert_eq!((x.axis.as_str(), x.source.column.as_str()), ("x", "pose/px"));
    /// ```
    fn from_str(text: &str) -> Result<Self, String> {
        let (axis, source) =
            text.split_once('=').ok_or("it must be AXIS=COLUMN or AXIS=COLUMN:UNIT, such as x=px:mm")?;
        if !is_axis_name(axis) {
            return Err(format!("`{axis}` is no name of an axis: letters, digits and _, a letter first, at most 32"));
        }
        let source: Source = source.parse()?;
        Ok(Self { axis: axis.into(), source })
    }
}

/// Whether an axis may have this name.
pub fn is_axis_name(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.len() <= 32
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// The units of a list such as `mm,deg,ms`.
///
/// # Errors
/// A word that is no unit, and two units of one dimension.
pub fn units_of(list: &str) -> Result<Vec<UnitWord>, String> {
    let mut units: Vec<UnitWord> = Vec::new();
    for word in list.split(',').map(str::trim).filter(|word| !word.is_empty()) {
        let unit = units::of_word(word).ok_or_else(|| {
            let known = units::UNITS.map(|unit| unit.word).join(", ");
            format!("`{word}` is no unit that is read; there are {known}")
        })?;
        if let Some(other) = units.iter().find(|other| other.dimension == unit.dimension) {
            return Err(format!("{} and {} measure the same", other.word, unit.word));
        }
        units.push(unit);
    }
    Ok(units)
}

impl Mapping {
    /// Refuses what no recording can have.
    ///
    /// # Errors
    /// What it is.
    pub fn check(&self) -> Result<(), String> {
        match self.sample_rate {
            Some(rate) if !(rate.is_finite() && rate > 0.0) => Err("the sample rate must be above 0".into()),
            _ => Ok(()),
        }
    }

    /// The unit that `--units` gives a dimension.
    pub fn unit_for(&self, dimension: Dimension) -> Option<UnitWord> {
        self.units.iter().copied().find(|unit| unit.dimension == dimension)
    }

    /// Whether nothing says which columns are read: then they are read by their names.
    pub fn is_by_name(&self) -> bool {
        self.axes.is_empty() && self.preset.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colon_is_of_the_name_unless_a_unit_follows() {
        let source =
            |text: &str| text.parse::<Source>().map(|source| (source.column, source.unit.map(|unit| unit.word)));
        assert_eq!(source("a:b:c"), Ok(("a:b:c".into(), None)));
        assert_eq!(source("a:mm"), Ok(("a".into(), Some("mm"))));
        assert!(source("a:yd").unwrap_err().contains("`yd` is no unit that is read"));
        assert!(source("").is_err());
        assert!("px".parse::<AxisSource>().unwrap_err().contains("AXIS=COLUMN"));
        assert!("1=px".parse::<AxisSource>().unwrap_err().contains("no name of an axis"));
        assert!(units_of("mm,deg,ns").unwrap().len() == 3 && units_of("mm,cm").is_err() && units_of("yd").is_err());
    }
}
