//! The caller's memory: a controller in front, its lists behind.
//!
//! ```text
//! memory   | Slot: head, controller | centers, widths of each basis | weights |
//! ```
//! Bases that are equal share their lists. Borrowed lists stay where the caller has them.

use core::slice;

use hpf_core::{AxisPrimitives, Basis, Gain, HybridPrimitive, Law, Movement, Phase, Real};

use crate::abi::{
    BasisPolicy, HPF_BASES_MAX, HPF_BASIS_PHASE, HPF_BASIS_STORED, HPF_BASIS_TIME, HPF_LISTS_BORROWED,
    HPF_LISTS_COPIED, Policy,
};
use crate::status::{HPF_MISALIGNED, HPF_NULL_POINTER, HPF_TOO_SMALL, HPF_UNKNOWN_CHOICE, HPF_WRONG_BASES, Refusal};

/// A list in memory that outlives the controller: behind it, or the caller's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct List<T> {
    start: *mut T,
    count: usize,
}

impl<T> AsRef<[T]> for List<T> {
    fn as_ref(&self) -> &[T] {
        // SAFETY: only `ListArena` makes lists: aligned, of `count` numbers, in memory that by the contract of `create` stays
        // and is written by nobody while the controller is used.
        unsafe { slice::from_raw_parts(self.start, self.count) }
    }
}

impl<T> AsMut<[T]> for List<T> {
    fn as_mut(&mut self) -> &mut [T] {
        // SAFETY: as above; called on lists fresh from `ListArena::take` only, which no copy of yet exists.
        unsafe { slice::from_raw_parts_mut(self.start, self.count) }
    }
}

/// The part of the memory that is not yet given away, and whether lists are copied into it.
pub(crate) struct ListArena<T> {
    next: *mut T,
    left: usize,
    copies: bool,
}

impl<T: Real + PartialOrd> ListArena<T> {
    /// Space for `left` numbers from `next` on.
    ///
    /// # Safety
    /// `next` is aligned and so much memory is there for writing, used by nobody else.
    pub(crate) unsafe fn new(next: *mut T, left: usize, copies: bool) -> Self {
        Self { next, left, copies }
    }

    /// A list of `count` zeros.
    fn take(&mut self, count: usize) -> Result<List<T>, Refusal> {
        let Some(left) = self.left.checked_sub(count) else { return Err(HPF_TOO_SMALL.into()) };
        let start = self.next;
        for i in 0..count {
            // SAFETY: by `new`, `left >= count` numbers are there.
            unsafe { start.add(i).write(T::ZERO) };
        }
        self.left = left;
        // SAFETY: as above; at most one past the end.
        self.next = unsafe { start.add(count) };
        Ok(List { start, count })
    }

    /// The caller's list of `count` numbers, copied or not.
    ///
    /// # Safety
    /// Unless null or not aligned, `from` points to as many.
    unsafe fn keep(&mut self, from: *const T, count: usize) -> Result<List<T>, Refusal> {
        if from.is_null() {
            return Err(HPF_NULL_POINTER.into());
        }
        if !from.is_aligned() {
            return Err(HPF_MISALIGNED.into());
        }
        if !self.copies {
            return Ok(List { start: from.cast_mut(), count });
        }
        let list = self.take(count)?;
        // SAFETY: `from` by contract, `list` just taken; the caller's memory and the controller's do not overlap.
        unsafe { list.start.copy_from_nonoverlapping(from, count) };
        Ok(list)
    }

    /// The basis that `policy` describes over a phase that falls by `decay`.
    ///
    /// # Safety
    /// As for the lists in it.
    unsafe fn basis(&mut self, policy: &BasisPolicy<T>, decay: T) -> Result<Basis<T, List<T>>, Refusal> {
        let count = policy.count as usize;
        Ok(match policy.family {
            HPF_BASIS_PHASE => Basis::equally_spaced(decay, policy.overlap, self.take(count)?, self.take(count)?)?,
            HPF_BASIS_TIME => {
                Basis::equally_spaced_in_time(decay, policy.overlap, self.take(count)?, self.take(count)?)?
            }
            // SAFETY: by contract.
            _ => unsafe { Basis::new(self.keep(policy.centers, count)?, self.keep(policy.widths, count)?)? },
        })
    }

