//! The entries in double precision.

use core::ffi::c_void;

use crate::abi::{Counters, Error, Input, Limits, Output, Policy, Settings};
use crate::instance::{self, Handle, Instance};

/// The instance for one axis in double precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f64_axes_1() -> *const Instance<f64> {
    instance::instance::<f64, 1>()
}

/// The instance for two axes in double precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f64_axes_2() -> *const Instance<f64> {
    instance::instance::<f64, 2>()
}

/// The instance for three axes in double precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f64_axes_3() -> *const Instance<f64> {
    instance::instance::<f64, 3>()
}

/// The instance for four axes in double precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f64_axes_4() -> *const Instance<f64> {
    instance::instance::<f64, 4>()
}

/// The instance for five axes in double precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f64_axes_5() -> *const Instance<f64> {
    instance::instance::<f64, 5>()
}

/// The instance for six axes in double precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f64_axes_6() -> *const Instance<f64> {
    instance::instance::<f64, 6>()
}

/// The instance for seven axes in double precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f64_axes_7() -> *const Instance<f64> {
    instance::instance::<f64, 7>()
}

/// The instance for `axes` in double precision, null unless there are 1 to HPF_AXES_MAX. A program that calls this links
/// all of them; one that names the one it uses does not.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f64_instance(axes: u32) -> *const Instance<f64> {
    match axes {
        1 => hpf_f64_axes_1(),
        2 => hpf_f64_axes_2(),
        3 => hpf_f64_axes_3(),
        4 => hpf_f64_axes_4(),
        5 => hpf_f64_axes_5(),
        6 => hpf_f64_axes_6(),
        7 => hpf_f64_axes_7(),
        _ => core::ptr::null(),
    }
}

/// Writes to `bytes` how much memory a controller of `policy` needs. Looks at axes, lists and bases only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f64_size(
    instance: *const Instance<f64>,
    policy: *const Policy<f64>,
    bytes: *mut usize,
) -> i32 {
    // SAFETY: the contract of the crate, here and below.
    unsafe { instance::size(instance, policy, bytes) }
}

/// Writes settings to start from: every axis gives way by the law of its policy, no filter, no tank; trips at twice the
/// force limit and where the robot is off by the offset limit; steps up to 10 ms, a ramp of 0.2 s, and for 20 ms a
/// bad input is bridged; a force more than 4 steps old is bad. `limits`: one per axis.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f64_compliant(settings: *mut Settings<f64>, axes: u32, limits: *const Limits<f64>) -> i32 {
    // SAFETY: as above.
    unsafe { instance::compliant(settings, axes, limits) }
}

/// Makes a controller in Idle, in `bytes` of `memory` aligned to HPF_ALIGNMENT, for a robot at rest at `position` (one
/// number per axis), and writes its address to `controller`; null if refused, and then `error` says why unless it is
/// null. The memory stays the caller's; the controller lives until it is used otherwise, and must not be moved. No two
/// threads may use one controller at once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f64_create(
    instance: *const Instance<f64>,
    memory: *mut c_void,
    bytes: usize,
    policy: *const Policy<f64>,
    settings: *const Settings<f64>,
    position: *const f64,
    controller: *mut *mut Handle<f64>,
    error: *mut Error,
) -> i32 {
    // SAFETY: as above.
    unsafe { instance::create(instance, memory, bytes, policy, settings, position, controller, error) }
}

/// One step of `dt` [s]. Total for every number in `input`; refused, with nothing changed and nothing written, only where
/// a pointer or a choice is wrong.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f64_update(
    controller: *mut Handle<f64>,
    input: *const Input<f64>,
    dt: f64,
    output: *mut Output<f64>,
) -> i32 {
    // SAFETY: as above.
    unsafe { instance::update(controller, input, dt, output) }
}

/// Replaces all settings between two steps, or none: the old ones then stay, and `error` says why unless it is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f64_set(
    controller: *mut Handle<f64>,
    settings: *const Settings<f64>,
    error: *mut Error,
) -> i32 {
    // SAFETY: as above.
    unsafe { instance::set(controller, settings, error) }
}

/// Writes the last output once more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f64_output(controller: *const Handle<f64>, output: *mut Output<f64>) -> i32 {
    // SAFETY: as above.
    unsafe { instance::output(controller, output) }
}

/// Writes how often what has gone wrong.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f64_counters(controller: *const Handle<f64>, counters: *mut Counters) -> i32 {
    // SAFETY: as above.
    unsafe { instance::counters(controller, counters) }
}

/// Writes to `bias` (one number per axis) the force that is called zero, beside the tool's weight: what the last tare has
/// found [N].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f64_bias(controller: *const Handle<f64>, bias: *mut f64) -> i32 {
    // SAFETY: as above.
    unsafe { instance::bias(controller, bias) }
}
