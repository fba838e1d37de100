//! Forces on the tool over time.

mod pulse;
mod ramp;
mod sine;
mod step;
mod table;

pub use pulse::Pulse;
pub use ramp::Ramp;
pub use sine::Sine;
pub use step::Step;
pub use table::{Samples, Table, TableError};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Quantity;

/// `[[disturbance]]`: a force of the environment on the tool.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Disturbance {
    /// Swings.
    Sine(Sine),
    /// Jumps, and stays.
    Step(Step),
    /// Jumps, and jumps back.
    Pulse(Pulse),
    /// Grows, and stays.
    Ramp(Ramp),
    /// Follows a table from a CSV file.
    Table(Table),
}

fn zero() -> Quantity {
    Quantity::Fixed(0.0)
}

/// On which side of a jump a force is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// As time comes near from before.
    Before,
    /// From then on.
    After,
}

/// Times this close count as the same [s]: step times are rounded products of a count and a step.
const SAME_TIME: f64 = 1e-9;

/// Whether a jump at `jump` [s] has happened at `time` [s], seen from `side`.
fn has_jumped(jump: f64, time: f64, side: Side) -> bool {
    match side {
        Side::Before => time > jump + SAME_TIME,
        Side::After => time >= jump - SAME_TIME,
    }
}

impl Disturbance {
    /// Its kind, as in the task file.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Sine(_) => "sine",
            Self::Step(_) => "step",
            Self::Pulse(_) => "pulse",
            Self::Ramp(_) => "ramp",
            Self::Table(_) => "table",
        }
    }

    /// The axis it acts on.
    pub fn axis(&self) -> &str {
        match self {
            Self::Sine(Sine { axis, .. })
            | Self::Step(Step { axis, .. })
            | Self::Pulse(Pulse { axis, .. })
            | Self::Ramp(Ramp { axis, .. })
            | Self::Table(Table { axis, .. }) => axis,
        }
    }

    /// Its numbers that may be drawn, each with its key.
    pub fn quantities(&self) -> Vec<(&'static str, &Quantity)> {
        match self {
            Self::Sine(Sine { amplitude, period, phase, length, .. }) => {
                let fixed = [("amplitude", amplitude), ("period", period), ("phase", phase)];
                fixed.into_iter().chain(length.iter().map(|length| ("length", length))).collect()
            }
            Self::Step(step) => vec![("amplitude", &step.amplitude), ("start", &step.start)],
            Self::Pulse(Pulse { amplitude, start, length, .. }) | Self::Ramp(Ramp { amplitude, start, length, .. }) => {
                vec![("amplitude", amplitude), ("start", start), ("length", length)]
            }
            Self::Table(_) => vec![],
        }
    }

    /// The disturbance of one motion: each number that is drawn, drawn by `draw`.
    #[must_use]
    pub fn drawn(&self, draw: &mut impl FnMut(&Quantity) -> f64) -> Self {
        let mut drawn = self.clone();
        let slots = match &mut drawn {
            Self::Sine(Sine { amplitude, period, phase, length, .. }) => {
                [amplitude, period, phase].into_iter().chain(length).collect()
            }
            Self::Step(step) => vec![&mut step.amplitude, &mut step.start],
            Self::Pulse(Pulse { amplitude, start, length, .. }) | Self::Ramp(Ramp { amplitude, start, length, .. }) => {
                vec![amplitude, start, length]
            }
            Self::Table(_) => vec![],
        };
        slots.into_iter().for_each(|slot| *slot = slot.drawn(draw));
        drawn
    }

    /// The force at `time` [s], on one side of it where it jumps [N]; what is not yet drawn counts as its mean.
    pub fn force(&self, time: f64, side: Side) -> f64 {
        match self {
            Self::Sine(sine) => sine.force(time, side),
            Self::Step(step) => step.force(time, side),
            Self::Pulse(pulse) => pulse.force(time, side),
            Self::Ramp(ramp) => ramp.force(time),
            Self::Table(table) => table.force(time),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pulse_jumps_up_and_down_and_a_step_stays() {
        let pulse = Pulse { axis: "x".into(), amplitude: 3.0.into(), start: 1.0.into(), length: 0.5.into() };
        let step = Step { axis: "x".into(), amplitude: 3.0.into(), start: 1.0.into() };
        for (time, side, during_pulse, after_step) in [
            (0.9, Side::After, 0.0, 0.0),
            (1.0, Side::Before, 0.0, 0.0),
            (1.0, Side::After, 3.0, 3.0),
            (1.2, Side::After, 3.0, 3.0),
            (1.5, Side::Before, 3.0, 3.0),
            (1.5, Side::After, 0.0, 3.0),
        ] {
            assert_eq!(pulse.force(time, side), during_pulse, "pulse at {time} {side:?}");
            assert_eq!(step.force(time, side), after_step, "step at {time} {side:?}");
        }
    }

    #[test]
    fn a_ramp_grows_between_its_ends() {
        let ramp = Ramp { axis: "x".into(), amplitude: 4.0.into(), start: 1.0.into(), length: 2.0.into() };
        assert_eq!([0.0, 1.0, 2.0, 3.0, 9.0].map(|time| ramp.force(time)), [0.0, 0.0, 2.0, 4.0, 4.0]);
    }

    #[test]
    fn a_sine_of_the_duration_pushes_then_pulls() {
        let mut sine =
            Sine { axis: "x".into(), amplitude: 10.0.into(), period: 5.0.into(), phase: 0.0.into(), length: None };
        let at = |sine: &Sine, time| sine.force(time, Side::After);
        assert!((at(&sine, 1.25) - 10.0).abs() < 1e-12 && (at(&sine, 3.75) + 10.0).abs() < 1e-12);
        assert!((at(&sine, 6.25) - 10.0).abs() < 1e-12, "for ever, where it has no length");
        sine.length = Some(6.0.into());
        assert!(sine.force(6.0, Side::Before) > 9.0 && at(&sine, 6.0) == 0.0 && at(&sine, 6.25) == 0.0);
    }
}
