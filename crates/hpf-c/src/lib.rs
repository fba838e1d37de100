//! The C interface of [`hpf_core::controller::Controller`]: `include/hpf.h`, made from this crate.
//!
//! What C hands over is checked, never trusted: pointers for null and alignment, structs for their size and version,
//! numbers by the constructors of `hpf-core`. Every function returns a status; none allocates, panics or keeps a
//! pointer that its documentation does not name. What cannot be checked is the contract: a pointer that is not null
//! points to memory of the stated size, which nobody else writes to meanwhile.
//!
//! One implementation, generic in scalar and number of axes, stands behind an [`instance::Instance`]: a table of
//! functions. A program names the instances that it uses, and its linker drops the others. `src/f32.rs` is made from
//! `src/f64.rs`, as the header is, by `UPDATE_HEADER=1 cargo test -p hpf-c --test header`.

#![no_std]
// C calls them by these names.
#![allow(clippy::missing_safety_doc, reason = "the safety of every entry is the contract above")]

#[cfg(not(feature = "bare"))]
extern crate std;

pub mod abi;
mod convert;
pub mod f32;
pub mod f64;
pub mod instance;
pub mod status;
mod storage;

/// Without a standard library there is nobody to report to; no entry gets here, which `check.sh` proves by linking.
#[cfg(feature = "bare")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    #[cfg(feature = "prove")]
    {
        unsafe extern "C" {
            /// Defined nowhere.
            fn hpf_panic_is_reachable() -> !;
        }
        // SAFETY: a program that could get here does not link.
        unsafe { hpf_panic_is_reachable() }
    }
    #[cfg(not(feature = "prove"))]
    loop {}
}
