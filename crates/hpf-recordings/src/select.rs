//! Which columns of a table become which signals, by a mapping.

use hpf_sim::task::{MAX_AXES, Unit};

use crate::guess;
use crate::mapping::{AxisSource, Mapping, Source};
use crate::mistake::Mistake;
use crate::names::{self, Signal, by_name};
use crate::table::Table;
use crate::units::{self, Dimension, UnitWord};

/// What is read of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// The column of time and its factor to seconds; none where the rate is given.
    pub time: Option<(usize, f64)>,
    /// Names and units of the axes.
    pub axes: Vec<(String, Unit)>,
    /// What each signal is read from.
    pub picks: Vec<Pick>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// A signal of an axis and where it is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    pub column: usize,
    pub axis: usize,
    pub signal: Signal,
    /// To SI units.
    pub factor: f64,
}

impl Plan {
    /// Notes the columns that are not read.
    pub fn note_ignored(&mut self, names: &[&str]) {
        if names.is_empty() {
            return;
        }
        let shown = names.iter().take(8).copied().collect::<Vec<_>>().join(", ");
        let more = if names.len() > 8 { format!(" and {} more", names.len() - 8) } else { String::new() };
        self.notes.push(format!("not read: {shown}{more}"));
    }
}

/// What `mapping` reads of `table`.
///
/// # Errors
/// What of it is not there, or not clear.
pub fn plan(table: &Table, mapping: &Mapping) -> Result<Plan, Vec<Mistake>> {
    let line = table.header_line.max(1);
    let has_time = mapping.time.is_some() || mapping.sample_rate.is_some() || table.time.is_some();
    let of_messages;
    let mapping = if mapping.is_by_name() && table.time.is_some() {
        of_messages = Mapping { axes: message_axes(table, mapping), ..mapping.clone() };
        &of_messages
    } else {
        mapping
    };
    let sources = mapping.time.iter().chain(mapping.forces.iter().map(|force| &force.source));
    let named: Vec<usize> = sources.filter_map(|source| table.find(&source.column).ok()).collect();
    let mut plan = if mapping.is_by_name() {
        by_name(table, mapping.ignore_rest, has_time, &named)?
    } else {
        mapped(table, mapping)
            .map_err(|messages| messages.into_iter().map(|message| Mistake::at(line, message)).collect::<Vec<_>>())?
    };
    let whole = |message: String| vec![Mistake::at(line, message)];
    if let Some(source) = &mapping.time {
        let at = unique(table, &source.column).map_err(whole)?;
        let unit = source.unit.or_else(|| unit_of(table, at, Dimension::Time, mapping));
        plan.time = Some((at, time_factor(table, at, unit, &mut plan.notes)));
    } else if mapping.sample_rate.is_some() {
        plan.time = None;
    } else if plan.time.is_none() {
        let found = match table.time {
            Some(at) => Some((at, unit_of(table, at, Dimension::Time, mapping))),
            None => guess::time_column(table).map(|at| (at, unit_of(table, at, Dimension::Time, mapping))),
        };
        let Some((at, unit)) = found else {
            let message = "no column is time; name it with --time COLUMN, or give --sample-rate HZ";
            return Err(whole(message.into()));
        };
        if table.time.is_none() {
            plan.notes.push(format!("time is read from the column `{}`", table.columns[at].name));
        }
        plan.time = Some((at, time_factor(table, at, unit, &mut plan.notes)));
    }
    forces(table, &mapping.forces, mapping, &mut plan).map_err(whole)?;
    if plan.axes.len() > MAX_AXES {
        return Err(whole(format!("{} axes; at most {MAX_AXES} are allowed", plan.axes.len())));
    }
    Ok(plan)
}

