//! A skill written: its parts in the order of the table of [`packed`](super).

use super::{Head, MAX_AXES, PackedError, Scalar, VERSION};
use crate::domain::single;
use crate::{AxisPrimitives, Basis, HybridPrimitive, Phase, Real, error};

/// The parts of a skill of any number of axes, borrowed; `S` holds each list.
///
/// ```
/// use hpf_core::packed::{Contents, Packed};
/// use hpf_core::*;
/// let basis = Basis::equally_spaced_in_time(4.6_f32, 0.6, [0.0; 3], [0.0; 3])?;
/// let axis = AxisPrimitives {
///     movement: Movement::new(0.0, 0.3, 25.0, 0.3, [5.0, 0.0, -5.0])?,
///     stiffness: Gain::new(30.0, 400.0, [100.0; 3])?,
///     damping: Gain::new(10.0, 100.0, [50.0; 3])?,
///     law: Law::FirstOrder,
/// };
/// let skill = HybridPrimitive::new(Phase::new(2.0, 4.6)?, [basis; 3], [axis])?;
/// let contents = Contents::of(&skill, 0);
/// let mut bytes = [0; 180];
/// assert_eq!(contents.head()?.length(), bytes.len());
/// contents.pack(&mut bytes)?;
/// assert_eq!(Packed::parse(&bytes)?.skill::<f32, 3, 1>()?, skill);
/// # Ok::<(), packed::PackedError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Contents<'a, T, S> {
    /// The phase.
    pub phase: &'a Phase<T>,
    /// The bases of movement, stiffness and damping.
    pub bases: [&'a Basis<T, S>; 3],
    /// The axes, 1 to [`MAX_AXES`], with one weight per function of each basis.
    pub axes: &'a [AxisPrimitives<T, S>],
    /// Bit i set: axis i is rotary.
    pub rotary: u16,
}

impl<'a, T: Real, S: AsRef<[T]>> Contents<'a, T, S> {
    /// The parts of `skill`; bit i of `rotary` set: axis i is rotary.
    pub fn of<const D: usize>(skill: &'a HybridPrimitive<T, S, D>, rotary: u16) -> Self {
        Self { phase: skill.phase(), bases: skill.bases(), axes: skill.axes(), rotary }
    }

    /// The head of the packed skill, its numbers held in the scalar of the parts: says how long it is.
    ///
    /// # Errors
    /// [`PackedError`] for more axes, or functions in a basis, than a packed skill can have.
    pub fn head(&self) -> Result<Head, PackedError> {
        let mut functions = [0; 3];
        for (slot, basis) in functions.iter_mut().zip(self.bases) {
            let (found, expected) = (basis.count(), u16::MAX.into());
            *slot = found.try_into().map_err(|_| PackedError::Functions { found, expected })?;
        }
        let (found, expected) = (self.axes.len(), MAX_AXES.into());
        let axes = found.try_into().map_err(|_| PackedError::Axes { found, expected })?;
        let head = Head {
            version: VERSION,
            scalar: if single::<T>() { Scalar::Single } else { Scalar::Double },
            axes,
            functions,
            rotary: self.rotary,
            in_time: self.bases.map(|basis| basis.overlap().is_some()),
        };
        head.checked()
    }

    /// Writes the packed skill into `out`, which is as long as its [`head`](Self::head) says.
    ///
    /// # Errors
    /// As for [`head`](Self::head), for another length of `out`, and for an axis whose lists are not as long as the bases.
    pub fn pack(&self, out: &mut [u8]) -> Result<(), PackedError> {
        let head = self.head()?;
        let [movement, stiffness, damping] = self.bases.map(Basis::count);
        for axis in self.axes {
            error::finite_list("movement.weights", axis.movement.weights(), movement)?;
            error::finite_list("stiffness.weights", axis.stiffness.weights(), stiffness)?;
            error::finite_list("damping.weights", axis.damping.weights(), damping)?;
        }
        let numbers = [self.phase.duration(), self.phase.decay()]
            .into_iter()
            .chain(self.bases.into_iter().flat_map(basis_numbers))
            .chain(self.axes.iter().flat_map(axis_numbers));
        head.pack(numbers.map(T::to_f64), out)
    }
}

/// Centers, then widths; of the time family the overlap takes the place of what has fallen to 1 at no distance.
fn basis_numbers<T: Real, S: AsRef<[T]>>(basis: &Basis<T, S>) -> impl Iterator<Item = T> {
    let (overlap, widths) = (basis.overlap(), basis.widths());
    let widths = overlap.into_iter().chain(widths.iter().skip(overlap.iter().len()).copied());
    basis.centers().iter().copied().chain(widths)
}

/// Movement, stiffness, damping and law.
fn axis_numbers<T: Real, S: AsRef<[T]>>(axis: &AxisPrimitives<T, S>) -> impl Iterator<Item = T> {
    let AxisPrimitives { movement, stiffness, damping, law } = axis;
    let numbers = [movement.start(), movement.goal(), movement.alpha(), movement.forcing_scale()];
    let gains = [stiffness, damping];
    let gains = gains.into_iter().flat_map(|gain| [gain.min(), gain.max()].into_iter().chain(listed(gain.weights())));
    numbers.into_iter().chain(listed(movement.weights())).chain(gains).chain(law.numbers())
}

fn listed<T: Copy>(numbers: &[T]) -> impl Iterator<Item = T> {
    numbers.iter().copied()
}
