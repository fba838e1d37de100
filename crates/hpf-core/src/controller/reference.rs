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
    course: Course<T>,
}

/// Motion relative to the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Course<T> {
    motion: MovementState<T>,
    /// The gliding goal.
    goal: MovementState<T>,
}

impl<T: Real> Course<T> {
    /// At rest at the target.
    pub const AT_GOAL: Self = {
        let rest = MovementState { position: T::ZERO, scaled_velocity: T::ZERO };
        Self { motion: rest, goal: rest }
    };
}

impl<T: Real + PartialOrd> Reference<T> {
    /// At rest at `position`, on its way to `target`.
    pub fn at_rest(position: T, target: T) -> Self {
        let mut course = Course::AT_GOAL;
        course.motion.position = position - target;
        Self { target, course }
    }

    /// Position [axis unit].
    #[inline]
    pub fn position(&self) -> T {
        self.target + self.course.motion.position
    }

    /// Gives it another target; neither the motion nor the gliding goal jumps.
    pub fn retarget(&mut self, target: T) {
        let gap = self.target - target;
        self.target = target;
        self.course.motion.position += gap;
        self.course.goal.position += gap;
    }

    /// Moves it by `distance` without changing how it moves.
    #[inline]
    pub fn shift(&mut self, distance: T) {
        self.course.motion.position += distance;
    }

    /// Its course one step later, `forcing` held over the step.
    #[inline]
    pub fn ahead(&self, transition: &Transition<T>, forcing: T) -> Course<T> {
        let Course { mut motion, mut goal } = self.course;
        transition.fade(&mut goal);
        let middle = T::of(0.5) * (self.course.goal.position + goal.position);
        transition.apply(&mut motion, middle, forcing);
        Course { motion, goal }
    }

    /// How far `next` is from here [axis unit].
    #[inline]
    pub fn distance(&self, next: &Course<T>) -> T {
        next.motion.position - self.course.motion.position
    }

    /// Goes the part `share` of the way to `next`.
    #[inline]
    pub fn go(&mut self, next: &Course<T>, share: T) {
        if share >= T::ONE {
            self.course = *next;
            return;
        }
        let part = |from: MovementState<T>, to: MovementState<T>| MovementState {
            position: from.position + share * (to.position - from.position),
            scaled_velocity: from.scaled_velocity + share * (to.scaled_velocity - from.scaled_velocity),
        };
        let Course { motion, goal } = self.course;
        self.course = Course { motion: part(motion, next.motion), goal: part(goal, next.goal) };
    }
}
