//! The controller: a skill as a robot runs it, one call per tick, on any input.
//!
//! One step of `dt` [s], all plain data in and out, nothing but arithmetic in between:
//! 1. the request, by the one table of [`Mode`];
//! 2. the force: a bad one (not finite, too old) is replaced by the last good one for [`Timing::hold`], then offsets
//!    freeze and the path comes to rest, then the mode is Fault; conditioning; trip levels;
//! 3. the rate of time along the path, by a ramp;
//! 4. the skill at the middle of the step, every basis once; stiffness as the energy tank allows it;
//! 5. the reference, exact, and of that step the share `c <= 1` that every velocity limit and the tank can pay for: slower
//!    in time, never off the path;
//! 6. the admittance of every axis, exact; then the limits, and what they cut is written back to the offset: nothing
//!    winds up. An offset at its limit drags the reference along;
//! 7. the books of energy, on what really was commanded.
//!
//! The tank keeps `sum f dx >= -(E_t0 - E_min)` from rest, for every force and stiffness, while no limit of motion is
//! hit. A limit of acceleration is an inertia that the law does not have, and may make the tool give more; the books
//! show it (the energy goes below the reserve, even below nought), and until it is paid back stiffness does not rise
//! and the path takes no energy. A rigid axis has no force in the books. A tank that is added later starts empty.
//!
//! Where a limit cuts a first-order axis of every compliance, its offset comes back by `d e' + k e = 0`.

mod exchange;
mod mode;
mod reference;
mod settings;

pub use exchange::{AxisOutput, Counters, Input, Output, Request, Status};
pub use mode::{Event, Mode};
pub use settings::{AxisSettings, Compliance, Damping, Law, Settings, Timing};

use reference::Reference;

use crate::admittance::{Inertial, OffsetMotion, step_offset};
use crate::conditioning::ForceState;
use crate::limits::{Hits, LARGEST, brake, cut};
use crate::passivity::{kinetic_energy, spring_energy};
use crate::{AxisPrimitives, ConfigError, HybridPrimitive, Profile, Real, Transition, error};

/// Spring factors of a movement for which no product of a step can overflow in single precision.
const ALPHA_RANGE: [f64; 2] = [1e-3, 1e6];

/// A skill, its settings and its state; `S` holds each list: `[T; N]`, or `&'static [T; N]` for lists in flash.
///
/// ```
/// use hpf_core::controller::*;
/// use hpf_core::limits::Limits;
/// use hpf_core::*;
/// let basis = Basis::equally_spaced(100.0_f64.ln(), 0.6, [0.0; 5], [0.0; 5])?;
/// let axis = AxisPrimitives {
///     movement: Movement::new(0.0, 0.3, 25.0, 0.3, [0.0; 5])?,
///     stiffness: Gain::new(30.0, 400.0, [100.0; 5])?,
///     damping: Gain::new(10.0, 100.0, [50.0; 5])?,
/// };
/// let skill = HybridPrimitive::new(Phase::new(2.0, 100.0_f64.ln())?, [basis; 3], [axis])?;
/// let limits = Limits { force: 50.0, offset: 0.2, velocity: 0.5, acceleration: 10.0, position: [-0.1, 0.6] };
/// let settings = Settings::compliant([limits]);
/// let mut controller = Controller::new(skill, settings, [0.0])?; // the robot is at 0 m
/// let mut input = Input {
///     measured_force: [10.0],
///     force_age: 0,
///     measured_position: None,
///     rate: 1.0,
///     request: Some(Request::Start),
/// };
/// for _ in 0..5000 {
///     controller.update(&input, 1e-3);
///     input.request = None;
/// }
/// let output = controller.update(&input, 1e-3);
/// assert!((output.axes[0].position - (0.3 + 10.0 / 100.0)).abs() < 1e-3); // at the goal, f/k away
/// # Ok::<(), ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controller<T, S, const D: usize> {
    skill: HybridPrimitive<T, S, D>,
    settings: Settings<T, D>,
    /// The second-order law of each axis that has one.
    laws: [Option<Inertial<T>>; D],
    /// Phase at which the movement has ended.
    end_phase: T,
    axes: [AxisState<T>; D],
    force: ForceState<T, D>,
    /// The last good reading [N].
    good_force: [T; D],
    /// Time since the last good reading [s].
    lost_for: T,
    ended: bool,
    counters: Counters,
    /// The last output; phase, rate, energy, mode and motion of the commands are the state of what they say.
    last: Output<T, D>,
}

