//! What an imitation adds to a run: its sources, and its distance from the demonstrations.

use core::fmt::Write as _;

use hpf_sim::demonstration::{DampingFrom, Imitated, StiffnessFrom};
use hpf_sim::task::Unit;
use serde_json::{Map, Value, json};

use super::Source;
use crate::render;
use hpf::results::Run;
use hpf::summary::Summary;

use hpf::words::{self, number, typed};

/// What a policy was made of, for people and for programs.
pub struct Account {
    sources: Vec<(String, String)>,
    axes: Vec<AxisAccount>,
    notes: Vec<String>,
}

struct AxisAccount {
    name: String,
    unit: Unit,
    error: f64,
    spread: f64,
    /// The same after the recordings were carried to the task's start and goal.
    aligned: [f64; 2],
    stiffness: &'static str,
    damping: &'static str,
}

impl Account {
    /// The account of `imitated` from `sources`; `errors` is its distance from the demonstrations by axis, as they were
    /// recorded and as they are aligned, `notes` what the user should know.
    pub fn new(sources: &[Source], imitated: &Imitated, errors: &[Vec<f64>; 2], notes: Vec<String>) -> Self {
        let [spread, aligned] = [imitated.spread(), imitated.aligned_spread()];
        let axes = imitated.policy.axes.iter().enumerate().map(|(a, axis)| AxisAccount {
            name: axis.name.clone(),
            unit: axis.unit,
            error: errors[0][a],
            spread: spread[a],
            aligned: [errors[1][a], aligned[a]],
            stiffness: match imitated.stiffness[a] {
                StiffnessFrom::Columns => "columns",
                StiffnessFrom::Spread => "spread",
                StiffnessFrom::Emg => "emg",
                StiffnessFrom::Force => "force",
                StiffnessFrom::Constant => "constant",
            },
            damping: match imitated.damping[a] {
                DampingFrom::Columns => "columns",
                DampingFrom::Force => "force",
                DampingFrom::Ratio => "ratio",
                DampingFrom::Constant => "constant",
            },
        });
        Self {
            sources: sources.iter().map(|source| (source.path.display().to_string(), source.sha256.clone())).collect(),
            axes: axes.collect(),
            notes,
        }
    }

    /// `summary` with the account under `imitation`.
    pub fn in_json(&self, mut summary: Value) -> Value {
        let axes = self.axes.iter().map(|axis| {
            let unit = axis.unit.symbol();
            let mut object = Map::new();
            object.insert("name".into(), json!(axis.name));
            object.insert(format!("rmse_{unit}"), json!(axis.error));
            object.insert(format!("spread_{unit}"), json!(axis.spread));
            object.insert(format!("aligned_rmse_{unit}"), json!(axis.aligned[0]));
            object.insert(format!("aligned_spread_{unit}"), json!(axis.aligned[1]));
            object.insert("stiffness_from".into(), json!(axis.stiffness));
            object.insert("damping_from".into(), json!(axis.damping));
            Value::Object(object)
        });
        let files = self.sources.iter().map(|(file, sha256)| json!({ "file": file, "sha256": sha256 }));
        summary["imitation"] = json!({
            "demonstrations": files.collect::<Vec<_>>(),
            "axes": axes.collect::<Vec<_>>(),
            "notes": self.notes,
        });
        summary
    }

    /// The result in the terminal.
    pub fn text(&self, run: &Run, summary: &Summary, folder: &str, files: &[String]) -> String {
        let task = &run.task;
        let count = self.sources.len();
        let mut text = format!(
            "{}: a policy of {} s from {count} demonstration{}, {} steps at {} Hz\n",
            task.name,
            task.duration,
            if count == 1 { "" } else { "s" },
            task.steps(),
            task.rate
        );
        for note in &self.notes {
            let _ = writeln!(text, "note: {note}");
        }
        let _ =
            writeln!(text, "\n{:<8} {:>14} {:>14}   {:<14} damping from", "axis", "RMSE", "spread", "stiffness from");
        for axis in &self.axes {
            let unit = axis.unit.symbol();
            let _ = writeln!(
                text,
                "{:<8} {:>14} {:>14}   {:<14} {}",
                axis.name,
                words::measure(axis.error, unit),
                if count == 1 { "-".into() } else { words::measure(axis.spread, unit) },
                axis.stiffness,
                axis.damping
            );
        }
        // Shown where it makes a difference: an axis that starts or ends elsewhere than its recordings.
        let differs = |axis: &&AxisAccount| {
            let far = |a: f64, b: f64| (a - b).abs() > 0.1 * a.max(b);
            far(axis.error, axis.aligned[0]) || far(axis.spread, axis.aligned[1])
        };
        for axis in self.axes.iter().filter(differs) {
            let unit = axis.unit.symbol();
            let [error, spread] = axis.aligned.map(|value| words::measure(value, unit));
            let spread = if count == 1 { String::new() } else { format!(", spread {spread}") };
            let _ = writeln!(text, "{}: brought to the policy's start and goal: RMSE {error}{spread}", axis.name);
        }
        let _ = write!(text, "\ncost {} in the task\n\n", number(summary.last.0));
        text += &render::metrics(run, &summary.metrics);
        let _ = write!(text, "\nwritten to {folder}:\n{}", render::wrapped(files));
        let [task, from, out] = ["/task.toml", "", "_learned"].map(|end| typed(format!("{folder}{end}")));
        let _ = write!(text, "\nnext: hpf learn {task} --from {from} --out {out}\n");
        text
    }
}
