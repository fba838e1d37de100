//! An energy that loses nothing to rounding.

use crate::Real;

/// Energy [J] in a tank or at a port. What its last digit cannot show is kept beside it: in single precision a slow motion
/// spends less in a step than the last digit of a full tank, and would spend it for nothing.
///
/// ```
/// use hpf_core::passivity::Stored;
/// let mut energy = Stored::new(4.0_f32);
/// for _ in 0..1_000_000 {
///     energy.add(-1e-7);
/// }
/// assert!((energy.level() - 3.9).abs() < 1e-6);
/// // Without what is kept beside it, all of that would be free.
/// assert_eq!(4.0_f32 - 1e-7, 4.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stored<T> {
    level: T,
    /// At most half of the last digit of the level.
    rest: T,
}

impl<T: Real> Stored<T> {
    /// An energy of `level` [J].
    pub fn new(level: T) -> Self {
        Self { level, rest: T::ZERO }
    }

    /// The energy [J].
    #[inline(always)]
    pub fn level(&self) -> T {
        self.level
    }

    /// Adds `energy` [J], below zero for what is spent.
    #[inline(always)]
    pub fn add(&mut self, energy: T) {
        let part = self.rest + energy;
        let level = self.level + part;
        self.rest = part - (level - self.level);
        self.level = level;
    }

    /// The same without what is above `most` [J], but for half of its last digit.
    #[inline(always)]
    pub fn capped(self, most: T) -> Self {
        Self { level: self.level.at_most(most), rest: most.select_below(self.level, T::ZERO, self.rest) }
    }
}