/// State of one axis beside its last command.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AxisState<T> {
    reference: Reference<T>,
    offset: OffsetMotion<T>,
}

impl<T: Real + PartialOrd, S: AsRef<[T]>, const D: usize> Controller<T, S, D> {
    /// A controller in Idle for a robot at rest at `position` [axis unit].
    ///
    /// # Errors
    /// [`ConfigError`] for settings that make no sense, a position or a goal outside the workspace, and a skill whose
    /// numbers are so extreme that a step could overflow.
    pub fn new(
        skill: HybridPrimitive<T, S, D>,
        settings: Settings<T, D>,
        position: [T; D],
    ) -> Result<Self, ConfigError> {
        let laws = settings.laws(skill.axes())?;
        error::within("duration", skill.phase().duration(), 1.0 / LARGEST, LARGEST)?;
        for AxisPrimitives { movement, .. } in skill.axes() {
            let [least, most] = ALPHA_RANGE;
            error::within("alpha", movement.alpha(), least, most)?;
            let largest = movement.weights().iter().fold(T::ZERO, |largest, weight| largest.max(weight.abs()));
            error::within("forcing_scale times weights", movement.forcing_scale().abs() * largest, 0.0, LARGEST)?;
        }
        let rest = AxisOutput {
            position: T::ZERO,
            velocity: T::ZERO,
            stiffness: T::ZERO,
            damping: T::ZERO,
            offset: T::ZERO,
            force: T::ZERO,
            hits: Hits::default(),
        };
        let still = OffsetMotion { offset: T::ZERO, velocity: T::ZERO };
        let mut controller = Self {
            settings,
            laws,
            end_phase: skill.phase().at(skill.phase().duration()),
            axes: [AxisState { reference: Reference::at_rest(T::ZERO, T::ZERO), offset: still }; D],
            force: ForceState::default(),
            good_force: [T::ZERO; D],
            lost_for: T::of(LARGEST),
            ended: false,
            counters: Counters::default(),
            last: Output {
                axes: [rest; D],
                phase: T::ONE,
                rate: T::ZERO,
                energy: T::ZERO,
                mode: Mode::Idle,
                status: Status::default(),
            },
            skill,
        };
        controller.put(position)?;
        controller.check_goals(&settings)?;
        Ok(controller)
    }

    /// The settings in use.
    pub fn settings(&self) -> &Settings<T, D> {
        &self.settings
    }

    /// The skill.
    pub fn skill(&self) -> &HybridPrimitive<T, S, D> {
        &self.skill
    }

    /// The last output.
    pub fn output(&self) -> &Output<T, D> {
        &self.last
    }

    /// How often what has gone wrong.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Replaces all settings between two steps. The command goes on from where it is, at the velocity it has.
    ///
    /// # Errors
    /// [`ConfigError`] for settings that make no sense, or that the present command, offset or goal would break; they
    /// are refused whole, the old ones stay, and the refusal is counted.
    pub fn set(&mut self, settings: Settings<T, D>) -> Result<(), ConfigError> {
        let accepted = settings.laws(self.skill.axes()).and_then(|laws| {
            for ((axis, state), command) in settings.axes.iter().zip(&self.axes).zip(&self.last.axes) {
                axis.limits.admit(command.position, command.velocity)?;
                let largest = axis.limits.offset.to_f64();
                error::within("offset", state.offset.offset, -largest, largest)?;
            }
            self.check_goals(&settings)?;
            Ok(laws)
        });
        match accepted {
            Ok(laws) => {
                // Mass that a moving offset is given costs energy, as stiffness does at an offset.
                let mut balance = T::ZERO;
                for ((state, old), new) in self.axes.iter().zip(&self.laws).zip(&laws) {
                    let [old, new] = [old, new].map(|law| law.map_or(T::ZERO, |law| law.mass()));
                    balance += kinetic_energy(old - new, state.offset.velocity);
                }
                self.last.energy = settings.tank.map_or(T::ZERO, |tank| {
                    tank.book(&mut self.last.energy, balance);
                    self.last.energy
                });
                (self.settings, self.laws) = (settings, laws);
                Ok(())
            }
            Err(refusal) => {
                self.counters.refused = self.counters.refused.saturating_add(1);
                Err(refusal)
            }
        }
    }

