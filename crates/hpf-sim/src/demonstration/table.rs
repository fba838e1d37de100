//! Reading a recording: CSV with a time, a position per axis, and what else was measured.

use core::fmt;

use super::{Demonstration, RecordedAxis};
use crate::table_end::TableEnd;
use crate::task::{MAX_AXES, MAX_STEPS, Unit, nearest};

/// Fewest samples of a recording: an acceleration by differences needs four neighbours.
pub const MIN_SAMPLES: usize = 5;
/// Mistakes that are told at once.
pub const MAX_MISTAKES: usize = 20;

/// What is wrong with a recording, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// The line, counted from 1.
    pub line: u64,
    /// The name of the column, where it is one's.
    pub column: Option<String>,
    /// What is wrong, and what is allowed.
    pub message: String,
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.line)?;
        if let Some(column) = &self.column {
            write!(f, "column `{column}`: ")?;
        }
        f.write_str(&self.message)
    }
}

/// A signal of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Signal {
    Position,
    Reference,
    Stiffness,
    Damping,
    Force,
    Emg,
    /// In the trajectory of a run, and not needed.
    Velocity,
}

/// Endings of column names: what they are, and the unit of the axis.
const ENDINGS: [(&str, Signal, Option<Unit>); 17] = [
    ("_m", Signal::Position, Some(Unit::M)),
    ("_rad", Signal::Position, Some(Unit::Rad)),
    ("_position_m", Signal::Position, Some(Unit::M)),
    ("_position_rad", Signal::Position, Some(Unit::Rad)),
    ("_reference_m", Signal::Reference, Some(Unit::M)),
    ("_reference_rad", Signal::Reference, Some(Unit::Rad)),
    ("_stiffness_n_m", Signal::Stiffness, Some(Unit::M)),
    ("_stiffness_nm_rad", Signal::Stiffness, Some(Unit::Rad)),
    ("_damping_n_s_m", Signal::Damping, Some(Unit::M)),
    ("_damping_nm_s_rad", Signal::Damping, Some(Unit::Rad)),
    ("_force_n", Signal::Force, Some(Unit::M)),
    ("_torque_nm", Signal::Force, Some(Unit::Rad)),
    ("_emg", Signal::Emg, None),
    ("_velocity_m_s", Signal::Velocity, Some(Unit::M)),
    ("_velocity_rad_s", Signal::Velocity, Some(Unit::Rad)),
    ("_reference_velocity_m_s", Signal::Velocity, Some(Unit::M)),
    ("_reference_velocity_rad_s", Signal::Velocity, Some(Unit::Rad)),
];

/// Columns of a run's trajectory that belong to no axis.
const OF_A_RUN: [&str; 4] = ["phase", "deflection_m", "deviation_m", "contact_force_n"];

/// Units that are not read: their ending, and what to give instead.
const OTHER_UNITS: [(&str, &str); 9] = [
    ("_mm", "m"),
    ("_cm", "m"),
    ("_km", "m"),
    ("_inch", "m"),
    ("_deg", "rad"),
    ("_ms", "s"),
    ("_us", "s"),
    ("_ns", "s"),
    ("_kn", "n"),
];

/// What a column holds.
enum Column {
    Time,
    Axis { name: String, signal: Signal, unit: Option<Unit> },
    Unread,
}

impl Demonstration {
    /// Reads a recording: CSV whose header names `time_s`, and for each axis `<axis>_m` or `<axis>_position_m`,
    /// and what there is of `<axis>_reference_m`, `_stiffness_n_m`, `_damping_n_s_m`, `_force_n` and `_emg`; for an
    /// axis in rad `_rad`, `_stiffness_nm_rad`, `_damping_nm_s_rad`, `_torque_nm`. The trajectory of a run is one. Lines
    /// that begin with `#` are left out. Time may start anywhere. A last number that may be cut ([`TableEnd`]) is a
    /// mistake.
    ///
    /// ```
    /// let text = "time_s,x_m\n3.0,0.0\n3.1,0.1\n3.2,0.5\n3.3,0.9\n3.4,1.0\n";
    /// let demonstration = hpf_sim::Demonstration::parse(text).unwrap();
    /// assert_eq!(demonstration.axes[0].name, "x");
    /// assert!((demonstration.duration() - 0.4).abs() < 1e-12);
    /// ```
    ///
    /// # Errors
    /// Every mistake found, to [`MAX_MISTAKES`]: the header's, or else those of the rows.
    pub fn parse(text: &str) -> Result<Self, Vec<Mistake>> {
        let whole = |message: &str| vec![Mistake { line: 1, column: None, message: message.into() }];
        let text = text.trim_start_matches('\u{feff}');
        if text.trim().is_empty() {
            return Err(whole("the file is empty; it needs a header such as time_s,x_m and a row per sample"));
        }
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .flexible(true)
            .from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| whole(&error.to_string()))?.clone();
        // The reader counts from where it began to look for a row: comments and empty lines come before it.
        let lines: Vec<&str> = text.lines().collect();
        let line_of = |position: Option<&csv::Position>| {
            let from = position.map_or(1, csv::Position::line);
            let is_row = |line: &&&str| !line.trim().is_empty() && !line.starts_with('#');
            let before = lines.iter().skip(from as usize - 1).position(|line| is_row(&line));
            from + before.unwrap_or_default() as u64
        };
        let line = line_of(header.position());
        let names: Vec<&str> = header.iter().collect();
        let columns = columns(&names).map_err(|found| {
            let place = |(column, message)| Mistake { line, column, message };
            found.into_iter().take(MAX_MISTAKES).map(place).collect::<Vec<_>>()
        })?;

