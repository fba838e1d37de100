//! The hybrid primitive: movement, stiffness and damping of every axis, driven by one phase.
//!
//! One step of `dt` [s] at `rate` r, per axis (the order is that of its parts, each exact for what it holds):
//! 1. phase to mid-step: `s_m = s exp(-alpha_s r h/(2 tau))`; the bases are evaluated there, once for all axes
//!    and once for the primitives that share one;
//! 2. movement: the exact step with F(s_m), second order;
//! 3. admittance by the axis' [`Law`], with k(s_m), d(s_m), second order in the parameters; the measured force is held,
//!    which is sampling, not integration;
//! 4. phase to the end of the step.
//!
//! Phase and reference are stepped as a controller steps them: sums of changes whose rounding is carried on, so that
//! single precision serves skills of hours.

use crate::admittance::{Inertial, OffsetMotion, step_offset};
use crate::domain::LARGEST;
use crate::reference::{Stride, advance};
use crate::{Basis, ConfigError, Gain, Law, Movement, MovementState, Phase, Real, error};

/// The three primitives of one axis and its law; `S` holds each primitive's weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisPrimitives<T, S> {
    /// Where to go.
    pub movement: Movement<T, S>,
    /// How stiffly to hold it [N/m].
    pub stiffness: Gain<T, S>,
    /// How much to damp it [N s/m].
    pub damping: Gain<T, S>,
    /// By which law it gives way to force.
    pub law: Law<T>,
}

/// The parameters of one skill of `D` axes; `S` holds each list: `[T; N]` in firmware, `Vec<T>` on a host.
///
/// ```
/// use hpf_core::*;
/// let basis = Basis::equally_spaced(100.0_f64.ln(), 0.6, [0.0; 5], [0.0; 5])?;
/// let axis = AxisPrimitives {
///     movement: Movement::new(0.0, 1.0, 25.0, 1.0, [0.0; 5])?,
///     stiffness: Gain::new(30.0, 400.0, [100.0; 5])?,
///     damping: Gain::new(10.0, 100.0, [50.0; 5])?,
///     law: Law::FirstOrder,
/// };
/// let skill = HybridPrimitive::new(Phase::new(1.0, 100.0_f64.ln())?, [basis; 3], [axis])?;
/// let mut state = skill.initial_state();
/// for _ in 0..10_000 {
///     skill.step(&mut state, [20.0], 1.0, 1e-3); // the environment pushes with 20 N
/// }
/// let [axis] = state.axes;
/// assert!((axis.reference.position - 1.0).abs() < 1e-6); // the reference is at the goal,
/// assert!((axis.offset - 0.2).abs() < 1e-6); // the tool gives way by f/k = 20/100 m
/// # Ok::<(), ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HybridPrimitive<T, S, const D: usize> {
    phase: Phase<T>,
    movement_basis: Basis<T, S>,
    stiffness_basis: Basis<T, S>,
    damping_basis: Basis<T, S>,
    sharing: Sharing,
    axes: [AxisPrimitives<T, S>; D],
}

/// Which primitives have one and the same basis: it is then evaluated once per step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sharing {
    /// Movement, stiffness and damping.
    All,
    /// Stiffness and damping.
    Gains,
    /// None.
    Nothing,
}

/// The three primitives of one axis at one phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile<T> {
    /// Forcing term F of the movement [axis unit].
    pub forcing: T,
    /// Stiffness [N/m].
    pub stiffness: T,
    /// Damping as the primitive has it [N s/m].
    pub damping: T,
}

/// State of one axis of a skill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisState<T> {
    /// Reference motion.
    pub reference: MovementState<T>,
    /// What position and velocity have lost in rounding so far: without it, single precision strays on long skills and
    /// stalls short of a far goal.
    pub remainder: MovementState<T>,
    /// Offset e: commanded minus reference position [axis unit].
    pub offset: T,
    /// Its velocity [axis unit/s]; of a first-order axis zero, for it has no inertia.
    pub offset_velocity: T,
}

