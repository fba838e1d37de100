//! What a model reads of a motion: position and force of every axis, deviation and force of the contact.

use crate::simulation::Simulation;
use crate::trace::Trace;

/// A recorded motion.
pub(crate) struct Record<'m> {
    /// Position [m] and force [N] of each axis.
    pub(super) axes: Vec<[&'m [f64]; 2]>,
    /// Deviation [m] and force [N].
    pub(super) contact: Option<[&'m [f64]; 2]>,
}

/// Numbers of one motion.
pub(super) fn size(simulation: &Simulation) -> usize {
    let signals = 2 * simulation.axis_count() + 2 * usize::from(simulation.touched().is_some());
    signals * simulation.priced_samples()
}

/// Appends the first `samples` of the motion of `trace`.
pub(crate) fn flatten(trace: &Trace, samples: usize, motion: &mut Vec<f64>) {
    for axis in &trace.axes {
        motion.extend(&axis.position[..samples]);
        motion.extend(&axis.force[..samples]);
    }
    if let Some(contact) = &trace.contact {
        motion.extend(&contact.deviation[..samples]);
        motion.extend(&contact.force[..samples]);
    }
}

impl<'m> Record<'m> {
    /// What [`flatten`] wrote.
    pub(super) fn read(simulation: &Simulation, motion: &'m [f64]) -> Self {
        let samples = simulation.priced_samples();
        let mut signals = motion.chunks_exact(samples);
        let mut pair = || Some([signals.next()?, signals.next()?]);
        let axes = (0..simulation.axis_count()).filter_map(|_| pair()).collect();
        Self { axes, contact: pair() }
    }
}
