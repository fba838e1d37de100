//! A skill as a few bytes: written by `hpf export --format binary`, read on a robot without allocation.
//!
//! Little-endian, no padding, at any alignment. With w the width of a number (4 or 8 bytes) and n_m, n_k, n_d functions
//! in the bases of movement, stiffness and damping:
//!
//! | at | bytes | what | unit |
//! |---|---|---|---|
//! | 0 | 4 | magic, `HPFS` | |
//! | 4 | 2 | version, 2; or 1, which says no law: first order | |
//! | 6 | 1 | w: 4 (f32) or 8 (f64); plus 16, 32, 64 where the basis of movement, stiffness, damping is of the time family | |
//! | 7 | 1 | axes D, 1 to 16 | |
//! | 8 | 3 x 2 | n_m, n_k, n_d | |
//! | 14 | 2 | bit i set: axis i is rotary, read rad for m and N m for N | |
//! | 16 | 2 w | duration tau, decay alpha_s of the phase | s, 1 |
//! | | 2 n_m w, 2 n_k w, 2 n_d w | centers, then widths of each basis | 1 |
//! | | D times: | | |
//! | | 4 w, n_m w | start, goal, alpha, forcing scale; weights of the movement | m, m, 1, m; 1 |
//! | | 2 w, n_k w | least and largest stiffness; weights | N/m |
//! | | 2 w, n_d w | least and largest damping; weights | N s/m |
//! | | 3 w | virtual mass, 0 of a first-order axis; damping ratio, 0 where damping is its primitive; least damping by that ratio | kg, 1, N s/m |
//! | end - 4 | 4 | CRC-32 (IEEE 802.3: reflected 0xEDB88320) of all bytes before | |
//!
//! The head decides the length, so a cut or lengthened file is refused before its checksum is taken; a CRC-32 finds every
//! error within 32 bits in a row, and so every damaged byte. What it finds intact still passes the constructors that
//! every skill passes. The checksum guards against damage, not against intent.
//!
//! A basis of the time family (see [`basis`](crate::basis)) has in place of its widths what a function has fallen to j
//! spacings from its center; for j = 0, where that is 1, its overlap.

use core::{array, fmt, iter, mem};

use crate::{AxisPrimitives, Basis, ConfigError, Gain, HybridPrimitive, Law, Movement, Phase, Real};

/// The first bytes of a packed skill.
pub const MAGIC: [u8; 4] = *b"HPFS";
/// The newest version; those from 1 on are read.
pub const VERSION: u16 = 2;
/// The version without laws: every axis is of first order.
const WITHOUT_LAWS: u16 = 1;
/// Most axes of a packed skill.
pub const MAX_AXES: u8 = 16;

/// Length of the head [bytes].
const HEAD: usize = 16;
/// Bits of the byte of the width that mark a basis of the time family: movement, stiffness, damping.
const IN_TIME: [u8; 3] = [16, 32, 64];
/// Numbers of a law.
const LAW_NUMBERS: usize = 3;
/// Length of the checksum [bytes].
const CHECKSUM: usize = 4;
/// IEEE 802.3, reflected.
const POLYNOMIAL: u32 = 0xEDB8_8320;

/// How a packed skill holds its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// `f32`.
    Single,
    /// `f64`.
    Double,
}

impl Scalar {
    /// Width of a number [bytes].
    pub const fn width(self) -> usize {
        match self {
            Self::Single => 4,
            Self::Double => 8,
        }
    }
}

/// The head of a packed skill: what is in it, and how long it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Head {
    /// Version, 1 to [`VERSION`].
    pub version: u16,
    /// How numbers are held.
    pub scalar: Scalar,
    /// Number of axes, 1 to [`MAX_AXES`].
    pub axes: u8,
    /// Functions in the bases of movement, stiffness and damping.
    pub functions: [u16; 3],
    /// Bit i set: axis i is rotary.
    pub rotary: u16,
    /// Whether the bases of movement, stiffness and damping are of the time family.
    pub in_time: [bool; 3],
}

