//! What must hold of what is learned, measured and paid for.

use std::collections::HashSet;

use super::{Rules, count};
use crate::task::keys::unknown;
use crate::task::learning::PRIMITIVES;
use crate::task::{Method, PerAxis, ViaPoint};

/// Keys of `[learning]` that PI2 alone takes.
const OF_PI2: [&str; 8] =
    ["preset", "temperature", "credit", "exploration", "covariance", "projection", "anneal", "final_noise"];

impl Rules<'_, '_, '_> {
    /// The parts of an axis that are learned.
    pub(super) fn learned(&mut self) {
        let task = self.task;
        let axes: Vec<&str> = task.axis.iter().map(|axis| axis.name.as_str()).collect();
        let mut named = HashSet::new();
        for (i, part) in task.learning.learn.iter().enumerate() {
            let (axis, primitive) = part.split_once('.').map_or((None, part.as_str()), |(a, p)| (Some(a), p));
            let path = format!("learning.learn.{i}");
            if let Some(axis) = axis.filter(|axis| !axes.contains(axis)) {
                self.say(&path, format!("there is no axis `{axis}`"), format!("the axes are: {}", axes.join(", ")));
            } else if !PRIMITIVES.contains(&primitive) {
                let help = format!("one of: {}; of one axis: {}.{}", PRIMITIVES.join(", "), axes[0], PRIMITIVES[0]);
                self.say(&path, unknown("part", primitive, &PRIMITIVES), help);
            } else if !named.insert(part) {
                self.say(&path, format!("`{part}` is named twice"), "name each part once");
            }
        }
    }

    /// Limits of planned motions.
    pub(super) fn safety(&mut self) {
        let task = self.task;
        let Some(safety) = &task.learning.safety else { return };
        if task.learning.method != Method::Model {
            let message = format!("method \"{}\" makes motions that no model predicts", task.learning.method.name());
            let help = "[learning.safety] needs method = \"model\", whose motions are all planned";
            self.say("learning.safety", message, help);
        }
        let Some(workspace) = &safety.workspace else { return };
        let axes = task.axis.len();
        if workspace.len() != axes {
            let message = format!("{} for {}", count(workspace.len(), "range", "ranges"), count(axes, "axis", "axes"));
            self.say("learning.safety.workspace", message, "write one [smallest, largest] per axis, in axis order");
            return;
        }
        for (i, ([low, high], axis)) in workspace.iter().zip(&task.axis).enumerate() {
            for (what, position) in [("start", axis.start), ("goal", axis.goal)] {
                // Written so that a NaN is outside.
                if !(*low <= position && position <= *high) {
                    let message = format!("the {what} of axis `{}` lies outside the workspace: {position}", axis.name);
                    let help =
                        format!("`workspace` must hold start and goal: [smallest, largest], here [{low}, {high}]");
                    self.say(&format!("learning.safety.workspace.{i}"), message, help);
                    break;
                }
            }
        }
    }

    pub(super) fn via_points(&mut self) {
        for (i, via) in self.task.via_point.iter().enumerate() {
            if let Some(time) = via.time
                && self.task.duration > 0.0
                && time > self.task.duration
            {
                let message = format!("the via point at {time} s lies outside the movement");
                self.say(
                    &format!("via_point.{i}.time"),
                    message,
                    format!("`time` must lie after 0 s and no later than duration = {} s", self.task.duration),
                );
            }
            if via.time.is_some() && via.radius.is_some() {
                let help = "leave out `time` to pass it at any time, or `radius` to pass it at this time";
                self.say(&format!("via_point.{i}.radius"), "a `radius` beside a `time`", help);
            }
            let axes = self.task.axis.len();
            if via.position.len() != axes {
                let numbers = count(via.position.len(), "number", "numbers");
                let message = format!("a position with {numbers} for {}", count(axes, "axis", "axes"));
                self.say(&format!("via_point.{i}.position"), message, "write one number per axis, in axis order");
            }
        }
    }

    pub(super) fn cost_and_targets(&mut self) {
        let (task, cost) = (self.task, &self.task.cost);
        let weighs = |value: &PerAxis| value.values().iter().any(|&weight| weight > 0.0);
        let per_axis = [
            &cost.goal,
            &cost.end_velocity,
            &cost.rest,
            &cost.via_point,
            &cost.acceleration,
            &cost.stiffness,
            &cost.damping,
        ];
        let silent = |value: &PerAxis| value.values().iter().all(|&weight| weight == 0.0);
        // A process may tell costs of its own.
        if task.environment.is_none()
            && cost.tracking == 0.0
            && cost.contact_force == 0.0
            && cost.via_distance == 0.0
            && per_axis.into_iter().all(silent)
        {
            self.say(
                "cost",
                "no cost term has a weight: there is nothing to learn",
                "give at least one term of [cost] a weight above 0",
            );
        }
        if task.environment.is_some() {
            for (path, given) in [
                ("accept.max_rest_error", task.accept.max_rest_error.is_some()),
                ("accept.rms_rest_error", task.accept.rms_rest_error.is_some()),
            ] {
                if given {
                    let help = "motions of a process end at the duration: leave it out";
                    self.say(path, format!("`{path}` has nothing to measure"), help);
                }
            }
        }
        if task.contact.is_none() {
            let targets = [
                ("cost.tracking", cost.tracking > 0.0),
                ("cost.contact_force", cost.contact_force > 0.0),
                ("accept.max_deviation", task.accept.max_deviation.is_some()),
                ("accept.max_force_error", task.accept.max_force_error.is_some()),
                ("accept.settling_time", task.accept.settling_time.is_some()),
                ("accept.max_contact_loss", task.accept.max_contact_loss.is_some()),
            ];
            for (path, given) in targets {
                if given {
                    self.say(path, format!("`{path}` has nothing to measure"), "add a [contact], or leave it out");
                }
            }
        }
        let is_timed = |via: &ViaPoint| via.time.is_some();
        for (path, given, is_measured, article) in [
            ("cost.via_point", weighs(&cost.via_point), task.via_point.iter().any(is_timed), "with a"),
            ("cost.via_distance", cost.via_distance > 0.0, !task.via_point.iter().all(is_timed), "without a"),
        ] {
            if given && !is_measured {
                let help = format!("add a [[via_point]] {article} `time`, or leave it out");
                self.say(path, format!("`{path}` has nothing to measure"), help);
            }
        }
        if task.via_point.is_empty() {
            for (path, given) in [
                ("accept.max_via_error", task.accept.max_via_error.is_some()),
                ("accept.rms_via_error", task.accept.rms_via_error.is_some()),
            ] {
                if given {
                    self.say(path, format!("`{path}` has nothing to measure"), "add a [[via_point]], or leave it out");
                }
            }
        }
    }

    pub(super) fn learning(&mut self) {
        let learning = &self.task.learning;
        let is_given = |key: &str| self.document.span(&format!("learning.{key}")) != self.document.span("learning");
        if !is_given("method")
            && let Some(key) = OF_PI2.into_iter().find(|key| is_given(key))
        {
            let help = "say method = \"pi2\" too; with no method named it is \"auto\", which has nothing to set";
            self.say(&format!("learning.{key}"), format!("`{key}` is a setting of pi2, and no method is named"), help);
        }
        // What learns from a model plans one motion at a time.
        let first = if matches!(learning.method, Method::Auto | Method::Model) { 1 } else { learning.rollouts };
        let least = first.saturating_add(2).saturating_mul(self.task.draws());
        if learning.max_rollouts.is_some_and(|max| max < least) {
            let help = format!(
                "at least {least}: one motion before learning, {first} of the first update, one after it{}",
                if self.task.is_random() { ", each once for every draw" } else { "" }
            );
            self.say("learning.max_rollouts", "`max_rollouts` leaves no room for a single update", help);
        }
        let unmodelled = [
            (self.task.admittance.order != 1, "a law of order 1"),
            (self.task.is_random(), "a task without anything drawn at random"),
        ];
        for (_, wanted) in unmodelled.into_iter().filter(|(is_so, _)| *is_so && learning.method == Method::Model) {
            let help = "method = \"auto\" begins with what there is a model of";
            self.say("learning.method", format!("`model` learns {wanted} only"), help);
        }
        let mut kept = HashSet::new();
        for (i, &update) in self.task.snapshots().iter().enumerate() {
            if !kept.insert(update) {
                self.say(
                    &format!("output.snapshots.{i}"),
                    format!("update {update} is kept twice"),
                    "name each update once",
                );
            }
        }
    }
}
