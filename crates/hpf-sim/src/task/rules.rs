//! What must hold between the keys of a task file, beyond the type and range of each.

use core::fmt::Display;

use super::keys::Document;
use super::{Diagnostic, Gain, MAX_STEPS, MIN_GOAL_DISTANCE, NamedScaling, PerAxis, Scaling, Task};

/// Appends every contradiction in `task` to `found`.
pub(super) fn check(task: &Task, document: &Document<'_>, found: &mut Vec<Diagnostic>) {
    let mut rules = Rules { task, document, found };
    rules.names();
    rules.steps();
    rules.per_axis();
    rules.gain("stiffness", &task.stiffness);
    rules.gain("damping", &task.damping);
    rules.scaling();
    rules.environment();
    rules.via_points();
    rules.cost_and_targets();
    rules.learning();
}

struct Rules<'t, 'd, 'f> {
    task: &'t Task,
    document: &'d Document<'d>,
    found: &'f mut Vec<Diagnostic>,
}

impl Rules<'_, '_, '_> {
    fn say(&mut self, path: &str, message: impl Display, help: impl Display) {
        let span = self.document.span(path);
        self.found.push(Diagnostic { span, message: message.to_string(), help: help.to_string() });
    }

    fn names(&mut self) {
        let is_file_name = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
        let name = &self.task.name;
        if name.is_empty() || name.len() > 100 || name.starts_with('.') || !name.chars().all(is_file_name) {
            let help = "1 to 100 letters, digits, `_`, `-` or `.`, the first not a dot: it names the run directory";
            self.say("name", format!("`{name}` cannot name a task"), help);
        }
        for (i, axis) in self.task.axis.iter().enumerate() {
            let path = format!("axis.{i}.name");
            let is_identifier = |c: char| c.is_ascii_alphanumeric() || c == '_';
            let name = &axis.name;
            if !name.starts_with(|c: char| c.is_ascii_alphabetic())
                || name.len() > 32
                || !name.chars().all(is_identifier)
            {
                self.say(
                    &path,
                    format!("`{name}` cannot name an axis"),
                    "a letter, then up to 31 letters, digits or `_`",
                );
            } else if self.task.axis_index(name) != Some(i) {
                self.say(&path, format!("two axes are called `{name}`"), "give each axis a name of its own");
            }
        }
    }

    fn steps(&mut self) {
        let steps = self.task.duration * self.task.rate;
        let help = "duration times rate is the number of steps: a whole number";
        if steps > MAX_STEPS as f64 {
            let message = format!("{} s at {} Hz are {steps:.0} steps", self.task.duration, self.task.rate);
            self.say("rate", message, format!("at most {MAX_STEPS} steps are allowed"));
        } else if (steps - steps.round()).abs() > 1e-6 * steps {
            self.say("rate", format!("{} s at {} Hz are {steps} steps", self.task.duration, self.task.rate), help);
        } else if steps < 2.0 {
            self.say(
                "rate",
                format!("{} s at {} Hz are {steps:.0} steps", self.task.duration, self.task.rate),
                "at least 2 steps are needed",
            );
        }
    }

    /// Lengths of per-axis arrays, and the sign of what cannot be negative.
    fn per_axis(&mut self) {
        let task = self.task;
        let mut values = vec![("movement.alpha", &task.movement.alpha, true)];
        if let Scaling::Given(given) = &task.movement.scaling {
            self.axis_count("movement.scaling.amplitude", &given.amplitude);
            if given.amplitude.values().contains(&0.0) {
                self.say(
                    "movement.scaling.amplitude",
                    "a forcing scale of 0 leaves nothing to learn",
                    "a number other than 0",
                );
            }
        }
        for (path, gain) in [("stiffness", &task.stiffness), ("damping", &task.damping)] {
            let paths = match path {
                "stiffness" => ["stiffness.initial", "stiffness.min", "stiffness.max"],
                _ => ["damping.initial", "damping.min", "damping.max"],
            };
            values.extend(
                paths.into_iter().zip([&gain.initial, &gain.min, &gain.max]).map(|(path, gain)| (path, gain, true)),
            );
        }
        let cost = &task.cost;
        values.extend([
            ("cost.goal", &cost.goal, false),
            ("cost.end_velocity", &cost.end_velocity, false),
            ("cost.via_point", &cost.via_point, false),
            ("cost.acceleration", &cost.acceleration, false),
            ("cost.stiffness", &cost.stiffness, false),
            ("cost.damping", &cost.damping, false),
            ("learning.noise.movement", &task.learning.noise.movement, false),
            ("learning.noise.stiffness", &task.learning.noise.stiffness, false),
            ("learning.noise.damping", &task.learning.noise.damping, false),
        ]);
        for (path, value, positive) in values {
            self.axis_count(path, value);
            let key = path.rsplit('.').next().unwrap_or(path);
            for &number in value.values() {
                if positive && number <= 0.0 {
                    self.say(path, format!("`{key}` is out of range: {number}"), format!("`{key}` must be above 0"));
                } else if number < 0.0 {
                    self.say(path, format!("`{key}` is out of range: {number}"), format!("`{key}` must be at least 0"));
                }
            }
        }
    }

    fn axis_count(&mut self, path: &str, value: &PerAxis) {
        let axes = self.task.axis.len();
        if let PerAxis::Each(values) = value
            && values.len() != axes
        {
            let message = format!("{} values for {axes} axes", values.len());
            self.say(path, message, "one number for all axes, or an array with one per axis");
        }
    }

    fn gain(&mut self, name: &str, gain: &Gain) {
        let axes = self.task.axis.len();
        if [&gain.min, &gain.max, &gain.initial].iter().any(|v| matches!(v, PerAxis::Each(v) if v.len() != axes)) {
            return;
        }
        for (i, axis) in self.task.axis.iter().enumerate() {
            let (min, max, initial) = (gain.min.of(i), gain.max.of(i), gain.initial.of(i));
            if min > max {
                let message = format!("`min` is above `max` on axis `{}`: {min} > {max}", axis.name);
                self.say(&format!("{name}.min"), message, format!("{name}.min must not be above {name}.max"));
                return;
            } else if !(min..=max).contains(&initial) {
                let message = format!("`initial` is outside its bounds on axis `{}`: {initial}", axis.name);
                self.say(&format!("{name}.initial"), message, format!("between {min} and {max}"));
                return;
            }
        }
    }

    fn scaling(&mut self) {
        if self.task.movement.scaling != Scaling::Named(NamedScaling::Goal) {
            return;
        }
        for (i, axis) in self.task.axis.iter().enumerate() {
            if (axis.goal - axis.start).abs() < MIN_GOAL_DISTANCE {
                let message = format!(
                    "goal scaling needs a goal away from the start, axis `{}` has {} -> {}",
                    axis.name, axis.start, axis.goal
                );
                let help = format!(
                    "at least {MIN_GOAL_DISTANCE:e} apart, or [movement] scaling = \"unit\" or {{ amplitude = ... }}"
                );
                self.say(&format!("axis.{i}.goal"), message, help);
            }
        }
    }

    fn environment(&mut self) {
        let names: Vec<&str> = self.task.axis.iter().map(|axis| axis.name.as_str()).collect();
        let disturbances =
            self.task.disturbance.iter().enumerate().map(|(i, d)| (format!("disturbance.{i}.axis"), d.axis()));
        let contact = self.task.contact.iter().map(|contact| ("contact.axis".to_owned(), contact.axis()));
        for (path, axis) in disturbances.chain(contact) {
            if !names.contains(&axis) {
                self.say(&path, format!("there is no axis `{axis}`"), format!("one of: {}", names.join(", ")));
            }
        }
    }

    fn via_points(&mut self) {
        for (i, via) in self.task.via_point.iter().enumerate() {
            if via.time > self.task.duration {
                let message = format!("the via point at {} s lies outside the movement", via.time);
                self.say(
                    &format!("via_point.{i}.time"),
                    message,
                    format!("after 0 s and no later than duration = {} s", self.task.duration),
                );
            }
            let axes = self.task.axis.len();
            if via.position.len() != axes {
                let message = format!("a position with {} numbers for {axes} axes", via.position.len());
                self.say(&format!("via_point.{i}.position"), message, "one number per axis, in axis order");
            }
        }
    }

    fn cost_and_targets(&mut self) {
        let (task, cost) = (self.task, &self.task.cost);
        let weighs = |value: &PerAxis| value.values().iter().any(|&weight| weight > 0.0);
        let per_axis =
            [&cost.goal, &cost.end_velocity, &cost.via_point, &cost.acceleration, &cost.stiffness, &cost.damping];
        if cost.tracking == 0.0 && cost.contact_force == 0.0 && !per_axis.into_iter().any(weighs) {
            self.say(
                "cost",
                "no cost term has a weight: there is nothing to learn",
                "give at least one term of [cost] a weight above 0",
            );
        }
        let no_contact = "it needs a [contact]";
        let no_via = "it needs a [[via_point]]";
        if task.contact.is_none() {
            let targets = [
                ("cost.tracking", cost.tracking > 0.0),
                ("cost.contact_force", cost.contact_force > 0.0),
                ("accept.max_deviation", task.accept.max_deviation.is_some()),
                ("accept.max_force_error", task.accept.max_force_error.is_some()),
                ("accept.max_contact_loss", task.accept.max_contact_loss.is_some()),
            ];
            for (path, given) in targets {
                if given {
                    self.say(path, format!("`{path}` has nothing to measure"), no_contact);
                }
            }
        }
        if task.via_point.is_empty() {
            for (path, given) in [
                ("cost.via_point", weighs(&cost.via_point)),
                ("accept.max_via_error", task.accept.max_via_error.is_some()),
            ] {
                if given {
                    self.say(path, format!("`{path}` has nothing to measure"), no_via);
                }
            }
        }
    }

    fn learning(&mut self) {
        let learning = &self.task.learning;
        let least = learning.rollouts + 2;
        if learning.max_rollouts.is_some_and(|max| max < least) {
            let help = format!(
                "at least {least}: a first look, one update of {} rollouts and a look at it",
                learning.rollouts
            );
            self.say("learning.max_rollouts", "not even one update fits", help);
        }
        for (i, &update) in self.task.output.snapshots.iter().enumerate() {
            if update > learning.updates {
                let help = format!("between 0 and learning.updates = {}", learning.updates);
                self.say(&format!("output.snapshots.{i}"), format!("there is no update {update} to keep"), help);
            }
        }
    }
}
