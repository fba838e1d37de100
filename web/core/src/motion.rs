//! Rollouts, as columns.

use hpf_sim::{Policy, Simulation, Trace};
use wasm_bindgen::JsError;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::refused;
use crate::task::WebTask;

/// A motion: one column per signal, one number per sample.
#[wasm_bindgen]
pub struct WebTrace {
    pub(crate) trace: Trace,
}

#[wasm_bindgen]
impl WebTrace {
    /// Time [s].
    pub fn time(&self) -> Vec<f64> {
        self.trace.time.clone()
    }

    /// Phase, 1 at the start.
    pub fn phase(&self) -> Vec<f64> {
        self.trace.phase.clone()
    }

    /// Steps after the duration.
    #[wasm_bindgen(js_name = restSteps)]
    pub fn rest_steps(&self) -> usize {
        self.trace.rest_steps
    }

    /// The signal `name` of an axis, named as in `AxisTrace` of hpf-sim; empty where there is none.
    pub fn axis(&self, axis: usize, name: &str) -> Vec<f64> {
        let Some(axis) = self.trace.axes.get(axis) else { return Vec::new() };
        let signal = match name {
            "reference_position" => &axis.reference_position,
            "reference_velocity" => &axis.reference_velocity,
            "position" => &axis.position,
            "velocity" => &axis.velocity,
            "force" => &axis.force,
            "stiffness" => &axis.stiffness,
            "damping" => &axis.damping,
            _ => return Vec::new(),
        };
        signal.clone()
    }

    /// The signal `name` of the contact, `travel`, `deflection`, `deviation` or `force`; empty where there is none.
    pub fn contact(&self, name: &str) -> Vec<f64> {
        let Some(contact) = &self.trace.contact else { return Vec::new() };
        let signal = match name {
            "travel" => &contact.travel,
            "deflection" => &contact.deflection,
            "deviation" => &contact.deviation,
            "force" => &contact.force,
            _ => return Vec::new(),
        };
        signal.clone()
    }
}

/// The motion of the policy in `policy` (JSON) in `task`, simulated.
///
/// # Errors
/// Where the policy is no policy, or not one of this task.
#[wasm_bindgen]
pub fn rollout(task: &WebTask, policy: &str) -> Result<WebTrace, JsError> {
    let policy = Policy::parse(policy).map_err(refused)?;
    let simulation = Simulation::new(&task.task, &policy).map_err(refused)?;
    Ok(WebTrace { trace: simulation.rollout(&simulation.parameters(&policy)) })
}
