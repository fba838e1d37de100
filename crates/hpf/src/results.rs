//! What a run leaves behind, as plain data: tables, logs and pictures only read it.

pub mod demonstrations;

use std::io;
use std::path::Path;

use hpf_learn::Progress;
use hpf_sim::cost::Term;
use hpf_sim::environment::{Contact, Disturbance, cantilever::Curve};
use hpf_sim::task::{Task, Unit};
use hpf_sim::{AxisTrace, ContactTrace, Policy, Simulation, Trace};

use crate::failure::Failure;
use crate::files::{LoadedTask, in_file, read_policy, read_task, read_text};
use crate::nodes;

/// A run: the task as run, the policy it led to, and the way there.
pub struct Run {
    /// The task, overrides applied.
    pub task: Task,
    /// The learned policy.
    pub policy: Policy,
    /// One row per noiseless evaluation, the start first.
    pub learning: Vec<LearningRow>,
    /// The learned policy's motion.
    pub trajectory: Trace,
    /// The motion after some updates, in their order.
    pub snapshots: Vec<(usize, Trace)>,
    /// The recordings that the policy imitates, each by axis at the samples of the trajectory; of others, none.
    pub demonstrations: Vec<Vec<Vec<f64>>>,
}

/// One row of `learning.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct LearningRow {
    /// Updates made.
    pub update: usize,
    /// Motions made, evaluations included.
    pub rollouts: usize,
    /// Total cost.
    pub total: f64,
    /// Cost by term, in the order of [`Term::ALL`].
    pub terms: Vec<f64>,
    /// Scale of the exploration, 1 at the start.
    pub exploration: f64,
}

/// The table of what a policy imitates.
pub const DEMONSTRATIONS: &str = "demonstrations.csv";

fn bad(message: impl Into<String>) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, message.into())
}

/// A number that was cut short is another number: a table ends where a row does.
fn refuse_cut(text: &str) -> io::Result<()> {
    if text.is_empty() || text.ends_with('\n') {
        Ok(())
    } else {
        Err(bad("the last row does not end: the file was cut"))
    }
}

fn other_rows(rows: usize, samples: usize) -> String {
    format!("it has {rows} rows, the trajectory of this task {samples}")
}

/// The text of `learning.csv`.
pub fn learning_csv(rows: &[LearningRow]) -> String {
    let mut text = format!("update,rollouts,total,{},exploration\n", Term::NAMES.join(","));
    for row in rows {
        let terms: Vec<String> = row.terms.iter().map(|term| format!("{term:?}")).collect();
        text += &format!("{},{},{:?},{},{:?}\n", row.update, row.rollouts, row.total, terms.join(","), row.exploration);
    }
    text
}

/// Reads `learning.csv`.
pub fn read_learning(text: &str) -> io::Result<Vec<LearningRow>> {
    refuse_cut(text)?;
    let mut rows = Vec::new();
    for record in csv::Reader::from_reader(text.as_bytes()).deserialize::<Vec<f64>>() {
        let record = record.map_err(io::Error::other)?;
        let [update, rollouts, total, terms @ .., exploration] = record.as_slice() else {
            return Err(bad("a row of learning.csv is too short"));
        };
        // Version 0.1 had no cost of rest.
        if terms.len() != Term::ALL.len() && terms.len() != Term::Rest as usize {
            return Err(bad("learning.csv has other cost terms than this version"));
        }
        let mut terms = terms.to_vec();
        terms.resize(Term::ALL.len(), 0.0);
        rows.push(LearningRow {
            update: *update as usize,
            rollouts: *rollouts as usize,
            total: *total,
            terms,
            exploration: *exploration,
        });
    }
    if rows.is_empty() { Err(bad("learning.csv has no row")) } else { Ok(rows) }
}

