//! The entries in single precision.

use core::ffi::c_void;

use crate::abi::{Counters, Error, Input, Limits, Output, Policy, Settings};
use crate::instance::{self, Handle, Instance};

/// The instance for one axis in single precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f32_axes_1() -> *const Instance<f32> {
    instance::instance::<f32, 1>()
}

/// The instance for two axes in single precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f32_axes_2() -> *const Instance<f32> {
    instance::instance::<f32, 2>()
}

/// The instance for three axes in single precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f32_axes_3() -> *const Instance<f32> {
    instance::instance::<f32, 3>()
}

/// The instance for four axes in single precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f32_axes_4() -> *const Instance<f32> {
    instance::instance::<f32, 4>()
}

/// The instance for five axes in single precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f32_axes_5() -> *const Instance<f32> {
    instance::instance::<f32, 5>()
}

/// The instance for six axes in single precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f32_axes_6() -> *const Instance<f32> {
    instance::instance::<f32, 6>()
}

/// The instance for seven axes in single precision.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f32_axes_7() -> *const Instance<f32> {
    instance::instance::<f32, 7>()
}

/// The instance for `axes` in single precision, null unless there are 1 to HPF_AXES_MAX. A program that calls this links
/// all of them; one that names the one it uses does not.
#[unsafe(no_mangle)]
pub extern "C" fn hpf_f32_instance(axes: u32) -> *const Instance<f32> {
    match axes {
        1 => hpf_f32_axes_1(),
        2 => hpf_f32_axes_2(),
        3 => hpf_f32_axes_3(),
        4 => hpf_f32_axes_4(),
        5 => hpf_f32_axes_5(),
        6 => hpf_f32_axes_6(),
        7 => hpf_f32_axes_7(),
        _ => core::ptr::null(),
    }
}

/// Writes to `bytes` how much memory a controller of `policy` needs. Looks at axes, lists and bases only.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f32_size(
    instance: *const Instance<f32>,
    policy: *const Policy<f32>,
    bytes: *mut usize,
) -> i32 {
    // SAFETY: the contract of the crate, here and below.
    unsafe { instance::size(instance, policy, bytes) }
}

/// Writes settings to start from: every axis gives way by the law of its policy, no filter, no tank; trips at twice the
/// force limit and where the robot is off by the offset limit; steps up to 10 ms, a ramp of 0.2 s, and for 20 ms a
/// bad input is bridged; a force more than 4 steps old is bad. `limits`: one per axis.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f32_compliant(settings: *mut Settings<f32>, axes: u32, limits: *const Limits<f32>) -> i32 {
    // SAFETY: as above.
    unsafe { instance::compliant(settings, axes, limits) }
}

/// Makes a controller in Idle, in `bytes` of `memory` aligned to HPF_ALIGNMENT, for a robot at rest at `position` (one
/// number per axis), and writes its address to `controller`; null if refused, and then `error` says why unless it is
/// null. The memory stays the caller's; the controller lives until it is used otherwise, and must not be moved. No two
/// threads may use one controller at once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f32_create(
    instance: *const Instance<f32>,
    memory: *mut c_void,
    bytes: usize,
    policy: *const Policy<f32>,
    settings: *const Settings<f32>,
    position: *const f32,
    controller: *mut *mut Handle<f32>,
    error: *mut Error,
) -> i32 {
    // SAFETY: as above.
    unsafe { instance::create(instance, memory, bytes, policy, settings, position, controller, error) }
}

/// One step of `dt` [s]. Total for every number in `input`; refused, with nothing changed and nothing written, only where
/// a pointer or a choice is wrong.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f32_update(
    controller: *mut Handle<f32>,
    input: *const Input<f32>,
    dt: f32,
    output: *mut Output<f32>,
) -> i32 {
    // SAFETY: as above.
    unsafe { instance::update(controller, input, dt, output) }
}

/// Replaces all settings between two steps, or none: the old ones then stay, and `error` says why unless it is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f32_set(
    controller: *mut Handle<f32>,
    settings: *const Settings<f32>,
    error: *mut Error,
) -> i32 {
    // SAFETY: as above.
    unsafe { instance::set(controller, settings, error) }
}

/// Writes the last output once more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f32_output(controller: *const Handle<f32>, output: *mut Output<f32>) -> i32 {
    // SAFETY: as above.
    unsafe { instance::output(controller, output) }
}

/// Writes how often what has gone wrong.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f32_counters(controller: *const Handle<f32>, counters: *mut Counters) -> i32 {
    // SAFETY: as above.
    unsafe { instance::counters(controller, counters) }
}

/// Writes to `bias` (one number per axis) the force that is called zero, beside the tool's weight: what the last tare has
/// found [N].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn hpf_f32_bias(controller: *const Handle<f32>, bias: *mut f32) -> i32 {
    // SAFETY: as above.
    unsafe { instance::bias(controller, bias) }
}