        let mut lists = vec![Vec::new(); names.len()];
        let mut mistakes = Vec::new();
        let mut last = line;
        for record in reader.records() {
            let record = record.map_err(|error| whole(&error.to_string()))?;
            last = line_of(record.position());
            if record.len() != names.len() {
                let message = format!("{} values for the {} columns of the header", record.len(), names.len());
                mistakes.push(Mistake { line: last, column: None, message });
            } else {
                for (i, cell) in record.iter().enumerate() {
                    match number(cell, &columns[i], lists[i].last().copied()) {
                        Ok(value) => lists[i].push(value),
                        Err(message) => {
                            mistakes.push(Mistake { line: last, column: Some(names[i].into()), message });
                        }
                    }
                }
            }
            if mistakes.len() >= MAX_MISTAKES {
                break;
            }
        }
        let samples = lists[0].len();
        if mistakes.is_empty() && !(MIN_SAMPLES..=MAX_STEPS + 1).contains(&samples) {
            let allowed = format!("at least {MIN_SAMPLES} and at most {} are needed", MAX_STEPS + 1);
            let message = format!("{samples} samples; {allowed}");
            mistakes.push(Mistake { line: last, column: None, message });
        }
        if let (true, TableEnd::Cut { number, .. }) = (mistakes.is_empty(), TableEnd::of(text)) {
            let message = format!(
                "the last number, {number}, is shorter than the others and no line break follows: the file may be cut; \
                 where it is whole, end it with a line break"
            );
            mistakes.push(Mistake { line: last, column: names.last().map(|name| (*name).to_owned()), message });
        }
        if !mistakes.is_empty() {
            mistakes.truncate(MAX_MISTAKES);
            return Err(mistakes);
        }
        Ok(assemble(columns, lists))
    }
}

/// The number in a cell, if it can stand there after `before`.
fn number(cell: &str, column: &Column, before: Option<f64>) -> Result<f64, String> {
    let value: f64 = match cell.parse() {
        Ok(value) => value,
        Err(_) if matches!(column, Column::Unread) => return Ok(0.0),
        Err(_) if cell.is_empty() => return Err("the value is missing".into()),
        Err(_) => return Err(format!("`{cell}` is no number")),
    };
    match column {
        Column::Unread => Ok(value),
        _ if !value.is_finite() => Err(format!("{cell} is not finite")),
        Column::Time => match before {
            Some(before) if value == before => Err(format!("the time {value} stands twice; each sample needs its own")),
            Some(before) if value < before => {
                Err(format!("the time falls from {before} to {value}; it must rise from row to row"))
            }
            _ => Ok(value),
        },
        Column::Axis { signal: Signal::Stiffness | Signal::Damping, .. } if value <= 0.0 => {
            Err(format!("must be above 0, not {value}"))
        }
        Column::Axis { .. } => Ok(value),
    }
}

/// What is wrong with the header: the column, and what.
type HeaderMistakes = Vec<(Option<String>, String)>;

/// What each column of the header holds.
fn columns(names: &[&str]) -> Result<Vec<Column>, HeaderMistakes> {
    let mut mistakes = HeaderMistakes::new();
    if let [one] = names
        && let Some(separator) = [';', '\t'].into_iter().find(|separator| one.contains(*separator))
    {
        return Err(vec![(None, format!("columns are separated by commas, not by {separator:?}"))]);
    }
    let read: Vec<Option<Column>> = names.iter().map(|name| column(name)).collect();
    let axes: Vec<(&str, Unit)> = read.iter().flatten().filter_map(axis).collect();
    // Under a misspelt ending, `x_stifness_n_m` would be a position of an axis of its own.
    let is_stray = |name: &str, axis: &str| {
        let bare = ["_m", "_rad"].iter().any(|ending| name == format!("{axis}{ending}"));
        bare && axes.iter().any(|(other, _)| axis.strip_prefix(other).is_some_and(|rest| rest.starts_with('_')))
    };
    let axes: Vec<(&str, Unit)> = read
        .iter()
        .zip(names)
        .filter_map(|(column, name)| axis(column.as_ref()?).filter(|(axis, _)| !is_stray(name, axis)))
        .collect();
    for (i, name) in names.iter().enumerate() {
        let mut say = |message: String| mistakes.push((Some((*name).to_owned()), message));
        if names[..i].contains(name) {
            say("the header has this column twice".into());
            continue;
        }
        match &read[i] {
            None => say(unknown(name, &axes)),
            Some(Column::Axis { name: axis, signal: Signal::Position, .. }) if is_stray(name, axis) => {
                say(unknown(name, &axes));
            }
            Some(Column::Axis { name: own, signal: Signal::Position, .. }) => {
                let is_same = |column: &Option<Column>| column.as_ref().and_then(axis).is_some_and(|(a, _)| a == own);
                if read[..i].iter().any(is_same) {
                    say(format!("axis `{own}` has two position columns"));
                }
            }
            Some(Column::Axis { name: own, unit, .. }) => match axes.iter().find(|(axis, _)| axis == own) {
                None => say(format!("axis `{own}` has no position column, {own}_m or {own}_rad")),
                Some((_, of_axis)) if unit.is_some_and(|unit| unit != *of_axis) => {
                    let unit = of_axis.symbol();
                    say(format!("axis `{own}` is in {unit}, this column belongs to the other unit"));
                }
                Some(_) => {}
            },
            Some(_) => {}
        }
    }
    if !names.contains(&"time_s") {
        mistakes.insert(0, (None, "there is no column `time_s`, the time in seconds".into()));
    }
    match axes.len() {
        0 => mistakes.push((None, "there is no position column, such as x_m or x_rad".into())),
        count if count > MAX_AXES => mistakes.push((None, format!("{count} axes; at most {MAX_AXES} are allowed"))),
        _ => {}
    }
    if !mistakes.is_empty() {
        return Err(mistakes);
    }
    Ok(read.into_iter().flatten().collect())
}

