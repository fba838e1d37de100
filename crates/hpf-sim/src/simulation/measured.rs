//! A tool on a real robot: it sees the force that its sensor reads once a step, and follows its command late.
//!
//! This is the loop of a controller: the reading is held over the step ([`step_offset`], [`Inertial::step`]), contact
//! force included. The environment answers to where the tool is, not to where it is told to be.

use std::collections::VecDeque;

use hpf_core::admittance::{Inertial, OffsetMotion, relax, step_offset};
use hpf_core::{Lanes, Real};

use super::circumstances::Met;
use super::motion::{Knot, Sample, Tool};
use super::tool::ContactModel;
use crate::task::Task;

/// Sensor and actuator of a task.
#[derive(Clone, Copy, Debug)]
pub(super) struct Robot {
    /// Age of a reading [steps].
    age: f64,
    /// Nought where readings are not rounded [N].
    quantisation: f64,
    /// Time constant [s], where the tool is late.
    lag: Option<f64>,
}

impl Robot {
    /// That of `task`, where it has a sensor or an actuator.
    pub(super) fn of(task: &Task, dt: f64) -> Option<Self> {
        let (sensor, lag) = (task.sensor.as_ref(), task.actuator.as_ref().map(|actuator| actuator.lag));
        (sensor.is_some() || lag.is_some()).then(|| Self {
            age: sensor.map_or(0.0, |sensor| sensor.delay) / dt,
            quantisation: sensor.map_or(0.0, |sensor| sensor.quantisation),
            lag,
        })
    }
}

/// A tool that sees forces through a sensor.
pub(super) struct Measured<'a, const N: usize> {
    dt: f64,
    robot: Robot,
    met: &'a Met,
    contact: Option<&'a ContactModel>,
    law: Option<Inertial<Lanes<N>>>,
    /// Of the command.
    motion: OffsetMotion<Lanes<N>>,
    /// Of the tool.
    position: Lanes<N>,
    /// Force of the environment at the last samples, newest first [N].
    history: VecDeque<Lanes<N>>,
    reading: Lanes<N>,
}

impl<'a, const N: usize> Measured<'a, N> {
    /// A tool at rest at `start`, or where the contact has it.
    pub(super) fn new(
        dt: f64,
        robot: Robot,
        met: &'a Met,
        contact: Option<&'a ContactModel>,
        law: Option<Inertial<Lanes<N>>>,
        start: Lanes<N>,
    ) -> Self {
        let position = contact.map_or(start, |contact| Lanes::of(contact.initial_position));
        let motion = OffsetMotion { offset: position - start, velocity: Lanes::ZERO };
        let (history, reading) = (VecDeque::new(), Lanes::ZERO);
        let mut tool = Self { dt, robot, met, contact, law, motion, position, history, reading };
        tool.read(0);
        tool
    }

    /// Takes the reading of sample `i`.
    fn read(&mut self, i: usize) {
        let answer = self.contact.map_or(Lanes::ZERO, |contact| {
            let surface = &contact.surfaces[2 * i];
            self.position.map(|position| -surface.direction * surface.contact_force(position))
        });
        self.history.push_front(Lanes::of(self.met.forces[i].0) + answer);
        let whole = self.robot.age.floor();
        self.history.truncate(whole as usize + 2);
        // What was before the start is as it was at the start.
        let [newer, older] = [0, 1].map(|more| self.history[(whole as usize + more).min(self.history.len() - 1)]);
        let delayed = newer + Lanes::of(self.robot.age - whole) * (older - newer);
        let (error, is_lost) =
            self.met.readings.get(i).map_or((0.0, false), |reading| (reading.error, reading.is_lost));
        if !is_lost {
            let unit = self.robot.quantisation;
            let read = |force: f64| if unit > 0.0 { unit * (force / unit + 0.5).floor() } else { force };
            self.reading = (delayed + Lanes::of(error)).map(read);
        }
    }

    /// The force that the admittance sees [N].
    fn force(&self) -> Lanes<N> {
        let push = self.contact.map_or(0.0, |contact| contact.surfaces[0].direction * contact.surfaces[0].set_point);
        self.reading + Lanes::of(push)
    }
}

impl<const N: usize> Tool<N> for Measured<'_, N> {
    fn sample(&self, i: usize, now: &Knot<N>) -> Sample<N> {
        let command = now.reference_position() + self.motion.offset;
        let velocity = match (self.robot.lag, self.law) {
            (Some(lag), _) => (command - self.position) / Lanes::of(lag),
            (None, Some(_)) => now.reference_velocity + self.motion.velocity,
            (None, None) => now.reference_velocity + (self.force() - now.stiffness * self.motion.offset) / now.damping,
        };
        Sample {
            reference_position: now.reference_position(),
            reference_velocity: now.reference_velocity,
            position: self.position,
            velocity,
            force: self.force(),
            stiffness: now.stiffness,
            damping: now.damping,
            contact: self.contact.map(|contact| {
                let surface = &contact.surfaces[2 * i];
                [
                    self.position.map(|position| surface.deviation(position)),
                    self.position.map(|position| surface.contact_force(position)),
                ]
            }),
        }
    }

    fn advance(&mut self, i: usize, now: &Knot<N>, next: &Knot<N>, [stiffness, damping]: [Lanes<N>; 2]) {
        let (force, dt) = (self.force(), Lanes::of(self.dt));
        let before = now.reference_position() + self.motion.offset;
        match self.law {
            Some(law) => law.step(&mut self.motion, stiffness, damping, force, dt),
            None => self.motion.offset = step_offset(self.motion.offset, stiffness, damping, force, dt),
        }
        let command = next.reference_position() + self.motion.offset;
        self.position = match self.robot.lag {
            Some(lag) => relax(self.position, before, command, Lanes::of(self.dt / lag)),
            None => command,
        };
        self.read(i + 1);
    }
}