/// Signals of an axis with the ends of their column names, for the unit of the axis.
fn axis_columns(unit: Unit, axis: &mut AxisTrace) -> [(&'static str, &mut Vec<f64>); 7] {
    let names = match unit {
        Unit::M => [
            "reference_m",
            "reference_velocity_m_s",
            "position_m",
            "velocity_m_s",
            "force_n",
            "stiffness_n_m",
            "damping_n_s_m",
        ],
        Unit::Rad => [
            "reference_rad",
            "reference_velocity_rad_s",
            "position_rad",
            "velocity_rad_s",
            "torque_nm",
            "stiffness_nm_rad",
            "damping_nm_s_rad",
        ],
    };
    let [a, b, c, d, e, f, g] = names;
    [
        (a, &mut axis.reference_position),
        (b, &mut axis.reference_velocity),
        (c, &mut axis.position),
        (d, &mut axis.velocity),
        (e, &mut axis.force),
        (f, &mut axis.stiffness),
        (g, &mut axis.damping),
    ]
}

/// Every signal of a trace with its column name, in the order of `trajectory.csv`.
fn columns<'t>(task: &Task, trace: &'t mut Trace) -> Vec<(String, &'t mut Vec<f64>)> {
    let mut columns = vec![("time_s".to_owned(), &mut trace.time), ("phase".to_owned(), &mut trace.phase)];
    for (axis, signals) in task.axis.iter().zip(&mut trace.axes) {
        for (name, signal) in axis_columns(axis.unit, signals) {
            columns.push((format!("{}_{name}", axis.name), signal));
        }
    }
    if let Some(contact) = &mut trace.contact {
        columns.push(("deflection_m".to_owned(), &mut contact.deflection));
        columns.push(("deviation_m".to_owned(), &mut contact.deviation));
        columns.push(("contact_force_n".to_owned(), &mut contact.force));
    }
    columns
}

/// Every signal of a trace with the name of its column, in the order of `trajectory.csv`.
pub fn signals(task: &Task, trace: &Trace) -> Vec<(String, Vec<f64>)> {
    let mut trace = trace.clone();
    columns(task, &mut trace).into_iter().map(|(name, signal)| (name, core::mem::take(signal))).collect()
}

/// The text of `trajectory.csv` and of each snapshot: numbers read back to the same bits.
pub fn trajectory_csv(task: &Task, trace: &Trace) -> String {
    let mut trace = trace.clone();
    let columns = columns(task, &mut trace);
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    let mut text = names.join(",") + "\n";
    for row in 0..columns[0].1.len() {
        let numbers: Vec<String> = columns.iter().map(|(_, signal)| format!("{:?}", signal[row])).collect();
        text += &numbers.join(",");
        text.push('\n');
    }
    text
}

/// Reads `trajectory.csv` or a snapshot of `task`.
pub fn read_trajectory(task: &Task, text: &str) -> io::Result<Trace> {
    refuse_cut(text)?;
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let mut trace = Trace { axes: vec![AxisTrace::default(); task.axis.len()], ..Trace::default() };
    trace.contact = task.contact.as_ref().map(|contact| ContactTrace {
        axis: task.axis_index(contact.axis()).unwrap_or(0),
        set_point: contact.surface(0.0, 0.0).set_point,
        ..ContactTrace::default()
    });
    let mut columns = columns(task, &mut trace);
    let header = reader.headers().map_err(io::Error::other)?.clone();
    if !header.iter().eq(columns.iter().map(|(name, _)| name.as_str())) {
        return Err(bad("the columns are not those of this task's trajectory"));
    }
    for record in reader.deserialize::<Vec<f64>>() {
        for ((_, signal), number) in columns.iter_mut().zip(record.map_err(io::Error::other)?) {
            signal.push(number);
        }
    }
    // A motion made by a process, or by an earlier version, ends at the duration.
    let (rows, samples) = (trace.time.len(), task.steps() + 1 + task.rest_steps());
    trace.rest_steps = rows.saturating_sub(task.steps() + 1);
    if rows != samples && rows != task.steps() + 1 {
        return Err(bad(other_rows(rows, samples)));
    }
    if let (Some(signals), Some(contact)) = (&mut trace.contact, &task.contact) {
        signals.travel = trace.time.iter().map(|time| contact.travel(time / task.duration)).collect();
    }
    Ok(trace)
}

