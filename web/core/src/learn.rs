//! Learning, as `hpf learn` does it: the same session, the same policy to the byte.

use hpf_learn::{LearnError, LearningLoop, Progress, Session};
use hpf_sim::{Policy, Simulation};
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};
use wasm_bindgen::prelude::wasm_bindgen;
use wasm_bindgen::{JsError, JsValue};

use crate::motion::WebTrace;
use crate::refused;
use crate::task::WebTask;

/// What was learned.
#[wasm_bindgen]
pub struct WebLearned {
    policy: Policy,
    trace: hpf_sim::Trace,
    summary: Value,
}

#[wasm_bindgen]
impl WebLearned {
    /// The bytes of `policy.json`.
    pub fn policy(&self) -> String {
        self.policy.to_json()
    }

    /// Its motion.
    pub fn trace(&self) -> WebTrace {
        WebTrace { trace: self.trace.clone() }
    }

    /// Costs and measures, as JSON.
    pub fn summary(&self) -> String {
        self.summary.to_string()
    }
}

impl WebLearned {
    /// Learns `task`; `observe` sees every evaluation, with its motion where it is the best so far.
    ///
    /// # Errors
    /// Why the task cannot be learned.
    pub fn learn(task: &WebTask, mut observe: impl FnMut(&Progress, Option<&hpf_sim::Trace>)) -> Result<Self, String> {
        let text = &task.text;
        let task = &task.task;
        let start = Policy::initial(task).map_err(|error| error.to_string())?;
        let simulation = Simulation::new(task, &start).map_err(|error| error.to_string())?;
        let weights = simulation.starting_weights(&start).map_err(|error| error.to_string())?;
        let start = start.with_weights(&weights).map_err(|error| error.to_string())?;
        let (method, most) = (task.learning.method(), task.learning.max_rollouts);
        let session = Session::begin(&simulation, simulation.parameters(&start), &method, most);
        let mut learning = LearningLoop::new(&simulation, session.map_err(|error| error.to_string())?);
        let (mut best, mut failure) = (f64::INFINITY, None);
        let history = loop {
            match learning.advance() {
                Ok(Some(progress)) => {
                    let better = progress.total < best;
                    best = best.min(progress.total);
                    let trace = better.then(|| simulation.rollout(&progress.weights));
                    observe(&progress, trace.as_ref());
                }
                Ok(None) => break learning.session().history(),
                Err(LearnError::Update { reason, history }) => {
                    failure = Some(reason.to_string());
                    break *history;
                }
                Err(error) => return Err(error.to_string()),
            }
        };
        let mut policy = start.with_weights(&history.best.weights).map_err(|error| error.to_string())?;
        let digest = Sha256::digest(text.as_bytes());
        policy.provenance.task_sha256 = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        policy.provenance.updates = history.best.update;
        policy.provenance.cost = history.best.total;
        let measures = simulation.evaluate(&history.best.weights).1;
        let measures = measures.iter().map(|measure| {
            json!({
                "name": measure.name, "unit": measure.unit, "value": measure.value,
                "target": measure.target, "pass": measure.pass(),
            })
        });
        let cost = |progress: &Progress| json!({ "total": progress.total, "terms": progress.terms });
        let summary = json!({
            "method": task.learning.method.name(), "seed": task.learning.seed,
            "updates": history.updates, "best_update": history.best.update, "rollouts": history.rollouts,
            "initial": cost(&history.initial), "final": cost(&history.best),
            "metrics": measures.collect::<Vec<_>>(), "failure": failure,
        });
        Ok(Self { policy, trace: simulation.rollout(&history.best.weights), summary })
    }
}

/// Learns `task`. `observe` is called for every evaluation with its update, the motions made, its cost, and where it is
/// the best so far with the position of each axis at every sample, axis by axis.
///
/// # Errors
/// Why the task cannot be learned, or what `observe` threw.
#[wasm_bindgen]
pub fn learn(task: &WebTask, observe: &js_sys::Function) -> Result<WebLearned, JsError> {
    let mut thrown = None;
    let learned = WebLearned::learn(task, |progress, trace| {
        let path: Vec<f64> =
            trace.iter().flat_map(|trace| &trace.axes).flat_map(|axis| &axis.position).copied().collect();
        let path = trace.map_or(JsValue::NULL, |_| js_sys::Float64Array::from(path.as_slice()).into());
        let arguments = js_sys::Array::of4(
            &JsValue::from(progress.update as f64),
            &JsValue::from(progress.rollouts as f64),
            &JsValue::from(progress.total),
            &path,
        );
        if let Err(error) = observe.apply(&JsValue::NULL, &arguments) {
            thrown = Some(format!("{error:?}"));
        }
    });
    match thrown {
        Some(thrown) => Err(refused(thrown)),
        None => learned.map_err(refused),
    }
}
