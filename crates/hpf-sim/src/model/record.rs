//! What a model reads of a motion: position and force of every axis, deviation and force of the contact.

use crate::simulation::Simulation;

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

impl<'m> Record<'m> {
    /// What [`Simulation::motion_into`] wrote.
    pub(super) fn read(simulation: &Simulation, motion: &'m [f64]) -> Self {
        let samples = simulation.priced_samples();
        let mut signals = motion.chunks_exact(samples);
        let mut pair = || Some([signals.next()?, signals.next()?]);
        let axes = (0..simulation.axis_count()).filter_map(|_| pair()).collect();
        Self { axes, contact: pair() }
    }
}
