//! What the real controller did in a run: a table by step, lines for the terminal, an object for programs.

use core::fmt::Write as _;

use hpf_core::controller::{Mode, Status};
use hpf_core::limits::Hits;
use hpf_sim::robot::{Conduct, Refusal, Settings, Tally, TimedRequest};
use hpf_sim::task::{Axis, Task, Unit};
use serde_json::{Value, json};

use crate::words::number;

/// A run of the controller: the motion that is shown, and counts over all motions.
pub struct Controlled {
    /// Its settings.
    pub settings: Settings,
    /// The text of the settings file, where there was one.
    pub text: Option<String>,
    /// Its behavior in the motion that is shown.
    pub conduct: Conduct,
    /// Its behavior in all motions that the measures are taken over.
    pub tally: Tally,
}

/// The name of a mode.
pub fn mode(mode: Mode) -> &'static str {
    match mode {
        Mode::Idle => "idle",
        Mode::Run => "run",
        Mode::Hold => "hold",
        Mode::Stop => "stop",
        Mode::Fault => "fault",
    }
}

/// Names of what is set, joined by `+`.
fn joined<const N: usize>(flags: [(bool, &str); N]) -> String {
    let set: Vec<&str> = flags.into_iter().filter_map(|(is_set, name)| is_set.then_some(name)).collect();
    set.join("+")
}

/// What has happened in a step, joined by `+`; whether a tare is possible is left out.
pub fn flags(status: &Status) -> String {
    joined([
        (status.ended, "ended"),
        (status.bad_time, "bad_time"),
        (status.long_time, "long_time"),
        (status.bad_force, "bad_force"),
        (status.force_lost, "force_lost"),
        (status.position_lost, "position_lost"),
        (status.rate_lost, "rate_lost"),
        (status.time_lost, "time_lost"),
        (status.bad_input, "bad_input"),
        (status.refused, "refused"),
        (status.force_tripped, "force_tripped"),
        (status.tracking_tripped, "tracking_tripped"),
        (status.energy_short, "energy_short"),
    ])
}

/// Which limits have cut a command, joined by `+`.
pub fn cut(hits: &Hits) -> String {
    let mut names = Tally::LIMITS.into_iter();
    joined(Tally::of(hits).map(|is_set| (is_set, names.next().unwrap_or_default())))
}

impl Controlled {
    /// The text of `controller.csv`: one row per step, at its end.
    pub fn csv(&self, task: &Task, time: &[f64]) -> String {
        let columns = |axis: &Axis| {
            let (name, unit) = (&axis.name, axis.unit.symbol());
            let force = if axis.unit == Unit::Rad { "torque_nm" } else { "force_n" };
            format!("{name}_limits,{name}_command_{unit},{name}_model_{force}")
        };
        let columns: Vec<String> = task.axis.iter().map(columns).collect();
        let mut text = format!("time_s,mode,rate,energy_j,port_energy_j,events,{}\n", columns.join(","));
        let conduct = &self.conduct;
        for (i, time) in time.iter().skip(1).enumerate() {
            let axes = conduct.hits[i].iter().zip(&conduct.command[i]).zip(&conduct.force[i]);
            let axes: Vec<String> =
                axes.map(|((hits, command), force)| format!("{},{command:?},{force:?}", cut(hits))).collect();
            let (mode, rate, events) = (mode(conduct.mode[i]), conduct.rate[i], flags(&conduct.status[i]));
            let (energy, port) = (conduct.energy[i], conduct.port_energy[i]);
            let _ = writeln!(text, "{time:?},{mode},{rate:?},{energy:?},{port:?},{events},{}", axes.join(","));
        }
        text
    }

    /// Times and modes they led to, of the motion that is shown.
    fn changes(&self, time: &[f64]) -> Vec<(f64, &'static str)> {
        self.conduct
            .changes()
            .into_iter()
            .map(|(step, to)| (time.get(step).copied().unwrap_or(0.0), mode(to)))
            .collect()
    }

    /// When the movement of the motion that is shown was at its end [s].
    fn end(&self, time: &[f64]) -> Option<f64> {
        self.conduct.end().and_then(|step| time.get(step + 1)).copied()
    }

    /// In how many steps the path was slower than asked for in the motion that is shown, and its least rate.
    fn slowed(&self, time: &[f64]) -> Option<(usize, f64)> {
        let asked = |time: f64| {
            let rates = self.settings.request.iter().filter_map(|request| match request {
                TimedRequest::Rate(at) if at.time <= time => Some((at.time, at.rate)),
                _ => None,
            });
            rates.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(1.0, |(_, rate)| rate)
        };
        let conduct = &self.conduct;
        let steps = conduct.rate.iter().zip(&conduct.mode).zip(&conduct.status).zip(time);
        let moving = steps.take_while(|(((_, mode), status), _)| **mode == Mode::Idle || !status.ended);
        let slow: Vec<f64> = moving
            .filter(|(((rate, mode), _), time)| **mode == Mode::Run && **rate < asked(**time) - 1e-9)
            .map(|(((rate, _), _), _)| *rate)
            .collect();
        Some((slow.len(), slow.iter().copied().reduce(f64::min)?))
    }

