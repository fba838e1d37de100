//! Why a call was refused: a number, a text, and for a parameter its name and bounds.

use core::ffi::{CStr, c_char};

use hpf_core::ConfigError;

use crate::abi::Error;

/// Done.
pub const HPF_OK: i32 = 0;
/// A pointer is null.
pub const HPF_NULL_POINTER: i32 = 1;
/// A pointer is not aligned to its type; memory for a controller, to HPF_ALIGNMENT.
pub const HPF_MISALIGNED: i32 = 2;
/// abi_version of a struct is not that of the library: another header was included.
pub const HPF_WRONG_VERSION: i32 = 3;
/// struct_size of a struct is not that of the library.
pub const HPF_WRONG_SIZE: i32 = 4;
/// The memory is too small for the controller.
pub const HPF_TOO_SMALL: i32 = 5;
/// The number of axes is not that of the instance, or above HPF_AXES_MAX.
pub const HPF_WRONG_AXES: i32 = 6;
/// A basis has fewer than 2 functions or more than HPF_BASES_MAX.
pub const HPF_WRONG_BASES: i32 = 7;
/// A family, compliance, request or storage is none of its constants.
pub const HPF_UNKNOWN_CHOICE: i32 = 8;
/// There is no controller here: never made, made with another scalar, or moved.
pub const HPF_NO_CONTROLLER: i32 = 9;
/// A number is infinite or NaN.
pub const HPF_NOT_FINITE: i32 = 10;
/// A number that must be positive is not.
pub const HPF_NOT_POSITIVE: i32 = 11;
/// A number lies outside its bounds.
pub const HPF_OUT_OF_RANGE: i32 = 12;
/// A lower bound lies above its upper bound.
pub const HPF_MIN_ABOVE_MAX: i32 = 13;
/// A list is too short.
pub const HPF_TOO_FEW: i32 = 14;
/// Two lists that belong together differ in length.
pub const HPF_LENGTH_MISMATCH: i32 = 15;
/// Centers of a basis do not fall from one to the next.
pub const HPF_NOT_DECREASING: i32 = 16;

/// What `status` means; never null, never freed.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_status_text(status: i32) -> *const c_char {
    #[cfg(feature = "negative-panic")]
    let status = [HPF_OK, HPF_NULL_POINTER][status as usize];
    text(status).as_ptr()
}

fn text(status: i32) -> &'static CStr {
    match status {
        HPF_OK => c"done",
        HPF_NULL_POINTER => c"a pointer is null",
        HPF_MISALIGNED => c"a pointer is not aligned",
        HPF_WRONG_VERSION => c"abi_version is not that of the library",
        HPF_WRONG_SIZE => c"struct_size is not that of the library",
        HPF_TOO_SMALL => c"the memory is too small for the controller",
        HPF_WRONG_AXES => c"the number of axes is not that of the instance",
        HPF_WRONG_BASES => c"a basis has too few or too many functions",
        HPF_UNKNOWN_CHOICE => c"a choice is none of its constants",
        HPF_NO_CONTROLLER => c"there is no controller here: never made, of the other scalar, or moved",
        HPF_NOT_FINITE => c"is not a finite number",
        HPF_NOT_POSITIVE => c"must be positive",
        HPF_OUT_OF_RANGE => c"lies outside its bounds",
        HPF_MIN_ABOVE_MAX => c"has its lower bound above its upper bound",
        HPF_TOO_FEW => c"has too few entries",
        HPF_LENGTH_MISMATCH => c"has the wrong number of entries",
        HPF_NOT_DECREASING => c"must fall from each entry to the next",
        _ => c"unknown status",
    }
}

/// A refused call.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Refusal {
    /// By this interface: a status.
    Border(i32),
    /// By hpf-core: a parameter.
    Parameter(ConfigError),
}

impl From<i32> for Refusal {
    fn from(status: i32) -> Self {
        Self::Border(status)
    }
}

impl From<ConfigError> for Refusal {
    fn from(error: ConfigError) -> Self {
        Self::Parameter(error)
    }
}

impl Refusal {
    /// Its status.
    pub(crate) fn status(self) -> i32 {
        self.parts().0
    }

    /// Status, parameter, the value found, the bounds.
    fn parts(self) -> (i32, &'static str, f64, [f64; 2]) {
        let error = match self {
            Self::Border(status) => return (status, "", 0.0, [0.0; 2]),
            Self::Parameter(error) => error,
        };
        match error {
            ConfigError::NotFinite { field } => (HPF_NOT_FINITE, field, f64::NAN, [0.0; 2]),
            ConfigError::NotPositive { field, value } => (HPF_NOT_POSITIVE, field, value, [0.0; 2]),
            ConfigError::OutOfRange { field, value, min, max } => (HPF_OUT_OF_RANGE, field, value, [min, max]),
            ConfigError::MinAboveMax { field, min, max } => (HPF_MIN_ABOVE_MAX, field, min, [min, max]),
            ConfigError::TooFew { field, count, least } => {
                (HPF_TOO_FEW, field, count as f64, [least as f64, f64::INFINITY])
            }
            ConfigError::LengthMismatch { field, found, expected } => {
                (HPF_LENGTH_MISMATCH, field, found as f64, [expected as f64; 2])
            }
            ConfigError::NotDecreasing { field } => (HPF_NOT_DECREASING, field, 0.0, [0.0; 2]),
        }
    }

    /// Writes itself to `error`.
    pub(crate) fn report(self, error: &mut Error) {
        let (status, field, value, [min, max]) = self.parts();
        (error.status, error.value, error.min, error.max) = (status, value, min, max);
        let gap: &[u8] = if field.is_empty() { b"" } else { b" " };
        let words = field.bytes().chain(gap.iter().copied()).chain(text(status).to_bytes().iter().copied());
        error.text = [0; 128];
        // The last place stays zero whatever the length.
        for (slot, byte) in error.text.iter_mut().take(127).zip(words) {
            *slot = byte as c_char;
        }
    }
}
