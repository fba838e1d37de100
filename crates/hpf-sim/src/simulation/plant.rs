//! A robot from outside its controller: where its tool is, what that touches, what its sensor reads of it, once a step,
//! and how it follows its command. The environment answers to where the tool is, not to where it is told to be.

use std::collections::VecDeque;

use hpf_core::admittance::relax;
use hpf_core::{Lanes, Real};

use super::scenario::AxisScenario;
use super::tool::ContactModel;
use crate::task::Task;

/// Sensor and actuator of a task.
#[derive(Clone, Copy, Debug)]
pub(super) struct Robot {
    /// Age of a reading [steps].
    age: f64,
    /// Zero where readings are not rounded [N].
    quantisation: f64,
    /// Time constant [s], where the tool is late.
    pub(super) lag: Option<f64>,
}

impl Robot {
    /// That of `task`; one that does not err and is never late, where it has neither sensor nor actuator.
    pub(super) fn of(task: &Task, dt: f64) -> Self {
        let sensor = task.sensor.as_ref();
        Self {
            age: sensor.map_or(0.0, |sensor| sensor.delay) / dt,
            quantisation: sensor.map_or(0.0, |sensor| sensor.quantisation),
            lag: task.actuator.as_ref().map(|actuator| actuator.lag),
        }
    }
}

/// One axis of a robot in its environment.
pub(super) struct Plant<'a, const N: usize> {
    dt: f64,
    robot: Robot,
    scenario: &'a AxisScenario,
    contact: Option<&'a ContactModel>,
    position: Lanes<N>,
    /// Force of the environment at the last samples, newest first [N].
    history: VecDeque<Lanes<N>>,
    reading: Lanes<N>,
    /// Readings lost since the last one.
    lost: u32,
}

impl<'a, const N: usize> Plant<'a, N> {
    /// A tool at rest at `start`, or where the contact has it.
    pub(super) fn new(
        dt: f64,
        robot: Robot,
        scenario: &'a AxisScenario,
        contact: Option<&'a ContactModel>,
        start: Lanes<N>,
    ) -> Self {
        let position = contact.map_or(start, |contact| Lanes::of(contact.initial_position));
        let (history, reading) = (VecDeque::new(), Lanes::ZERO);
        let mut plant = Self { dt, robot, scenario, contact, position, history, reading, lost: 0 };
        plant.read(0);
        plant
    }

    /// Where the tool is [axis unit].
    pub(super) fn position(&self) -> Lanes<N> {
        self.position
    }

    /// What the sensor reads [N].
    pub(super) fn reading(&self) -> Lanes<N> {
        self.reading
    }

    /// Steps since that reading was new.
    pub(super) fn lost(&self) -> u32 {
        self.lost
    }

    /// Force with which the tool is to press, along the axis [N].
    pub(super) fn push(&self) -> f64 {
        self.contact.map_or(0.0, |contact| contact.surfaces[0].direction * contact.surfaces[0].set_point)
    }

    /// Deviation and contact force at sample `i`, where there is a contact.
    pub(super) fn contact(&self, i: usize) -> Option<[Lanes<N>; 2]> {
        self.contact.map(|contact| {
            let surface = &contact.surfaces[2 * i];
            [
                self.position.map(|position| surface.deviation(position)),
                self.position.map(|position| surface.contact_force(position)),
            ]
        })
    }

    /// Step `i`, in which the command runs from one position to another.
    pub(super) fn follow(&mut self, i: usize, from: Lanes<N>, to: Lanes<N>) {
        self.position = match self.robot.lag {
            Some(lag) => relax(self.position, from, to, Lanes::of(self.dt / lag)),
            None => to,
        };
        self.read(i + 1);
    }

    /// Takes the reading of sample `i`.
    fn read(&mut self, i: usize) {
        let answer = self.contact.map_or(Lanes::ZERO, |contact| {
            let surface = &contact.surfaces[2 * i];
            self.position.map(|position| -surface.direction * surface.contact_force(position))
        });
        self.history.push_front(Lanes::of(self.scenario.forces[i].0) + answer);
        let whole = self.robot.age.floor();
        self.history.truncate(whole as usize + 2);
        // What was before the start is as it was at the start.
        let [newer, older] = [0, 1].map(|more| self.history[(whole as usize + more).min(self.history.len() - 1)]);
        let delayed = newer + Lanes::of(self.robot.age - whole) * (older - newer);
        let (error, is_lost) =
            self.scenario.readings.get(i).map_or((0.0, false), |reading| (reading.error, reading.is_lost));
        if is_lost {
            self.lost = self.lost.saturating_add(1);
            return;
        }
        self.lost = 0;
        let unit = self.robot.quantisation;
        let read = |force: f64| if unit > 0.0 { unit * (force / unit + 0.5).floor() } else { force };
        self.reading = (delayed + Lanes::of(error)).map(read);
    }
}
