//! A packed skill read: its head, its numbers, and the skill they make.

use core::{array, iter, mem};

use super::axis::Numbers;
use super::{CHECKSUM, HEAD, Head, PackedAxis, PackedError, WITHOUT_LAWS, crc32};
use crate::{AxisPrimitives, Basis, Gain, HybridPrimitive, Law, Movement, Phase, Real};

/// A packed skill whose bytes are intact, borrowed where it lies.
///
/// ```
/// use hpf_core::packed::{Head, Packed, Scalar, VERSION};
/// let head = Head {
///     version: VERSION,
///     scalar: Scalar::Single,
///     axes: 1,
///     functions: [2; 3],
///     rotary: 0,
///     in_time: [false; 3],
/// };
/// let basis = [1.0, 0.1, 2.0, 2.0]; // centers, widths
/// let axis = [0.0, 0.3, 25.0, 1.0, 5.0, -5.0, 30.0, 400.0, 100.0, 200.0, 10.0, 100.0, 50.0, 50.0];
/// let law = [2.0, 0.0, 0.0]; // 2 kg, damping from its primitive
/// let numbers = [&[1.5, 2.3][..], &basis, &basis, &basis, &axis, &law].concat();
/// let mut bytes = [0; 144];
/// assert_eq!(head.length(), bytes.len());
/// head.pack(numbers, &mut bytes)?;
///
/// let skill = Packed::parse(&bytes)?.skill::<f32, 2, 1>()?; // lists of 2, 1 axis
/// assert_eq!(skill.axes()[0].movement.goal(), 0.3);
/// assert_eq!(skill.axes()[0].law.mass(), 2.0);
/// bytes[40] ^= 1;
/// assert!(Packed::parse(&bytes).is_err());
/// # Ok::<(), hpf_core::packed::PackedError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packed<'a> {
    head: Head,
    /// What stands between head and checksum.
    numbers: &'a [u8],
}