    /// One step of `dt` [s]. Total: whatever comes in, the commands are finite and within every limit.
    pub fn update(&mut self, input: &Input<T, D>, dt: T) -> Output<T, D> {
        let mut status =
            Status { refused: !input.request.is_none_or(|request| self.obey(request)), ..Status::default() };
        if dt.is_finite() && dt > T::ZERO {
            let longest = self.settings.timing.longest_step;
            status.long_time = dt > longest;
            self.advance(input, dt.at_most(longest), &mut status);
        } else {
            status.bad_time = true;
        }
        if status != Status::default() {
            self.counters.count(&status);
        }
        self.last.status = status;
        // In parts: as a whole it is copied by a call on a microcontroller.
        let Output { axes, phase, rate, energy, mode, status } = self.last;
        Output { axes, phase, rate, energy, mode, status }
    }

    /// Does what is asked for; returns whether it did.
    fn obey(&mut self, request: Request<T, D>) -> bool {
        match request {
            Request::Start => self.on(Event::Start),
            Request::Hold => self.on(Event::Hold),
            Request::Resume => self.on(Event::Resume),
            Request::Stop => self.on(Event::Stop),
            Request::Goal(goal) => self.retarget(goal),
            Request::Tare => {
                let idle = self.last.mode == Mode::Idle;
                if idle {
                    self.force.tare();
                }
                idle
            }
            Request::Reset(position) => {
                self.last.mode.after(Event::Reset).is_some() && self.put(position).is_ok() && self.on(Event::Reset)
            }
        }
    }

    /// Goes to the mode after `event`; returns whether there is one.
    fn on(&mut self, event: Event) -> bool {
        let Some(mode) = self.last.mode.after(event) else { return false };
        if mode == Mode::Fault && self.last.mode != Mode::Fault {
            self.counters.faults = self.counters.faults.saturating_add(1);
        }
        self.last.mode = mode;
        true
    }

    /// Puts everything but mode and counters to the start of the movement, at rest at `position`.
    fn put(&mut self, position: [T; D]) -> Result<(), ConfigError> {
        for (axis, &position) in self.settings.axes.iter().zip(&position) {
            axis.limits.admit(position, T::ZERO)?;
        }
        let profiles = self.skill.at(T::ONE);
        let slots = self.axes.iter_mut().zip(&mut self.last.axes).zip(self.skill.axes()).zip(position).zip(profiles);
        for ((((state, command), primitives), position), Profile { stiffness, damping, .. }) in slots {
            state.reference = Reference::at_rest(position, primitives.movement.goal());
            state.offset = OffsetMotion { offset: T::ZERO, velocity: T::ZERO };
            *command = AxisOutput {
                position,
                velocity: T::ZERO,
                stiffness,
                damping,
                offset: T::ZERO,
                force: T::ZERO,
                hits: Hits::default(),
            };
        }
        self.last.phase = T::ONE;
        self.last.rate = T::ZERO;
        self.last.energy = self.settings.tank.map_or(T::ZERO, |tank| tank.capacity());
        self.ended = false;
        Ok(())
    }

    /// Whether every goal lies in the workspace of `settings`.
    fn check_goals(&self, settings: &Settings<T, D>) -> Result<(), ConfigError> {
        settings.axes.iter().zip(&self.axes).try_for_each(|(axis, state)| {
            let [min, max] = axis.limits.position.map(T::to_f64);
            error::within("goal", state.reference.target, min, max).map(drop)
        })
    }

