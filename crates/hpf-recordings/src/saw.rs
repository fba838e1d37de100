//! What is in a file: its columns, what they may be and why, and the command that may read it.

use core::fmt::{self, Write as _};

use crate::guess::{self, short};
use crate::names::{self, Kind};
use crate::preset::PRESETS;
use crate::table::Table;
use crate::units;

/// Columns that are shown.
const SHOWN: usize = 40;

/// The role of a column that may be anything.
const UNKNOWN: &str = "not known";

/// What is in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Saw {
    /// The kind of the file, in words.
    pub kind: String,
    /// Topics or arrays: name, type, messages or rows, and whether they are read.
    pub topics: Vec<Topic>,
    /// Number of rows.
    pub rows: usize,
    /// The columns.
    pub columns: Vec<SawColumn>,
    /// Options of `hpf imitate` that may read the file; none where nothing fits.
    pub options: Option<String>,
}

/// A topic of a bag, or an array of an archive.
#[derive(Clone, Debug, PartialEq)]
pub struct Topic {
    /// Its name.
    pub name: String,
    /// The type of its messages.
    pub kind: String,
    /// Number of its messages or rows.
    pub count: usize,
    /// Whether it can be read.
    pub is_read: bool,
}

/// A column as it was seen.
#[derive(Clone, Debug, PartialEq)]
pub struct SawColumn {
    /// Its name.
    pub name: String,
    /// Least and largest number in it.
    pub range: Option<(f64, f64)>,
    /// What it may be.
    pub role: String,
}

impl Saw {
    /// What is in `table`.
    pub fn of(table: &Table, topics: Vec<Topic>) -> Self {
        let time = table.time_guess();
        let kinds: Vec<Option<Kind>> = table.columns.iter().map(|column| names::kind(&column.name)).collect();
        let mut axes: Vec<(String, String)> = Vec::new();
        let mut columns = Vec::new();
        let has_own = kinds.iter().any(|kind| matches!(kind, Some(Kind::Axis { signal: names::Signal::Position, .. })));
        let mut options = Vec::new();
        for (at, column) in table.columns.iter().enumerate() {
            let name = if table.is_named { column.name.clone() } else { format!("#{}", column.name) };
            let role = if time == Some(at) || matches!(kinds[at], Some(Kind::Time { .. })) {
                let given = column.unit.or_else(|| units::in_name(&column.name).1);
                let given = given.filter(|unit| unit.dimension == units::Dimension::Time);
                let step = guess::median_step(&column.values);
                // A name that says seconds over steps of days is not believed.
                let (unit, reason) = match given {
                    Some(unit) if step * unit.factor < 1000.0 => (unit, "says its name".to_owned()),
                    _ => guess::time_unit(column),
                };
                if !matches!(kinds[at], Some(Kind::Time { factor }) if factor == unit.factor) && table.time.is_none() {
                    options.push(format!("--time {}", quoted(&format!("{name}:{}", unit.word))));
                }
                format!("time in {}: {reason}", unit.word)
            } else if let Some(Kind::Axis { name, signal, .. }) = &kinds[at] {
                format!("{signal:?} of axis {name}").to_lowercase()
            } else if let Some(axis) = guess::axis_name(table, at).filter(|_| !has_own && axes.len() < 7) {
                let free = (1..).map(|n| if n == 1 { axis.clone() } else { format!("{axis}{n}") });
                let axis = free.into_iter().find(|axis| axes.iter().all(|(other, _)| other != axis)).unwrap_or(axis);
                let given = column.unit.or_else(|| units::in_name(&column.name).1);
                let (unit, reason) = match given {
                    Some(unit) => (unit, "says its name".to_owned()),
                    None => {
                        let (unit, reason) = guess::position_unit(table, at, None);
                        (unit, reason.text)
                    }
                };
                axes.push((axis.clone(), quoted(&format!("{axis}={name}:{}", unit.word))));
                format!("position of axis {axis} in {}: {reason}", unit.word)
            } else {
                UNKNOWN.to_owned()
            };
            columns.push(SawColumn { name, range: column.range(), role });
        }
        if time.is_none() && !kinds.iter().any(|kind| matches!(kind, Some(Kind::Time { .. }))) {
            options.push("--sample-rate HZ".into());
        }
        options.extend(axes.iter().map(|(_, option)| format!("--axis {option}")));
        if columns.iter().any(|column| column.role == UNKNOWN) && (has_own || !axes.is_empty()) {
            options.push("--ignore-rest".into());
        }
        let preset = PRESETS.iter().find(|(_, preset)| is_surely(*preset, table));
        let options = match preset {
            Some((name, _)) => Some(format!("--preset {name}")),
            None => (has_own || !axes.is_empty()).then(|| options.join(" ")),
        };
        Self { kind: table.kind.clone(), topics, rows: table.rows(), columns, options }
    }

    /// The command that may read the file `path`.
    pub fn command(&self, path: &str) -> Option<String> {
        let options = self.options.as_ref()?;
        let gap = if options.is_empty() { "" } else { " " };
        Some(format!("hpf imitate {}{gap}{options}", quoted(path)))
    }
}

/// Whether a table is of a preset whose columns have names that nothing else has.
fn is_surely(preset: crate::preset::Preset, table: &Table) -> bool {
    use crate::preset::Preset::{Euroc, Franka, Optitrack, Tum, Ur, UrJoints};
    let first = table.columns.first().map(|column| crate::table::plain(&column.name)).unwrap_or_default();
    let is_likely = match preset {
        Ur | UrJoints | Franka | Optitrack => true,
        Tum => {
            table.columns.len() == 8 && (!table.is_named || first.starts_with("timestamp")) && is_of_unit_length(table)
        }
        Euroc => first == "timestamp_ns" && table.columns.iter().any(|column| column.name.contains("p_RS_R_x")),
        _ => false,
    };
    is_likely && preset.find(table).is_ok()
}

/// Whether the last four of eight columns are quaternions.
fn is_of_unit_length(table: &Table) -> bool {
    let squares = |row: usize| table.columns[4..8].iter().map(|column| column.values[row].powi(2)).sum::<f64>();
    table.rows() > 0 && (0..table.rows()).all(|row| (squares(row) - 1.0).abs() < 0.02)
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-./:=,+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.into()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

impl fmt::Display for Saw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}, {} rows", self.kind, self.rows)?;
        for topic in &self.topics {
            let read = if topic.is_read { "" } else { " (not read)" };
            writeln!(f, "  {:<32} {:>8}  {}{read}", topic.name, topic.count, topic.kind)?;
        }
        let width =
            self.columns.iter().take(SHOWN).map(|column| column.name.chars().count()).max().unwrap_or(0).min(40);
        for column in self.columns.iter().take(SHOWN) {
            let mut line = format!("  {:<width$}  ", column.name);
            match column.range {
                Some((low, high)) if low == high => write!(line, "{:>10} throughout    ", short(low))?,
                Some((low, high)) => write!(line, "{:>10} to {:<10}", short(low), short(high))?,
                None => write!(line, "{:>24}", "no numbers")?,
            }
            writeln!(f, "{line}  {}", column.role)?;
        }
        if self.columns.len() > SHOWN {
            writeln!(f, "  and {} more columns", self.columns.len() - SHOWN)?;
        }
        Ok(())
    }
}
