//! One implementation for every scalar and number of axes, behind a table of functions.

use core::ptr;

use hpf_core::Real;
use hpf_core::controller::Controller;

use crate::abi::{Counters, Error, HPF_ABI_VERSION, HPF_AXES_MAX, Input, Limits, Output, Policy, Settings, Versioned};
use crate::status::{
    HPF_MISALIGNED, HPF_NO_CONTROLLER, HPF_NULL_POINTER, HPF_OK, HPF_TOO_SMALL, HPF_WRONG_AXES, HPF_WRONG_SIZE,
    HPF_WRONG_VERSION, Refusal,
};
use crate::storage::{List, ListArena, numbers};

/// Alignment of the memory for a controller.
pub const HPF_ALIGNMENT: usize = 8;
/// Upper bound of what a single-precision controller needs beside its axes and lists.
pub const HPF_F32_BYTES_BASE: usize = 552;
/// Upper bound of what each axis adds, without lists.
pub const HPF_F32_BYTES_PER_AXIS: usize = 392;
/// Upper bound of what a double-precision controller needs beside its axes and lists.
pub const HPF_F64_BYTES_BASE: usize = 800;
/// Upper bound of what each axis adds, without lists.
pub const HPF_F64_BYTES_PER_AXIS: usize = 720;

/// A scalar that controllers are made for.
pub trait Scalar: Real + PartialOrd {
    /// Marks a controller and an instance of this scalar.
    const MARK: u64;
}

impl Scalar for f32 {
    const MARK: u64 = u64::from_ne_bytes(*b"HPFf32\x01\x5a");
}

impl Scalar for f64 {
    const MARK: u64 = u64::from_ne_bytes(*b"HPFf64\x01\x5a");
}

/// What an entry ends with.
type Outcome = Result<(), Refusal>;

/// Makes a controller in so many bytes, for a robot at a position.
type Create<T> = unsafe fn(*mut Handle<T>, usize, &Policy<T>, &Settings<T>, *const T) -> Outcome;

/// The functions of the controllers of one scalar and number of axes; opaque to C.
#[derive(Debug)]
pub struct Instance<T: 'static> {
    mark: u64,
    axes: usize,
    /// Bytes of a controller without its lists.
    bytes: usize,
    create: Create<T>,
    update: unsafe fn(*mut Handle<T>, &Input<T>, T, &mut Output<T>) -> Outcome,
    set: unsafe fn(*mut Handle<T>, &Settings<T>) -> Outcome,
    output: unsafe fn(*const Handle<T>, &mut Output<T>),
    counters: unsafe fn(*const Handle<T>, &mut Counters),
    /// Writes one number per axis, to a pointer that is checked.
    bias: unsafe fn(*const Handle<T>, *mut T) -> Outcome,
}

/// A controller in the caller's memory; opaque to C.
#[derive(Debug)]
pub struct Handle<T: 'static> {
    mark: u64,
    /// Where it was made: its lists are there too, it does not move.
    own: *mut Handle<T>,
    instance: &'static Instance<T>,
}

/// What lies in the memory before the lists.
#[repr(C)]
struct Slot<T: 'static, const D: usize> {
    handle: Handle<T>,
    controller: Controller<T, List<T>, D>,
}

impl<T: Scalar, const D: usize> Slot<T, D> {
    const INSTANCE: Instance<T> = Instance {
        mark: T::MARK,
        axes: D,
        bytes: size_of::<Self>().next_multiple_of(HPF_ALIGNMENT),
        create: Self::create,
        update: Self::update,
        set: Self::set,
        output: Self::output,
        counters: Self::counters,
        bias: Self::bias,
    };
    const FITS: () = {
        let [base, per_axis] = match size_of::<T>() {
            4 => [HPF_F32_BYTES_BASE, HPF_F32_BYTES_PER_AXIS],
            _ => [HPF_F64_BYTES_BASE, HPF_F64_BYTES_PER_AXIS],
        };
        assert!(D <= HPF_AXES_MAX && align_of::<Self>() <= HPF_ALIGNMENT);
        assert!(Self::INSTANCE.bytes <= base + D * per_axis);
    };