    /// Goes to `goal` from now on: at once where nothing moves yet, without a jump in flight. Returns whether it does.
    fn retarget(&mut self, goal: [T; D]) -> bool {
        let flying = match self.last.mode {
            Mode::Idle => false,
            Mode::Run | Mode::Hold => true,
            Mode::Stop | Mode::Fault => return false,
        };
        let inside = |(axis, &goal): (&AxisSettings<T>, &T)| {
            let [min, max] = axis.limits.position;
            goal >= min && goal <= max
        };
        if !self.settings.axes.iter().zip(&goal).all(inside) {
            return false;
        }
        for ((state, command), goal) in self.axes.iter_mut().zip(&self.last.axes).zip(goal) {
            if flying {
                state.reference.retarget(goal);
            } else {
                state.reference = Reference::at_rest(command.position, goal);
            }
        }
        true
    }

    /// One step of a `dt` that is in order.
    fn advance(&mut self, input: &Input<T, D>, dt: T, status: &mut Status) {
        let force = self.feel(input, dt, status);
        self.watch(input, status);

        let asked = if input.rate.is_finite() { input.rate.at_least(T::ZERO).at_most(T::ONE) } else { T::ZERO };
        status.bad_input |= !input.rate.is_finite();
        let asked = if self.last.mode == Mode::Run && !status.force_lost { asked } else { T::ZERO };
        let change = dt / self.settings.timing.ramp;
        let rate = asked.at_least(self.last.rate - change).at_most(self.last.rate + change);
        if status.force_lost && rate <= T::ZERO {
            self.on(Event::ForceLost);
        }
        self.walk(force, rate, dt, status);

        status.ended = !self.ended && self.last.phase <= self.end_phase;
        self.ended |= status.ended;
    }

    /// The force that the model sees, good or not.
    fn feel(&mut self, input: &Input<T, D>, dt: T, status: &mut Status) -> [T; D] {
        let timing = &self.settings.timing;
        let good = input.force_age <= timing.oldest_force && input.measured_force.iter().all(|force| force.is_finite());
        if good {
            let largest = T::of(LARGEST);
            self.good_force = input.measured_force.map(|force| cut(force, T::ZERO, largest).0);
            self.lost_for = T::ZERO;
        } else {
            self.lost_for = (self.lost_for + dt).at_most(T::of(LARGEST));
        }
        status.bad_force = !good;
        status.force_lost = self.lost_for > timing.hold;
        let compensated = self.settings.conditioning.compensated(&self.force, self.good_force);
        let mut forces = compensated.iter().zip(&self.settings.axes);
        status.force_tripped = good && forces.any(|(force, axis)| force.abs() > axis.trip_force);
        self.settings.conditioning.settle(&mut self.force, compensated, dt)
    }

    /// Stops where a force or the robot's distance from the command is too large.
    fn watch(&mut self, input: &Input<T, D>, status: &mut Status) {
        if let Some(measured) = input.measured_position {
            if measured.iter().all(|position| position.is_finite()) {
                let gaps = measured.iter().zip(&self.last.axes).zip(&self.settings.axes);
                status.tracking_tripped =
                    gaps.into_iter().any(|((&at, command), axis)| (at - command.position).abs() > axis.tracking);
            } else {
                status.bad_input = true;
            }
        }
        if status.force_tripped || status.tracking_tripped {
            self.on(Event::Tripped);
        }
    }

