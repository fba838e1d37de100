//! `summary.json`: the result of a run, for other programs.

use hpf_learn::{History, Progress, TerminationReason};
use hpf_sim::Metric;
use hpf_sim::cost::Term;
use serde_json::{Map, Value, json};

use crate::files::sha256;
use crate::results::Run;

/// The result of a run.
pub struct Summary {
    /// Name of the task.
    pub task: String,
    /// SHA-256 of the task as run.
    pub task_sha256: String,
    /// SHA-256 of policy.json.
    pub policy_sha256: String,
    /// The learning method; "simulation" where nothing was learned.
    pub method: &'static str,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Threads used.
    pub threads: usize,
    /// Updates made.
    pub updates: usize,
    /// The update that the policy comes from.
    pub best_update: usize,
    /// Motions made, evaluations included.
    pub rollouts: usize,
    /// Wall time of learning alone [s].
    pub learning_s: f64,
    /// Wall time of all [s].
    pub total_s: f64,
    /// Cost before learning, total and by term.
    pub initial: (f64, Vec<f64>),
    /// Cost of the policy, total and by term.
    pub last: (f64, Vec<f64>),
    /// Measures of the policy's motion.
    pub metrics: Vec<Metric>,
    /// Rollouts whose cost was not finite.
    pub rejected: usize,
    /// Why it ended.
    pub stopped_because: String,
}

impl Summary {
    /// The result of learning `run`, whose measures are `metrics` and which took `seconds` of learning and in
    /// all; `failure` is why it broke off, if it did.
    pub fn of_learning(
        run: &Run,
        history: &History,
        metrics: Vec<Metric>,
        seconds: [f64; 2],
        failure: Option<&str>,
    ) -> Self {
        let stopped_because = match (failure, history.stop) {
            (Some(reason), _) => reason.to_owned(),
            (None, TerminationReason::Updates) => "all updates were made".into(),
            (None, TerminationReason::Rollouts) => {
                let most = run.task.learning.max_rollouts.unwrap_or_default();
                format!("the next update would pass max_rollouts = {most}")
            }
            (None, TerminationReason::Requested) => "it was interrupted".into(),
            (None, TerminationReason::Exhausted(reason)) => reason.to_string(),
        };
        let cost = |progress: &Progress| (progress.total, progress.terms.clone());
        Self {
            task: run.task.name.clone(),
            task_sha256: run.policy.provenance.task_sha256.clone(),
            policy_sha256: sha256(&run.policy.to_json()),
            method: run.task.learning.method.name(),
            seed: run.task.learning.seed,
            threads: rayon::current_num_threads(),
            updates: history.updates,
            best_update: history.best.update,
            rollouts: history.rollouts,
            learning_s: seconds[0],
            total_s: seconds[1],
            initial: cost(&history.initial),
            last: cost(&history.best),
            metrics,
            rejected: history.rejected,
            stopped_because,
        }
    }

    /// Whether a target was missed.
    pub fn is_missed(&self) -> bool {
        self.metrics.iter().any(|metric| metric.pass() == Some(false))
    }

    /// The contents of `summary.json`.
    pub fn to_json(&self) -> Value {
        let cost = |(total, terms): &(f64, Vec<f64>)| {
            let mut object = Map::from_iter([("total".to_owned(), json!(total))]);
            object.extend(Term::NAMES.iter().zip(terms).map(|(name, value)| ((*name).to_owned(), json!(value))));
            object
        };
        let metrics = self.metrics.iter().map(|metric| {
            json!({
                "name": metric.name,
                "unit": metric.unit,
                "value": metric.value,
                "target": metric.target,
                "pass": metric.pass(),
            })
        });
        json!({
            "format": "hpf-summary",
            "version": 1,
            "task": self.task,
            "task_sha256": self.task_sha256,
            "policy_sha256": self.policy_sha256,
            "method": self.method,
            "seed": self.seed,
            "threads": self.threads,
            "updates": self.updates,
            "best_update": self.best_update,
            "rollouts_total": self.rollouts,
            "learning_s": self.learning_s,
            "total_s": self.total_s,
            "cost": { "initial": cost(&self.initial), "final": cost(&self.last) },
            "metrics": metrics.collect::<Vec<_>>(),
            "rejected_rollouts": self.rejected,
            "stopped_because": self.stopped_because,
        })
    }
}