/// The axes of messages: what is in m, else the positions of joints.
fn message_axes(table: &Table, mapping: &Mapping) -> Vec<AxisSource> {
    let of = |dimension: Dimension| {
        let columns = table.columns.iter().filter(move |one| one.unit.is_some_and(|unit| unit.dimension == dimension));
        columns.map(move |column| {
            let axis = column.name.strip_suffix(".position").unwrap_or(&column.name);
            let axis: String = axis.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
            AxisSource { axis, source: Source { column: column.name.clone(), unit: mapping.unit_for(dimension) } }
        })
    };
    of(Dimension::Length).chain(of(Dimension::Angle)).collect()
}

/// The only column of this name.
fn unique(table: &Table, name: &str) -> Result<usize, String> {
    let at = table.find(name)?;
    let count = table.columns.iter().filter(|column| column.name == table.columns[at].name).count();
    if count > 1 && !name.starts_with('#') {
        return Err(format!("{count} columns are called `{name}`: give the number of one, as in #{}", at + 1));
    }
    Ok(at)
}

/// The unit of a column by its format, its name or the mapping's units.
fn unit_of(table: &Table, at: usize, dimension: Dimension, mapping: &Mapping) -> Option<UnitWord> {
    let column = &table.columns[at];
    let is_fit = |unit: &UnitWord| unit.dimension == dimension;
    let by_name = || units::in_name(&column.name).1.filter(is_fit);
    column.unit.filter(is_fit).or_else(by_name).or_else(|| mapping.unit_for(dimension))
}

fn time_factor(table: &Table, at: usize, unit: Option<UnitWord>, notes: &mut Vec<String>) -> f64 {
    if let Some(unit) = unit {
        return unit.factor;
    }
    let (unit, reason) = guess::time_unit(&table.columns[at]);
    notes.push(format!("`{}` is taken to be in {}: {reason}", table.columns[at].name, unit.word));
    unit.factor
}

