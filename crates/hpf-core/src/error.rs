//! What a constructor refuses; bytes that are no skill are refused by [`packed`](crate::packed).

use core::fmt;

use crate::domain::{LARGEST, SMALLEST};

/// Why a constructor refused its parameters. Reason = variant, culprit = payload.
///
/// ```
/// use hpf_core::{ConfigError, Phase};
/// let refused = Phase::new(-1.0_f64, 4.6).unwrap_err();
/// assert_eq!(refused, ConfigError::NotPositive { field: "duration", value: -1.0 });
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConfigError {
    /// A value is infinite or NaN.
    NotFinite {
        /// The parameter's name.
        field: &'static str,
    },
    /// A value that must be positive is not.
    NotPositive {
        /// The parameter's name.
        field: &'static str,
        /// The value found.
        value: f64,
    },
    /// A value lies outside its bounds.
    OutOfRange {
        /// The parameter's name.
        field: &'static str,
        /// The value found.
        value: f64,
        /// The smallest value allowed.
        min: f64,
        /// The largest value allowed.
        max: f64,
    },
    /// A lower bound lies above its upper bound.
    MinAboveMax {
        /// The parameter's name.
        field: &'static str,
        /// The lower bound found.
        min: f64,
        /// The upper bound found.
        max: f64,
    },
    /// A list is too short.
    TooFew {
        /// The parameter's name.
        field: &'static str,
        /// The length found.
        count: usize,
        /// The smallest length allowed.
        least: usize,
    },
    /// Two lists that belong together differ in length.
    LengthMismatch {
        /// The parameter's name.
        field: &'static str,
        /// The length found.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// Basis centers must fall from one to the next: oldest phase first.
    NotDecreasing {
        /// The parameter's name.
        field: &'static str,
    },
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite { field } => write!(f, "{field} is not a finite number"),
            Self::NotPositive { field, value } => write!(f, "{field} must be positive, not {value}"),
            Self::OutOfRange { field, value, min, max } => {
                write!(f, "{field} must lie in [{min}, {max}], not {value}")
            }
            Self::MinAboveMax { field, min, max } => {
                write!(f, "{field} has its lower bound {min} above its upper bound {max}")
            }
            Self::TooFew { field, count, least } => {
                write!(f, "{field} has {count} entries, at least {least} are needed")
            }
            Self::LengthMismatch { field, found, expected } => {
                write!(f, "{field} has {found} entries, {expected} are needed")
            }
            Self::NotDecreasing { field } => write!(f, "{field} must fall from each entry to the next"),
        }
    }
}

impl core::error::Error for ConfigError {}

/// `value` if finite, else an error that names `field`.
pub(crate) fn finite<T: crate::Real>(field: &'static str, value: T) -> Result<T, ConfigError> {
    if value.is_finite() { Ok(value) } else { Err(ConfigError::NotFinite { field }) }
}

/// `value` if finite and positive, else an error that names `field`.
pub(crate) fn positive<T: crate::Real>(field: &'static str, value: T) -> Result<T, ConfigError> {
    finite(field, value)?;
    if value.to_f64() > 0.0 { Ok(value) } else { Err(ConfigError::NotPositive { field, value: value.to_f64() }) }
}

/// `value` if it is positive and within the [domain](crate::domain), else an error that names `field`.
pub(crate) fn size<T: crate::Real>(field: &'static str, value: T) -> Result<T, ConfigError> {
    positive(field, value)?;
    within(field, value, SMALLEST, LARGEST)
}

/// `value` if it is zero, or positive and not above the [domain](crate::domain), else an error that names `field`.
pub(crate) fn not_negative<T: crate::Real>(field: &'static str, value: T) -> Result<T, ConfigError> {
    within(field, value, 0.0, LARGEST)
}

/// `value` if it is within the [domain](crate::domain) of numbers of either sign, else an error that names `field`.
pub(crate) fn number<T: crate::Real>(field: &'static str, value: T) -> Result<T, ConfigError> {
    within(field, value, -LARGEST, LARGEST)
}

/// `value` if finite and in `[min, max]`, as its scalar rounds them, else an error that names `field`.
pub(crate) fn within<T: crate::Real>(field: &'static str, value: T, min: f64, max: f64) -> Result<T, ConfigError> {
    let found = finite(field, value)?.to_f64();
    if found >= T::of(min).to_f64() && found <= T::of(max).to_f64() {
        Ok(value)
    } else {
        Err(ConfigError::OutOfRange { field, value: found, min, max })
    }
}

/// Every value finite, and as many as `expected`.
pub(crate) fn finite_list<T: crate::Real>(
    field: &'static str,
    values: &[T],
    expected: usize,
) -> Result<(), ConfigError> {
    if values.len() != expected {
        return Err(ConfigError::LengthMismatch { field, found: values.len(), expected });
    }
    values.iter().try_for_each(|&value| finite(field, value).map(drop))
}
