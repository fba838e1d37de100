//! Results in the terminal: a few readable lines.

use core::fmt::Write as _;

use hpf_core::passivity::Case;
use hpf_sim::cost::Term;
use hpf_sim::task::{Environment, Gain, Task, Unit};
use hpf_sim::{AxisTrace, Certificate, Conditions, Metric, Policy};
use serde_json::Value;

use hpf::escape::line;
use hpf::paper::published;
use hpf::results::Run;
use hpf::summary::Summary;
use hpf::words::{measure, number};

/// Cost by term before and after, terms that stay zero left out.
pub fn costs(summary: &Summary) -> String {
    let mut text = format!("{:<16} {:>12} {:>12}\n", "cost", "before", "after");
    let ((before, initial), (after, last)) = (&summary.initial, &summary.last);
    for ((name, before), after) in Term::NAMES.iter().zip(initial).zip(last) {
        if *before != 0.0 || *after != 0.0 {
            let _ = writeln!(text, "  {name:<14} {:>12} {:>12}", number(*before), number(*after));
        }
    }
    let _ = writeln!(text, "  {:<14} {:>12} {:>12}", "total", number(*before), number(*after));
    text
}

/// Measures of a run with their targets, ranges of stiffness and damping last.
pub fn metrics(run: &Run, metrics: &[Metric]) -> String {
    let task = &run.task;
    let mut text = format!("{:<20} {:>14}   {}\n", "measure", "value", "target");
    for metric in
        metrics.iter().filter(|metric| !metric.name.starts_with("stiffness") && !metric.name.starts_with("damping"))
    {
        let _ = write!(text, "  {:<18} {:>14}", metric.name, measure(metric.value, metric.unit));
        if let (Some(target), Some(pass)) = (metric.target, metric.pass()) {
            let verdict = if pass { "pass" } else { "MISSED" };
            let _ = write!(text, "   {verdict}, at most {}", measure(target, metric.unit));
        }
        if let Some(published) = published(task, metric.name) {
            let _ = write!(text, " ({}: {})", published.by, measure(published.value, metric.unit));
        }
        text.push('\n');
    }
    type Signal = fn(&AxisTrace) -> &[f64];
    let gains: [(_, _, Signal); 2] =
        [("stiffness", &task.stiffness, |axis| &axis.stiffness), ("damping", &task.damping, |axis| &axis.damping)];
    for (name, gain, signal) in gains {
        text += &gain_lines(task, name, gain, run.trajectory.axes.iter().map(signal));
    }
    text
}

/// Ranges and bounds of a gain: in one line where all axes have the same, else by axis.
fn gain_lines<'t>(task: &Task, name: &str, gain: &Gain, signals: impl Iterator<Item = &'t [f64]>) -> String {
    let line = |(a, signal): (usize, &[f64])| {
        let unit = match (task.axis[a].unit, name) {
            (Unit::M, "stiffness") => "N/m",
            (Unit::M, _) => "N s/m",
            (Unit::Rad, "stiffness") => "N m/rad",
            (Unit::Rad, _) => "N m s/rad",
        };
        let (low, high) = signal.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (v.min(l), v.max(h)));
        let range = format!("{} .. {}", number(low), measure(high, unit));
        format!("{range:>14}   bounds {} .. {}", number(gain.min.of(a)), number(gain.max.of(a)))
    };
    let lines: Vec<String> = signals.enumerate().map(line).collect();
    if lines.iter().all(|line| *line == lines[0]) {
        return lines.first().map_or(String::new(), |line| format!("  {name:<18} {line}\n"));
    }
    let named = task.axis.iter().map(|axis| format!("{name} {}", axis.name)).zip(&lines);
    named.map(|(name, line)| format!("  {name:<18} {line}\n")).collect()
}