    /// The skill that `policy`, checked by [`numbers`], describes.
    ///
    /// # Safety
    /// Every list in it that is not null and is aligned has as many numbers as its basis has functions.
    pub(crate) unsafe fn skill<const D: usize>(
        &mut self,
        policy: &Policy<T>,
    ) -> Result<HybridPrimitive<T, List<T>, D>, Refusal> {
        let phase = Phase::new(policy.duration, policy.decay)?;
        let [movement, stiffness, damping] = bases(policy);
        // SAFETY: by contract.
        let movement_basis = unsafe { self.basis(movement, policy.decay)? };
        let stiffness_basis = match stiffness == movement {
            true => movement_basis,
            // SAFETY: by contract.
            false => unsafe { self.basis(stiffness, policy.decay)? },
        };
        let damping_basis = match (damping == stiffness, damping == movement) {
            (true, _) => stiffness_basis,
            (false, true) => movement_basis,
            // SAFETY: by contract.
            (false, false) => unsafe { self.basis(damping, policy.decay)? },
        };
        let mut axes = [None; D];
        for (slot, axis) in axes.iter_mut().zip(&policy.axis) {
            // SAFETY: by contract.
            let weights = unsafe {
                [
                    self.keep(axis.movement_weights, movement.count as usize)?,
                    self.keep(axis.stiffness_weights, stiffness.count as usize)?,
                    self.keep(axis.damping_weights, damping.count as usize)?,
                ]
            };
            let [movement, stiffness, damping] = weights;
            *slot = Some(AxisPrimitives {
                movement: Movement::new(axis.start, axis.goal, axis.alpha, axis.forcing_scale, movement)?,
                stiffness: Gain::new(axis.stiffness_min, axis.stiffness_max, stiffness)?,
                damping: Gain::new(axis.damping_min, axis.damping_max, damping)?,
                law: Law::of(axis.mass, axis.damping_ratio, axis.damping_floor)?,
            });
        }
        let Some(axes) = all(axes) else { return Err(crate::status::HPF_WRONG_AXES.into()) };
        Ok(HybridPrimitive::new(phase, [movement_basis, stiffness_basis, damping_basis], axes)?)
    }
}

/// Every value, if none is missing.
fn all<V: Copy, const D: usize>(values: [Option<V>; D]) -> Option<[V; D]> {
    let mut found = [values.first().copied().flatten()?; D];
    for (slot, value) in found.iter_mut().zip(values) {
        *slot = value?;
    }
    Some(found)
}

fn bases<T>(policy: &Policy<T>) -> [&BasisPolicy<T>; 3] {
    [&policy.movement_basis, &policy.stiffness_basis, &policy.damping_basis]
}

/// How many numbers [`ListArena::skill`] takes, and whether it copies; refuses what no skill can be.
pub(crate) fn numbers<T: Real + PartialOrd>(policy: &Policy<T>, axes: usize) -> Result<(usize, bool), Refusal> {
    let copies = match policy.lists {
        HPF_LISTS_COPIED => true,
        HPF_LISTS_BORROWED => false,
        _ => return Err(HPF_UNKNOWN_CHOICE.into()),
    };
    let [movement, stiffness, damping] = bases(policy);
    let mut total = 0;
    for (basis, shared) in
        [(movement, false), (stiffness, stiffness == movement), (damping, damping == stiffness || damping == movement)]
    {
        let count = basis.count as usize;
        if !(2..=HPF_BASES_MAX).contains(&count) {
            return Err(HPF_WRONG_BASES.into());
        }
        let made = match basis.family {
            HPF_BASIS_PHASE | HPF_BASIS_TIME => true,
            HPF_BASIS_STORED => copies,
            _ => return Err(HPF_UNKNOWN_CHOICE.into()),
        };
        total += if made && !shared { 2 * count } else { 0 } + if copies { axes * count } else { 0 };
    }
    Ok((total, copies))
}
