//! `hpf.imitate`: recorded motions in, a policy that imitates them out.

use std::sync::Arc;

use hpf::failure::in_text;
use hpf::recordings::{self, Mapping};
use hpf::results::{LearningRow, Run};
use hpf::{Failure, Prepared, Trial, files, overrides, trial};
use hpf_sim::demonstration::{
    DampingFrom, DurationFrom, Fit, Follow, Imitation, Outline, ScaleBy, Smoothing, StiffnessFrom,
};
use hpf_sim::{Metric, Task};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors;
use crate::run::PyRun;
use crate::task::PyTask;

/// One of the `allowed`, by its name.
fn choice<T: Copy>(what: &str, name: &str, allowed: &[(&str, T)]) -> PyResult<T> {
    allowed.iter().find(|(word, _)| *word == name).map(|(_, value)| *value).ok_or_else(|| {
        let words: Vec<String> = allowed.iter().map(|(word, _)| format!("{word:?}")).collect();
        PyValueError::new_err(format!("{what} must be one of {}, not {name:?}", words.join(", ")))
    })
}

/// The options of `hpf.imitate`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Options {
    name: Option<String>,
    path: String,
    fit: String,
    smooth: Option<f64>,
    is_smoothed: bool,
    basis: usize,
    duration: Option<f64>,
    rate: Option<f64>,
    scaling: Option<String>,
    via_points: usize,
    stiffness_from: Option<String>,
    damping_from: Option<String>,
    stiffness: [f64; 3],
    damping: [f64; 3],
    damping_ratio: f64,
    mass: f64,
}

impl Options {
    fn follow(&self) -> PyResult<Follow> {
        choice("path", &self.path, &[("position", Follow::Position), ("reference", Follow::Reference)])
    }

    fn imitation(&self) -> PyResult<Imitation> {
        let stiffness = [
            ("columns", StiffnessFrom::Columns),
            ("spread", StiffnessFrom::Spread),
            ("emg", StiffnessFrom::Emg),
            ("force", StiffnessFrom::Force),
            ("constant", StiffnessFrom::Constant),
        ];
        let damping = [
            ("columns", DampingFrom::Columns),
            ("force", DampingFrom::Force),
            ("ratio", DampingFrom::Ratio),
            ("constant", DampingFrom::Constant),
        ];
        let of_stiffness = |name: &String| choice("stiffness_from", name, &stiffness);
        let of_damping = |name: &String| choice("damping_from", name, &damping);
        Ok(Imitation {
            follow: self.follow()?,
            fit: choice("fit", &self.fit, &[("ridge", Fit::Ridge), ("lwr", Fit::LocallyWeighted)])?,
            smoothing: match self.smooth {
                _ if !self.is_smoothed => Smoothing::Off,
                Some(cut_off) => Smoothing::CutOff(cut_off),
                None => Smoothing::default(),
            },
            stiffness: self.stiffness_from.as_ref().map(of_stiffness).transpose()?,
            damping: self.damping_from.as_ref().map(of_damping).transpose()?,
            damping_ratio: self.damping_ratio,
            mass: self.mass,
            ..Imitation::default()
        })
    }

    fn outline(&self, name: String) -> PyResult<Outline> {
        let scales = [("goal", ScaleBy::Goal), ("unit", ScaleBy::Unit), ("range", ScaleBy::Range)];
        Ok(Outline {
            name,
            follow: self.follow()?,
            duration: self.duration.map_or(DurationFrom::Mean, DurationFrom::Given),
            rate: self.rate,
            basis: self.basis,
            scaling: self.scaling.as_ref().map(|name| choice("scaling", name, &scales)).transpose()?,
            stiffness: self.stiffness,
            damping: self.damping,
            via_points: self.via_points,
            ..Outline::default()
        })
    }
}

