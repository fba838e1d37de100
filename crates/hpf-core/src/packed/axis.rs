//! What a packed skill holds of one axis, number by number.

use core::iter;

use super::{Head, Scalar};
use crate::Real;

/// An axis of a packed skill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackedAxis<'a> {
    /// Whether its unit is rad in place of m, and N m in place of N.
    pub is_rotary: bool,
    /// Where the movement starts [axis unit].
    pub start: f64,
    /// Where it ends [axis unit].
    pub goal: f64,
    /// Spring factor alpha of the movement.
    pub alpha: f64,
    /// Scale A of the forcing term [axis unit].
    pub forcing_scale: f64,
    /// Stiffness [N/m].
    pub stiffness: PackedGain<'a>,
    /// Damping [N s/m].
    pub damping: PackedGain<'a>,
    /// Virtual mass [kg], zero of a first-order axis; damping ratio, zero where damping is its primitive; least damping
    /// by that ratio [N s/m].
    pub law: [f64; 3],
    weights: Numbers<'a>,
}

/// A gain of a packed skill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackedGain<'a> {
    /// Smallest value [N/m or N s/m].
    pub min: f64,
    /// Largest value [N/m or N s/m].
    pub max: f64,
    weights: Numbers<'a>,
}

impl<'a> PackedAxis<'a> {
    /// The axis number `axis`, with which `numbers` begins; takes it from there.
    pub(super) fn read(head: &Head, axis: u8, numbers: &mut Numbers<'a>) -> Self {
        let [movement, stiffness, damping] = head.functions.map(usize::from);
        let [start, goal, alpha, forcing_scale] = numbers.take();
        let weights = numbers.split(movement);
        let mut gain = |count: usize| {
            let [min, max] = numbers.take();
            PackedGain { min, max, weights: numbers.split(count) }
        };
        let (stiffness, damping) = (gain(stiffness), gain(damping));
        let law = if head.law_numbers() == 0 { [0.0; 3] } else { numbers.take() };
        let is_rotary = head.rotary.checked_shr(axis.into()).unwrap_or(0) & 1 == 1;
        Self { is_rotary, start, goal, alpha, forcing_scale, stiffness, damping, law, weights }
    }

    /// Weights of the movement, oldest phase first.
    pub fn weights(&self) -> impl Iterator<Item = f64> + use<'a> {
        self.weights.values()
    }
}

impl<'a> PackedGain<'a> {
    /// Weights, oldest phase first [as the gain].
    pub fn weights(&self) -> impl Iterator<Item = f64> + use<'a> {
        self.weights.values()
    }
}

/// Numbers one after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Numbers<'a> {
    pub(super) scalar: Scalar,
    pub(super) bytes: &'a [u8],
}

impl<'a> Numbers<'a> {
    /// The numbers in the scalar `T`.
    pub(super) fn values<T: Real>(self) -> impl Iterator<Item = T> + use<'a, T> {
        let Self { scalar, bytes: mut rest } = self;
        iter::from_fn(move || match scalar {
            Scalar::Single => {
                let (bytes, next) = rest.split_first_chunk()?;
                rest = next;
                Some(T::of(f32::from_le_bytes(*bytes).into()))
            }
            Scalar::Double => {
                let (bytes, next) = rest.split_first_chunk()?;
                rest = next;
                Some(T::of(f64::from_le_bytes(*bytes)))
            }
        })
    }

    /// Takes the first `count`, or as many as there are.
    pub(super) fn split(&mut self, count: usize) -> Self {
        let end = count.saturating_mul(self.scalar.width()).min(self.bytes.len());
        let (first, rest) = self.bytes.split_at_checked(end).unwrap_or((self.bytes, &[]));
        self.bytes = rest;
        Self { bytes: first, ..*self }
    }

    /// Takes the first `N`; the head has said that they are there.
    fn take<const N: usize>(&mut self) -> [f64; N] {
        let mut taken = [0.0; N];
        taken.iter_mut().zip(self.split(N).values()).for_each(|(slot, number)| *slot = number);
        taken
    }
}