/// State of a skill: plain data, copy it to take a snapshot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HybridState<T, const D: usize> {
    /// Phase s, 1 at the start.
    pub phase: T,
    /// What the phase has lost in rounding so far.
    pub phase_remainder: T,
    /// One state per axis.
    pub axes: [AxisState<T>; D],
}

/// What one step asks of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisCommand<T> {
    /// Commanded position: reference + offset [axis unit].
    pub position: T,
    /// Commanded velocity [axis unit/s].
    pub velocity: T,
    /// Stiffness at mid-step [N/m].
    pub stiffness: T,
    /// Damping at mid-step, by the law [N s/m].
    pub damping: T,
}

impl<T: Real, S: AsRef<[T]>, const D: usize> HybridPrimitive<T, S, D> {
    /// A skill from its phase, the bases of movement, stiffness and damping, and its axes.
    ///
    /// # Errors
    /// [`ConfigError`] where an axis has not one weight per function of the basis, and for a law with a number outside its
    /// [domain](crate::domain).
    pub fn new(
        phase: Phase<T>,
        [movement_basis, stiffness_basis, damping_basis]: [Basis<T, S>; 3],
        axes: [AxisPrimitives<T, S>; D],
    ) -> Result<Self, ConfigError> {
        for axis in &axes {
            error::finite_list("movement.weights", axis.movement.weights(), movement_basis.count())?;
            error::finite_list("stiffness.weights", axis.stiffness.weights(), stiffness_basis.count())?;
            error::finite_list("damping.weights", axis.damping.weights(), damping_basis.count())?;
        }
        let sharing = match (stiffness_basis.same(&damping_basis), movement_basis.same(&damping_basis)) {
            (true, true) => Sharing::All,
            (true, false) => Sharing::Gains,
            (false, _) => Sharing::Nothing,
        };
        let skill = Self { phase, movement_basis, stiffness_basis, damping_basis, sharing, axes };
        skill.check_laws()?;
        Ok(skill)
    }

    /// The phase all axes share.
    pub fn phase(&self) -> &Phase<T> {
        &self.phase
    }

    /// The bases of movement, stiffness and damping.
    pub fn bases(&self) -> [&Basis<T, S>; 3] {
        [&self.movement_basis, &self.stiffness_basis, &self.damping_basis]
    }

    /// The primitives and the law of each axis.
    pub fn axes(&self) -> &[AxisPrimitives<T, S>; D] {
        &self.axes
    }

    /// The primitives of every axis at phase `s`; a basis they share is evaluated once.
    #[inline]
    pub fn at(&self, s: T) -> [Profile<T>; D] {
        let axes = self.axes.each_ref();
        let mixed = match self.sharing {
            Sharing::All => self.damping_basis.mix_sets(
                s,
                axes.map(|axis| [axis.movement.weights(), axis.stiffness.weights(), axis.damping.weights()]),
            ),
            Sharing::Gains => {
                let mut gains = self
                    .damping_basis
                    .mix_sets(s, axes.map(|axis| [axis.stiffness.weights(), axis.damping.weights()]))
                    .into_iter();
                let movement = self.movement_basis.mix(s, axes.map(|axis| axis.movement.weights()));
                movement.map(|movement| {
                    let [stiffness, damping] = gains.next().unwrap_or([T::ZERO; 2]);
                    [movement, stiffness, damping]
                })
            }
            Sharing::Nothing => {
                let mut stiffness = self.stiffness_basis.mix(s, axes.map(|axis| axis.stiffness.weights())).into_iter();
                let mut damping = self.damping_basis.mix(s, axes.map(|axis| axis.damping.weights())).into_iter();
                let movement = self.movement_basis.mix(s, axes.map(|axis| axis.movement.weights()));
                movement
                    .map(|movement| [movement, stiffness.next().unwrap_or(T::ZERO), damping.next().unwrap_or(T::ZERO)])
            }
        };
        let mut profiles = [Profile { forcing: T::ZERO, stiffness: T::ZERO, damping: T::ZERO }; D];
        let gate = self.phase.gate(s);
        for ((profile, axis), &[movement, stiffness, damping]) in profiles.iter_mut().zip(&self.axes).zip(&mixed) {
            *profile = Profile { forcing: axis.movement.forcing(gate, movement), stiffness, damping };
        }
        profiles
    }