/// All of a learned run.
pub fn learned(run: &Run, summary: &Summary, notes: &[String], folder: &str, files: &[String], next: &str) -> String {
    let mut text = format!(
        "{}: {} updates, {} motions, {:.2} s of learning ({:.2} s in all), seed {}; stopped because {}\n",
        summary.task,
        summary.updates,
        summary.rollouts,
        summary.learning_s,
        summary.total_s,
        summary.seed,
        summary.stopped_because
    );
    for note in notes {
        let _ = writeln!(text, "note: {note}");
    }
    if summary.rejected > 0 {
        let _ = writeln!(text, "{} rollouts had no finite cost and were left out", summary.rejected);
    }
    let _ = write!(text, "\n{}\n{}", costs(summary), metrics(run, &summary.metrics));
    let _ = write!(text, "\nwritten to {folder}:\n{}", wrapped(files));
    let _ = write!(text, "\nnext: {next}\n");
    text
}

/// A simulated policy.
pub fn simulated(run: &Run, summary: &Summary, folder: Option<&str>, files: &[String]) -> String {
    let mut text = format!("{} at {} Hz\n\n{:<16} {:>12}\n", summary.task, run.task.rate, "cost", "");
    for (name, value) in Term::NAMES.iter().zip(&summary.last.1).filter(|(_, value)| **value != 0.0) {
        let _ = writeln!(text, "  {name:<14} {:>12}", number(*value));
    }
    let _ = writeln!(text, "  {:<14} {:>12}\n", "total", number(summary.last.0));
    text += &metrics(run, &summary.metrics);
    if let Some(folder) = folder {
        let _ = write!(text, "\nwritten to {folder}:\n{}", wrapped(files));
    }
    text
}

/// The result for programs: the summary, and where its files are.
pub fn json(summary: &Summary, folder: Option<&str>, files: &[String]) -> String {
    finished(summary.to_json(), folder, files)
}

/// An object for programs, and where its files are.
pub fn finished(mut object: Value, folder: Option<&str>, files: &[String]) -> String {
    object["directory"] = folder.into();
    object["files"] = files.into();
    format!("{object:#}\n")
}

/// From what rate on a loop that measures its force can hold the contact of `task`.
pub fn least_rate(task: &Task) -> String {
    match task.least_rate() {
        Some(rate) => format!(
            "one that measures the contact's force holds it from {} Hz on, at the least damping",
            number(rounded_up(rate))
        ),
        None => "none that measures the contact's force holds it at the least damping, at any rate".into(),
    }
}

/// `rate` [Hz] in three digits that are enough; what its search has added makes no other.
fn rounded_up(rate: f64) -> f64 {
    let digit = 10.0_f64.powf(rate.log10().floor() - 2.0);
    (rate * (1.0 - 1e-6) / digit).ceil() * digit
}

/// The most motions of learning `task`.
pub fn planned_motions(task: &Task) -> usize {
    let learning = &task.learning;
    let motions = task.draws() * (1 + learning.updates * (learning.rollouts + 1));
    learning.max_rollouts.map_or(motions, |max| max.min(motions))
}

/// What a task holds.
pub fn task(task: &Task, parameters: usize, initial_cost: Option<f64>) -> String {
    let mut text = format!("{}: a valid task\n", task.name);
    let steps = task.steps();
    let _ = writeln!(text, "  motion      {} s at {} Hz, {steps} steps", task.duration, task.rate);
    match task.rest_steps() {
        0 => text += "  rest        motions of a process end at the duration: `cost.rest` counts for nothing\n",
        _ => _ = writeln!(text, "  rest        {} s after it", number(task.rest_time())),
    }
    for axis in &task.axis {
        let unit = axis.unit.symbol();
        let _ = writeln!(text, "  axis        {}: {} -> {} {unit}", axis.name, axis.start, axis.goal);
    }
    if let Some(Environment::Process(process)) = &task.environment {
        let _ = writeln!(text, "  process     {} of `{}`", process.workers, process.command.join(" "));
    }
    for disturbance in &task.disturbance {
        let _ = writeln!(text, "  force       {} on {}", disturbance.kind(), disturbance.axis());
    }
    if let Some(contact) = &task.contact {
        let _ = writeln!(text, "  contact     {} on {}", contact.kind(), contact.axis());
        let _ = writeln!(text, "  loop        {}", least_rate(task));
    }
    for via in &task.via_point {
        let when = match (via.time, via.radius.unwrap_or(0.0)) {
            (Some(time), _) => format!("at {time} s"),
            (None, radius) => format!("at any time, within {radius}"),
        };
        let _ = writeln!(text, "  via point   {:?} {when}", via.position);
    }
    let learning = &task.learning;
    let planned = planned_motions(task);
    let _ = writeln!(
        text,
        "  learning    {parameters} parameters, {} updates of {} rollouts, at most {planned} motions",
        learning.updates, learning.rollouts
    );
    let threads = rayon::current_num_threads();
    let _ = writeln!(text, "  memory      at most {} MB on {threads} threads", number(task.memory(threads) / 1e6));
    if let Some(cost) = initial_cost {
        let _ = writeln!(text, "  cost        {} before learning", number(cost));
    }
    text
}

