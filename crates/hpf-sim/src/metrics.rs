//! What a motion is judged by: every target of `[accept]`, and the environment's own measures.

use crate::cost::Approach;
use crate::environment::Contact;
use crate::simulation::Simulation;
use crate::task::{Unit, ViaPoint};
use crate::trace::{AxisTrace, Trace};

/// How long a motion may take to settle before its contact force is judged, where the task does not say [s].
pub const SETTLING_TIME: f64 = 0.1;

/// The measure that is a mean over draws.
const MAX_COST: &str = "max_cost";
/// Measures that are root mean squares: over via points, over the rest time, and over draws.
const RMS_VIA_ERROR: &str = "rms_via_error";
const RMS_REST_ERROR: &str = "rms_rest_error";

/// The largest distance to the goal in the rest time.
pub const MAX_REST_ERROR: &str = "max_rest_error";

/// One measure of a motion, or of a policy over the draws of its motions.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    /// Its name: the key of its target in `[accept]` where it can have one.
    pub name: &'static str,
    /// Its unit; empty for a number without one.
    pub unit: &'static str,
    /// Its value.
    pub value: f64,
    /// The largest value that passes, where the task names one.
    pub target: Option<f64>,
}

impl Metric {
    /// Whether it passes; `None` without a target.
    pub fn pass(&self) -> Option<bool> {
        // A NaN passes nothing.
        self.target.map(|target| self.value <= target)
    }
}

/// A signal of an axis.
type Signal = fn(&AxisTrace) -> &[f64];

