//! The controller: a skill as a robot runs it, one call per tick, on any input.
//!
//! One step of `dt` [s], all plain data in and out, nothing but arithmetic in between:
//! 1. the request, by the one table of [`Mode`];
//! 2. force, measured position, rate and dt, bad ones by the one table of [`faults`]; conditioning; trip levels, each axis
//!    by itself;
//! 3. the rate of time along the path: at its start the one asked for, under way by a ramp;
//! 4. the skill at the middle of the step, every basis once; stiffness as the energy tank allows it;
//! 5. the reference, exact, and of that step the share `c <= 1` that every velocity limit and the tank can pay for: slower
//!    in time, never off the path;
//! 6. the admittance of every axis, exact; then the limits, and what they cut is written back to the offset: nothing
//!    winds up. An offset at its limit drags the reference along;
//! 7. the books of energy, on what really was commanded; those of the [`Port`](crate::passivity::Port), on what was
//!    measured, are made before the reference and confine the command to where it can be paid for.
//!
//! The tank keeps `sum f dx >= -(E_t0 - E_min)` from rest, for every force and stiffness, by either law, compliant or
//! pressing, while no limit of motion cuts. What is left of it is spent ever slower, never switched off: the path takes
//! at most the share dt/ramp of it in a step, a set-point acts in proportion to the last quarter. A limit of motion
//! comes first: a limit of acceleration is an inertia that the law does not have, and may make the tool give more. The
//! books show it, so that `sum f dx >= -(E_t0 - E_t)` holds in any case; E_t goes below the reserve, even below zero,
//! and until it is back stiffness does not rise and neither the path nor a set-point takes energy. A rigid axis has no
//! force in the books. A tank that is added later starts empty.
//!
//! Where a limit cuts a first-order axis of every compliance, its offset comes back by `d e' + k e = 0`.

mod exchange;
pub mod faults;
mod mode;
mod port;
mod sense;
mod settings;
mod step;
mod tool;

pub use exchange::{AxisOutput, Counters, Input, Output, Request, Status};
pub use mode::{Event, Mode};
pub use settings::{AxisSettings, Compliance, Settings, Timing};

use exchange::count;
use faults::Debts;

use crate::admittance::{Inertial, OffsetMotion};
use crate::conditioning::{ForceState, TareWindow};
use crate::limits::Hits;
use crate::passivity::{PortAxis, Stored};
use crate::reference::{Reference, Stride};
use crate::{ConfigError, HybridPrimitive, Profile, Real, error};

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
///     law: Law::FirstOrder,
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
    mode: Mode,
    /// What has happened in this step so far, and after it in the last one.
    status: Status,
    phase: T,
    /// What the phase has lost in rounding.
    phase_remainder: T,
    /// Rate at which time has run along the path in the last step.
    rate: T,
    /// Energy in the tank [J]; zero without one.
    energy: Stored<T>,
    /// Energy at the physical port [J]; zero without one.
    port_energy: Stored<T>,
    axes: [AxisState<T>; D],
    force: ForceState<T, D>,
    /// The last good reading [N].
    good_force: [T; D],
    /// What force is a tare's.
    tare: TareWindow<T, D>,
    /// What each input owes.
    debts: Debts<T>,
    ended: bool,
    /// Whether it has been in Run since it was put where it is.
    moved: bool,
    counters: Counters,
    cache: StepCache<T>,
    /// The step of phase and references for the rate and the step's length in `cache`.
    stride: Stride<T, D>,
    /// Whether the books of the physical port have begun.
    port_known: bool,
}

/// What a step's length and the rate of time decide, beside the [`Stride`]: kept while they stay what they are.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StepCache<T> {
    /// The step's length [s]; zero where none has been looked at.
    dt: T,
    /// The share of a change of force that the filter lets through in one step.
    settled: T,
    /// The share of the ramp that one step is, at most 1: how far the rate may change in it, and which part of what the
    /// tank can spend the path may take.
    ramp_share: T,
    /// The rate that the stride is for; none that can be where the step's length is new.
    rate: T,
}

