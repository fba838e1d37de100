//! The names of columns that hpf writes and reads without options: an axis, what was measured of it, the unit.

use std::collections::{HashMap, HashSet};

use hpf_sim::task::{MAX_AXES, Unit};

use crate::mapping::is_axis_name;
use crate::mistake::{MAX_MISTAKES, Mistake};
use crate::select::{Pick, Plan};
use crate::table::{Table, nearest};
use crate::units;

/// A signal of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Signal {
    Position,
    Reference,
    Stiffness,
    Damping,
    Force,
    Emg,
    /// In the trajectory of a run, and not needed.
    Velocity,
}

/// Endings of column names behind the axis: what they are, the unit of the axis, and their factor to SI.
const ENDINGS: [(&str, Signal, Option<Unit>, f64); 13] = [
    ("_stiffness_n_m", Signal::Stiffness, Some(Unit::M), 1.0),
    ("_stiffness_nm_rad", Signal::Stiffness, Some(Unit::Rad), 1.0),
    ("_damping_n_s_m", Signal::Damping, Some(Unit::M), 1.0),
    ("_damping_nm_s_rad", Signal::Damping, Some(Unit::Rad), 1.0),
    ("_force_n", Signal::Force, Some(Unit::M), 1.0),
    ("_force_kn", Signal::Force, Some(Unit::M), 1e3),
    ("_torque_nm", Signal::Force, Some(Unit::Rad), 1.0),
    ("_torque_nmm", Signal::Force, Some(Unit::Rad), 1e-3),
    ("_emg", Signal::Emg, None, 1.0),
    ("_velocity_m_s", Signal::Velocity, Some(Unit::M), 1.0),
    ("_velocity_rad_s", Signal::Velocity, Some(Unit::Rad), 1.0),
    ("_reference_velocity_m_s", Signal::Velocity, Some(Unit::M), 1.0),
    ("_reference_velocity_rad_s", Signal::Velocity, Some(Unit::Rad), 1.0),
];

/// Units of positions in names.
const POSITION_UNITS: [(&str, Unit); 9] = [
    ("m", Unit::M),
    ("mm", Unit::M),
    ("cm", Unit::M),
    ("um", Unit::M),
    ("km", Unit::M),
    ("inch", Unit::M),
    ("rad", Unit::Rad),
    ("deg", Unit::Rad),
    ("mrad", Unit::Rad),
];

/// Columns of a run's trajectory that belong to no axis.
const OF_A_RUN: [&str; 4] = ["phase", "deflection_m", "deviation_m", "contact_force_n"];

/// Words of signals: `x_stifness_n_m` is one misspelt, not the position of an axis `x_stifness_n`.
const SIGNAL_WORDS: [&str; 8] = ["reference", "position", "stiffness", "damping", "force", "torque", "emg", "velocity"];

/// What a column holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    Time { factor: f64 },
    Axis { name: String, signal: Signal, unit: Option<Unit>, factor: f64 },
    Unread,
}

/// What a column of this name holds, by the longest ending that fits.
pub fn kind(name: &str) -> Option<Kind> {
    if let Some(word) = name.strip_prefix("time_")
        && let Some(unit) = units::UNITS.iter().find(|unit| unit.word == word)
        && unit.dimension == units::Dimension::Time
    {
        return Some(Kind::Time { factor: unit.factor });
    }
    if OF_A_RUN.contains(&name) {
        return Some(Kind::Unread);
    }
    let fixed = ENDINGS.iter().filter_map(|(ending, signal, unit, factor)| {
        let axis = name.strip_suffix(ending)?;
        is_axis_name(axis).then_some((axis, *signal, *unit, *factor))
    });
    let longest = fixed.min_by_key(|fit| fit.0.len());
    let position = || {
        let (front, word) = name.rsplit_once('_')?;
        let (_, unit) = POSITION_UNITS.iter().find(|(known, _)| *known == word)?;
        let factor = units::of_word(word)?.factor;
        let stems = [("_position", Signal::Position), ("_reference", Signal::Reference)];
        let found = stems.iter().find_map(|(stem, signal)| Some((front.strip_suffix(stem)?, *signal)));
        let (axis, signal) = found.filter(|(axis, _)| !axis.is_empty()).unwrap_or((front, Signal::Position));
        is_axis_name(axis).then_some((axis, signal, Some(*unit), factor))
    };
    let (axis, signal, unit, factor) = longest.or_else(position)?;
    Some(Kind::Axis { name: axis.into(), signal, unit, factor })
}