/// The axis whose position a column is.
fn axis(column: &Column) -> Option<(&str, Unit)> {
    match column {
        Column::Axis { name, signal: Signal::Position, unit: Some(unit) } => Some((name, *unit)),
        _ => None,
    }
}

/// What a column of this name holds, by the longest ending that fits.
fn column(name: &str) -> Option<Column> {
    if name == "time_s" {
        return Some(Column::Time);
    }
    if OF_A_RUN.contains(&name) {
        return Some(Column::Unread);
    }
    let fits = ENDINGS.iter().filter_map(|(ending, signal, unit)| {
        let axis = name.strip_suffix(ending)?;
        let is_name = axis.starts_with(|c: char| c.is_ascii_alphabetic())
            && axis.len() <= 32
            && axis.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        is_name.then_some((axis, ending.len(), *signal, *unit))
    });
    let (axis, _, signal, unit) = fits.max_by_key(|fit| fit.1)?;
    Some(Column::Axis { name: axis.into(), signal, unit })
}

/// What to say of a column that nobody knows.
fn unknown(name: &str, axes: &[(&str, Unit)]) -> String {
    if let Some((ending, unit)) = OTHER_UNITS.iter().find(|(ending, _)| name.ends_with(ending)) {
        let stem = name.strip_suffix(ending).unwrap_or(name);
        return format!("the unit {} is not read; give `{stem}_{unit}`, in SI units", &ending[1..]);
    }
    let of_axis = |(axis, unit): &(&str, Unit)| {
        let fits = ENDINGS.iter().filter(|(_, _, of)| of.is_none_or(|of| of == *unit));
        fits.map(|(ending, ..)| format!("{axis}{ending}")).collect::<Vec<_>>()
    };
    let known: Vec<String> = axes.iter().flat_map(of_axis).chain(["time_s".to_owned()]).collect();
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    let near = nearest(name, &known).map_or(String::new(), |near| format!(", did you mean `{near}`?"));
    let endings = "_m, _position_m, _reference_m, _stiffness_n_m, _damping_n_s_m, _force_n, _emg, or those of rad";
    format!("unknown column{near}; columns are time_s and, after the name of an axis, {endings}")
}

/// The recording of columns that hold together.
fn assemble(columns: Vec<Column>, lists: Vec<Vec<f64>>) -> Demonstration {
    let mut demonstration = Demonstration { time: Vec::new(), axes: Vec::new() };
    for column in &columns {
        if let Some((name, unit)) = axis(column) {
            demonstration.axes.push(RecordedAxis {
                name: name.into(),
                unit,
                position: Vec::new(),
                reference: None,
                stiffness: None,
                damping: None,
                force: None,
                emg: None,
            });
        }
    }
    for (column, list) in columns.into_iter().zip(lists) {
        match column {
            Column::Time => {
                let start = list[0];
                demonstration.time = list.into_iter().map(|time| time - start).collect();
            }
            Column::Axis { name, signal, .. } => {
                let axis = demonstration.axes.iter_mut().find(|axis| axis.name == name);
                let axis = axis.expect("every signal's axis has a position: the header was checked");
                match signal {
                    Signal::Position => axis.position = list,
                    Signal::Reference => axis.reference = Some(list),
                    Signal::Stiffness => axis.stiffness = Some(list),
                    Signal::Damping => axis.damping = Some(list),
                    Signal::Force => axis.force = Some(list),
                    Signal::Emg => axis.emg = Some(list),
                    Signal::Velocity => {}
                }
            }
            Column::Unread => {}
        }
    }
    demonstration
}
