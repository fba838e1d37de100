//! A rollout of all axes: time outside, axes inside. Between two tiles of a few steps every axis is at the same instant.

use hpf_core::{Lanes, Real as _};
use hpf_learn::Parameters;

use super::inertial::{FreeInertial, TouchingInertial};
use super::measured::Measured;
use super::motion::{Motion, Reference, Sample, Sink, Tool};
use super::profiles::Profiles;
use super::scenario::{AxisScenario, Scenario};
use super::table::TILE;
use super::tool::{Free, Touching};
use super::{AxisModel, Simulation};
use crate::task::MAX_AXES;
use crate::trace::Trace;

/// The tool of one axis.
enum AxisTool<'a, const N: usize> {
    Free(Free<'a, N>),
    Touching(Touching<'a, N>),
    FreeInertial(FreeInertial<'a, N>),
    TouchingInertial(TouchingInertial<'a, N>),
    Measured(Measured<'a, N>),
}

/// One axis on its way.
struct Axis<'a, P, const N: usize> {
    motion: Motion<'a, P, N>,
    tool: AxisTool<'a, N>,
}

impl<P: Profiles<N>, const N: usize> Axis<'_, P, N> {
    /// [`Motion::advance`] with its tool; those that gain nothing from vector registers are compiled once.
    #[inline(always)]
    fn advance(&mut self, first: usize, drive: &[f64], take: impl FnMut(usize, &Sample<N>)) {
        let motion = &mut self.motion;
        match &mut self.tool {
            AxisTool::Free(tool) => motion.advance(first, drive, tool, take),
            AxisTool::Touching(tool) => motion.advance(first, drive, tool, take),
            AxisTool::FreeInertial(tool) => motion.advance(first, drive, tool, take),
            AxisTool::TouchingInertial(tool) => advance_rarely(motion, first, drive, tool, take),
            AxisTool::Measured(tool) => advance_rarely(motion, first, drive, tool, take),
        }
    }

    #[inline(always)]
    fn sample(&self, i: usize) -> Sample<N> {
        match &self.tool {
            AxisTool::Free(tool) => self.motion.sample(i, tool),
            AxisTool::Touching(tool) => self.motion.sample(i, tool),
            AxisTool::FreeInertial(tool) => self.motion.sample(i, tool),
            AxisTool::TouchingInertial(tool) => self.motion.sample(i, tool),
            AxisTool::Measured(tool) => self.motion.sample(i, tool),
        }
    }
}

#[inline(never)]
fn advance_rarely<P: Profiles<N>, const N: usize>(
    motion: &mut Motion<'_, P, N>,
    first: usize,
    drive: &[f64],
    tool: &mut impl Tool<N>,
    take: impl FnMut(usize, &Sample<N>),
) {
    motion.advance(first, drive, tool, take);
}

impl Simulation {
    /// The motion of all axes over `steps`, each with its reference and profiles, each sample handed to `sink`.
    #[inline(always)]
    pub(super) fn roll<'a, P: Profiles<N>, const N: usize>(
        &'a self,
        steps: usize,
        scenario: &'a Scenario,
        parts: impl Fn(&'a AxisModel) -> (&'a Reference<N>, P),
        mut sink: impl Sink<N>,
    ) {
        let mut axes: [Option<Axis<'_, P, N>>; MAX_AXES] = core::array::from_fn(|a| {
            let (reference, profiles) = parts(self.axes.get(a)?);
            let tool = self.tool(a, reference, &scenario.axes[a]);
            Some(Axis { motion: Motion::new(reference, profiles), tool })
        });
        for (tile, drive) in self.drive[..steps].chunks(TILE).enumerate() {
            for (a, axis) in axes.iter_mut().flatten().enumerate() {
                axis.advance(tile * TILE, drive, |i, sample| sink.take(a, i, sample));
            }
        }
        for (a, axis) in axes.iter().flatten().enumerate() {
            sink.take(a, steps, &axis.sample(steps));
        }
    }

    /// The tool of axis `a` at the start.
    fn tool<'a, const N: usize>(
        &'a self,
        a: usize,
        reference: &Reference<N>,
        scenario: &'a AxisScenario,
    ) -> AxisTool<'a, N> {
        let (dt, forces) = (self.dt, &scenario.forces);
        let contact = self.contact.as_ref().filter(|contact| contact.axis == a);
        if let Some(robot) = self.robot {
            let tool = Measured::new(dt, robot, scenario, contact, reference.inertial, reference.start());
            return AxisTool::Measured(tool);
        }
        match (contact, reference.inertial, self.axes[a].inertial) {
            (Some(contact), _, Some(law)) => {
                let held = [self.axes[a].largest_stiffness, reference.start().to_f64()];
                AxisTool::TouchingInertial(TouchingInertial::new(dt, forces, contact, law, held))
            }
            (Some(contact), ..) => AxisTool::Touching(Touching::new(dt, forces, contact)),
            (None, Some(law), _) => AxisTool::FreeInertial(FreeInertial::new(dt, forces, law)),
            (None, None, _) => AxisTool::Free(Free::new(dt, forces)),
        }
    }

    /// Writes the first `steps` of the motion of the skill in `scenario` into `trace`.
    pub(super) fn rollout_over(
        &self,
        steps: usize,
        scenario: &Scenario,
        parameters: Parameters<'_>,
        trace: &mut Trace,
    ) {
        self.roll(steps, scenario, |axis| (&axis.alone, self.rowwise(axis, parameters)), trace);
    }
}

impl Sink<1> for &mut Trace {
    fn take(&mut self, a: usize, i: usize, sample: &Sample<1>) {
        let axis = &mut self.axes[a];
        for (signal, Lanes([value])) in [
            (&mut axis.reference_position, sample.reference_position),
            (&mut axis.reference_velocity, sample.reference_velocity),
            (&mut axis.position, sample.position),
            (&mut axis.velocity, sample.velocity),
            (&mut axis.force, sample.force),
            (&mut axis.stiffness, sample.stiffness),
            (&mut axis.damping, sample.damping),
        ] {
            signal[i] = value;
        }
        if let (Some(contact), Some([deviation, force])) =
            (self.contact.as_mut().filter(|contact| contact.axis == a), sample.contact)
        {
            [contact.deviation[i], contact.force[i]] = [deviation.0[0], force.0[0]];
        }
    }
}
