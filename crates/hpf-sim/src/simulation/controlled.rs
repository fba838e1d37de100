//! The real controller in the environment of a task: [`crate::robot`].
//!
//! Each step of h: the requests that are due, one update of the [`Controller`] on what the [`Plant`] of each axis reads,
//! one step of the plants on what it commands. The trace has the samples of a simulation: positions of the tool and of
//! the reference, readings with the force that is pressed with; velocities are means over the step that led there.

use std::collections::VecDeque;

use hpf_core::controller::{AxisSettings, Compliance, Controller, Input, Mode, Output, Request};
use hpf_core::{Lanes, Real as _};
use hpf_learn::Cost;

use super::draws::add_mean;
use super::plant::{Plant, Robot};
use super::scenario::{Scenario, Set};
use super::{Simulation, SimulationError};
use crate::metrics::{Metric, over_draws};
use crate::policy::Policy;
use crate::robot::{Conduct, Refusal, Settings, Tally, TimedRequest};
use crate::trace::Trace;

impl Simulation {
    /// The motion of the tool where the controller runs `policy`, and what the controller did; where something is drawn,
    /// in the first of the draws that policies are measured by. `policy` has the structure that the simulation is for.
    ///
    /// # Errors
    /// [`SimulationError`] for settings that the controller refuses with this skill.
    pub fn controlled(&self, policy: &Policy, settings: &Settings) -> Result<(Trace, Conduct), SimulationError> {
        let mut trace = self.blank_trace();
        let conduct = self.control(policy, settings, &self.shown, &mut trace)?;
        Ok((trace, conduct))
    }

    /// What `policy`, run by the controller, costs and is measured by, as [`Simulation::evaluate`] without a controller,
    /// and what the controller did in all draws together.
    ///
    /// # Errors
    /// As for [`Simulation::controlled`].
    pub fn evaluate_controlled(
        &self,
        policy: &Policy,
        settings: &Settings,
    ) -> Result<(Cost, Vec<Metric>, Tally), SimulationError> {
        let count = self.task.evaluation_draws();
        let (mut trace, mut mean, mut one) = (self.blank_trace(), Cost::default(), Cost::default());
        let (mut metrics, mut tally) = (Vec::with_capacity(count), Tally::default());
        for (i, scenario) in Scenario::of_set(&self.task, Set::Evaluation, count).enumerate() {
            tally.add(&self.control(policy, settings, &scenario, &mut trace)?.tally());
            self.cost_into(&trace, &mut one);
            add_mean(&mut mean, &one, i == 0, count);
            metrics.push(self.metrics(&trace));
        }
        Ok((mean, over_draws(metrics), tally))
    }

    /// Whether `settings` press away from the contact of the task.
    pub fn presses_away(&self, settings: &Settings) -> bool {
        self.contact
            .as_ref()
            .zip(settings.press.as_ref())
            .is_some_and(|(contact, press)| press.of(contact.axis) * contact.surfaces[0].direction < 0.0)
    }

    fn control(
        &self,
        policy: &Policy,
        settings: &Settings,
        scenario: &Scenario,
        trace: &mut Trace,
    ) -> Result<Conduct, SimulationError> {
        match self.axes.len() {
            1 => self.control_axes::<1>(policy, settings, scenario, trace),
            2 => self.control_axes::<2>(policy, settings, scenario, trace),
            3 => self.control_axes::<3>(policy, settings, scenario, trace),
            4 => self.control_axes::<4>(policy, settings, scenario, trace),
            5 => self.control_axes::<5>(policy, settings, scenario, trace),
            6 => self.control_axes::<6>(policy, settings, scenario, trace),
            _ => self.control_axes::<7>(policy, settings, scenario, trace),
        }
    }

    fn control_axes<const D: usize>(
        &self,
        policy: &Policy,
        settings: &Settings,
        scenario: &Scenario,
        trace: &mut Trace,
    ) -> Result<Conduct, SimulationError> {
        let refused = SimulationError::Controller;
        let skill = policy.to_hybrid::<D>().map_err(refused)?;
        let starts = skill.axes().each_ref().map(|axis| Lanes([axis.movement.start()]));
        let robot = Robot::of(&self.task, self.dt);
        let mut plants: [Plant<'_, 1>; D] = core::array::from_fn(|a| {
            let contact = self.contact.as_ref().filter(|contact| contact.axis == a);
            Plant::new(self.dt, robot, &scenario.axes[a], contact, starts[a])
        });
        let push = plants.each_ref().map(Plant::push);
        let position = |plants: &[Plant<'_, 1>; D]| plants.each_ref().map(|plant| plant.position().to_f64());
        let given = settings.controller(push, self.dt).map_err(refused)?;
        let presses = |axis: &AxisSettings<f64>| matches!(axis.compliance, Compliance::Press(_));
        if settings.press.as_ref().is_some_and(|press| press.values().iter().any(|press| *press != 0.0))
            && !given.axes.iter().any(presses)
        {
            return Err(SimulationError::PressesNothing);
        }
        let mut controller = Controller::new(skill, given, position(&plants)).map_err(refused)?;
        let mut requests = Requests::of(settings);
        let mut conduct = Conduct::default();
        self.record(0, &controller.output(), &plants, trace);
        for i in 0..trace.time.len() - 1 {
            let (before, mode) = (controller.output().axes.map(|axis| axis.position), controller.output().mode);
            let request = requests.due(i as f64 * self.dt, position(&plants), 0.5 * self.dt);
            let input = Input {
                measured_force: plants.each_ref().map(|plant| plant.reading().to_f64()),
                force_age: plants.iter().map(Plant::lost).max().unwrap_or(0),
                measured_position: settings.watch_position.then(|| position(&plants)),
                rate: requests.rate,
                request,
            };
            let output = controller.update(&input, self.dt);
            for ((plant, from), axis) in plants.iter_mut().zip(before).zip(&output.axes) {
                plant.follow(i, Lanes([from]), Lanes([axis.position]));
            }
            if let Some(request) = input.request.as_ref().filter(|_| output.status.refused) {
                let (request, reason) = refusal(request, mode);
                conduct.refusals.push(Refusal { step: i, request, reason });
            }
            conduct.take(&output);
            self.record(i + 1, &output, &plants, trace);
        }
        conduct.unasked = requests.waiting.len();
        conduct.counters = *controller.counters();
        Ok(conduct)
    }