/// The text of `beam.csv`, where the task has a beam: both curves along it.
pub fn beam_csv(task: &Task) -> Option<String> {
    let Some(Contact::Cantilever(beam)) = &task.contact else { return None };
    let mut text = "travel_m,tip_load_m,moving_load_m\n".to_owned();
    for i in 0..=100 {
        let x = beam.length * f64::from(i) / 100.0;
        let [tip, moving] = [Curve::TipLoad, Curve::MovingLoad].map(|curve| beam.deflection_of(curve, x));
        text += &format!("{x:?},{tip:?},{moving:?}\n");
    }
    Some(text)
}

/// A force table that moves into the run directory, so that the directory is complete in itself.
pub struct OwnTable {
    /// Its name there.
    pub name: String,
    /// Its rows.
    pub csv: String,
    /// The override that makes the task name it.
    pub change: String,
}

/// Gives every force table of `task` a name beside the task file of the run.
pub fn own_tables(task: &mut Task) -> Vec<OwnTable> {
    let mut tables = Vec::new();
    for (i, disturbance) in task.disturbance.iter_mut().enumerate() {
        if let Disturbance::Table(table) = disturbance {
            let name = format!("disturbance_{i}.csv");
            let rows = table.samples.rows().map(|(time, force)| format!("{time:?},{force:?}\n"));
            let csv = "time_s,force_n\n".to_owned() + &rows.collect::<String>();
            table.file.clone_from(&name);
            tables.push(OwnTable { change: format!("disturbance.{i}.file=\"{name}\""), name, csv });
        }
    }
    tables
}

impl From<&Progress> for LearningRow {
    fn from(progress: &Progress) -> Self {
        Self {
            update: progress.update,
            rollouts: progress.rollouts,
            total: progress.total,
            terms: progress.terms.clone(),
            exploration: progress.exploration,
        }
    }
}

impl Run {
    /// What learning the task from the policy `start` led to at its `best`.
    pub fn learned(
        loaded: &LoadedTask,
        start: Policy,
        simulation: &Simulation,
        best: &Progress,
        learning: Vec<LearningRow>,
        snapshots: Vec<(usize, Trace)>,
    ) -> Self {
        let mut policy = start.with_weights(&best.weights).expect("learned from this start");
        policy.provenance.task_sha256 = loaded.sha256();
        policy.provenance.updates = best.update;
        policy.provenance.cost = best.total;
        let trajectory = simulation.rollout(&best.weights);
        Self { task: loaded.task.clone(), policy, learning, trajectory, snapshots, demonstrations: Vec::new() }
    }

    /// Reads a run directory.
    ///
    /// # Errors
    /// [`Failure::Input`] that names what is there in place of a directory, or the file that is missing or damaged.
    pub fn load(directory: &Path) -> Result<Self, Failure> {
        if let Some(words) = nodes::in_the_place_of_a_folder(directory) {
            return Err(in_file(directory)(format!("this is {words}, a run directory is wanted")));
        }
        let task = read_task(&directory.join("task.toml"), &[])?.task;
        let policy = read_policy(&directory.join("policy.json"))?;
        let path = directory.join("learning.csv");
        let learning = read_learning(&read_text(&path)?).map_err(in_file(&path))?;
        let path = directory.join("trajectory.csv");
        let trajectory = read_trajectory(&task, &read_text(&path)?).map_err(in_file(&path))?;
        let mut snapshots = Vec::new();
        for &update in task.snapshots() {
            let path = directory.join("snapshots").join(format!("{update}.csv"));
            // A run that stopped early has not reached its later snapshots.
            if path.exists() {
                snapshots.push((update, read_trajectory(&task, &read_text(&path)?).map_err(in_file(&path))?));
            }
        }
        let path = directory.join(DEMONSTRATIONS);
        let demonstrations = if path.exists() {
            demonstrations::read(&task, &read_text(&path)?).map_err(in_file(&path))?
        } else {
            Vec::new()
        };
        Ok(Self { task, policy, learning, trajectory, snapshots, demonstrations })
    }
}