/// Why bytes are not a packed skill, or not the one expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PackedError {
    /// The first bytes are not [`MAGIC`].
    NotASkill,
    /// Another version.
    Version {
        /// The version found.
        found: u16,
    },
    /// A number is neither 4 nor 8 bytes wide.
    Width {
        /// The width found [bytes].
        found: u8,
    },
    /// Not 1 to [`MAX_AXES`] axes, or not as many as asked for.
    Axes {
        /// The number found.
        found: usize,
        /// The largest number allowed, or the one asked for.
        expected: usize,
    },
    /// Cut, or longer than its head says.
    Length {
        /// The length found [bytes].
        found: usize,
        /// The length it must have [bytes].
        expected: usize,
    },
    /// Damaged.
    Checksum {
        /// The checksum in the file.
        found: u32,
        /// The checksum of the bytes.
        computed: u32,
    },
    /// A basis has another number of functions than the arrays asked for.
    Functions {
        /// The number found.
        found: usize,
        /// The number asked for.
        expected: usize,
    },
    /// The storage is too small.
    Storage {
        /// Numbers it has room for.
        found: usize,
        /// Numbers it must have room for.
        needed: usize,
    },
    /// Numbers more or fewer than the head says.
    Numbers {
        /// How many it must be.
        expected: usize,
    },
    /// A number that cannot be.
    Config(ConfigError),
}