    /// The same skill under other laws, one for each axis: what was learned with the mass of a simulated tool, say, with
    /// that of a robot.
    ///
    /// # Errors
    /// As for [`new`](Self::new).
    pub fn with_laws(self, laws: [Law<T>; D]) -> Result<Self, ConfigError> {
        let mut skill = self;
        for (axis, law) in skill.axes.iter_mut().zip(laws) {
            axis.law = law;
        }
        skill.check_laws()?;
        Ok(skill)
    }

    fn check_laws(&self) -> Result<(), ConfigError> {
        self.axes.iter().try_for_each(|axis| axis.law.check())
    }

    /// At rest at the start, without offset.
    pub fn initial_state(&self) -> HybridState<T, D> {
        let axes = self.axes.each_ref();
        HybridState {
            phase: self.phase.start(),
            phase_remainder: T::ZERO,
            axes: axes.map(|axis| AxisState {
                reference: axis.movement.initial_state(),
                remainder: MovementState { position: T::ZERO, scaled_velocity: T::ZERO },
                offset: T::ZERO,
                offset_velocity: T::ZERO,
            }),
        }
    }

    /// Advances by `dt` [s] under the measured force of the environment on the tool [N], time running at `rate`.
    ///
    /// Total: `rate` is limited to [0, 1]; a `dt` that is negative or not finite counts as no time; a force that is
    /// not finite leaves the offset of its axis where it is, at rest; beyond 1e9, `dt` and force count as 1e9. In a step
    /// 1e15 times longer than the times of its law, `m/d` or `sqrt(m/k)`, a mass counts as none.
    pub fn step(&self, state: &mut HybridState<T, D>, measured_force: [T; D], rate: T, dt: T) -> [AxisCommand<T>; D] {
        let rate = rate.max(T::ZERO).min(T::ONE);
        let largest = T::of(LARGEST);
        let dt = if dt.is_finite() { dt.max(T::ZERO).min(largest) } else { T::ZERO };
        let duration = self.phase.duration();

        let stride = Stride::new(&self.phase, &self.axes, rate, dt);
        let middle = stride.half.middle(state.phase);
        let profiles = self.at(middle);
        stride.half.advance(&mut state.phase, &mut state.phase_remainder, middle, T::ONE);

        let mut commands =
            [AxisCommand { position: T::ZERO, velocity: T::ZERO, stiffness: T::ZERO, damping: T::ONE }; D];
        let slots = commands.iter_mut().zip(&mut state.axes).zip(&self.axes).zip(measured_force).zip(profiles);
        for (((((command, state), axis), force), profile), step) in slots.zip(&stride.axes) {
            let Profile { forcing, stiffness, damping } = profile;
            let damping = axis.law.damping(stiffness, damping);
            let distance = (state.reference.position - axis.movement.goal()) + state.remainder.position;
            let change = step.of(distance, state.reference.scaled_velocity, forcing);
            advance(&mut state.reference, &mut state.remainder, &change, T::ONE);
            let mut give = T::ZERO;
            if !force.is_finite() {
                state.offset_velocity = T::ZERO;
            } else {
                let force = force.max(-largest).min(largest);
                let inertial = match axis.law {
                    Law::FirstOrder => None,
                    Law::SecondOrder { mass, .. } => Inertial::within_reach(mass, stiffness, damping, dt),
                };
                if let Some(inertial) = inertial {
                    let mut motion = OffsetMotion { offset: state.offset, velocity: state.offset_velocity };
                    inertial.step(&mut motion, stiffness, damping, force, dt);
                    (state.offset, state.offset_velocity) = (motion.offset, motion.velocity);
                    give = motion.velocity;
                } else {
                    state.offset = step_offset(state.offset, stiffness, damping, force, dt);
                    state.offset_velocity = T::ZERO;
                    give = (force - stiffness * state.offset) / damping;
                }
            }
            *command = AxisCommand {
                position: state.reference.position + state.offset,
                velocity: state.reference.scaled_velocity * rate / duration + give,
                stiffness,
                damping,
            };
        }
        commands
    }
}