impl Simulation {
    /// All measures of one motion; of a policy, see [`Simulation::evaluate`].
    pub fn metrics(&self, trace: &Trace) -> Vec<Metric> {
        let accept = &self.task.accept;
        let rotary = self.task.axis.iter().any(|axis| axis.unit == Unit::Rad);
        let linear = self.task.axis.iter().any(|axis| axis.unit == Unit::M);
        // Where axes of both kinds come together, a distance over all of them has no unit.
        let [length, speed, stiffness, damping] = match (linear, rotary) {
            (true, false) => ["m", "m/s", "N/m", "N s/m"],
            (false, true) => ["rad", "rad/s", "N m/rad", "N m s/rad"],
            _ => [""; 4],
        };
        let steps = trace.steps();
        let metric = |name, unit, value, target| Metric { name, unit, value, target };
        let mut metrics = Vec::new();
        let distance = |target: &dyn Fn(usize) -> f64, position: &dyn Fn(usize) -> f64| {
            (0..trace.axes.len()).map(|a| (position(a) - target(a)).powi(2)).sum::<f64>().sqrt()
        };

        if let (Some(contact), Some(task_contact)) = (&trace.contact, &self.task.contact) {
            // A contact is along a linear axis, whatever the others are.
            let (length, force) = ("m", "N");
            let deviation = largest(contact.deviation[..=steps].iter().map(|deviation| deviation.abs()));
            metrics.push(metric("max_deviation", length, deviation, accept.max_deviation));
            let settling = accept.settling_time.unwrap_or(SETTLING_TIME).min(trace.time[steps]);
            let settled = trace.time.iter().zip(&contact.force[..=steps]).filter(|(time, _)| **time >= settling);
            let error = largest(settled.map(|(_, force)| (force - contact.set_point).abs()));
            metrics.push(metric("max_force_error", force, error, accept.max_force_error));
            let lost = contact.force[1..=steps].iter().filter(|force| **force <= 0.0).count() as f64 * trace.dt();
            metrics.push(metric("max_contact_loss", "s", lost, accept.max_contact_loss));
            if matches!(task_contact, Contact::Wall(_)) {
                metrics.push(metric("peak_contact_force", force, largest(contact.force.iter().copied()), None));
            }
        }
        if !self.task.via_point.is_empty() {
            let error = |via: &ViaPoint| match via.time {
                Some(time) => distance(&|a| via.position[a], &|a| trace.sample(&trace.axes[a].position, time)),
                None => Approach::nearest(via, trace).outside,
            };
            let errors: Vec<f64> = self.task.via_point.iter().map(error).collect();
            metrics.push(metric("max_via_error", length, largest(errors.iter().copied()), accept.max_via_error));
            if self.task.is_random() || accept.rms_via_error.is_some() {
                let square = errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64;
                metrics.push(metric(RMS_VIA_ERROR, length, square.sqrt(), accept.rms_via_error));
            }
        }
        let goal = distance(&|a| self.task.axis[a].goal, &|a| trace.axes[a].position[steps]);
        metrics.push(metric("max_goal_error", length, goal, accept.max_goal_error));
        let end_speed = distance(&|_| 0.0, &|a| trace.axes[a].velocity[steps]);
        metrics.push(metric("max_end_speed", speed, end_speed, accept.max_end_speed));
        if trace.rest_steps > 0 {
            let error = |i: usize| distance(&|a| self.task.axis[a].goal, &|a| trace.axes[a].position[i]);
            let errors = || (steps..trace.time.len()).map(error);
            metrics.push(metric(MAX_REST_ERROR, length, largest(errors()), accept.max_rest_error));
            if self.is_pushed_at_rest || accept.rms_rest_error.is_some() {
                let square = errors().map(|error| error * error).sum::<f64>() / (1 + trace.rest_steps) as f64;
                metrics.push(metric(RMS_REST_ERROR, length, square.sqrt(), accept.rms_rest_error));
            }
        }
        metrics.push(metric(MAX_COST, "", self.cost(trace).total(), accept.max_cost));

        let offsets = trace.axes.iter().flat_map(|axis| axis.position.iter().zip(&axis.reference_position));
        metrics.push(metric("peak_offset", length, largest(offsets.map(|(p, r)| (p - r).abs())), None));
        let gains: [(_, _, Signal); 2] = [
            (["stiffness_min", "stiffness_max"], stiffness, |axis| &axis.stiffness),
            (["damping_min", "damping_max"], damping, |axis| &axis.damping),
        ];
        for ([min_name, max_name], unit, signal) in gains {
            let values = || trace.axes.iter().flat_map(signal).copied();
            metrics.push(metric(min_name, unit, -largest(values().map(|value| -value)), None));
            metrics.push(metric(max_name, unit, largest(values()), None));
        }
        metrics
    }
}

/// The measures of a policy from those of its motions, one set for each draw: of each measure the largest, the least of
/// a least one, the mean of the cost, and the root of the mean square where it is one.
pub(crate) fn over_draws(draws: Vec<Vec<Metric>>) -> Vec<Metric> {
    let count = draws.len() as f64;
    let mut draws = draws.into_iter();
    let mut metrics = draws.next().unwrap_or_default();
    let square = |name: &str| name == RMS_VIA_ERROR || name == RMS_REST_ERROR;
    for metric in metrics.iter_mut().filter(|metric| square(metric.name)) {
        metric.value *= metric.value;
    }
    for draw in draws {
        for (metric, Metric { value, .. }) in metrics.iter_mut().zip(draw) {
            metric.value = match metric.name {
                MAX_COST => metric.value + value,
                name if square(name) => metric.value + value * value,
                name if name.ends_with("_min") => -largest([-metric.value, -value].into_iter()),
                _ => largest([metric.value, value].into_iter()),
            };
        }
    }
    for metric in &mut metrics {
        metric.value = match metric.name {
            MAX_COST => metric.value / count,
            name if square(name) => (metric.value / count).sqrt(),
            _ => metric.value,
        };
    }
    metrics
}

/// The largest of some numbers; NaN if one of them is, or there is none.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.reduce(|most, value| if value.is_nan() || value > most { value } else { most }).unwrap_or(f64::NAN)
}