/// The axis whose position a column is.
fn axis(kind: &Kind) -> Option<(&str, Unit)> {
    match kind {
        Kind::Axis { name, signal: Signal::Position, unit: Some(unit), .. } => Some((name, *unit)),
        _ => None,
    }
}

/// Whether the name `axis` is another axis and a misspelt signal of it.
fn is_stray(axis: &str, axes: &HashSet<&str>) -> bool {
    axis.match_indices('_').any(|(at, _)| {
        let word = axis[at + 1..].split('_').next().unwrap_or_default();
        let near = |known: &&str| {
            let most = if known.len() > 5 { 2 } else { 1 };
            word.len() > 2 && strsim::levenshtein(word, known) <= most
        };
        axes.contains(&axis[..at]) && SIGNAL_WORDS.iter().any(near)
    })
}

/// What is read of a table by the names of its columns; those `named` by the mapping need no name of ours.
///
/// # Errors
/// Every mistake of the header, to [`MAX_MISTAKES`].
pub fn by_name(table: &Table, ignore_rest: bool, has_time: bool, named: &[usize]) -> Result<Plan, Vec<Mistake>> {
    let line = if table.is_named { table.header_line } else { 1 };
    let mut mistakes = Vec::new();
    let kinds: Vec<Option<Kind>> = table.columns.iter().map(|column| kind(&column.name)).collect();
    let all: HashSet<&str> = kinds.iter().flatten().filter_map(axis).map(|(name, _)| name).collect();
    let axes: Vec<(&str, Unit)> =
        kinds.iter().flatten().filter_map(axis).filter(|(axis, _)| !is_stray(axis, &all)).collect();
    let unit_of: HashMap<&str, Unit> = axes.iter().rev().copied().collect();
    let (mut seen, mut positions) = (HashSet::new(), HashSet::new());
    let mut plan = Plan::default();
    let mut ignored = Vec::new();
    for (at, (kind, column)) in kinds.iter().zip(&table.columns).enumerate() {
        let name = &column.name;
        if mistakes.len() >= MAX_MISTAKES {
            break;
        }
        let mut say = |message: String| mistakes.push(Mistake::of_column(line, name, message));
        let is_unknown = match kind {
            None if named.contains(&at) => continue,
            None => true,
            Some(Kind::Axis { name: own, signal: Signal::Position, .. }) => is_stray(own, &all),
            Some(_) => false,
        };
        if is_unknown {
            if ignore_rest {
                ignored.push(name.as_str())
            } else {
                say(unknown(name, &axes))
            }
            continue;
        }
        if !seen.insert(name.as_str()) {
            say("the header has this column twice".into());
            continue;
        }
        match kind.as_ref().expect("unknown columns were passed over") {
            Kind::Time { factor } => match plan.time {
                None => plan.time = Some((at, *factor)),
                Some(_) => say("there are two columns of time".into()),
            },
            Kind::Axis { name: own, signal, unit, factor } => {
                let Some(of_axis) = unit_of.get(own.as_str()).copied() else {
                    if ignore_rest {
                        ignored.push(name.as_str());
                    } else {
                        say(format!("axis `{own}` has no position column, {own}_m or {own}_rad"));
                    }
                    continue;
                };
                if unit.is_some_and(|unit| unit != of_axis) {
                    let unit = of_axis.symbol();
                    say(format!("axis `{own}` is in {unit}, this column belongs to the other unit"));
                } else if *signal == Signal::Position {
                    if positions.insert(own.as_str()) {
                        plan.axes.push((own.clone(), of_axis));
                        plan.picks.push(Pick {
                            column: at,
                            axis: plan.axes.len() - 1,
                            signal: *signal,
                            factor: *factor,
                        });
                    } else {
                        say(format!("axis `{own}` has two position columns"));
                    }
                }
            }
            Kind::Unread => {}
        }
    }
    if plan.time.is_none() && !has_time && !kinds.iter().flatten().any(|kind| matches!(kind, Kind::Time { .. })) {
        mistakes.insert(0, Mistake::at(line, "there is no column `time_s`, the time in seconds"));
    }
    match axes.len() {
        0 => mistakes.push(Mistake::at(line, "there is no position column, such as x_m or x_rad")),
        count if count > MAX_AXES => {
            mistakes.push(Mistake::at(line, format!("{count} axes; at most {MAX_AXES} are allowed")));
        }
        _ => {}
    }
    if !mistakes.is_empty() {
        mistakes.truncate(MAX_MISTAKES);
        return Err(mistakes);
    }
    signals(&kinds, &mut plan);
    plan.note_ignored(&ignored);
    Ok(plan)
}

