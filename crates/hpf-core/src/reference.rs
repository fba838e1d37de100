//! The stepper of a skill's reference: phase to mid-step, forcing term there, exact step of every movement.
//!
//! ```text
//! s_m = s + s half,   F = gamma(s_m) A sum_i w_i phi_i(s_m),   (x, z)+ = step(x, z; g, F),   s+ = s + (s + s_m) half
//! ```
//!
//! | who steps | phase | motion |
//! |---|---|---|
//! | [`HybridPrimitive::step`](crate::HybridPrimitive::step) | [`Stride`], at any rate | sums of changes, rounding carried |
//! | [`Controller`](crate::controller::Controller) | [`Stride`], of which it may go a part | the same, relative to a goal that glides |
//! | rollouts, fits | known in advance | [`PlannedReference`]: equal steps from state to state |
//!
//! The exact step has two forms, which are equal but for rounding: what it adds
//! ([`Increment`](crate::movement::Increment)), for loops of millions of steps in single precision, and where it leads
//! ([`Transition`]), for the few thousand of a rollout.

use crate::compensated::{accumulate, two_sum};
use crate::movement::Increment;
use crate::phase::HalfStep;
use crate::{AxisPrimitives, ConfigError, Movement, MovementState, Phase, Real, Transition};

/// What the rate of time and the length of a step decide about phase and reference motions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stride<T, const D: usize> {
    pub half: HalfStep<T>,
    /// The step of each axis' movement.
    pub axes: [Increment<T>; D],
}

impl<T: Real, const D: usize> Stride<T, D> {
    /// No step.
    pub const NONE: Self = Self { half: HalfStep::NONE, axes: [Increment::NONE; D] };

    /// The step of `dt` [s] at `rate`; axes with the same alpha as the one before share its numbers.
    #[inline]
    pub fn new<S: AsRef<[T]>>(phase: &Phase<T>, axes: &[AxisPrimitives<T, S>; D], rate: T, dt: T) -> Self {
        let mut stride = Self { half: phase.half_step(rate, dt), ..Self::NONE };
        let normalised_dt = rate * dt / phase.duration();
        let mut last: Option<(T, Increment<T>)> = None;
        for (slot, AxisPrimitives { movement, .. }) in stride.axes.iter_mut().zip(axes) {
            let alpha = movement.alpha();
            *slot = match last {
                Some((same, step)) if alpha == same => step,
                _ => Increment::new(alpha, normalised_dt),
            };
            last = Some((alpha, *slot));
        }
        stride
    }
}

/// A reference at the nominal rate in equal steps, its forcing term known at every mid-step.
///
/// ```
/// use hpf_core::PlannedReference;
/// let reference = PlannedReference::new(0.0, 1.0, 25.0, 1.0, 2.0, 0.02)?; // from 0 to 1 in 2 s, in steps of 20 ms
/// let mut state = reference.initial_state();
/// for _ in 0..100 {
///     reference.step(&mut state, reference.goal(), 0.0, 0.0); // no forcing: the critically damped pull alone
/// }
/// let u = 12.5_f64; // alpha/2, the whole duration
/// assert!((state.position - (1.0 - (1.0 + u) * (-u).exp())).abs() < 1e-12);
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedReference<T> {
    movement: Movement<T, [T; 0]>,
    transition: Transition<T>,
    /// 1 over the duration [1/s].
    per_duration: T,
}

impl<T: Real> PlannedReference<T> {
    /// A reference from rest at `start` to `goal` (both in the axis unit) in `duration` [s], in steps of `dt` [s].
    ///
    /// # Errors
    /// As [`Movement::new`].
    pub fn new(start: T, goal: T, alpha: T, forcing_scale: T, duration: T, dt: T) -> Result<Self, ConfigError> {
        Ok(Self {
            movement: Movement::new(start, goal, alpha, forcing_scale, [])?,
            transition: Transition::new(alpha, dt / duration),
            per_duration: T::ONE / duration,
        })
    }

    /// Where the movement ends [axis unit].
    #[inline(always)]
    pub fn goal(&self) -> T {
        self.movement.goal()
    }

    /// Scale A of the forcing term [axis unit].
    #[inline(always)]
    pub fn forcing_scale(&self) -> T {
        self.movement.forcing_scale()
    }

    /// The state at the start: at rest.
    #[inline(always)]
    pub fn initial_state(&self) -> MovementState<T> {
        self.movement.initial_state()
    }

