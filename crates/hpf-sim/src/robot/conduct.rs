//! What a controller did, besides moving the tool.

use hpf_core::controller::{Counters, Mode, Output, Status};
use hpf_core::limits::Hits;

/// What a controller did in one motion: one entry per step, and what it has counted.
#[derive(Clone, Debug, Default)]
pub struct Conduct {
    /// The mode after each step.
    pub mode: Vec<Mode>,
    /// Rate of time along the path in each step.
    pub rate: Vec<f64>,
    /// Energy in the tank after each step [J]; zero without one.
    pub energy: Vec<f64>,
    /// Energy at the port after each step [J]; zero without one.
    pub port_energy: Vec<f64>,
    /// What has happened in each step.
    pub status: Vec<Status>,
    /// Limits that have cut the command of each axis, by step, then by axis.
    pub hits: Vec<Vec<Hits>>,
    /// Command [axis unit] of each axis after each step, by step, then by axis.
    pub command: Vec<Vec<f64>>,
    /// Force [N] on each axis as the model saw it in each step, within its limit, by step, then by axis.
    pub force: Vec<Vec<f64>>,
    /// Requests that were refused, in their order.
    pub refusals: Vec<Refusal>,
    /// Requests whose time never came.
    pub unasked: usize,
    /// What was counted.
    pub counters: Counters,
}

/// A request that was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The step it was made in.
    pub step: usize,
    /// Its kind, as in the settings file.
    pub request: &'static str,
    /// Why it was refused.
    pub reason: String,
}

/// What a controller did over one motion, or over several, in numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Steps in all.
    pub steps: usize,
    /// Motions.
    pub motions: usize,
    /// Motions whose movement came to its end.
    pub ended: usize,
    /// Motions that ended in Stop.
    pub stopped: usize,
    /// Motions that ended in Fault.
    pub faulted: usize,
    /// Steps in which a limit has cut a command: force, offset, velocity, acceleration, workspace.
    pub hits: [usize; 5],
    /// Steps in which the tank held something back.
    pub short: usize,
    /// Least energy in the tank [J].
    pub least_energy: f64,
    /// Requests refused.
    pub refused: u64,
    /// Requests of a motion whose time never came, the most of any.
    pub unasked: usize,
    /// Steps with a bad force, a bad input, and a time that was bad or too long.
    pub bad: [u64; 3],
    /// Forces above their trip level and robots that did not follow.
    pub trips: u64,
    /// Entries into Fault.
    pub faults: u64,
}

impl Tally {
    /// What the hits are of, in their order.
    pub const LIMITS: [&'static str; 5] = ["force", "offset", "velocity", "acceleration", "position"];

    /// Which of the [`Tally::LIMITS`] were hit.
    pub fn of(hits: &Hits) -> [bool; 5] {
        [hits.force, hits.offset, hits.velocity, hits.acceleration, hits.position]
    }

    /// Adds what was done in another motion.
    pub fn add(&mut self, other: &Self) {
        let first = self.motions == 0;
        self.steps += other.steps;
        self.motions += other.motions;
        self.ended += other.ended;
        self.stopped += other.stopped;
        self.faulted += other.faulted;
        self.hits.iter_mut().zip(other.hits).for_each(|(sum, hits)| *sum += hits);
        self.short += other.short;
        self.least_energy = if first { other.least_energy } else { self.least_energy.min(other.least_energy) };
        self.refused += other.refused;
        self.unasked = self.unasked.max(other.unasked);
        self.bad.iter_mut().zip(other.bad).for_each(|(sum, bad)| *sum += bad);
        self.trips += other.trips;
        self.faults += other.faults;
    }
}

impl Conduct {
    /// Takes what a step came to.
    pub(crate) fn take<const D: usize>(&mut self, output: &Output<f64, D>) {
        self.mode.push(output.mode);
        self.rate.push(output.rate);
        self.energy.push(output.energy);
        self.port_energy.push(output.port_energy);
        self.status.push(output.status);
        self.hits.push(output.axes.iter().map(|axis| axis.hits).collect());
        self.command.push(output.axes.iter().map(|axis| axis.position).collect());
        self.force.push(output.axes.iter().map(|axis| axis.force).collect());
    }

    /// In numbers.
    pub fn tally(&self) -> Tally {
        let mut cut = [0; 5];
        for step in &self.hits {
            for (i, cut) in cut.iter_mut().enumerate() {
                *cut += usize::from(step.iter().any(|hits| Tally::of(hits)[i]));
            }
        }
        let (last, counters) = (self.mode.last(), &self.counters);
        Tally {
            steps: self.mode.len(),
            motions: 1,
            ended: usize::from(self.end().is_some()),
            stopped: usize::from(last == Some(&Mode::Stop)),
            faulted: usize::from(last == Some(&Mode::Fault)),
            hits: cut,
            short: self.status.iter().filter(|status| status.energy_short).count(),
            least_energy: self.energy.iter().copied().reduce(f64::min).unwrap_or(0.0),
            refused: counters.refused.into(),
            unasked: self.unasked,
            bad: [
                counters.bad_force.into(),
                counters.bad_input.into(),
                u64::from(counters.bad_time) + u64::from(counters.long_time),
            ],
            trips: counters.trips.into(),
            faults: counters.faults.into(),
        }
    }

    /// The step after which the movement was at its end.
    pub fn end(&self) -> Option<usize> {
        self.status.iter().position(|status| status.ended)
    }

    /// The modes in their order, each with the step after which it holds.
    pub fn changes(&self) -> Vec<(usize, Mode)> {
        let mut changes: Vec<(usize, Mode)> = Vec::new();
        for (step, &mode) in self.mode.iter().enumerate() {
            if changes.last().is_none_or(|(_, last)| *last != mode) {
                changes.push((step, mode));
            }
        }
        changes
    }
}
