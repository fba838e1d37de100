//! The price of a motion, term by term (the paper's Eq. 22-24).
//!
//! ```text
//! terminal:  1/2 W_goal |p(T) - g|^2 + 1/2 W_vel |v(T)|^2
//! rest:      1/2 W_rest [|p - g|^2 + t_r^2 |v|^2] dt            after T, over the rest time; t_r = T/10
//! once:      1/2 W_via |p(t_via) - p_via|^2                     for each via point with a time
//!            W_dist max(0, min_t |p(t) - p_via| - r)            for each via point without one
//! running:   1/2 [W_track (p - n)^2 + W_force (F_c - f_d)^2 + W_acc |a|^2 + W_stiff |k|^2 + W_damp |d|^2] dt
//! ```
//! p, v, a are the tool's actual motion, n the curve of the contact, F_c - f_d its force less the set-point (not in the
//! paper: near a clamp a large error of force hides in a small deviation). The rest term is not in the paper either: what
//! a skill does after its end is of interest to whoever stands beside it. Running terms are integrals, so a weight
//! means the same at any rate (the paper sums without dt). Signals at samples are integrated by the trapezoid rule; the
//! acceleration of a step is the change of velocity over it.
//!
//! Every term but one is a square, so the cost is `1/2 |rho|^2` of weighted signals rho and of what k and d cost: linear
//! in the weights, those need no measuring and are a quadratic form of the weights instead. A distance is told by the
//! offsets of all samples from the via point ([`Distance`]), which answer linearly to what moves them.

mod approach;
mod meter;

use hpf_learn::{Distance, SignalGroup};

use crate::task::{PerAxis, REST_VELOCITY_TIME, Task, ViaPoint};
use crate::trace::Trace;
pub(crate) use approach::Approach;
use meter::AxisPrices;
pub(crate) use meter::CostAccumulator;

/// A term of the cost; its name is its key in the task file, and its column in every table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// Distance to the goal at the end.
    Goal,
    /// Velocity at the end.
    EndVelocity,
    /// Distance to each via point, at its time or at the nearest.
    ViaPoint,
    /// Deviation from the curve of the contact.
    Tracking,
    /// Contact force away from its set-point.
    ContactForce,
    /// Acceleration.
    Acceleration,
    /// Stiffness.
    Stiffness,
    /// Damping.
    Damping,
    /// Distance to the goal and velocity in the rest time.
    Rest,
}

impl Term {
    /// All terms, in the order of every table.
    pub const ALL: [Self; 9] = [
        Self::Goal,
        Self::EndVelocity,
        Self::ViaPoint,
        Self::Tracking,
        Self::ContactForce,
        Self::Acceleration,
        Self::Stiffness,
        Self::Damping,
        Self::Rest,
    ];

    /// Names of all terms.
    pub const NAMES: [&str; 9] = [
        "goal",
        "end_velocity",
        "via_point",
        "tracking",
        "contact_force",
        "acceleration",
        "stiffness",
        "damping",
        "rest",
    ];
}

/// The weights of a task's cost, and what its terms measure against.
#[derive(Clone, Debug)]
pub(crate) struct CostModel {
    /// What one axis after the other is measured by, step by step.
    axes: Vec<AxisPrices>,
    goal: Vec<f64>,
    via: Vec<(f64, Vec<f64>)>,
    /// Via points that may be passed at any time, where their distance costs something.
    free_via: Vec<ViaPoint>,
    via_distance_weight: f64,
    goal_weight: Vec<f64>,
    end_velocity_weight: Vec<f64>,
    rest_weight: Vec<f64>,
    /// Steps of the rest time.
    rest_steps: usize,
    /// t_r [s].
    rest_velocity_time: f64,
    via_weight: Vec<f64>,
    tracking_weight: f64,
    contact_force_weight: f64,
    acceleration_weight: Vec<f64>,
    stiffness_weight: Vec<f64>,
    damping_weight: Vec<f64>,
}

impl CostModel {
    pub(crate) fn new(task: &Task) -> Self {
        let axes = task.axis.len();
        let spread = |value: &PerAxis| (0..axes).map(|i| value.of(i)).collect();
        let cost = &task.cost;
        let is_free = |via: &&ViaPoint| via.time.is_none() && cost.via_distance > 0.0;
        Self {
            axes: (0..axes).map(|a| AxisPrices::new(task, a)).collect(),
            goal: task.axis.iter().map(|axis| axis.goal).collect(),
            via: task.via_point.iter().filter_map(|via| Some((via.time?, via.position.clone()))).collect(),
            free_via: task.via_point.iter().filter(is_free).cloned().collect(),
            via_distance_weight: cost.via_distance,
            goal_weight: spread(&cost.goal),
            end_velocity_weight: spread(&cost.end_velocity),
            rest_weight: (0..axes).map(|a| task.rest_weight(a)).collect(),
            rest_steps: task.rest_steps(),
            rest_velocity_time: REST_VELOCITY_TIME * task.duration,
            via_weight: spread(&cost.via_point),
            tracking_weight: cost.tracking,
            contact_force_weight: cost.contact_force,
            acceleration_weight: spread(&cost.acceleration),
            stiffness_weight: spread(&cost.stiffness),
            damping_weight: spread(&cost.damping),
        }
    }
}

impl CostModel {
    /// Whether each axis has its own costs, so that they can be told axis by axis.
    pub(crate) fn is_by_axis(&self) -> bool {
        self.free_via.is_empty()
    }

    /// Whether rest costs something.
    pub(crate) fn weighs_rest(&self) -> bool {
        self.rest_weight.iter().any(|&weight| weight > 0.0)
    }

