//! `demonstrations.csv`: the recordings that a policy imitates at the samples of its run, beside its reference.

use std::io;

use hpf_sim::task::{Axis, Task};

use super::{Run, bad, refuse_cut};

/// Names of the columns of an axis: `count` demonstrations, then the reference.
fn columns(axis: &Axis, count: usize) -> impl Iterator<Item = String> {
    let (name, unit) = (&axis.name, axis.unit.symbol());
    let recorded = (1..=count).map(move |number| format!("{name}_demonstration_{number}_{unit}"));
    recorded.chain([format!("{name}_reference_{unit}")])
}

/// Names of all columns.
fn header(task: &Task, count: usize) -> Vec<String> {
    ["time_s".to_owned()].into_iter().chain(task.axis.iter().flat_map(|axis| columns(axis, count))).collect()
}

/// The text of `demonstrations.csv`.
pub fn write(run: &Run) -> String {
    let mut signals = vec![&run.trajectory.time];
    for (a, axis) in run.trajectory.axes.iter().enumerate() {
        signals.extend(run.demonstrations.iter().map(|demonstration| &demonstration[a]));
        signals.push(&axis.reference_position);
    }
    let mut text = header(&run.task, run.demonstrations.len()).join(",") + "\n";
    for row in 0..=run.trajectory.steps() {
        let numbers: Vec<String> = signals.iter().map(|signal| format!("{:?}", signal[row])).collect();
        text += &numbers.join(",");
        text.push('\n');
    }
    text
}

/// Reads `demonstrations.csv` of a run of `task`: each demonstration by axis.
pub fn read(task: &Task, text: &str) -> io::Result<Vec<Vec<Vec<f64>>>> {
    refuse_cut(text)?;
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let names = reader.headers().map_err(io::Error::other)?.clone();
    let axes = task.axis.len();
    let count = (names.len().saturating_sub(1) / axes).saturating_sub(1);
    if count == 0 || !names.iter().eq(header(task, count)) {
        return Err(bad("the columns are not those of demonstrations of this task"));
    }
    let mut demonstrations = vec![vec![Vec::new(); axes]; count];
    for record in reader.deserialize::<Vec<f64>>() {
        let record = record.map_err(io::Error::other)?;
        for (a, numbers) in record[1..].chunks_exact(count + 1).enumerate() {
            demonstrations.iter_mut().zip(numbers).for_each(|(demonstration, number)| demonstration[a].push(*number));
        }
    }
    let (rows, samples) = (demonstrations[0][0].len(), task.steps() + 1);
    if rows == samples { Ok(demonstrations) } else { Err(bad(super::other_rows(rows, samples))) }
}
