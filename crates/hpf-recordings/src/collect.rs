//! The rows of a table as signals: every number that is read must be one.

use hpf_sim::demonstration::RecordedAxis;
use hpf_sim::task::MAX_STEPS;

use crate::guess;
use crate::mapping::Mapping;
use crate::mistake::{MAX_MISTAKES, Mistake};
use crate::names::Signal;
use crate::select::Plan;
use crate::table::Table;

/// Fewest samples of a recording: an acceleration by differences needs four neighbors.
pub const MIN_SAMPLES: usize = 5;

/// Steps of time that no recording of a motion has [s].
const LONGEST_STEP: f64 = 1000.0;

/// Signals with the line of each sample.
#[derive(Clone, Debug, Default)]
pub struct Raw {
    /// The line or row of each sample.
    pub lines: Vec<u64>,
    /// Time since the first sample [s].
    pub time: Vec<f64>,
    /// Stamps that stand twice, as mistakes: some can be mended.
    pub twice: Vec<Mistake>,
    /// Positions and what else was measured, in SI units.
    pub axes: Vec<RecordedAxis>,
}

impl Raw {
    /// Every signal, with the axis it is of.
    pub fn signals_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        self.axes.iter_mut().flat_map(|axis| {
            let RecordedAxis { position, reference, stiffness, damping, force, emg, .. } = axis;
            core::iter::once(position).chain([reference, stiffness, damping, force, emg].into_iter().flatten())
        })
    }

    /// Keeps the samples for which `is_kept` holds.
    pub fn retain(&mut self, is_kept: &[bool]) {
        let keep = |list: &mut Vec<f64>| {
            let mut kept = is_kept.iter();
            list.retain(|_| *kept.next().expect("a flag per sample"));
        };
        keep(&mut self.time);
        self.signals_mut().for_each(keep);
        let mut kept = is_kept.iter();
        self.lines.retain(|_| *kept.next().expect("a flag per sample"));
    }
}

/// The signals that `plan` reads of `table`; `notes` gains what was mended.
///
/// # Errors
/// Every mistake in the rows, to [`MAX_MISTAKES`].
pub fn collect(table: &Table, plan: &Plan, mapping: &Mapping, notes: &mut Vec<String>) -> Result<Raw, Vec<Mistake>> {
    let mut mistakes: Vec<(usize, Mistake)> = table.mistakes.iter().map(|mistake| (0, mistake.clone())).collect();
    let used: Vec<usize> = plan.picks.iter().map(|pick| pick.column).collect();
    // Rows without a number are left out where that is asked for: gaps, which are filled in.
    let is_whole = |row: &usize| used.iter().all(|at| table.columns[*at].values[*row].is_finite());
    let rows: Vec<usize> = (0..table.rows()).filter(|row| !mapping.bridge || is_whole(row)).collect();
    if rows.len() < table.rows() {
        let first = (0..table.rows()).find(|row| !is_whole(row)).map_or(0, |row| table.lines[row]);
        let count = table.rows() - rows.len();
        notes.push(format!("{count} rows without a number, from line {first} on, are left out (--bridge)"));
    }
    for pick in &plan.picks {
        let column = &table.columns[pick.column];
        let most = mistakes.len() + MAX_MISTAKES;
        for &row in &rows {
            if mistakes.len() >= most {
                break;
            }
            let value = column.values[row] + column.base;
            let message = match pick.signal {
                _ if !value.is_finite() => not_finite(&column.text(row)),
                Signal::Stiffness | Signal::Damping if value <= 0.0 => format!("must be above 0, not {value}"),
                _ => continue,
            };
            mistakes.push((pick.column, Mistake::of_column(table.lines[row], &column.name, message)));
        }
    }
    let mut twice = Vec::new();
    let time = match plan.time {
        Some((at, factor)) => time(table, at, factor, &rows, &mut mistakes, &mut twice),
        None => {
            let rate = mapping.sample_rate.unwrap_or(1.0);
            (0..rows.len()).map(|i| i as f64 / rate).collect()
        }
    };
    let samples = rows.len();
    if mistakes.is_empty() && !(MIN_SAMPLES..=MAX_STEPS + 1).contains(&samples) {
        let allowed = format!("at least {MIN_SAMPLES} and at most {} are needed", MAX_STEPS + 1);
        let last = table.lines.last().copied().unwrap_or(table.header_line.max(1));
        mistakes.push((0, Mistake::at(last, format!("{samples} samples; {allowed}"))));
    }
    if mistakes.is_empty() && guess::median_step(&time) > LONGEST_STEP {
        let (at, _) = plan.time.expect("a rate gives shorter steps");
        let column = &table.columns[at];
        let (unit, reason) = guess::time_unit(column);
        let message = format!(
            "steps of {} s are none of a motion; in {} {reason}: read it with --time {}:{}",
            guess::short(guess::median_step(&time)),
            unit.word,
            column.name,
            unit.word
        );
        mistakes.push((0, Mistake::of_column(table.lines.get(1).copied().unwrap_or(1), &column.name, message)));
    }
    if !mistakes.is_empty() {
        mistakes.extend(twice);
        mistakes.sort_by_key(|(column, mistake)| (mistake.line, *column));
        return Err(mistakes.into_iter().take(MAX_MISTAKES).map(|(_, mistake)| mistake).collect());
    }
    let mut axes: Vec<RecordedAxis> = plan
        .axes
        .iter()
        .map(|(name, unit)| RecordedAxis {
            name: name.clone(),
            unit: *unit,
            position: Vec::new(),
            reference: None,
            stiffness: None,
            damping: None,
            force: None,
            emg: None,
        })
        .collect();
    for pick in &plan.picks {
        let column = &table.columns[pick.column];
        let list = rows.iter().map(|row| (column.values[*row] + column.base) * pick.factor).collect();
        let axis = &mut axes[pick.axis];
        match pick.signal {
            Signal::Position => axis.position = list,
            Signal::Reference => axis.reference = Some(list),
            Signal::Stiffness => axis.stiffness = Some(list),
            Signal::Damping => axis.damping = Some(list),
            Signal::Force => axis.force = Some(list),
            Signal::Emg => axis.emg = Some(list),
            Signal::Velocity => {}
        }
    }
    let twice = twice.into_iter().map(|(_, mistake)| mistake).collect();
    Ok(Raw { twice, lines: rows.iter().map(|row| table.lines[*row]).collect(), time, axes })
}