/// What a policy is.
pub fn policy(policy: &Policy) -> String {
    let mut text = format!("{}: a valid policy, {} s\n", line(&policy.task), policy.duration_s);
    for axis in &policy.axes {
        let unit = axis.unit.symbol();
        let _ = writeln!(text, "  axis        {}: {} -> {} {unit}", line(&axis.name), axis.start, axis.goal);
        for (name, gain) in [("stiffness", &axis.stiffness), ("damping", &axis.damping)] {
            let range = gain.weights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |r, w| (r.0.min(*w), r.1.max(*w)));
            let _ = writeln!(
                text,
                "    {name:<9} {} .. {}, bounds {} .. {}",
                number(range.0),
                number(range.1),
                number(gain.min),
                number(gain.max)
            );
        }
        let counts = [axis.movement.weights.len(), axis.stiffness.weights.len(), axis.damping.weights.len()];
        let _ = writeln!(text, "    basis     {} movement, {} stiffness, {} damping", counts[0], counts[1], counts[2]);
    }
    let from = &policy.provenance;
    let _ = writeln!(
        text,
        "  learned     hpf {}, seed {}, {} updates, cost {}",
        line(&from.hpf),
        from.seed,
        from.updates,
        number(from.cost)
    );
    text
}

/// What each axis of a policy can do at worst.
pub fn certificates(policy: &Policy, conditions: &Conditions, certificates: &[Certificate]) -> String {
    let Conditions { rate, delay, load, lag, cutoff, contact: touched } = *conditions;
    let mut text = format!(
        "certificates, {}-order law at {} Hz, measured force {} ms late, over the movement and as long again at its goal\n",
        if policy.admittance.order == 2 { "second" } else { "first" },
        number(rate),
        number(delay * 1e3)
    );
    let masses = [touched.tool, touched.mass, touched.damping];
    if lag > 0.0 || cutoff.is_some() || masses.iter().any(|&value| value > 0.0) {
        let filter = cutoff.map_or("no filter".into(), |cutoff| format!("filter at {} Hz", number(cutoff)));
        let [tool, mass, damping] = masses.map(number);
        let _ = writeln!(
            text,
            "  robot {} ms behind its command, {filter}, tool {tool} kg, contact {mass} kg and {damping} N s/m",
            number(lag * 1e3)
        );
    }
    for (axis, certificate) in policy.axes.iter().zip(certificates) {
        let [unit, force, stiffness, damping] = match axis.unit {
            Unit::M => ["m", "N", "N/m", "N s/m"],
            Unit::Rad => ["rad", "N m", "N m/rad", "N m s/rad"],
        };
        let passive = match certificate.fails_at {
            None => "yes, from rest".into(),
            Some(time) => format!("NOT from {} s on: a tank has to guard it", number(time)),
        };
        let stable = match (policy.admittance.order, certificate.decay) {
            (1, _) => "yes, as every law of first order".into(),
            (_, Some(decay)) => format!("yes, a = {} 1/s proves it", number(decay)),
            (_, None) => "not proved: stiffness rises faster than damping can take".into(),
        };
        let (energy, offset) = (number(certificate.switched_energy), measure(certificate.largest_offset, unit));
        let held = if axis.unit == Unit::M { "kg" } else { "kg m^2" };
        let contact = match certificate.contact_case {
            Case::FreeAir => format!("none: a tool of {} {held} oscillates in free air already", number(touched.tool)),
            _ if certificate.contact_stiffness == 0.0 => {
                format!("none: {} {held} that move with the tool oscillate", number(touched.tool + touched.mass))
            }
            case => format!(
                "softer than {} {stiffness}{}, at {} s",
                number(certificate.contact_stiffness),
                match case {
                    Case::Behind => ", its mass behind its spring",
                    _ if touched.mass > 0.0 => ", its mass moving with the tool",
                    _ => "",
                },
                number(certificate.contact_at)
            ),
        };
        let (tool, safe) = (number(certificate.tool_mass), number(certificate.safe_tool_mass));
        let least = number(certificate.least_damping);
        let (velocity, acceleration) = (number(certificate.peak_velocity), number(certificate.peak_acceleration));
        let _ = writeln!(text, "  {}", line(&axis.name));
        let _ = writeln!(text, "    stable    {stable}");
        let _ = writeln!(text, "    passive   {passive}");
        let _ = writeln!(
            text,
            "    energy    at most {energy} J from rising stiffness, offset within {offset} (any force to {} {force})",
            number(load)
        );
        let _ = writeln!(
            text,
            "    tool      lighter than {tool} {held} behind the sensor; at any delay and lag, up to {safe} {held}"
        );
        let _ = writeln!(text, "    contact   {contact} (damping at least {least} {damping})");
        let _ = writeln!(text, "    reference at most {velocity} {unit}/s, {acceleration} {unit}/s^2");
        let rest = measure(certificate.rest_distance, unit);
        let _ = writeln!(text, "    rest      reference within {rest} of the goal after the end, where nothing pushes");
    }
    text
}

