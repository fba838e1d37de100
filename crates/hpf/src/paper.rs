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
