//! The motions that figures compare: the kept ones, light to dark, and the learned one, strongest.

use hpf_sim::Trace;
use hpf_sim::task::{Axis, Unit};
use plotters::style::RGBColor;

use super::palette::{BLUE, GREY, Pen, tint};
use crate::results::Run;

/// Most earlier motions in one figure; of more, some are picked.
const MOST: usize = 8;

/// A motion and how it is drawn.
pub struct Motion<'r> {
    /// What the legend calls it.
    pub label: String,
    /// Its signals.
    pub trace: &'r Trace,
    /// Its line.
    pub pen: Pen,
}

/// The kept motions in the order of their updates, the learned one last.
pub fn motions(run: &Run) -> Vec<Motion<'_>> {
    // The learned motion often is the last one kept: drawn once.
    let kept: Vec<_> = run.snapshots.iter().filter(|(_, trace)| *trace != run.trajectory).collect();
    let shown = kept.len().min(MOST);
    let kept: Vec<_> = (0..shown).map(|i| kept[i * (kept.len() - 1) / (shown - 1).max(1)]).collect();
    let mut motions: Vec<Motion<'_>> = kept
        .iter()
        .enumerate()
        .map(|(i, (update, trace))| Motion {
            label: if *update == 0 { "initial".into() } else { format!("update {update}") },
            trace,
            pen: Pen::plain(shade(i, kept.len())),
        })
        .collect();
    motions.push(learned(run));
    motions
}

/// What a title says of motions that are drawn beside the learned one.
pub fn by_update(run: &Run) -> &'static str {
    if motions(run).len() > 1 { ", by update" } else { "" }
}

/// The motion before learning, where it was kept.
pub fn initial(run: &Run) -> Option<&Trace> {
    run.snapshots.iter().find(|(update, _)| *update == 0).map(|(_, trace)| trace)
}

/// Whether learning made the motion of `run`: a demonstration or a task alone makes others.
pub fn is_learned(run: &Run) -> bool {
    run.policy.provenance.updates > 0 || run.learning.len() > 1
}

/// What a title adds about runs that all learned.
pub fn that_learned<'r>(mut runs: impl Iterator<Item = &'r Run>) -> &'static str {
    if runs.all(is_learned) { ", learned" } else { "" }
}

/// The motion of the policy: the learned one, where learning made it.
pub fn learned(run: &Run) -> Motion<'_> {
    let label = match run.policy.provenance.updates {
        0 if !is_learned(run) => "motion".into(),
        0 => "learned".into(),
        update => format!("learned, update {update}"),
    };
    Motion { label, trace: &run.trajectory, pen: Pen::strong(BLUE) }
}

/// The grey of the `i`th of `count` earlier motions: the later, the darker.
fn shade(i: usize, count: usize) -> RGBColor {
    let share = if count > 1 { i as f64 / (count - 1) as f64 } else { 0.0 };
    tint(GREY, 0.45 + 0.8 * share)
}

/// Positions as they are shown: millimetres where metres would all be zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// What a position is multiplied by.
    pub factor: f64,
    /// Its unit then.
    pub unit: &'static str,
}

impl Length {
    /// Millimetres.
    pub const MM: Self = Self { factor: 1e3, unit: "mm" };

    /// What fits positions of `axis` up to `most`, whatever their sign.
    pub fn fitting(axis: &Axis, most: f64) -> Self {
        match axis.unit {
            Unit::M if most < 0.1 => Self::MM,
            Unit::M => Self { factor: 1.0, unit: "m" },
            Unit::Rad => Self { factor: 1.0, unit: "rad" },
        }
    }
}