/// State of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AxisState<T> {
    reference: Reference<T>,
    offset: OffsetMotion<T>,
    /// Commanded position [axis unit].
    position: T,
    /// Commanded velocity [axis unit/s].
    velocity: T,
    /// Stiffness [N/m] as the tank has allowed it.
    stiffness: T,
    /// Damping [N s/m] by the law.
    damping: T,
    /// Force as the model has seen it [N].
    force: T,
    /// Limits that have cut the command.
    hits: Hits,
    /// The second-order step, if the law is of that order.
    law: Option<Inertial<T>>,
    /// The books of the physical port.
    port: PortAxis<T>,
}

impl<T: Real> AxisState<T> {
    fn command(&self) -> AxisOutput<T> {
        let Self { position, velocity, stiffness, damping, force, hits, .. } = *self;
        AxisOutput { position, velocity, stiffness, damping, offset: self.offset.offset, force, hits }
    }
}

impl<T: Real + PartialOrd, S: AsRef<[T]>, const D: usize> Controller<T, S, D> {
    /// A controller in Idle for a robot at rest at `position` [axis unit].
    ///
    /// # Errors
    /// [`ConfigError`] for settings outside their [domain](crate::domain), and a position or a goal outside the workspace.
    pub fn new(
        skill: HybridPrimitive<T, S, D>,
        settings: Settings<T, D>,
        position: [T; D],
    ) -> Result<Self, ConfigError> {
        let laws = settings.laws(skill.axes())?;
        let axis = |law| AxisState {
            reference: Reference::at_rest(T::ZERO, T::ZERO),
            offset: OffsetMotion { offset: T::ZERO, velocity: T::ZERO },
            position: T::ZERO,
            velocity: T::ZERO,
            stiffness: T::ZERO,
            damping: T::ZERO,
            force: T::ZERO,
            hits: Hits::default(),
            law,
            port: PortAxis::at_rest(T::ZERO, T::ZERO),
        };
        let mut controller = Self {
            settings,
            mode: Mode::Idle,
            status: Status::default(),
            phase: skill.phase().start(),
            phase_remainder: T::ZERO,
            rate: T::ZERO,
            energy: Stored::new(T::ZERO),
            port_energy: Stored::new(T::ZERO),
            axes: laws.map(axis),
            force: ForceState::default(),
            good_force: [T::ZERO; D],
            tare: TareWindow::default(),
            debts: Debts::UNREAD,
            ended: false,
            moved: false,
            counters: Counters::default(),
            cache: StepCache { dt: T::ZERO, settled: T::ZERO, ramp_share: T::ZERO, rate: T::ZERO },
            stride: Stride::NONE,
            port_known: false,
            skill,
        };
        controller.place_at(position)?;
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
    #[inline]
    pub fn output(&self) -> Output<T, D> {
        Output {
            axes: self.axes.each_ref().map(AxisState::command),
            phase: self.phase,
            rate: self.rate,
            energy: self.energy.level(),
            port_energy: self.port_energy.level(),
            mode: self.mode,
            status: self.status,
        }
    }

    /// The force [N] that is called zero, beside the tool's weight: what the last tare has found.
    pub fn bias(&self) -> [T; D] {
        self.force.bias
    }

    /// How often what has gone wrong.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Replaces all settings between two steps. The command goes on from where it is, at the velocity it has; before a tare
    /// the force has to stand still anew.
    ///
    /// # Errors
    /// [`ConfigError`] for settings that make no sense, or that the present command, offset or goal would break; they
    /// are refused whole, the old ones stay, and the refusal is counted.
    pub fn set(&mut self, settings: Settings<T, D>) -> Result<(), ConfigError> {
        let accepted = settings.laws(self.skill.axes()).and_then(|laws| {
            for (axis, state) in settings.axes.iter().zip(&self.axes) {
                axis.limits.admit(state.position, state.velocity)?;
                let largest = axis.limits.offset.to_f64();
                error::within("offset", state.offset.offset, -largest, largest)?;
            }
            self.check_goals(&settings)?;
            Ok(laws)
        });
        match accepted {
            Ok(laws) => {
                for (state, law) in self.axes.iter_mut().zip(laws) {
                    state.law = law;
                }
                // What a smaller tank cannot hold is gone; without a tank there are no books, and no debt.
                let kept = |energy: Stored<T>, is_there: bool| match settings.tank.filter(|_| is_there) {
                    Some(tank) => energy.capped(tank.capacity()),
                    None => Stored::new(T::ZERO),
                };
                self.energy = kept(self.energy, true);
                // A port that is added later starts empty, like a tank.
                if self.settings.port.is_none() {
                    self.open_port();
                }
                self.port_energy = kept(self.port_energy, settings.port.is_some());
                self.settings = settings;
                self.cache.dt = T::ZERO;
                self.tare = TareWindow::default();
                Ok(())
            }
            Err(refusal) => {
                count(&mut self.counters.refused);
                Err(refusal)
            }
        }
    }

    /// One step of `dt` [s]. Total: whatever comes in, the commands are finite and within every limit.
    pub fn update(&mut self, input: &Input<T, D>, dt: T) -> Output<T, D> {
        self.status = Status::default();
        if let Some(request) = input.request
            && !self.handle_request(request, input)
        {
            self.status.refused = true;
            count(&mut self.counters.refused);
        }
        match self.validate_dt(dt) {
            Some(dt) => self.advance(input, dt),
            None => self.stand(input),
        }
        self.output()
    }

    /// Does what is asked for; returns whether it did.
    fn handle_request(&mut self, request: Request<T, D>, input: &Input<T, D>) -> bool {
        match request {
            Request::Start => self.handle_event(Event::Start),
            Request::Hold => self.handle_event(Event::Hold),
            Request::Resume => self.handle_event(Event::Resume),
            Request::Stop => self.handle_event(Event::Stop),
            Request::Goal(goal) => self.retarget(goal),
            Request::Tare => self.handle_tare(input),
            Request::Reset(position) => {
                self.mode.after(Event::Reset).is_some()
                    && self.place_at(position).is_ok()
                    && self.handle_event(Event::Reset)
            }
        }
    }

    /// Goes to the mode after `event`; returns whether there is one.
    fn handle_event(&mut self, event: Event) -> bool {
        let Some(mode) = self.mode.after(event) else { return false };
        if mode == Mode::Fault && self.mode != Mode::Fault {
            count(&mut self.counters.faults);
        }
        self.mode = mode;
        true
    }

    /// Puts everything to the start of the movement, at rest at `position`, but for mode, counters, and what is known of the
    /// force: bias, filter and last good reading stay.
    fn place_at(&mut self, position: [T; D]) -> Result<(), ConfigError> {
        for (axis, &position) in self.settings.axes.iter().zip(&position) {
            axis.limits.admit(position, T::ZERO)?;
        }
        let profiles = self.skill.at(self.skill.phase().start());
        let slots = self.axes.iter_mut().zip(self.skill.axes()).zip(position).zip(profiles);
        for (((state, primitives), position), Profile { stiffness, damping, .. }) in slots {
            *state = AxisState {
                reference: Reference::at_rest(position, primitives.movement.goal()),
                offset: OffsetMotion { offset: T::ZERO, velocity: T::ZERO },
                position,
                velocity: T::ZERO,
                stiffness,
                damping,
                force: T::ZERO,
                hits: Hits::default(),
                ..*state
            };
        }
        self.phase = self.skill.phase().start();
        self.rate = T::ZERO;
        self.energy = Stored::new(self.settings.tank.map_or(T::ZERO, |tank| tank.capacity()));
        self.port_energy = Stored::new(self.settings.port.map_or(T::ZERO, |_| self.energy.level()));
        self.open_port();
        (self.ended, self.moved, self.phase_remainder) = (false, false, T::ZERO);
        (self.tare, self.debts) = (TareWindow::default(), Debts::UNREAD);
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
        let flying = match self.mode {
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
        for (state, goal) in self.axes.iter_mut().zip(goal) {
            if flying {
                state.reference.retarget(goal);
            } else {
                state.reference = Reference::at_rest(state.position, goal);
            }
        }
        true
    }
}