    /// When a request was made [s].
    fn asked_at(&self, refusal: &Refusal, time: &[f64]) -> f64 {
        time.get(refusal.step).copied().unwrap_or(0.0)
    }

    /// Why the measures, which go by the clock and the goal of the task, are not those of the movement itself.
    fn off_the_task(&self, task: &Task, time: &[f64]) -> Option<String> {
        let end = self.end(time);
        let mut reasons = Vec::new();
        if end.is_none_or(|end| (end - task.duration).abs() > 1.5 / task.rate) {
            reasons.push(end.map_or("the movement does not end".into(), |end| {
                format!("the movement ends at {} s, not {} s", number(end), number(task.duration))
            }));
        }
        if self.settings.request.iter().any(|request| matches!(request, TimedRequest::Goal(_))) {
            reasons.push("a request sets another goal".into());
        }
        (!reasons.is_empty()).then(|| reasons.join(", "))
    }

    /// Lines for the terminal.
    pub fn render(&self, task: &Task, time: &[f64]) -> String {
        let tally = &self.tally;
        let changes: Vec<String> =
            self.changes(time).into_iter().map(|(time, mode)| format!("{mode} at {} s", number(time))).collect();
        let mut text = format!("\ncontroller\n  modes          {}\n", changes.join(", "));
        if tally.motions > 1 {
            let _ = writeln!(
                text,
                "  motions        {}, {} ended, {} in stop, {} in fault",
                tally.motions, tally.ended, tally.stopped, tally.faulted
            );
        }
        if let Some(reasons) = self.off_the_task(task, time) {
            let _ = writeln!(text, "  measures       by the clock and the goal of the task: {reasons}");
        }
        let hits: Vec<String> = Tally::LIMITS
            .iter()
            .zip(tally.hits)
            .filter(|(_, steps)| *steps > 0)
            .map(|(name, steps)| format!("{name} in {steps} of {} steps", tally.steps))
            .collect();
        let _ = writeln!(
            text,
            "  limits         {}",
            if hits.is_empty() { "none was hit".into() } else { hits.join(", ") }
        );
        if let Some((steps, least)) = self.slowed(time) {
            let _ = writeln!(
                text,
                "  path           slower than asked for in {steps} of {} steps, at rate {} at least: by a ramp, a limit or the tank",
                self.conduct.rate.len(),
                number(least)
            );
        }
        if let Some(tank) = &self.settings.tank {
            let _ = writeln!(
                text,
                "  tank           at least {} of {} J, held back in {} step{}",
                number(tally.least_energy),
                number(tank.capacity),
                tally.short,
                if tally.short == 1 { "" } else { "s" }
            );
        }
        let [force, input, clock] = tally.bad;
        let counts = [
            ("bad force", "bad forces", force),
            ("bad input", "bad inputs", input),
            ("bad time", "bad times", clock),
            ("request refused", "requests refused", tally.refused),
            ("step above a trip level", "steps above a trip level", tally.trips),
            ("fault", "faults", tally.faults),
        ];
        let counts: Vec<String> = counts
            .iter()
            .filter(|(.., count)| *count > 0)
            .map(|(one, more, count)| format!("{count} {}", if *count == 1 { one } else { more }))
            .collect();
        let _ =
            writeln!(text, "  faults         {}", if counts.is_empty() { "none".into() } else { counts.join(", ") });
        for refusal in &self.conduct.refusals {
            let (time, Refusal { request, reason, .. }) = (self.asked_at(refusal, time), refusal);
            let _ = writeln!(text, "  refused        {request} at {} s: {reason}", number(time));
        }
        if tally.unasked > 0 {
            let _ = writeln!(text, "  requests       {} never made: the motion ends before", tally.unasked);
        }
        text
    }

    /// The same for programs.
    pub fn to_json(&self, time: &[f64]) -> Value {
        let tally = &self.tally;
        let changes = self.changes(time).into_iter().map(|(time, mode)| json!({ "time_s": time, "mode": mode }));
        let hits: serde_json::Map<String, Value> =
            Tally::LIMITS.iter().zip(tally.hits).map(|(name, steps)| ((*name).to_owned(), json!(steps))).collect();
        let refused = self.conduct.refusals.iter().map(|refusal| {
            let Refusal { request, reason, .. } = refusal;
            json!({ "time_s": self.asked_at(refusal, time), "request": request, "reason": reason })
        });
        let ([bad_force, bad_input, bad_time], end) = (tally.bad, self.end(time));
        json!({
            "modes": changes.collect::<Vec<_>>(), "end_s": end,
            "steps": tally.steps, "motions": tally.motions, "ended": tally.ended,
            "in_stop": tally.stopped, "in_fault": tally.faulted,
            "limited_steps": hits,
            "energy_short_steps": tally.short,
            "least_energy_j": self.settings.tank.as_ref().map(|_| tally.least_energy),
            "bad_forces": bad_force, "bad_inputs": bad_input, "bad_times": bad_time,
            "requests_refused": tally.refused, "refused": refused.collect::<Vec<_>>(), "requests_never_made": tally.unasked, "trips": tally.trips, "faults": tally.faults,
        })
    }
}
