//! The reference of one axis, kept relative to its goal, with a goal that may move.
//!
//! Where a new goal is set, the goal that the movement is pulled to glides there by the movement's own critically damped
//! law, without forcing and in the same path time. Everything is stored relative to the new goal: nearing it, single
//! precision grows finer instead of rounding the last steps away. What rounding takes from a step, or from a target far
//! away, is kept and carried on.

use crate::compensated::{accumulate, two_sum};
use crate::movement::Increment;
use crate::{MovementState, Real};

/// Reference motion of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reference<T> {
    /// Where it goes in the end [axis unit].
    pub target: T,
    course: Course<T>,
    /// What the course has lost in rounding.
    remainder: Course<T>,
}

/// Motion relative to the target, or a change of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Course<T> {
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

/// Adds the part `share` of `change` to `motion`.
#[inline(always)]
fn advance<T: Real>(
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
