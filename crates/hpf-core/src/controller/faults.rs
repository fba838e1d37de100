//! The one table of bad inputs: what is done at once, and when it becomes a fault.
//!
//! | input | bad where | at once | lost after | then |
//! |---|---|---|---|---|
//! | force | an axis not finite, or all older than `oldest_force` | the last good one of that axis stands in | `hold` | offsets freeze, rest by the ramp, Fault |
//! | position | an axis not finite | the other axes are watched | `hold` | rest by the ramp, Fault |
//! | rate | not finite | counts as 0: rest by the ramp | `hold` | Fault |
//! | dt | not finite, or below 1 us | no time: the command stands still, at velocity 0; then on from rest by the ramp | [`CLOCK_STEPS`] steps | Fault |
//! | dt | above `longest_step` | cut; of a step, the part that is cut is bad, one at most | [`CLOCK_STEPS`] steps | rest by the ramp, Fault |
//!
//! Each input owes its bad time, a dt its bad steps. Good time pays back [`DRAIN`] of itself: an input that is bad for
//! more than a fifth of the time owes ever more, however its good moments lie. It is lost while it owes more than its
//! limit and has not been good for as long as that since. A lost input is a Fault once the path is at rest, and at the
//! latest when it owes more than its limit by the ramp, a dt by as many steps again. In Idle nothing moves, nothing
//! becomes a fault, and a good input owes nothing. Whatever the others do, each is judged by itself; while dt is bad,
//! time stands still for all of them.

use crate::Real;

/// Good time pays back this share of itself.
pub const DRAIN: f64 = 0.25;

/// A dt may owe so many bad steps.
pub const CLOCK_STEPS: f64 = 20.0;

/// What each input owes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Debts<T> {
    pub force: Debt<T>,
    pub position: Debt<T>,
    pub rate: Debt<T>,
    pub clock: Debt<T>,
    /// Whether one of them owes anything.
    pub any: bool,
}

impl<T: Real + PartialOrd> Debts<T> {
    /// Nothing is owed, and no force has been read yet.
    pub const UNREAD: Self =
        Self { force: Debt::UNREAD, position: Debt::NONE, rate: Debt::NONE, clock: Debt::NONE, any: true };

    /// Looks whether anything is owed.
    pub fn sum_up(&mut self) {
        self.any = [self.force, self.position, self.rate, self.clock].into_iter().any(|debt| debt != Debt::NONE);
    }
}

/// What one input owes, in s, a dt in steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Debt<T> {
    /// None where it has never been good.
    owed: Option<T>,
    /// For how long it has been good since it was bad, no longer than matters.
    good_for: T,
}

impl<T: Real + PartialOrd> Debt<T> {
    const UNREAD: Self = Self { owed: None, good_for: T::ZERO };
    const NONE: Self = Self { owed: Some(T::ZERO), good_for: T::ZERO };

    /// More than `limit` is owed, and it has not been good for as long since.
    pub fn lost(self, limit: T) -> bool {
        self.owed.is_none_or(|owed| owed > limit && self.good_for <= limit)
    }

    /// It is lost, and more than `limit` is owed by `ramp` and more: it comes and goes too often.
    pub fn hopeless(self, limit: T, ramp: T) -> bool {
        self.lost(limit) && self.owed.is_some_and(|owed| owed > limit + ramp)
    }

    /// A good step that pays back its part of `whole`; `still`: nothing moves.
    pub fn pay(&mut self, whole: T, still: bool) {
        let owed = if still { T::ZERO } else { self.owed.unwrap_or(T::ZERO) };
        let left = owed - whole * T::of(DRAIN);
        *self = if left > T::ZERO { Self { owed: Some(left), good_for: self.good_for + whole } } else { Self::NONE };
    }

    /// A step that is bad for `part`, where `limit` is lost. Never is more than `most` above it owed.
    pub fn owe(&mut self, part: T, limit: T, most: T, still: bool) {
        self.good_for = T::ZERO;
        self.owed = self.owed.map(|owed| (owed + part).at_most(limit + most));
        if still && self.lost(limit) {
            self.owed = None;
        }
    }
}
