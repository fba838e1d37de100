//! What the paper claims, where a figure or a table shows it: Li et al., Sensors 2024, 24(12), 3964.

use hpf_sim::environment::{Contact, cantilever::Curve};
use hpf_sim::task::Task;

/// The deviation that the paper claims for its cantilever [m].
pub const PAPER_DEVIATION: f64 = 0.15e-3;

/// The deviation that the paper claims for `task` [m], if it is on the paper's curve.
pub fn paper_deviation(task: &Task) -> Option<f64> {
    let is_paper_curve = matches!(&task.contact, Some(Contact::Cantilever(beam)) if beam.curve == Curve::TipLoad);
    is_paper_curve.then_some(PAPER_DEVIATION)
}

/// A value that others published for a measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Published {
    /// Where, in a few words.
    pub by: &'static str,
    /// The value, in the unit of the measure.
    pub value: f64,
}

/// What is published for the measure `name` of `task`, if anything is.
pub fn published(task: &Task, name: &str) -> Option<Published> {
    let deviation = paper_deviation(task).filter(|_| name == "max_deviation");
    deviation.map(|value| Published { by: "the paper", value })
}
