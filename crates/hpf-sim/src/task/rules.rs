//! What must hold between the keys of a task file, beyond the type and range of each.

mod learning;

use core::fmt::Display;

use hpf_core::domain::{ALPHA, LARGEST, SMALLEST};

use super::keys::{Document, plain};
use super::{
    Diagnostic, Environment, Gain, MAX_AXES, MAX_MEMORY, MAX_NUMBERS, MAX_STEPS, MIN_GOAL_DISTANCE, NamedScaling,
    PerAxis, Scaling, Task, Unit, WHOLE_STEPS,
};
use crate::environment::{Contact, Distribution, Quantity};

/// Most steps that a reading may be old.
const MAX_DELAY_STEPS: f64 = 1000.0;

/// Appends every contradiction in `task` to `found`.
pub(super) fn check(task: &Task, document: &Document<'_>, found: &mut Vec<Diagnostic>) {
    let is_misspelt = found.iter().any(|diagnostic| diagnostic.message.starts_with("unknown key"));
    let mut rules = Rules { task, document, found };
    let named = rules.names();
    rules.steps();
    rules.per_axis();
    rules.domain();
    rules.gain("stiffness", &task.stiffness);
    rules.gain("damping", &task.damping);
    rules.scaling();
    rules.admittance();
    // Of too many axes, told already, nobody wants the list.
    if named && task.axis.len() <= MAX_AXES {
        rules.environment();
        rules.learned();
        rules.safety();
    }
    rules.via_points();
    // What a file lacks is told only where every key is known: a misspelt table would be told twice.
    if !is_misspelt {
        rules.cost_and_targets();
    }
    rules.process();
    rules.learning();
    rules.sizes();
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

    /// Whether every axis has a name of its own: where not, nobody can say which one a disturbance means.
    fn names(&mut self) -> bool {
        let is_file_name = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
        let name = &self.task.name;
        if name.is_empty() || name.len() > 100 || name.starts_with('.') || !name.chars().all(is_file_name) {
            let help = "1 to 100 letters, digits, `_`, `-` or `.`, the first not a dot: it names the run directory";
            self.say("name", format!("`{name}` cannot name a task"), help);
        }
        let before = self.found.len();
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
            } else if let Some(of) = name.strip_suffix("_reference").filter(|of| self.task.axis_index(of).is_some()) {
                let help = "tables have columns of the reference of every axis: rename one of the two";
                self.say(&path, format!("columns of `{name}` would be called like some of axis `{of}`"), help);
            } else if self.task.axis_index(name) != Some(i) {
                self.say(&path, format!("two axes are called `{name}`"), "give each axis a name of its own");
            }
        }
        self.found.len() == before
    }

    fn steps(&mut self) {
        let steps = self.task.duration * self.task.rate;
        // Out of range by itself: told already.
        if !(self.task.duration > 0.0 && self.task.rate > 0.0 && steps.is_finite()) {
            return;
        }
        let product = format!("{} s at {} Hz make", plain(self.task.duration), plain(self.task.rate));
        if steps > MAX_STEPS as f64 {
            let help = format!("duration times rate is the number of steps, at most {MAX_STEPS}");
            self.say("rate", format!("{product} {} steps", plain(steps.round())), help);
        } else if (steps - steps.round()).abs() > WHOLE_STEPS * steps {
            let near =
                [steps.floor().max(2.0), steps.floor().max(2.0) + 1.0].map(|steps| plain(steps / self.task.duration));
            let help = format!(
                "duration times rate is the number of steps and must be a whole number: the nearest rates are {} and {}",
                near[0], near[1]
            );
            self.say("rate", format!("{product} {steps} steps"), help);
        } else if steps.round() < 2.0 {
            let help = "duration times rate is the number of steps, at least 2";
            self.say("rate", format!("{product} only 1 step"), help);
        }
    }

    /// Lengths of per-axis arrays, and the sign of what cannot be negative.
    fn per_axis(&mut self) {
        let task = self.task;
        let mut values = vec![("movement.alpha", &task.movement.alpha, true)];
        if let Some(mass) = &task.admittance.mass {
            values.push(("admittance.mass", mass, true));
        }
        if let Some(safety) = &task.learning.safety {
            values.extend(safety.max_force.as_ref().map(|limit| ("learning.safety.max_force", limit, true)));
            values.extend(safety.max_velocity.as_ref().map(|limit| ("learning.safety.max_velocity", limit, true)));
        }
        if let Some(recording) = &task.recording {
            values.push(("recording.position_noise", &recording.position_noise, false));
            values.push(("recording.force_noise", &recording.force_noise, false));
        }
        if let Scaling::Given(given) = &task.movement.scaling {
            self.axis_count("movement.scaling.amplitude", &given.amplitude);
            for (i, _) in given.amplitude.values().iter().enumerate().filter(|(_, scale)| **scale == 0.0) {
                self.say(
                    &given.amplitude.place("movement.scaling.amplitude", i),
                    "a forcing scale of 0 leaves nothing to learn",
                    "`amplitude` must be a number other than 0",
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
            ("cost.rest", &cost.rest, false),
            ("cost.via_point", &cost.via_point, false),
            ("cost.acceleration", &cost.acceleration, false),
            ("cost.stiffness", &cost.stiffness, false),
            ("cost.damping", &cost.damping, false),
            ("learning.noise.movement", &task.learning.noise.movement, false),
            ("learning.noise.stiffness", &task.learning.noise.stiffness, false),
            ("learning.noise.damping", &task.learning.noise.damping, false),
            ("learning.noise.goal", &task.learning.noise.goal, false),
        ]);
        for (path, value, positive) in values {
            self.axis_count(path, value);
            let key = path.rsplit('.').next().unwrap_or(path);
            for (i, &number) in value.values().iter().enumerate() {
                let least = if positive { "above 0" } else { "at least 0" };
                if number < 0.0 || (positive && number == 0.0) {
                    let message = format!("`{key}` is out of range: {number}");
                    self.say(&value.place(path, i), message, format!("`{key}` must be {least}"));
                } else if positive {
                    let bounds = if path == "movement.alpha" { ALPHA } else { [SMALLEST, LARGEST] };
                    self.within(&value.place(path, i), key, number, bounds);
                }
            }
        }
    }

    /// A number that a controller could not work with.
    fn within(&mut self, path: &str, key: &str, number: f64, [least, most]: [f64; 2]) {
        // Not finite: told already.
        if number.is_finite() && !(least..=most).contains(&number) {
            let help = format!("`{key}` must lie between {} and {}", plain(least), plain(most));
            self.say(path, format!("`{key}` is out of range: {}", plain(number)), help);
        }
    }

    /// Bounds of the ends of the motion.
    fn domain(&mut self) {
        for (i, axis) in self.task.axis.iter().enumerate() {
            for (key, number) in [("start", axis.start), ("goal", axis.goal)] {
                self.within(&format!("axis.{i}.{key}"), key, number, [-LARGEST, LARGEST]);
            }
        }
    }

    fn axis_count(&mut self, path: &str, value: &PerAxis) {
        let axes = self.task.axis.len();
        if let PerAxis::Each(values) = value
            && values.len() != axes
        {
            let message = format!("{} for {}", count(values.len(), "value", "values"), count(axes, "axis", "axes"));
            self.say(path, message, "write one number for all axes, or an array with one per axis");
        }
    }

    fn gain(&mut self, name: &str, gain: &Gain) {
        let axes = self.task.axis.len();
        let refused = |value: &&PerAxis| {
            matches!(value, PerAxis::Each(values) if values.len() != axes) || value.values().iter().any(|&v| v <= 0.0)
        };
        if [&gain.min, &gain.max, &gain.initial].iter().any(refused) {
            return;
        }
        for (i, axis) in self.task.axis.iter().enumerate() {
            let (min, max, initial) = (gain.min.of(i), gain.max.of(i), gain.initial.of(i));
            if min > max {
                let message = format!("`min` is above `max` on axis `{}`: {min} > {max}", axis.name);
                let path = gain.min.place(&format!("{name}.min"), i);
                self.say(&path, message, format!("{name}.min must not be above {name}.max"));
                return;
            } else if !(min..=max).contains(&initial) {
                let message = format!("`initial` is outside its bounds on axis `{}`: {initial}", axis.name);
                let path = gain.initial.place(&format!("{name}.initial"), i);
                self.say(&path, message, format!("`initial` must lie between min = {min} and max = {max}"));
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
                    "goal scaling needs a goal away from the start, axis `{}` goes from {} to {}",
                    axis.name, axis.start, axis.goal
                );
                let help = format!(
                    "move them at least {MIN_GOAL_DISTANCE:e} apart, or set scaling = \"unit\" under [movement]"
                );
                self.say(&format!("axis.{i}.goal"), message, help);
            }
        }
    }

    fn admittance(&mut self) {
        let admittance = &self.task.admittance;
        match (admittance.order, &admittance.mass) {
            (2, None) => {
                let help = "add `mass`, one number for all axes or an array with one per axis";
                self.say("admittance.order", "a law of order 2 has a mass, and none is given", help);
            }
            (1, Some(_)) => {
                let help = "set order = 2, or leave `mass` out";
                self.say("admittance.mass", "a law of order 1 has no mass", help);
            }
            _ => {}
        }
    }

    fn environment(&mut self) {
        let names: Vec<&str> = self.task.axis.iter().map(|axis| axis.name.as_str()).collect();
        let disturbances =
            self.task.disturbance.iter().enumerate().map(|(i, d)| (format!("disturbance.{i}.axis"), d.axis()));
        let contact = self.task.contact.iter().map(|contact| ("contact.axis".to_owned(), contact.axis()));
        for (path, axis) in disturbances.chain(contact) {
            if !names.contains(&axis) {
                self.say(&path, format!("there is no axis `{axis}`"), format!("the axes are: {}", names.join(", ")));
            }
        }
        for (i, disturbance) in self.task.disturbance.iter().enumerate() {
            for (key, quantity) in disturbance.quantities() {
                self.quantity(&format!("disturbance.{i}.{key}"), key, quantity);
            }
        }
        if let Some(sensor) = &self.task.sensor {
            self.quantity("sensor.bias", "bias", &sensor.bias);
            let steps = sensor.delay * self.task.rate;
            if steps > MAX_DELAY_STEPS {
                let help = format!("at most {MAX_DELAY_STEPS} steps: a shorter delay, or a lower rate");
                self.say("sensor.delay", format!("a reading {} steps old", plain(steps.round())), help);
            }
        }
        if let Some(Contact::Cantilever(beam)) = &self.task.contact
            && beam.from >= beam.length
        {
            let help = format!("`from` must be less than `length`, {}", plain(beam.length));
            self.say("contact.from", "the tool starts beyond the tip", help);
        }
        let touched = self.task.contact.as_ref().and_then(|contact| self.task.axis_index(contact.axis()));
        if touched.is_some_and(|axis| self.task.axis[axis].unit == Unit::Rad) {
            self.say("contact.axis", "a contact on an axis in rad", "a contact is in m and N: name an axis in m");
        }
    }

    /// A number that may be drawn: every number it can be must be allowed.
    fn quantity(&mut self, path: &str, key: &str, quantity: &Quantity) {
        let (least, words, excludes) = match key {
            "period" | "length" => (0.0, "a number above 0", true),
            "start" => (0.0, "a number of at least 0", false),
            _ => (f64::NEG_INFINITY, "a number", false),
        };
        let refused = |number: &f64| *number < least || (excludes && *number == least);
        let numbers: Vec<(String, f64)> = match quantity {
            Quantity::Fixed(number) => vec![(path.to_owned(), *number)],
            Quantity::Drawn(Distribution::Uniform([low, high])) => {
                if low >= high {
                    let message = format!("`{key}` is drawn from an empty range: {low} to {high}");
                    self.say(&format!("{path}.uniform"), message, "uniform = [low, high], the first below the second");
                    return;
                }
                vec![(format!("{path}.uniform.0"), *low), (format!("{path}.uniform.1"), *high)]
            }
            Quantity::Drawn(Distribution::Normal([_, deviation])) => {
                let path = format!("{path}.normal");
                if *deviation < 0.0 {
                    let help = "normal = [mean, standard deviation], the second at least 0";
                    self.say(&format!("{path}.1"), format!("a standard deviation below 0: {deviation}"), help);
                } else if least.is_finite() {
                    let message = format!("`{key}` must be {words}, and a normal distribution has no bounds");
                    self.say(&path, message, format!("draw `{key}` from uniform = [low, high] or choice = [...]"));
                }
                return;
            }
            Quantity::Drawn(Distribution::Choice(values)) => {
                values.iter().enumerate().map(|(i, value)| (format!("{path}.choice.{i}"), *value)).collect()
            }
        };
        for (path, number) in numbers.iter().filter(|(_, number)| refused(number)) {
            self.say(path, format!("`{key}` is out of range: {number}"), format!("`{key}` must be {words}"));
        }
    }

    /// Tables that would not fit into memory.
    fn sizes(&mut self) {
        // More steps than are allowed are told already.
        if self.task.duration * self.task.rate > MAX_STEPS as f64 {
            return;
        }
        if let Some(table) = self.task.too_large() {
            let message = format!("{} are {} numbers", table.what, plain(table.numbers));
            let help = format!(
                "at most {MAX_NUMBERS}, and {} GB of memory with the other tables: a lower rate, or fewer rollouts, \
                 basis functions or snapshots",
                MAX_MEMORY / 1e9
            );
            self.say(table.path, message, help);
        }
    }

    /// What hpf would simulate, in a task that a process runs.
    fn process(&mut self) {
        let task = self.task;
        let Some(Environment::Process(process)) = &task.environment else { return };
        if process.command.first().is_some_and(String::is_empty) {
            self.say("environment.command.0", "the name of the program is empty", "a program and its arguments");
        }
        for (path, given) in [
            ("disturbance", !task.disturbance.is_empty()),
            ("contact", task.contact.is_some()),
            ("sensor", task.sensor.is_some()),
            ("actuator", task.actuator.is_some()),
            ("recording", task.recording.is_some()),
            ("output.snapshots", !task.snapshots().is_empty()),
        ] {
            if given {
                let help = "the process is the environment: leave it out, or leave out [environment]";
                self.say(path, format!("`{path}` is simulated, and the rollouts of this task are not"), help);
            }
        }
    }
}

/// The path of the value of axis `i`: that of one number for all axes, or of its place in the array.
fn count(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}