    /// Writes sample `i`.
    fn record<const D: usize>(&self, i: usize, output: &Output<f64, D>, plants: &[Plant<'_, 1>; D], trace: &mut Trace) {
        trace.phase[i] = output.phase;
        for (a, ((command, plant), axis)) in output.axes.iter().zip(plants).zip(&mut trace.axes).enumerate() {
            let (position, reference) = (plant.position().to_f64(), command.position - command.offset);
            let since = |signal: &[f64], now: f64| if i == 0 { 0.0 } else { (now - signal[i - 1]) / self.dt };
            axis.reference_velocity[i] = since(&axis.reference_position, reference);
            axis.velocity[i] = since(&axis.position, position);
            axis.reference_position[i] = reference;
            axis.position[i] = position;
            axis.force[i] = plant.reading().to_f64() + plant.push();
            (axis.stiffness[i], axis.damping[i]) = (command.stiffness, command.damping);
            if let (Some(contact), Some([deviation, force])) =
                (trace.contact.as_mut().filter(|contact| contact.axis == a), plant.contact(i))
            {
                (contact.deviation[i], contact.force[i]) = (deviation.to_f64(), force.to_f64());
            }
        }
    }
}

/// The kind of a request that was refused in `mode`, and why.
fn refusal<const D: usize>(request: &Request<f64, D>, mode: Mode) -> (&'static str, String) {
    let not_in = || format!("not in {}", format!("{mode:?}").to_lowercase());
    match request {
        Request::Start => ("start", not_in()),
        Request::Hold => ("hold", not_in()),
        Request::Resume => ("resume", not_in()),
        Request::Stop => ("stop", not_in()),
        Request::Tare if mode == Mode::Idle => ("tare", "the force has not stood still".into()),
        Request::Tare => ("tare", not_in()),
        Request::Reset(_) if matches!(mode, Mode::Idle | Mode::Stop | Mode::Fault) => {
            ("reset", "the robot is outside the workspace".into())
        }
        Request::Reset(_) => ("reset", not_in()),
        Request::Goal(_) if matches!(mode, Mode::Idle | Mode::Run | Mode::Hold) => {
            ("goal", "it lies outside the workspace".into())
        }
        Request::Goal(_) => ("goal", not_in()),
    }
}

/// What is still to be asked for, soonest first; one request a step.
struct Requests<'s> {
    waiting: VecDeque<&'s TimedRequest>,
    /// A movement that nobody starts is started at once.
    starts: bool,
    /// Rate of time along the path that is asked for.
    rate: f64,
}

impl<'s> Requests<'s> {
    fn of(settings: &'s Settings) -> Self {
        let mut waiting: Vec<&TimedRequest> = settings.request.iter().collect();
        waiting.sort_by(|a, b| a.time().total_cmp(&b.time()));
        let starts = !waiting.iter().any(|request| matches!(request, TimedRequest::Start(_)));
        Self { waiting: waiting.into(), starts, rate: 1.0 }
    }

    /// The request of the step that begins at `time` [s], of a robot at `position`; `slack` is half a step.
    fn due<const D: usize>(&mut self, time: f64, position: [f64; D], slack: f64) -> Option<Request<f64, D>> {
        if core::mem::take(&mut self.starts) {
            return Some(Request::Start);
        }
        while let Some(request) = self.waiting.pop_front_if(|request| request.time() < time + slack) {
            return Some(match request {
                TimedRequest::Start(_) => Request::Start,
                TimedRequest::Hold(_) => Request::Hold,
                TimedRequest::Resume(_) => Request::Resume,
                TimedRequest::Stop(_) => Request::Stop,
                TimedRequest::Tare(_) => Request::Tare,
                TimedRequest::Reset(_) => Request::Reset(position),
                TimedRequest::Goal(goal) => Request::Goal(core::array::from_fn(|axis| goal.position.of(axis))),
                TimedRequest::Rate(at) => {
                    self.rate = at.rate;
                    continue;
                }
            });
        }
        None
    }
}