/// What the preset or the axes of `mapping` read.
fn mapped(table: &Table, mapping: &Mapping) -> Result<Plan, Vec<String>> {
    let mut plan = Plan::default();
    if let Some(preset) = mapping.preset {
        let found = preset.find(table).map_err(|message| vec![message])?;
        let factor = |column: usize, word: &str| {
            let given = units::of_word(word).expect("presets name units that are read");
            // A column that states its unit is believed.
            let own = units::in_name(&table.columns[column].name).1.filter(|unit| unit.dimension == given.dimension);
            own.unwrap_or(given).factor
        };
        plan.time = found.time.map(|(at, word)| (at, factor(at, word)));
        for (axis, column, word) in found.axes {
            let of_axis = units::of_word(word).map_or(Unit::M, |unit| axis_unit(unit.dimension));
            plan.axes.push((axis, of_axis));
            let axis = plan.axes.len() - 1;
            plan.picks.push(Pick { column, axis, signal: Signal::Position, factor: factor(column, word) });
        }
        for (name, column, word) in found.forces {
            if let Some(axis) = plan.axes.iter().position(|(axis, _)| *axis == name) {
                plan.picks.push(Pick { column, axis, signal: Signal::Force, factor: factor(column, word) });
            }
        }
    }
    let mut mistakes = Vec::new();
    if !mapping.axes.is_empty() {
        // Axes that are named take the place of the preset's; its time stays.
        plan.axes.clear();
        plan.picks.clear();
    }
    for AxisSource { axis, source } in &mapping.axes {
        if plan.axes.iter().any(|(name, _)| name == axis) {
            mistakes.push(format!("the axis `{axis}` is named twice"));
            continue;
        }
        let at = match unique(table, &source.column) {
            Ok(at) => at,
            Err(message) => {
                mistakes.push(message);
                continue;
            }
        };
        let column = &table.columns[at];
        let known = source.unit.or(column.unit).or_else(|| units::in_name(&column.name).1);
        let given = [Dimension::Length, Dimension::Angle].map(|dimension| mapping.unit_for(dimension));
        let unit = known.or_else(|| match (given, guess::is_angle(&column.name)) {
            ([length, None], _) => length,
            ([None, angle], _) | ([_, angle], true) => angle,
            ([length, _], false) => length,
        });
        let unit = match unit {
            Some(unit) if matches!(unit.dimension, Dimension::Length | Dimension::Angle) => unit,
            Some(unit) => {
                let allowed = format!("{}, {}", units::words(Dimension::Length), units::words(Dimension::Angle));
                mistakes.push(format!("axis `{axis}`: {} is no unit of a position; there are {allowed}", unit.word));
                continue;
            }
            None => {
                let (unit, reason) = guess::position_unit(table, at, plan.time);
                if reason.is_implausible {
                    mistakes.push(format!(
                        "column `{}` has no unit: {}; give it as in --axis {axis}={}:{}",
                        column.name, reason.text, source.column, unit.word
                    ));
                    continue;
                }
                plan.notes.push(format!("axis `{axis}` is taken to be in {}: {}", unit.word, reason.text));
                unit
            }
        };
        plan.axes.push((axis.clone(), axis_unit(unit.dimension)));
        let axis = plan.axes.len() - 1;
        plan.picks.push(Pick { column: at, axis, signal: Signal::Position, factor: unit.factor });
    }
    if !mistakes.is_empty() {
        return Err(mistakes);
    }
    let kinds: Vec<_> = table.columns.iter().map(|column| names::kind(&column.name)).collect();
    if mapping.time.is_none() && plan.time.is_none() {
        plan.time = kinds.iter().enumerate().find_map(|(at, kind)| match kind {
            Some(names::Kind::Time { factor }) => Some((at, *factor)),
            _ => None,
        });
    }
    names::signals(&kinds, &mut plan);
    let is_read = |at: usize| {
        plan.picks.iter().any(|pick| pick.column == at)
            || plan.time.is_some_and(|(time, _)| time == at)
            || mapping.time.as_ref().is_some_and(|time| table.find(&time.column) == Ok(at))
            || mapping.forces.iter().any(|force| table.find(&force.source.column) == Ok(at))
    };
    if !mapping.ignore_rest && mapping.preset.is_none() {
        let left: Vec<&str> = table
            .columns
            .iter()
            .enumerate()
            .filter(|(at, _)| !is_read(*at))
            .map(|(_, one)| one.name.as_str())
            .collect();
        plan.note_ignored(&left);
    }
    Ok(plan)
}

fn axis_unit(dimension: Dimension) -> Unit {
    if dimension == Dimension::Angle { Unit::Rad } else { Unit::M }
}

/// Adds the forces of a mapping.
fn forces(table: &Table, wanted: &[AxisSource], mapping: &Mapping, plan: &mut Plan) -> Result<(), String> {
    for AxisSource { axis: name, source } in wanted {
        let Some(axis) = plan.axes.iter().position(|(axis, _)| axis == name) else {
            let names: Vec<&str> = plan.axes.iter().map(|(axis, _)| axis.as_str()).collect();
            return Err(format!("the force of axis `{name}` has no axis; there are {}", names.join(", ")));
        };
        let column = unique(table, &source.column)?;
        let dimension = if plan.axes[axis].1 == Unit::M { Dimension::Force } else { Dimension::Torque };
        let unit = source.unit.or_else(|| unit_of(table, column, dimension, mapping));
        let factor = match unit {
            Some(unit) if unit.dimension == dimension => unit.factor,
            Some(unit) => {
                let allowed = units::words(dimension);
                return Err(format!("the force of axis `{name}`: {} is not one of {allowed}", unit.word));
            }
            None => {
                let word = if dimension == Dimension::Force { "N" } else { "N m" };
                plan.notes
                    .push(format!("the force of axis `{name}` is taken to be in {word}: nothing says another unit"));
                1.0
            }
        };
        plan.picks.retain(|pick| !(pick.axis == axis && pick.signal == Signal::Force));
        plan.picks.push(Pick { column, axis, signal: Signal::Force, factor });
    }
    Ok(())
}