fn not_finite(text: &str) -> String {
    match text.parse::<f64>() {
        Ok(_) => format!("{text} is not finite"),
        Err(_) if text.is_empty() => "the value is missing".into(),
        Err(_) => format!("`{text}` is no number"),
    }
}

/// Time since the first sample [s]; stamps that stand twice go to `twice`, for some can be mended.
fn time(
    table: &Table,
    at: usize,
    factor: f64,
    rows: &[usize],
    mistakes: &mut Vec<(usize, Mistake)>,
    twice: &mut Vec<(usize, Mistake)>,
) -> Vec<f64> {
    let column = &table.columns[at];
    let (mut before, mut time): (Option<f64>, Vec<f64>) = (None, Vec::with_capacity(rows.len()));
    let start = rows.iter().map(|row| column.values[*row]).find(|value| value.is_finite()).unwrap_or_default();
    let mut count = 0;
    for &row in rows {
        let value = column.values[row];
        let place = |message: String| (at, Mistake::of_column(table.lines[row], &column.name, message));
        if !value.is_finite() {
            if count < MAX_MISTAKES {
                mistakes.push(place(not_finite(&column.text(row))));
            }
            count += 1;
            continue;
        }
        let stamp = |value: f64| column.base + value;
        match before {
            Some(before) if value == before && twice.len() < MAX_MISTAKES => {
                let value = stamp(value);
                twice.push(place(format!("the time {value} stands twice; each sample needs its own")));
            }
            Some(before) if value < before => {
                if count < MAX_MISTAKES {
                    // Back near the start, a second recording begins.
                    let is_reset = value - start < 0.1 * (before - start);
                    let reset =
                        if is_reset { "; where a second recording begins, put it in a file of its own" } else { "" };
                    let (before, value) = (stamp(before), stamp(value));
                    mistakes.push(place(format!(
                        "the time falls from {before} to {value}; it must rise from row to row{reset}"
                    )));
                }
                count += 1;
                continue;
            }
            _ => {}
        }
        before = Some(value);
        time.push((value - start) * factor);
    }
    time
}