/// The policy of the recordings `sources`, names and texts of tables and where they are cut [s], in `task` or in one made
/// for them.
///
/// # Errors
/// DemonstrationError and TaskError.
#[pyfunction]
pub fn _imitate(
    py: Python<'_>,
    sources: Vec<(String, String, Option<f64>)>,
    task: Option<&Bound<'_, PyTask>>,
    options: &Bound<'_, PyAny>,
) -> PyResult<PyRun> {
    let options: Options = options.extract()?;
    let (mut demonstrations, mut notes) = (Vec::new(), Vec::new());
    for (name, text, movement) in &sources {
        let read = recordings::read(text.as_bytes(), &Mapping::default());
        let read = read.map_err(|refusal| errors::of_recording(py, Some(name), &refusal.mistakes))?;
        let mut demonstration = read.recording;
        notes.extend(read.notes.into_iter().map(|note| format!("{name}: {note}")));
        if let Some(duration) = movement {
            demonstration.cut(*duration);
        }
        demonstrations.push(demonstration);
    }
    notes.extend(recordings::align_turns(&mut demonstrations));
    let refuse = |text: String| errors::plain(py, "DemonstrationError", &text);
    let prepared = match task {
        Some(task) => task.get().prepared.clone(),
        None => {
            if demonstrations.is_empty() {
                return Err(refuse("there is no demonstration".into()));
            }
            let outline = options.outline(options.name.clone().unwrap_or_else(|| "demonstration".into()))?;
            notes.extend(outline.note(&demonstrations));
            // As the program writes it, which applies its overrides.
            let text = overrides::apply(&outline.write(&demonstrations), &[]);
            let text = text.map_err(|failure| errors::of(py, &failure, "TaskError", None))?;
            let task = Task::parse(&text).map_err(in_text("the task of the demonstrations"));
            let task = task.map_err(|failure| errors::of(py, &failure, "TaskError", None))?;
            let loaded = files::LoadedTask { task, text, notes: Vec::new() };
            let prepared = Prepared::own(loaded);
            Arc::new(prepared.map_err(|failure| errors::of(py, &failure, "TaskError", None))?)
        }
    };
    let imitation = options.imitation()?;
    let loaded = &prepared.loaded;
    let made = py.detach(|| -> Result<Trial, String> {
        let imitated = imitation.of(&demonstrations, &loaded.task).map_err(|error| {
            let source = error.demonstration().and_then(|i| sources.get(i));
            let place = source.map_or(&loaded.task.name, |(name, ..)| name);
            format!("{place}: {error}")
        })?;
        notes.extend(imitated.notes.iter().cloned());
        let simulated = trial::simulate(imitated.policy.clone(), loaded);
        let Trial { run, mut summary } = simulated.map_err(|failure: Failure| failure.to_string())?;
        let Run { task, mut policy, learning, trajectory, .. } = run;
        policy.provenance.task_sha256 = files::sha256(&loaded.text);
        policy.provenance.cost = summary.last.0;
        summary.policy_sha256 = files::sha256(&policy.to_json());
        notes.extend(recordings::notes_outside(&imitated, &trajectory));
        let error = imitated.errors(&trajectory).iter().map(|error| error * error).sum::<f64>().sqrt();
        let units: Vec<&str> = task.axis.iter().map(|axis| axis.unit.symbol()).collect();
        let unit = if units.iter().all(|unit| *unit == units[0]) { units[0] } else { "" };
        summary.metrics.push(Metric { name: "demonstration_rmse", unit, value: error, target: None });
        (summary.method, summary.rollouts) = ("imitation", 1);
        summary.stopped_because = "a demonstration was fitted, nothing learned".into();
        let learning = learning.into_iter().map(|row| LearningRow { rollouts: 1, ..row }).collect();
        let demonstrations = imitated.demonstrations;
        Ok(Trial { run: Run { task, policy, learning, trajectory, snapshots: Vec::new(), demonstrations }, summary })
    });
    let trial = made.map_err(refuse)?;
    Ok(PyRun::in_memory(trial, prepared.clone(), Vec::new(), notes))
}