    /// # Safety
    /// `memory` is aligned to `HPF_ALIGNMENT` and has `bytes` for writing, used by nobody else; `position` points to `D`
    /// numbers, lists of `policy` to as many as their basis has functions, unless null or not aligned.
    unsafe fn create(
        memory: *mut Handle<T>,
        bytes: usize,
        policy: &Policy<T>,
        settings: &Settings<T>,
        position: *const T,
    ) -> Outcome {
        let (count, copies) = numbers(policy, D)?;
        if bytes < Self::INSTANCE.bytes + count * size_of::<T>() {
            return Err(HPF_TOO_SMALL.into());
        }
        let settings = settings.read::<D>()?;
        // SAFETY: by contract; an array has the alignment of its numbers.
        let &position = unsafe { checked(position.cast::<[T; D]>())? };
        // SAFETY: memory by contract and the check above; a whole number of `T` behind the slot.
        let skill = unsafe {
            let mut arena = ListArena::new(memory.cast::<u8>().add(Self::INSTANCE.bytes).cast(), count, copies);
            arena.skill::<D>(policy)?
        };
        let controller = Controller::new(skill, settings, position)?;
        let handle = Handle { mark: T::MARK, own: memory, instance: const { &Self::INSTANCE } };
        // SAFETY: by contract and the check above.
        unsafe { memory.cast::<Self>().write(Self { handle, controller }) };
        Ok(())
    }

    /// # Safety
    /// `handle` is one of `create`, here and below, used by nobody else.
    unsafe fn update(handle: *mut Handle<T>, input: &Input<T>, dt: T, output: &mut Output<T>) -> Outcome {
        let input = input.read()?;
        // SAFETY: by contract.
        let slot = unsafe { &mut *handle.cast::<Self>() };
        output.write(&slot.controller.update(&input, dt));
        Ok(())
    }

    unsafe fn set(handle: *mut Handle<T>, settings: &Settings<T>) -> Outcome {
        let settings = settings.read()?;
        // SAFETY: by contract.
        let slot = unsafe { &mut *handle.cast::<Self>() };
        Ok(slot.controller.set(settings)?)
    }

    unsafe fn output(handle: *const Handle<T>, output: &mut Output<T>) {
        // SAFETY: by contract.
        let slot = unsafe { &*handle.cast::<Self>() };
        output.write(&slot.controller.output());
    }

    unsafe fn counters(handle: *const Handle<T>, counters: &mut Counters) {
        // SAFETY: by contract.
        let slot = unsafe { &*handle.cast::<Self>() };
        counters.write(slot.controller.counters());
    }

    /// # Safety
    /// As above; `bias` points to `D` numbers for writing, unless null or not aligned.
    unsafe fn bias(handle: *const Handle<T>, bias: *mut T) -> Outcome {
        let bias = bias.cast::<[T; D]>();
        usable(bias.cast_const())?;
        // SAFETY: by contract and the check above; an array has the alignment of its numbers.
        unsafe {
            let slot = &*handle.cast::<Self>();
            bias.write(slot.controller.bias());
        }
        Ok(())
    }
}

/// The instance for `D` axes.
pub(crate) const fn instance<T: Scalar, const D: usize>() -> &'static Instance<T> {
    const { Slot::<T, D>::FITS };
    const { &Slot::<T, D>::INSTANCE }
}

/// Refuses a pointer that is null or not aligned.
fn usable<V>(pointer: *const V) -> Outcome {
    match (pointer.is_null(), pointer.is_aligned()) {
        (true, _) => Err(HPF_NULL_POINTER.into()),
        (false, false) => Err(HPF_MISALIGNED.into()),
        (false, true) => Ok(()),
    }
}

