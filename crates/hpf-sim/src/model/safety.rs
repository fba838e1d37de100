//! Limits that a planned motion has to keep, by what the model predicts and how far it has been off.
//!
//! ```text
//! |f| + 3 s_f <= max_force     y -+ 3 s_y within the workspace     |v| + 3 (s_f + k_max s_y)/d_min <= max_velocity
//! ```
//! s_f, s_y are the errors that the fit leaves, the noise of the record among them; those of the velocity follow from the
//! law. A motion that would go beyond is cut back toward the best one made until it does not.

use super::EnvironmentModel;
use super::inside::Inside;
use crate::task::Safety;

/// Errors of the fit that a prediction may be off by.
const DOUBT: f64 = 3.0;
/// Times that a way is halved in search of a motion within the limits.
const MOST_HALVINGS: i32 = 8;

impl EnvironmentModel {
    /// The longest part of the way from `anchor` to `weights` that stays within the limits; `None` where no part does.
    pub(super) fn within_limits(&self, anchor: &[f64], weights: Vec<f64>, inside: &Inside<'_>) -> Option<Vec<f64>> {
        let Some(safety) = &self.plant.simulation.task.learning.safety else { return Some(weights) };
        let part = |halvings: i32| -> Vec<f64> {
            let share = 0.5_f64.powi(halvings);
            anchor.iter().zip(&weights).map(|(a, w)| a + share * (w - a)).collect()
        };
        (0..MOST_HALVINGS).map(part).find(|weights| self.keeps(safety, weights, inside))
    }

    fn keeps(&self, safety: &Safety, weights: &[f64], inside: &Inside<'_>) -> bool {
        let simulation = &self.plant.simulation;
        (0..self.axes.len()).all(|a| {
            let [position, velocity, force] =
                inside.loads[a].roll(&simulation.planned(a, &weights[simulation.axis_parameters(a)]));
            let mut trace = simulation.blank_trace();
            inside.show(a, [&position, &velocity, &force], &mut trace);
            let pressed = match (simulation.touched(), trace.contact) {
                (Some((touched, _)), Some(contact)) if touched == a => contact.force,
                _ => force,
            };
            let [off_position, off_force] = self.axes[a].errors().map(|error| DOUBT * error);
            let [stiffness, damping] = simulation.softest(a);
            let off_velocity = (off_force + stiffness * off_position) / damping;
            let below = |signal: &[f64], off: f64, limit: Option<f64>| {
                limit.is_none_or(|limit| signal.iter().all(|x| x.abs() + off <= limit))
            };
            let [low, high] = safety.workspace.as_ref().map_or([f64::NEG_INFINITY, f64::INFINITY], |box_| box_[a]);
            below(&pressed, off_force, safety.max_force.as_ref().map(|limit| limit.of(a)))
                && below(&velocity, off_velocity, safety.max_velocity.as_ref().map(|limit| limit.of(a)))
                && position.iter().all(|y| y - off_position >= low && y + off_position <= high)
        })
    }
}
