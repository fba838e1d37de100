//! A tool on a real robot: it sees the force that its sensor reads once a step, and follows its command late.
//!
//! This is the loop of a controller: the reading is held over the step ([`step_offset`], [`Inertial::step`]), contact
//! force included. What lies outside the controller is the [`Plant`].

use hpf_core::admittance::{Inertial, OffsetMotion, step_offset};
use hpf_core::{Lanes, Real};

use super::motion::{Knot, Sample, Tool};
use super::plant::{Plant, Robot};
use super::scenario::AxisScenario;
use super::tool::ContactModel;

/// A tool that sees forces through a sensor.
pub(super) struct Measured<'a, const N: usize> {
    dt: f64,
    lag: Option<f64>,
    plant: Plant<'a, N>,
    law: Option<Inertial<Lanes<N>>>,
    /// Of the command.
    motion: OffsetMotion<Lanes<N>>,
}

impl<'a, const N: usize> Measured<'a, N> {
    /// A tool at rest at `start`, or where the contact has it.
    pub(super) fn new(
        dt: f64,
        robot: Robot,
        scenario: &'a AxisScenario,
        contact: Option<&'a ContactModel>,
        law: Option<Inertial<Lanes<N>>>,
        start: Lanes<N>,
    ) -> Self {
        let plant = Plant::new(dt, robot, scenario, contact, start);
        let motion = OffsetMotion { offset: plant.position() - start, velocity: Lanes::ZERO };
        Self { dt, lag: robot.lag, plant, law, motion }
    }

    /// The force that the admittance sees [N].
    fn force(&self) -> Lanes<N> {
        self.plant.reading() + Lanes::of(self.plant.push())
    }
}

impl<const N: usize> Tool<N> for Measured<'_, N> {
    fn sample(&self, i: usize, now: &Knot<N>) -> Sample<N> {
        let (position, command) = (self.plant.position(), now.reference_position() + self.motion.offset);
        let velocity = match (self.lag, self.law) {
            (Some(lag), _) => (command - position) / Lanes::of(lag),
            (None, Some(_)) => now.reference_velocity + self.motion.velocity,
            (None, None) => now.reference_velocity + (self.force() - now.stiffness * self.motion.offset) / now.damping,
        };
        Sample {
            reference_position: now.reference_position(),
            reference_velocity: now.reference_velocity,
            position,
            velocity,
            force: self.force(),
            stiffness: now.stiffness,
            damping: now.damping,
            contact: self.plant.contact(i),
        }
    }

    fn advance(&mut self, i: usize, now: &Knot<N>, next: &Knot<N>, [stiffness, damping]: [Lanes<N>; 2]) {
        let (force, dt) = (self.force(), Lanes::of(self.dt));
        let before = now.reference_position() + self.motion.offset;
        match self.law {
            Some(law) => law.step(&mut self.motion, stiffness, damping, force, dt),
            None => self.motion.offset = step_offset(self.motion.offset, stiffness, damping, force, dt),
        }
        self.plant.follow(i, before, next.reference_position() + self.motion.offset);
    }
}
