//! The data of a page: columns of 32-bit numbers in base 64, as few samples as the page has room for.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use hpf_sim::cost::Term;
use hpf_sim::{ContactTrace, Trace};

use super::{Exhibit, Map, Value, json};

/// Numbers of all traces of a page: 1.1 MB in base 64, where the core takes 1.4 MB.
const MOST_NUMBERS: usize = 200_000;
/// Rows of a learning curve.
const MOST_ROWS: usize = 500;
/// The largest policy that a page can be touched with [bytes].
const MOST_POLICY: usize = 100_000;
/// Most rows of the force tables of a task that can be moved by hand.
const MOST_TABLE_ROWS: usize = 10_000;

/// All of `exhibits`, as the scripts of the page read it.
pub(super) fn of(exhibits: &[Exhibit], command: &str) -> Value {
    let sizes = exhibits.iter().flat_map(traces).map(|trace| trace.time.len() * (7 * trace.axes.len() + 5));
    let stride = sizes.sum::<usize>().div_ceil(MOST_NUMBERS).max(1);
    let mut notes: Vec<String> = Vec::new();
    if stride > 1 {
        notes.push(format!("One sample in {stride} is shown; the tables of the runs have all of them."));
    }
    let runs: Vec<Value> = exhibits.iter().map(|exhibit| one(exhibit, stride, &mut notes)).collect();
    json!({
        "version": env!("CARGO_PKG_VERSION"), "command": command, "terms": Term::NAMES, "notes": notes, "runs": runs,
    })
}

/// The motions of an exhibit.
fn traces(exhibit: &Exhibit) -> impl Iterator<Item = &Trace> {
    let run = exhibit.run.iter();
    run.flat_map(|run| core::iter::once(&run.trajectory).chain(run.snapshots.iter().map(|(_, trace)| trace)))
}

fn one(exhibit: &Exhibit, stride: usize, notes: &mut Vec<String>) -> Value {
    notes.extend(exhibit.notes.iter().map(|note| format!("{}: {note}", exhibit.name)));
    let policy = exhibit.run.as_ref().map(|run| run.policy.to_json()).filter(|policy| {
        let is_small = policy.len() <= MOST_POLICY;
        if !is_small {
            notes.push(format!("{}: the policy is too large to be touched here.", exhibit.name));
        }
        is_small
    });
    let mut tables = exhibit.tables();
    if tables.values().filter_map(Value::as_array).map(Vec::len).sum::<usize>() > MOST_TABLE_ROWS {
        notes.push(format!("{}: the force tables are too large to be touched here.", exhibit.name));
        tables.clear();
    }
    let snapshots = exhibit.run.iter().flat_map(|run| &run.snapshots);
    let snapshots = snapshots.map(|(update, trace)| json!({ "update": update, "trace": packed(trace, stride) }));
    json!({
        "name": exhibit.name,
        "outline": exhibit.task.outline(),
        "task": exhibit.text,
        "tables": tables,
        "policy": policy,
        "summary": exhibit.summary,
        "learning": learning(exhibit),
        "trace": exhibit.run.as_ref().map(|run| packed(&run.trajectory, stride)),
        "snapshots": snapshots.collect::<Vec<_>>(),
        "commands": exhibit.commands,
    })
}

/// Motions made and total costs, where something was learned.
fn learning(exhibit: &Exhibit) -> Option<Value> {
    let rows = &exhibit.run.as_ref()?.learning;
    let stride = rows.len().div_ceil(MOST_ROWS).max(1);
    let is_kept = |i: &usize| i.is_multiple_of(stride) || i + 1 == rows.len();
    let kept = || (0..rows.len()).filter(is_kept);
    let rollouts: Vec<usize> = kept().map(|i| rows[i].rollouts).collect();
    let total: Vec<f64> = kept().map(|i| rows[i].total).collect();
    Some(json!({ "rollouts": rollouts, "total": total }))
}

/// Every `stride`th number and the last, as 32 bits each, smallest byte first, in base 64.
fn column(numbers: &[f64], stride: usize) -> String {
    let last = numbers.len().saturating_sub(1);
    let kept = numbers.iter().enumerate().filter(|(i, _)| i.is_multiple_of(stride) || *i == last);
    let bytes: Vec<u8> = kept.flat_map(|(_, number)| (*number as f32).to_le_bytes()).collect();
    BASE64_STANDARD.encode(bytes)
}

fn packed(trace: &Trace, stride: usize) -> Value {
    let column = |numbers: &[f64]| Value::String(column(numbers, stride));
    let axes = trace.axes.iter().map(|axis| {
        json!({
            "reference_position": column(&axis.reference_position),
            "reference_velocity": column(&axis.reference_velocity),
            "position": column(&axis.position),
            "velocity": column(&axis.velocity),
            "force": column(&axis.force),
            "stiffness": column(&axis.stiffness),
            "damping": column(&axis.damping),
        })
    });
    let contact = trace.contact.as_ref().map(|contact: &ContactTrace| {
        Map::from_iter([
            ("axis".to_owned(), json!(contact.axis)),
            ("set_point".to_owned(), json!(contact.set_point)),
            ("travel".to_owned(), column(&contact.travel)),
            ("deflection".to_owned(), column(&contact.deflection)),
            ("deviation".to_owned(), column(&contact.deviation)),
            ("force".to_owned(), column(&contact.force)),
        ])
    });
    json!({
        "time": column(&trace.time), "rest": trace.rest_steps / stride,
        "axes": axes.collect::<Vec<_>>(), "contact": contact,
    })
}
