//! The reference of one axis, kept relative to its goal, with a goal that may move.
//!
//! Where a new goal is set, the goal that the movement is pulled to glides there by the movement's own critically damped
//! law, without forcing and in the same path time. Everything is stored relative to the new goal: nearing it, single
//! precision grows finer instead of rounding the last steps away.

use crate::{MovementState, Real, Transition};

/// Reference motion of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reference<T> {
    /// Where it goes in the end [axis unit].
    pub target: T,
    /// Motion relative to the target.
    motion: MovementState<T>,
    /// Gliding goal relative to the target.
    goal: MovementState<T>,
}

impl<T: Real> Reference<T> {
    /// At rest at `position`, on its way to `target`.
    pub fn at_rest(position: T, target: T) -> Self {
        let rest = MovementState { position: T::ZERO, scaled_velocity: T::ZERO };
        Self { target, motion: MovementState { position: position - target, ..rest }, goal: rest }
    }

    /// Position [axis unit].
    #[inline]
    pub fn position(&self) -> T {
        self.target + self.motion.position
    }

    /// Gives it another target; neither the motion nor the gliding goal jumps.
    pub fn retarget(&mut self, target: T) {
        let gap = self.target - target;
        self.target = target;
        self.motion.position += gap;
        self.goal.position += gap;
    }

    /// Moves it by `distance` without changing how it moves.
    #[inline]
    pub fn shift(&mut self, distance: T) {
        self.motion.position += distance;
    }

    /// The reference one step later, `forcing` held over the step.
    #[inline]
    pub fn ahead(&self, transition: &Transition<T>, forcing: T) -> Self {
        let mut next = *self;
        transition.apply(&mut next.goal, T::ZERO, T::ZERO);
        let middle = T::of(0.5) * (self.goal.position + next.goal.position);
        transition.apply(&mut next.motion, middle, forcing);
        next
    }

    /// How far `next` is from here [axis unit].
    #[inline]
    pub fn distance(&self, next: &Self) -> T {
        next.motion.position - self.motion.position
    }

    /// Goes the part `share` of the way to `next`.
    #[inline]
    pub fn go(&mut self, next: &Self, share: T) {
        let part = |from: MovementState<T>, to: MovementState<T>| MovementState {
            position: from.position + share * (to.position - from.position),
            scaled_velocity: from.scaled_velocity + share * (to.scaled_velocity - from.scaled_velocity),
        };
        self.motion = part(self.motion, next.motion);
        self.goal = part(self.goal, next.goal);
    }
}
