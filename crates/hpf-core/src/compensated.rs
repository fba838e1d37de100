//! Sums of many small changes: what rounding takes from one change is carried to the next.
//!
//! `sum = value + (change + remainder)`, `remainder = (change + remainder) - (sum - value)` (Kahan, Communications of the
//! ACM 8(1):40, 1965): a long skill in single precision makes millions of steps, each of which a plain sum would round by
//! as much as a hundredth of the step.

use crate::Real;
use crate::domain::{TINY, tiny_phase};

/// A remainder below is zero: changes of a millionth of a millionth of [`TINY`] still count.
const TINY_REMAINDER: f64 = 1e-30;

/// Adds `change` to `value`, of which `remainder` has been lost in rounding so far; each is zero where its size is below
/// its `tiny`.
#[inline(always)]
fn add<T: Real>(value: &mut T, remainder: &mut T, change: T, size: impl Fn(T) -> T, tiny: [T; 2]) {
    let flushed = |x: T, size: T, tiny: T| size.select_below(tiny, T::ZERO, x);
    let [tiny, tiny_remainder] = tiny;
    let change = change + *remainder;
    let sum = *value + change;
    let lost = change - (sum - *value);
    *remainder = flushed(lost, lost.abs(), tiny_remainder);
    *value = flushed(sum, size(sum), tiny);
}

/// Adds `change` to a motion's `value`, of which `remainder` has been lost in rounding so far. What dies away becomes zero.
#[inline(always)]
pub(crate) fn accumulate<T: Real>(value: &mut T, remainder: &mut T, change: T) {
    add(value, remainder, change, T::abs, [T::of(TINY), T::of(TINY_REMAINDER)]);
}

/// The same for a phase, which counts down to smaller numbers and, however the step to its very end rounds, not below zero.
#[inline(always)]
pub(crate) fn accumulate_phase<T: Real>(phase: &mut T, remainder: &mut T, change: T) {
    add(phase, remainder, change, |phase| phase, [tiny_phase(), tiny_phase::<T>() * T::of(1e-6)]);
}

/// `a + b`, and what rounding takes from it, whichever is larger (Knuth's two-sum).
pub(crate) fn two_sum<T: Real>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}