impl<'a> Packed<'a> {
    /// Checks head, length and checksum of `bytes`.
    ///
    /// # Errors
    /// [`PackedError`] for bytes that are no packed skill of this version, cut, lengthened or damaged.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, PackedError> {
        let short = PackedError::Length { found: bytes.len(), expected: HEAD + CHECKSUM };
        let (body, sum) = bytes.split_last_chunk::<CHECKSUM>().ok_or(short)?;
        let (head, numbers) = body.split_first_chunk::<HEAD>().ok_or(short)?;
        let head = Head::parse(*head)?;
        let (found, expected) = (bytes.len(), head.length());
        if found != expected {
            return Err(PackedError::Length { found, expected });
        }
        let (found, computed) = (u32::from_le_bytes(*sum), crc32(body));
        if found != computed {
            return Err(PackedError::Checksum { found, computed });
        }
        Ok(Self { head, numbers })
    }

    /// What is in it.
    pub fn head(&self) -> &Head {
        &self.head
    }

    /// Its numbers, in the order of the table of [`packed`](super).
    pub fn values<T: Real>(&self) -> impl Iterator<Item = T> + use<'a, T> {
        self.numbers().values()
    }

    fn numbers(&self) -> Numbers<'a> {
        Numbers { scalar: self.head.scalar, bytes: self.numbers }
    }

    /// Duration tau [s].
    pub fn duration(&self) -> f64 {
        one(&mut self.values())
    }

    /// What it holds of each axis, as the numbers stand there: whether they make a skill is for [`skill`](Self::skill)
    /// to say.
    ///
    /// ```
    /// # use hpf_core::packed::{Head, Packed, Scalar, VERSION};
    /// # let (scalar, functions, in_time) = (Scalar::Double, [2; 3], [false; 3]);
    /// # let head = Head { version: VERSION, scalar, axes: 1, functions, rotary: 1, in_time };
    /// # let basis = [1.0, 0.1, 2.0, 2.0];
    /// # let axis = [0.0, 0.3, 25.0, 1.0, 5.0, -5.0, 30.0, 400.0, 100.0, 200.0, 10.0, 100.0, 50.0, 60.0];
    /// # let numbers = [&[1.5, 2.3][..], &basis, &basis, &basis, &axis, &[2.0, 0.0, 0.0]].concat();
    /// # let mut bytes = vec![0; head.length()];
    /// # head.pack(numbers, &mut bytes)?;
    /// let packed = Packed::parse(&bytes)?;
    /// for axis in packed.axes() {
    ///     assert_eq!((axis.goal, axis.stiffness.max, axis.is_rotary), (0.3, 400.0, true));
    ///     assert!(axis.damping.weights().eq([50.0, 60.0]));
    /// }
    /// # Ok::<(), hpf_core::packed::PackedError>(())
    /// ```
    pub fn axes(&self) -> impl Iterator<Item = PackedAxis<'a>> + use<'a> {
        let head = self.head;
        let mut numbers = self.numbers();
        let _ = numbers.split(head.front_numbers());
        (0..head.axes).map(move |axis| PackedAxis::read(&head, axis, &mut numbers))
    }

    /// The skill, its lists in arrays of its own: all three bases have `N` functions.
    ///
    /// # Errors
    /// [`PackedError`] for another number of axes or functions, and for numbers that cannot be.
    pub fn skill<T: Real, const N: usize, const D: usize>(&self) -> Result<HybridPrimitive<T, [T; N], D>, PackedError> {
        self.build(|numbers, found| {
            if found != N {
                return Err(PackedError::Functions { found, expected: N });
            }
            let mut list = [T::ZERO; N];
            list.iter_mut().zip(numbers).for_each(|(slot, number)| *slot = number);
            Ok(list)
        })
    }

    /// The skill, its lists in `storage`, which has room for [`Head::storage`] numbers or more.
    ///
    /// # Errors
    /// [`PackedError`] for another number of axes, a storage too small, and numbers that cannot be.
    pub fn skill_in<'s, T: Real, const D: usize>(
        &self,
        storage: &'s mut [T],
    ) -> Result<HybridPrimitive<T, &'s [T], D>, PackedError> {
        let small = PackedError::Storage { found: storage.len(), needed: self.head.storage() };
        let mut free = storage;
        self.build(|numbers, count| {
            let (list, rest) = mem::take(&mut free).split_at_mut_checked(count).ok_or(small)?;
            free = rest;
            list.iter_mut().zip(numbers).for_each(|(slot, number)| *slot = number);
            Ok(&*list)
        })
    }

    /// The skill, each list stored by `store`, which takes as many numbers as it is told.
    fn build<T: Real, S: AsRef<[T]> + Copy, const D: usize>(
        &self,
        mut store: impl FnMut(&mut dyn Iterator<Item = T>, usize) -> Result<S, PackedError>,
    ) -> Result<HybridPrimitive<T, S, D>, PackedError> {
        let found = usize::from(self.head.axes);
        if found != D {
            return Err(PackedError::Axes { found, expected: D });
        }
        let counts @ [movement, stiffness, damping] = self.head.functions.map(usize::from);
        let mut values = self.values::<T>();
        let values: &mut dyn Iterator<Item = T> = &mut values;
        let phase = Phase::new(one(values), one(values))?;
        let decay = phase.decay();
        let mut basis = |count: usize, in_time: bool, values: &mut dyn Iterator<Item = T>| {
            let centers = store(values, count)?;
            if in_time {
                let overlap = one(values);
                let falls = store(&mut iter::once(T::ONE).chain(values), count)?;
                return Ok::<_, PackedError>(Basis::stored_in_time(decay, overlap, centers, falls)?);
            }
            Ok(Basis::new(centers, store(values, count)?)?)
        };
        let ([m, k, d], [m_in_time, k_in_time, d_in_time]) = (counts, self.head.in_time);
        let bases = [basis(m, m_in_time, values)?, basis(k, k_in_time, values)?, basis(d, d_in_time, values)?];
        let mut axis = || {
            let [start, goal, alpha, scale] = [one(values), one(values), one(values), one(values)];
            let movement = Movement::new(start, goal, alpha, scale, store(values, movement)?)?;
            let [min, max] = [one(values), one(values)];
            let stiffness = Gain::new(min, max, store(values, stiffness)?)?;
            let [min, max] = [one(values), one(values)];
            let damping = Gain::new(min, max, store(values, damping)?)?;
            let law = match self.head.version {
                WITHOUT_LAWS => Law::FirstOrder,
                _ => Law::of(one(values), one(values), one(values))?,
            };
            Ok::<_, PackedError>(AxisPrimitives { movement, stiffness, damping, law })
        };
        // An array cannot be left half built: after a refusal the rest of it repeats the first axis, and is dropped.
        let first = axis()?;
        let mut refused = None;
        let axes = array::from_fn(|i| {
            if i == 0 || refused.is_some() {
                return first;
            }
            axis().unwrap_or_else(|error| {
                refused = Some(error);
                first
            })
        });
        match refused {
            Some(error) => Err(error),
            None => Ok(HybridPrimitive::new(phase, bases, axes)?),
        }
    }
}

/// The next number; the head has said that there is one.
fn one<T: Real>(values: &mut dyn Iterator<Item = T>) -> T {
    values.next().unwrap_or(T::ZERO)
}