    /// Advances reference, offsets and commands.
    fn walk(&mut self, force: [T; D], rate: T, dt: T, status: &mut Status) {
        let tank = self.settings.tank;
        let gives = !status.force_lost && matches!(self.last.mode, Mode::Run | Mode::Hold | Mode::Stop);
        let duration = self.skill.phase().duration();
        let fall = self.skill.phase().fall(rate, dt * T::of(0.5));
        let middle = self.last.phase * fall;

        // Stiffness as the tank allows it; the whole step of every reference, and what it would cost.
        let mut next = self.axes.map(|state| state.reference);
        let mut share = T::ONE;
        let mut cost = T::ZERO;
        let mut transition: Option<(T, Transition<T>)> = None;
        let parts = next.iter_mut().zip(&self.axes).zip(&mut self.last.axes).zip(self.skill.axes());
        let parts = parts.zip(&self.settings.axes).zip(&self.laws).zip(force).zip(self.skill.at(middle));
        for (((((((next, state), command), primitives), settings), law), force), profile) in parts {
            let (sensed, strong) = cut(force, T::ZERO, settings.limits.force);
            let force = if settings.compliance == Compliance::Rigid { T::ZERO } else { sensed };
            let stiffness = tank.map_or(profile.stiffness, |tank| {
                let (energy, offset) = (&mut self.last.energy, state.offset.offset);
                tank.stiffness(energy, command.stiffness, profile.stiffness, offset, dt)
            });
            status.energy_short |= stiffness < profile.stiffness;
            let damping = match (settings.law, law) {
                (Law::SecondOrder { damping, .. }, Some(law)) => damping.at(law.mass(), stiffness, profile.damping),
                _ => profile.damping,
            };
            (command.force, command.stiffness, command.damping) = (force, stiffness, damping);
            command.hits = Hits { force: strong, ..Hits::default() };

            let alpha = primitives.movement.alpha();
            let step = match transition {
                Some((same, step)) if same == alpha => step,
                _ => Transition::new(alpha, rate * dt / duration),
            };
            transition = Some((alpha, step));
            *next = state.reference.ahead(&step, profile.forcing);
            let distance = state.reference.distance(next);
            let farthest = settings.limits.velocity * dt;
            if distance.abs() > farthest {
                share = share.at_most(farthest / distance.abs());
            }
            cost = cost - force * distance;
        }
        if let Some(available) = tank.map(|tank| tank.available(self.last.energy))
            && cost > available
        {
            share = share.at_most(available / cost);
            status.energy_short = true;
        }
        self.last.phase += share * (middle * fall - self.last.phase);
        self.last.rate = rate * share;

        let presses = tank.is_none_or(|tank| tank.available(self.last.energy) > T::ZERO);
        let mut balance = T::ZERO;
        let parts = self.axes.iter_mut().zip(&mut self.last.axes).zip(&next).zip(&self.settings.axes).zip(&self.laws);
        for ((((state, command), next), settings), law) in parts {
            let AxisOutput { force, stiffness, damping, .. } = *command;
            let drive = match settings.compliance {
                Compliance::Press(setpoint) if presses => force + setpoint,
                Compliance::Press(_) => {
                    status.energy_short = true;
                    force
                }
                Compliance::Rigid | Compliance::Compliant => force,
            };
            let kinetic = |velocity| law.map_or(T::ZERO, |law| kinetic_energy(law.mass(), velocity));
            let stored = |at: OffsetMotion<T>| spring_energy(stiffness, at.offset) + kinetic(at.velocity);
            let travel = share * state.reference.distance(next);
            if share < T::ONE {
                state.reference.go(next, share);
            } else {
                state.reference = *next;
            }

            let before = state.offset;
            match law {
                _ if !gives => state.offset.velocity = T::ZERO,
                Some(law) => law.step(&mut state.offset, stiffness, damping, drive, dt),
                None => {
                    state.offset.offset = step_offset(before.offset, stiffness, damping, drive, dt);
                    state.offset.velocity = (state.offset.offset - before.offset) / dt;
                }
            }
            let limits = &settings.limits;
            let wanted = (state.offset.offset - before.offset) / dt;
            let room = [limits.offset + before.offset, limits.offset - before.offset];
            let (giving, held) = brake(wanted, room, limits.acceleration, dt);
            let (velocity, mut hits) = limits.velocity(command.position, command.velocity, travel / dt + giving, dt);
            if held || hits.any_motion() {
                let give = if hits.any_motion() { velocity * dt - travel } else { giving * dt };
                let offset = before.offset + give;
                let (kept, dragged) = cut(offset, T::ZERO, limits.offset);
                state.offset = OffsetMotion { offset: kept, velocity: give / dt };
                state.reference.shift(offset - kept);
                hits.offset = held || dragged;
            }
            balance += force * (velocity * dt) - (stored(state.offset) - stored(before));

            let [min, max] = limits.position;
            command.position = (state.reference.position() + state.offset.offset).at_least(min).at_most(max);
            command.velocity = velocity;
            command.offset = state.offset.offset;
            command.hits = Hits { force: command.hits.force, ..hits };
        }
        if let Some(tank) = tank {
            tank.book(&mut self.last.energy, balance);
        }
    }
}
