//! A skill as a few bytes: written from its parts ([`Contents`]), by `hpf export --format binary` for one, and read on a
//! robot ([`Packed`]), both without allocation.
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

mod axis;
mod read;
mod write;

pub use axis::{PackedAxis, PackedGain};
pub use read::Packed;
pub use write::Contents;

use core::fmt;

use crate::ConfigError;

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

    /// Numbers before those of the first axis: of the phase and the bases.
    fn front_numbers(&self) -> usize {
        self.functions_in_all().saturating_mul(2).saturating_add(2)
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

    /// Writes a packed skill of this head into `out`, which is [`length`](Self::length) bytes: bare `numbers` in the order
    /// of the table above, of which there are [`numbers`](Self::numbers). A skill is written by [`Contents::pack`].
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
