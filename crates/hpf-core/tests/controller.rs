//! The controller, promise by promise, with either family of bases and either law of giving way.

use crate::support::{DT, Family, Kind, Rig, skill};
use hpf_core::Real;
use hpf_core::admittance::step_offset;
use hpf_core::controller::{AxisOutput, Compliance, Controller, Event, Mode, Output, Request, Settings};
use hpf_core::passivity::EnergyTank;
use hpf_core::{Damping, Law};

type Arm = Rig<f64, 1>;

const MODES: [Mode; 5] = [Mode::Idle, Mode::Run, Mode::Hold, Mode::Stop, Mode::Fault];
const EVENTS: [Event; 7] =
    [Event::Start, Event::Hold, Event::Resume, Event::Stop, Event::Reset, Event::Tripped, Event::Lost];

#[test]
fn the_table_in_the_docs_is_the_table_in_the_code() {
    for text in [include_str!("../src/controller/mode.rs"), include_str!("../../../docs/embedding.md")] {
        let rows: Vec<Vec<&str>> = text
            .lines()
            .filter(|line| line.trim_start_matches("//! ").starts_with("| **"))
            .map(|line| line.split('|').map(|cell| cell.trim().trim_matches('*')).collect())
            .collect();
        assert_eq!(rows.len(), MODES.len());
        for (mode, row) in MODES.into_iter().zip(rows) {
            assert_eq!(format!("{mode:?}"), row[1]);
            for (event, cell) in EVENTS.into_iter().zip(&row[2..9]) {
                let after = mode.after(event).map_or("-".to_owned(), |mode| format!("{mode:?}"));
                assert_eq!(after, *cell, "{mode:?} on {event:?}");
            }
        }
    }
}

macro_rules! promises {
    ($name:ident, $family:ident, $law:expr) => {
        mod $name {
            use super::*;

            const KIND: Kind = Kind { family: Family::$family, law: $law };

            include!("controller/promises.rs");
            include!("controller/faults.rs");
        }
    };
}

promises!(phase_family, Phase, Law::FirstOrder);
promises!(time_family, Time, Law::FirstOrder);
promises!(second_order, Phase, Law::SecondOrder { mass: 0.5, damping: Damping::Primitive });