/// A summary read back from a run directory.
pub fn summary(summary: &Value) -> String {
    let text_of = |key: &str| line(summary[key].as_str().unwrap_or("?")).into_owned();
    let number_of = |value: &Value| value.as_f64().map_or("?".into(), number);
    let mut text = format!(
        "{}: {}, {} updates, {} motions, seed {}; stopped because {}\n\n{:<16} {:>12} {:>12}\n",
        text_of("task"),
        text_of("method"),
        summary["updates"],
        summary["rollouts_total"],
        summary["seed"],
        text_of("stopped_because"),
        "cost",
        "before",
        "after"
    );
    for (name, before) in summary["cost"]["initial"].as_object().into_iter().flatten() {
        let after = &summary["cost"]["final"][name];
        if before.as_f64() != Some(0.0) || after.as_f64() != Some(0.0) {
            let name = line(name);
            let _ = writeln!(text, "  {name:<14} {:>12} {:>12}", number_of(before), number_of(after));
        }
    }
    let _ = writeln!(text, "\n{:<20} {:>14}   target", "measure", "value");
    for metric in summary["metrics"].as_array().into_iter().flatten() {
        let unit = metric["unit"].as_str().unwrap_or_default();
        let show = |value: &Value| value.as_f64().map_or("?".into(), |value| measure(value, unit));
        let _ = write!(text, "  {:<18} {:>14}", line(metric["name"].as_str().unwrap_or("?")), show(&metric["value"]));
        if let Some(pass) = metric["pass"].as_bool() {
            let _ = write!(text, "   {}, at most {}", if pass { "pass" } else { "MISSED" }, show(&metric["target"]));
        }
        text.push('\n');
    }
    text
}

/// File names in lines of at most 100 letters.
pub fn wrapped(files: &[String]) -> String {
    let mut text = String::new();
    let mut line = String::new();
    for file in files {
        if line.len() + file.len() > 98 {
            let _ = writeln!(text, " {line}");
            line.clear();
        }
        let _ = write!(line, " {file}");
    }
    let _ = writeln!(text, " {line}");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_four_digits_that_count() {
        let cases = [
            (0.0, "0"),
            (12.0, "12.00"),
            (0.048_651, "0.04865"),
            (123_456.0, "123456"),
            (1e-9, "1.000e-9"),
            (9.999_99, "10.00"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
        assert_eq!(measure(1.005e-5, "m"), "0.01005 mm");
        assert_eq!(measure(0.3, "N"), "0.3000 N");
    }
}