/// What `pointer` points to, if it is usable.
///
/// # Safety
/// It then points to a value that nobody writes to meanwhile.
unsafe fn checked<'a, V>(pointer: *const V) -> Result<&'a V, Refusal> {
    usable(pointer)?;
    // SAFETY: by contract.
    Ok(unsafe { &*pointer })
}

/// The struct at `pointer`, if it says that it is one of this version and size.
///
/// # Safety
/// Unless null, not aligned or of another version or size, it points to one that nobody writes to meanwhile.
unsafe fn read<'a, V: Versioned>(pointer: *const V) -> Result<&'a V, Refusal> {
    // SAFETY: every version begins with these two, and is aligned to them at least.
    let &[size, version] = unsafe { checked(pointer.cast::<[u32; 2]>())? };
    if version != HPF_ABI_VERSION {
        return Err(HPF_WRONG_VERSION.into());
    }
    if size as usize != size_of::<V>() {
        return Err(HPF_WRONG_SIZE.into());
    }
    // SAFETY: by contract.
    unsafe { checked(pointer) }
}

/// As [`read`], for writing.
///
/// # Safety
/// As there, and nobody reads it meanwhile.
unsafe fn write<'a, V: Versioned>(pointer: *mut V) -> Result<&'a mut V, Refusal> {
    // SAFETY: by contract; the reference made for the check is gone.
    unsafe {
        read(pointer.cast_const())?;
        Ok(&mut *pointer)
    }
}

/// The instance at `pointer`.
///
/// # Safety
/// Unless null or not aligned, it came from this library.
unsafe fn known<T: Scalar>(pointer: *const Instance<T>) -> Result<&'static Instance<T>, Refusal> {
    // SAFETY: by contract.
    let instance = unsafe { checked(pointer)? };
    if instance.mark == T::MARK { Ok(instance) } else { Err(HPF_NO_CONTROLLER.into()) }
}

/// The instance of the controller at `handle`.
///
/// # Safety
/// Unless null or not aligned, `handle` points to memory that was given to `create`, or that holds other numbers.
unsafe fn made<T: Scalar>(handle: *const Handle<T>) -> Result<&'static Instance<T>, Refusal> {
    // SAFETY: by contract; each field is looked at only if the one before it is right.
    unsafe {
        usable(handle)?;
        let marked = ptr::addr_of!((*handle).mark).read() == T::MARK;
        if marked && ptr::eq(ptr::addr_of!((*handle).own).read(), handle) {
            known(ptr::from_ref(ptr::addr_of!((*handle).instance).read()))
        } else {
            Err(HPF_NO_CONTROLLER.into())
        }
    }
}

/// The status of an outcome.
fn status(outcome: Outcome) -> i32 {
    outcome.err().map_or(HPF_OK, Refusal::status)
}

/// The status of an outcome, the refusal in `error` unless that is null.
///
/// # Safety
/// As for [`write`].
unsafe fn reported(error: *mut Error, outcome: impl FnOnce() -> Outcome) -> i32 {
    if error.is_null() {
        return status(outcome());
    }
    // SAFETY: by contract.
    match unsafe { write(error) } {
        Err(refusal) => refusal.status(),
        Ok(error) => {
            let outcome = outcome();
            (error.status, error.reserved) = (HPF_OK, 0);
            (error.value, error.min, error.max, error.text) = (0.0, 0.0, 0.0, [0; 128]);
            if let Err(refusal) = outcome {
                refusal.report(error);
            }
            status(outcome)
        }
    }
}

/// The policy at `pointer`, if it has as many axes as `instance`.
///
/// # Safety
/// As for [`read`].
unsafe fn policy_for<'a, T: Scalar>(
    instance: &Instance<T>,
    pointer: *const Policy<T>,
) -> Result<&'a Policy<T>, Refusal> {
    // SAFETY: by contract.
    let policy = unsafe { read(pointer)? };
    if policy.axes as usize == instance.axes { Ok(policy) } else { Err(HPF_WRONG_AXES.into()) }
}