impl fmt::Display for PackedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotASkill => write!(f, "this is not a packed skill"),
            Self::Version { found } => write!(f, "version {found}, versions 1 to {VERSION} are read"),
            Self::Width { found } => write!(f, "numbers are {found} bytes wide, 4 or 8 are read"),
            Self::Axes { found, expected } => write!(f, "{found} axes, not {expected}"),
            Self::Length { found, expected } => write!(f, "{found} bytes, not {expected}"),
            Self::Checksum { found, computed } => write!(f, "damaged: checksum {found:08x}, not {computed:08x}"),
            Self::Functions { found, expected } => write!(f, "a basis has {found} functions, not {expected}"),
            Self::Storage { found, needed } => write!(f, "room for {found} numbers, {needed} are needed"),
            Self::Numbers { expected } => write!(f, "not {expected} numbers"),
            Self::Config(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for PackedError {}

impl From<ConfigError> for PackedError {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}

impl Head {
    /// Functions of all three bases together.
    fn functions_in_all(&self) -> usize {
        self.functions.iter().map(|&count| usize::from(count)).sum()
    }

    /// Numbers that lists hold: centers and widths once, weights for each axis.
    pub fn storage(&self) -> usize {
        self.functions_in_all().saturating_mul(2 + usize::from(self.axes))
    }

    /// Numbers in all.
    pub fn numbers(&self) -> usize {
        self.storage().saturating_add(2 + (8 + self.law_numbers()) * usize::from(self.axes))
    }

    /// Numbers of the law of an axis, the last of its numbers: 3, none in version 1.
    pub fn law_numbers(&self) -> usize {
        if self.version == WITHOUT_LAWS { 0 } else { LAW_NUMBERS }
    }

    /// Length of the packed skill [bytes].
    pub fn length(&self) -> usize {
        self.numbers().saturating_mul(self.scalar.width()).saturating_add(HEAD + CHECKSUM)
    }

    fn parse(head: [u8; HEAD]) -> Result<Self, PackedError> {
        let [m0, m1, m2, m3, v0, v1, width, axes, a0, a1, b0, b1, c0, c1, r0, r1] = head;
        if [m0, m1, m2, m3] != MAGIC {
            return Err(PackedError::NotASkill);
        }
        let version = u16::from_le_bytes([v0, v1]);
        if !(WITHOUT_LAWS..=VERSION).contains(&version) {
            return Err(PackedError::Version { found: version });
        }
        let in_time = IN_TIME.map(|bit| width & bit != 0);
        let scalar = match width & !IN_TIME.iter().fold(0, |all, bit| all | bit) {
            4 => Scalar::Single,
            8 => Scalar::Double,
            _ => return Err(PackedError::Width { found: width }),
        };
        let functions = [[a0, a1], [b0, b1], [c0, c1]].map(u16::from_le_bytes);
        Self { version, scalar, axes, functions, rotary: u16::from_le_bytes([r0, r1]), in_time }.checked()
    }

    fn checked(self) -> Result<Self, PackedError> {
        if !(WITHOUT_LAWS..=VERSION).contains(&self.version) {
            return Err(PackedError::Version { found: self.version });
        }
        if (1..=MAX_AXES).contains(&self.axes) {
            Ok(self)
        } else {
            Err(PackedError::Axes { found: self.axes.into(), expected: MAX_AXES.into() })
        }
    }

    /// Writes a packed skill of this head into `out`, which is [`length`](Self::length) bytes: `numbers` in the order of
    /// the table above, of which there are [`numbers`](Self::numbers).
    ///
    /// # Errors
    /// [`PackedError`] for a version or a number of axes, bytes or numbers that is not the right one, and for a number that is not
    /// finite in the width asked for.
    pub fn pack(&self, numbers: impl IntoIterator<Item = f64>, out: &mut [u8]) -> Result<(), PackedError> {
        let head = self.checked()?;
        let (found, expected) = (out.len(), head.length());
        if found != expected {
            return Err(PackedError::Length { found, expected });
        }
        let [[v0, v1], [r0, r1]] = [head.version, head.rotary].map(u16::to_le_bytes);
        let [[a0, a1], [b0, b1], [c0, c1]] = head.functions.map(u16::to_le_bytes);
        let [m0, m1, m2, m3] = MAGIC;
        let width = head.scalar.width();
        let marks = IN_TIME.iter().zip(head.in_time).filter(|(_, in_time)| *in_time);
        let marked = marks.fold(width as u8, |marked, (bit, _)| marked | bit);
        let front = [m0, m1, m2, m3, v0, v1, marked, head.axes, a0, a1, b0, b1, c0, c1, r0, r1];
        let wrong = PackedError::Numbers { expected: head.numbers() };
        let (body, sum) = out.split_last_chunk_mut::<CHECKSUM>().ok_or(wrong)?;
        let (slots, rest) = body.split_first_chunk_mut::<HEAD>().ok_or(wrong)?;
        *slots = front;
        let mut numbers = numbers.into_iter();
        for slot in rest.chunks_exact_mut(width) {
            let number = numbers.next().ok_or(wrong)?;
            let finite = match head.scalar {
                Scalar::Single => (number as f32).is_finite(),
                Scalar::Double => number.is_finite(),
            };
            if !finite {
                return Err(ConfigError::NotFinite { field: "packed number" }.into());
            }
            let put = |slot: &mut [u8], bytes: &[u8]| slot.iter_mut().zip(bytes).for_each(|(slot, byte)| *slot = *byte);
            match head.scalar {
                Scalar::Single => put(slot, &(number as f32).to_le_bytes()),
                Scalar::Double => put(slot, &number.to_le_bytes()),
            }
        }
        if numbers.next().is_some() {
            return Err(wrong);
        }
        *sum = crc32(body).to_le_bytes();
        Ok(())
    }
}

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

    /// Its numbers, in the order of the table above.
    pub fn values<T: Real>(&self) -> impl Iterator<Item = T> + use<'a, T> {
        let (scalar, mut rest) = (self.head.scalar, self.numbers);
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

/// CRC-32 (IEEE 802.3) of `bytes`, without a table: a skill is read once.
///
/// ```
/// assert_eq!(hpf_core::packed::crc32(b"123456789"), 0xCBF4_3926); // the check value of its specification
/// ```
pub fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| (sum >> 1) ^ (POLYNOMIAL & (sum & 1).wrapping_neg()))
    })
}