    /// Number of signals of axis `a` with `steps` steps, in contact or not.
    fn signal_count(&self, a: usize, steps: usize, contact: bool) -> usize {
        let along = |weight: f64, count: usize| if weight > 0.0 { count } else { 0 };
        let touching = along(self.tracking_weight, steps + 1) + along(self.contact_force_weight, steps + 1);
        2 + self.via.len()
            + self.free_via.len() * (steps + 1)
            + along(self.acceleration_weight[a], steps)
            + along(self.rest_weight[a], 2 * (self.rest_steps + 1))
            + if contact { touching } else { 0 }
    }

    /// The signals of each axis, given its number of parameters; `contact` is the axis that touches something.
    pub(crate) fn signal_groups(&self, parameters: &[usize], steps: usize, contact: Option<usize>) -> Vec<SignalGroup> {
        let (mut parameter, mut signal) = (0, 0);
        let group = |(a, count): (usize, &usize)| {
            let starts = (parameter, signal);
            parameter += count;
            signal += self.signal_count(a, steps, contact == Some(a));
            SignalGroup { parameters: starts.0..parameter, signals: starts.1..signal }
        };
        parameters.iter().enumerate().map(group).collect()
    }

    /// What an offset from a via point without a time is multiplied by: as squares, offsets of a metre would cost about
    /// what the distance costs.
    fn offset_scale(&self, steps: usize) -> f64 {
        (self.via_distance_weight / (steps + 1) as f64).sqrt()
    }

    /// The distances to the via points without a time, among the signals of `groups`.
    pub(crate) fn distances(&self, groups: &[SignalGroup], steps: usize) -> Vec<Distance> {
        let scale = self.offset_scale(steps);
        let distance = |(v, via): (usize, &ViaPoint)| Distance {
            weight: self.via_distance_weight / scale,
            radius: scale * via.radius.unwrap_or(0.0),
            offsets: groups
                .iter()
                .map(|group| group.signals.start + 2 + self.via.len() + v * (steps + 1))
                .map(|start| start..start + steps + 1)
                .collect(),
        };
        self.free_via.iter().enumerate().map(distance).collect()
    }

    /// Writes the signals of `trace`, axis by axis: half their squares, and the distances that some of them tell instead,
    /// are what it costs without stiffness and damping.
    pub(crate) fn signals(&self, trace: &Trace, signals: &mut Vec<f64>) {
        signals.clear();
        (0..trace.axes.len()).for_each(|a| self.axis_signals(a, trace, signals));
    }

    /// Appends the signals of axis `a`: each is an affine function of its position, its velocity, and deviation and force
    /// of its contact.
    pub(crate) fn axis_signals(&self, a: usize, trace: &Trace, signals: &mut Vec<f64>) {
        let (steps, dt) = (trace.steps(), trace.dt());
        let (axis, scale) = (&trace.axes[a], self.offset_scale(steps));
        signals.push(self.goal_weight[a].sqrt() * (axis.position[steps] - self.goal[a]));
        signals.push(self.end_velocity_weight[a].sqrt() * axis.velocity[steps]);
        for (time, position) in &self.via {
            let error = trace.sample(&axis.position, *time) - position[a];
            signals.push(self.via_weight[a].sqrt() * error);
        }
        for via in &self.free_via {
            signals.extend(axis.position[..=steps].iter().map(|position| scale * (position - via.position[a])));
        }
        let factor = (self.acceleration_weight[a] * dt).sqrt();
        if factor > 0.0 {
            signals.extend(axis.acceleration(dt).take(steps).map(|a| factor * a));
        }
        if self.rest_weight[a] > 0.0 {
            let time = self.rest_velocity_time;
            let samples = axis.position[steps..].iter().zip(&axis.velocity[steps..]).zip(trapezoid(trace.rest_steps));
            for ((position, velocity), share) in samples {
                let root = (self.rest_weight[a] * dt * share).sqrt();
                signals.extend([root * (position - self.goal[a]), root * time * velocity]);
            }
        }
        let Some(contact) = trace.contact.as_ref().filter(|contact| contact.axis == a) else { return };
        let roots: Vec<f64> = trapezoid(steps).map(|share| (share * dt).sqrt()).collect();
        if self.tracking_weight > 0.0 {
            let factor = self.tracking_weight.sqrt();
            signals.extend(contact.deviation.iter().zip(&roots).map(|(error, root)| factor * root * error));
        }
        if self.contact_force_weight > 0.0 {
            let factor = self.contact_force_weight.sqrt();
            let errors = contact.force.iter().map(|force| force - contact.set_point);
            signals.extend(errors.zip(&roots).map(|(error, root)| factor * root * error));
        }
    }

    /// What the weights of axis `a`'s stiffness and damping cost by themselves: the matrix Q of `1/2 w^T Q w`, from
    /// the basis functions at each sample, one row per sample.
    pub(crate) fn gain_prices(&self, a: usize, stiffness: &[&[f64]], damping: &[&[f64]], dt: f64) -> [Vec<f64>; 2] {
        let price = |weight: f64, rows: &[&[f64]]| {
            if weight == 0.0 {
                return Vec::new();
            }
            let count = rows[0].len();
            let mut matrix = vec![0.0; count * count];
            for (row, share) in rows.iter().zip(trapezoid(rows.len() - 1)) {
                for (i, phi) in row.iter().enumerate() {
                    for (slot, other) in matrix[i * count..].iter_mut().zip(*row) {
                        *slot += weight * dt * share * phi * other;
                    }
                }
            }
            matrix
        };
        [price(self.stiffness_weight[a], stiffness), price(self.damping_weight[a], damping)]
    }
}

/// Share of a step that each sample stands for: the trapezoid rule.
fn trapezoid(steps: usize) -> impl Iterator<Item = f64> {
    (0..=steps).map(move |i| if i == 0 || i == steps { 0.5 } else { 1.0 })
}