/// Bytes that a controller of `policy` needs.
///
/// # Safety
/// The contract of the crate, here and below.
pub(crate) unsafe fn size<T: Scalar>(instance: *const Instance<T>, policy: *const Policy<T>, bytes: *mut usize) -> i32 {
    let needed = || {
        // SAFETY: by contract.
        let instance = unsafe { known(instance)? };
        // SAFETY: by contract.
        let policy = unsafe { policy_for(instance, policy)? };
        usable(bytes)?;
        let (count, _) = numbers(policy, instance.axes)?;
        // SAFETY: checked above.
        unsafe { bytes.write(instance.bytes + count * size_of::<T>()) };
        Ok(())
    };
    status(needed())
}

#[expect(clippy::too_many_arguments, reason = "the arguments of the C function")]
pub(crate) unsafe fn create<T: Scalar>(
    instance: *const Instance<T>,
    memory: *mut core::ffi::c_void,
    bytes: usize,
    policy: *const Policy<T>,
    settings: *const Settings<T>,
    position: *const T,
    controller: *mut *mut Handle<T>,
    error: *mut Error,
) -> i32 {
    let made = || {
        // SAFETY: by contract.
        unsafe {
            usable(controller)?;
            controller.write(ptr::null_mut());
            let instance = known(instance)?;
            if memory.is_null() {
                return Err(HPF_NULL_POINTER.into());
            }
            if !memory.addr().is_multiple_of(HPF_ALIGNMENT) {
                return Err(HPF_MISALIGNED.into());
            }
            let (policy, settings) = (policy_for(instance, policy)?, read(settings)?);
            let handle = memory.cast::<Handle<T>>();
            if bytes >= instance.bytes {
                // What was here is no longer, even if what follows is refused.
                ptr::addr_of_mut!((*handle).mark).write(0);
            }
            (instance.create)(handle, bytes, policy, settings, position)?;
            controller.write(handle);
        }
        Ok(())
    };
    // SAFETY: by contract.
    unsafe { reported(error, made) }
}

pub(crate) unsafe fn update<T: Scalar>(
    controller: *mut Handle<T>,
    input: *const Input<T>,
    dt: T,
    output: *mut Output<T>,
) -> i32 {
    // SAFETY: by contract.
    let step = || unsafe { (made(controller)?.update)(controller, read(input)?, dt, write(output)?) };
    status(step())
}

pub(crate) unsafe fn set<T: Scalar>(
    controller: *mut Handle<T>,
    settings: *const Settings<T>,
    error: *mut Error,
) -> i32 {
    // SAFETY: by contract.
    unsafe { reported(error, || (made(controller)?.set)(controller, read(settings)?)) }
}

pub(crate) unsafe fn output<T: Scalar>(controller: *const Handle<T>, output: *mut Output<T>) -> i32 {
    let last = || {
        // SAFETY: by contract.
        unsafe { (made(controller)?.output)(controller, write(output)?) };
        Ok(())
    };
    status(last())
}

pub(crate) unsafe fn counters<T: Scalar>(controller: *const Handle<T>, counters: *mut Counters) -> i32 {
    let counted = || {
        // SAFETY: by contract.
        unsafe { (made(controller)?.counters)(controller, write(counters)?) };
        Ok(())
    };
    status(counted())
}

pub(crate) unsafe fn bias<T: Scalar>(controller: *const Handle<T>, bias: *mut T) -> i32 {
    // SAFETY: by contract.
    let read = || unsafe { (made(controller)?.bias)(controller, bias) };
    status(read())
}

pub(crate) unsafe fn compliant<T: Scalar>(settings: *mut Settings<T>, axes: u32, limits: *const Limits<T>) -> i32 {
    let fill = || {
        let axes = axes as usize;
        if !(1..=HPF_AXES_MAX).contains(&axes) {
            return Err(HPF_WRONG_AXES.into());
        }
        // SAFETY: by contract.
        unsafe {
            usable(limits)?;
            write(settings)?.write_compliant(core::slice::from_raw_parts(limits, axes));
        }
        Ok(())
    };
    status(fill())
}