    /// Advances `state` by one step towards `goal`, given gate and mixture of the weights at mid-step.
    #[inline(always)]
    pub fn step(&self, state: &mut MovementState<T>, goal: T, gate: T, mixed_weights: T) {
        self.transition.apply(state, goal, self.movement.forcing(gate, mixed_weights));
    }

    /// Velocity of the reference [axis unit/s].
    #[inline(always)]
    pub fn velocity(&self, state: &MovementState<T>) -> T {
        state.scaled_velocity * self.per_duration
    }
}

/// Reference motion of one axis, kept relative to its goal, with a goal that may move.
///
/// Where a new goal is set, the goal that the movement is pulled to glides there by the movement's own critically damped
/// law, without forcing and in the same path time. Everything is stored relative to the new goal: nearing it, single
/// precision grows finer instead of rounding the last steps away. What rounding takes from a step, or from a target far
/// away, is kept and carried on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reference<T> {
    /// Where it goes in the end [axis unit].
    pub target: T,
    course: Course<T>,
    /// What the course has lost in rounding.
    remainder: Course<T>,
}

/// Motion relative to the target, or a change of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Course<T> {
    motion: MovementState<T>,
    /// The gliding goal.
    goal: MovementState<T>,
}

impl<T: Real> Course<T> {
    /// At rest at the target; no change.
    pub const NONE: Self = {
        let none = MovementState { position: T::ZERO, scaled_velocity: T::ZERO };
        Self { motion: none, goal: none }
    };

    /// How far the motion goes, where this is a change [axis unit].
    #[inline]
    pub fn distance(&self) -> T {
        self.motion.position
    }
}

/// Adds the part `share` of `change` to `motion`; `remainder` carries what rounding takes.
#[inline(always)]
pub(crate) fn advance<T: Real>(
    motion: &mut MovementState<T>,
    remainder: &mut MovementState<T>,
    change: &MovementState<T>,
    share: T,
) {
    accumulate(&mut motion.position, &mut remainder.position, share * change.position);
    accumulate(&mut motion.scaled_velocity, &mut remainder.scaled_velocity, share * change.scaled_velocity);
}

impl<T: Real + PartialOrd> Reference<T> {
    /// At rest at `position`, on its way to `target`.
    pub fn at_rest(position: T, target: T) -> Self {
        let (mut course, mut remainder) = (Course::NONE, Course::NONE);
        (course.motion.position, remainder.motion.position) = two_sum(position, -target);
        Self { target, course, remainder }
    }

    /// Position [axis unit].
    #[inline]
    pub fn position(&self) -> T {
        self.target + self.course.motion.position + self.remainder.motion.position
    }

    /// Gives it another target; neither the motion nor the gliding goal jumps.
    pub fn retarget(&mut self, target: T) {
        let (gap, lost) = two_sum(self.target, -target);
        self.target = target;
        let (course, remainder) = (&mut self.course, &mut self.remainder);
        for (position, remainder) in [
            (&mut course.motion.position, &mut remainder.motion.position),
            (&mut course.goal.position, &mut remainder.goal.position),
        ] {
            let (sum, lost_too) = two_sum(*position, gap);
            *position = sum;
            *remainder += lost + lost_too;
        }
    }

    /// Moves it by `distance` without changing how it moves.
    #[inline]
    pub fn shift(&mut self, distance: T) {
        accumulate(&mut self.course.motion.position, &mut self.remainder.motion.position, distance);
    }

    /// What one step changes, `forcing` held over it.
    #[inline]
    pub fn ahead(&self, step: &Increment<T>, forcing: T) -> Course<T> {
        let Course { motion, goal } = &self.course;
        let mut change = Course::NONE;
        let mut distance = motion.position;
        if *goal != Course::NONE.goal {
            change.goal = step.of(goal.position, goal.scaled_velocity, T::ZERO);
            // Far from the target both are coarse, and what they have lost in rounding is as large as their distance.
            let lost = self.remainder.motion.position - self.remainder.goal.position;
            distance = (motion.position - goal.position) + lost - T::of(0.5) * change.goal.position;
        }
        change.motion = step.of(distance, motion.scaled_velocity, forcing);
        change
    }

    /// Goes the part `share` of `change`.
    #[inline]
    pub fn go(&mut self, change: &Course<T>, share: T) {
        let (course, remainder) = (&mut self.course, &mut self.remainder);
        advance(&mut course.motion, &mut remainder.motion, &change.motion, share);
        if course.goal != Course::NONE.goal {
            advance(&mut course.goal, &mut remainder.goal, &change.goal, share);
        }
    }
}