/// Adds the signals of the axes of `plan` but their positions.
pub fn signals(kinds: &[Option<Kind>], plan: &mut Plan) {
    for (at, kind) in kinds.iter().enumerate() {
        if let Some(Kind::Axis { name, signal, unit, factor }) = kind
            && !matches!(signal, Signal::Position | Signal::Velocity)
            && let Some(axis) =
                plan.axes.iter().position(|(axis, of)| axis == name && unit.is_none_or(|unit| unit == *of))
            && !plan.picks.iter().any(|pick| pick.axis == axis && pick.signal == *signal)
        {
            plan.picks.push(Pick { column: at, axis, signal: *signal, factor: *factor });
        }
    }
}

/// Axes whose columns are compared with an unknown one.
const COMPARED: usize = 30;

/// What to say of a column that nobody knows.
fn unknown(name: &str, axes: &[(&str, Unit)]) -> String {
    let of_axis = |(axis, unit): &(&str, Unit)| {
        let fits = ENDINGS.iter().filter(|(_, _, of, _)| of.is_none_or(|of| of == *unit));
        let symbol = unit.symbol();
        let positions = ["", "_position", "_reference"].map(|stem| format!("{axis}{stem}_{symbol}"));
        fits.map(|(ending, ..)| format!("{axis}{ending}")).chain(positions).collect::<Vec<_>>()
    };
    let known: Vec<String> = axes.iter().take(COMPARED).flat_map(of_axis).chain(["time_s".to_owned()]).collect();
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    let near = nearest(name, &known).map_or(String::new(), |near| format!(", did you mean `{near}`?"));
    let endings = "_m, _position_m, _reference_m, _stiffness_n_m, _damping_n_s_m, _force_n, _emg, or those of rad";
    format!("unknown column{near}; columns are time_s and, after the name of an axis, {endings}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_an_axis_a_signal_and_a_unit() {
        let found = |name: &str| match kind(name) {
            Some(Kind::Axis { name, signal, unit, factor }) => Some((name, signal, unit, factor)),
            _ => None,
        };
        assert_eq!(found("x_m"), Some(("x".into(), Signal::Position, Some(Unit::M), 1.0)));
        assert_eq!(found("x_position_mm"), Some(("x".into(), Signal::Position, Some(Unit::M), 1e-3)));
        assert_eq!(found("a_b_reference_deg").unwrap().0, "a_b");
        assert_eq!(found("x_reference_velocity_m_s").unwrap().1, Signal::Velocity);
        assert_eq!(found("x_stiffness_n_m").unwrap().1, Signal::Stiffness);
        assert_eq!((found("colour"), found("1_m")), (None, None));
        assert_eq!(kind("time_ns"), Some(Kind::Time { factor: 1e-9 }));
        assert_eq!(kind("phase"), Some(Kind::Unread));
    }

    #[test]
    fn two_joints_may_begin_alike_and_a_misspelt_signal_is_none() {
        let axes = HashSet::from(["elbow", "elbow_yaw", "x", "x_stifness_n"]);
        assert!(!is_stray("elbow_yaw", &axes));
        assert!(is_stray("x_stifness_n", &axes));
        assert!(!is_stray("x", &axes));
    }
}
