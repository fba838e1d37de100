//! Proof by linking: a skill and a controller of `hpf-core` are built and stepped, a packed skill is read and written, and
//! orientation, stiffness with directions and rhythm are stepped, without a reachable panic and without a heap.
//!
//! The panic handler calls a function that exists nowhere, so a program links only if the linker finds no way from
//! the functions exported here to a panic. There is no global allocator, so code that allocates does not build.

#![no_std]

#[cfg(feature = "negative-alloc")]
extern crate alloc;

mod pose;

use core::mem::MaybeUninit;

use hpf_core::conditioning::ForceConditioning;
use hpf_core::controller::{AxisSettings, Compliance, Controller, Input, Request, Settings, Timing};
use hpf_core::limits::Limits;
use hpf_core::packed::{Contents, Packed, PackedError};
use hpf_core::passivity::{EnergyTank, Port};
use hpf_core::{
    AxisPrimitives, Basis, ConfigError, Damping, Gain, HybridPrimitive, HybridState, Law, Movement, Phase, Real,
};

unsafe extern "C" {
    /// Defined nowhere.
    fn hpf_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: a program that could get here does not link.
    unsafe { hpf_panic_is_reachable() }
}

/// Functions of each basis.
const N: usize = 20;
/// Axes.
const D: usize = 2;

/// A skill, its state and a controller of the same skill: opaque to C, which gives it [`ROOM`] bytes.
struct Run<T> {
    skill: HybridPrimitive<T, [T; N], D>,
    state: HybridState<T, D>,
    controller: Controller<T, [T; N], D>,
}

/// Settings that reach every branch: every compliance, tank, port, filter and dead zone.
fn settings<T: Real>() -> Result<Settings<T, D>, ConfigError> {
    let axis = |compliance| AxisSettings {
        compliance,
        limits: Limits {
            force: T::of(50.0),
            offset: T::of(0.3),
            velocity: T::of(2.0),
            acceleration: T::of(50.0),
            position: [T::of(-2.0), T::of(2.0)],
        },
        trip_force: T::of(80.0),
        tracking: T::of(0.1),
    };
    Ok(Settings {
        axes: [axis(Compliance::Compliant), axis(Compliance::Press(T::ZERO))],
        conditioning: ForceConditioning {
            tool_mass: T::ZERO,
            gravity: [T::ZERO; D],
            cutoff: Some(T::of(100.0)),
            dead_zone: [T::ZERO; D],
        },
        tank: Some(EnergyTank::new(T::of(5.0), T::ZERO, T::ONE, T::of(1e3))?),
        // Closed, because this loop has no position to measure; the compiler cannot know.
        port: core::hint::black_box(false).then_some(Port { force_delay: 2, force_bias: [T::of(0.5); D] }),
        timing: Timing { longest_step: T::of(0.01), ramp: T::of(0.2), hold: T::of(0.02), oldest_force: 4 },
    })
}

/// Bytes and alignment that `main.c` sets aside for a [`Run`].
const ROOM: usize = 8192;
const _: () = assert!(size_of::<Run<f64>>() <= ROOM && align_of::<Run<f64>>() <= 8);

impl<T: Real + PartialOrd> Run<T> {
    /// A skill at its start from weights of movement, stiffness and damping, N for each axis.
    fn new(
        [movement, stiffness, damping]: &[[[T; N]; D]; 3],
        goal: &[T; D],
        duration: T,
        decay: T,
    ) -> Result<Self, ConfigError> {
        let basis = Basis::equally_spaced(decay, T::of(0.6), [T::ZERO; N], [T::ZERO; N])?;
        let axis = |goal: T, movement: &[T; N], stiffness: &[T; N], damping: &[T; N], law: Law<T>| {
            Ok::<_, ConfigError>(AxisPrimitives {
                movement: Movement::new(T::ZERO, goal, T::of(25.0), goal, *movement)?,
                stiffness: Gain::new(T::of(30.0), T::of(400.0), *stiffness)?,
                damping: Gain::new(T::of(10.0), T::of(100.0), *damping)?,
                law,
            })
        };
        let ([gx, gy], [mx, my], [kx, ky], [dx, dy]) = (goal, movement, stiffness, damping);
        let ratio = Damping::Ratio { ratio: T::ONE, floor: T::of(10.0) };
        let second = Law::SecondOrder { mass: T::of(2.0), damping: ratio };
        let axes = [axis(*gx, mx, kx, dx, Law::FirstOrder)?, axis(*gy, my, ky, dy, second)?];
        let skill = HybridPrimitive::new(Phase::new(duration, decay)?, [basis; 3], axes)?;
        let mut controller = Controller::new(skill, settings()?, [T::ZERO; D])?;
        controller.set(settings()?)?;
        Ok(Self { skill, state: skill.initial_state(), controller })
    }

    /// One step; writes position, velocity, stiffness and damping of each axis.
    fn step(&mut self, force: &[T; D], rate: T, dt: T, commands: &mut [[T; 4]; D]) {
        let found = self.skill.step(&mut self.state, *force, rate, dt);
        *commands = found.map(|axis| [axis.position, axis.velocity, axis.stiffness, axis.damping]);
        #[cfg(feature = "negative-panic")]
        {
            commands[dt.to_f64() as usize][0] = T::ZERO; // out of bounds from 2 s on
        }
        #[cfg(feature = "negative-alloc")]
        {
            commands[0][0] = T::of(alloc::vec![T::ZERO; dt.to_f64() as usize].len() as f64);
        }
    }
}

impl<T: Real + PartialOrd> Run<T> {
    /// One update of the controller; writes what `step` does. `request` 0 is none, 1 to 7 are those of [`Request`].
    fn update(&mut self, force: &[T; D], request: u32, rate: T, dt: T, commands: &mut [[T; 4]; D]) {
        let request = match request {
            1 => Some(Request::Start),
            2 => Some(Request::Hold),
            3 => Some(Request::Resume),
            4 => Some(Request::Stop),
            5 => Some(Request::Goal(*force)),
            6 => Some(Request::Tare),
            7 => Some(Request::Reset(*force)),
            _ => None,
        };
        // A position is watched where the rate is negative: reachable, and out of the way of what `main.c` checks.
        let measured_position = (rate.to_f64() < 0.0).then_some(*force);
        let input = Input { measured_force: *force, force_age: 0, measured_position, rate, request };
        let found = self.controller.update(&input, dt);
        *commands = found.axes.map(|axis| [axis.position, axis.velocity, axis.stiffness, axis.damping]);
        #[cfg(feature = "negative-panic-update")]
        {
            commands[dt.to_f64() as usize][0] = T::ZERO; // out of bounds from 2 s on
        }
    }
}

/// Room for a packed skill [bytes].
const PACKED: usize = 4096;

/// Reads a packed skill into arrays of its own, writes that, reads what was written into storage, and steps both; returns
/// where the first axis then is.
fn unpack<T: Real>(bytes: &[u8]) -> Result<[T; 2], PackedError> {
    let packed = Packed::parse(bytes)?;
    let owned = packed.skill::<T, N, D>()?;
    let contents = Contents::of(&owned, packed.head().rotary);
    let (mut room, expected) = ([0; PACKED], contents.head()?.length());
    let written = room.get_mut(..expected).ok_or(PackedError::Length { found: PACKED, expected })?;
    contents.pack(written)?;
    let packed = Packed::parse(written)?;
    let mut storage = [T::ZERO; 3 * N * (2 + D)];
    let borrowed = packed.skill_in::<T, D>(&mut storage)?;
    // The axes number by number: the goals are those of the skill.
    for (axis, read) in owned.axes().iter().zip(packed.axes()) {
        if read.goal != axis.movement.goal().to_f64() || !read.weights().eq(weights(&axis.movement)) {
            return Err(PackedError::NotASkill);
        }
    }
    let [first, _] = owned.step(&mut owned.initial_state(), [T::ONE; D], T::ONE, T::of(0.01));
    let [second, _] = borrowed.step(&mut borrowed.initial_state(), [T::ONE; D], T::ONE, T::of(0.01));
    #[cfg(feature = "negative-panic-unpack")]
    let first = [first][usize::from(bytes[0])];
    Ok([first.position, second.position])
}

fn weights<T: Real>(movement: &Movement<T, [T; N]>) -> impl Iterator<Item = f64> {
    movement.weights().iter().map(|weight| weight.to_f64())
}

macro_rules! export {
    ($float:ident, $new:ident, $step:ident, $update:ident, $unpack:ident, $pose:ident) => {
        /// A step of orientation, stiffness with directions and rhythm; returns whether the input was accepted.
        ///
        /// # Safety
        /// The pointers point to as many numbers as their types say.
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $pose(
            input: *const [$float; pose::IN],
            dt: $float,
            out: *mut [$float; pose::OUT],
        ) -> bool {
            // SAFETY: the caller's promise.
            let (input, out) = unsafe { (&*input, &mut *out) };
            pose::pose(input, dt, out).is_ok()
        }

        /// Reads a packed skill and writes where a step of it leads; returns whether it was accepted.
        ///
        /// # Safety
        /// `bytes` points to `length` bytes, `position` to two numbers.
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $unpack(bytes: *const u8, length: usize, position: *mut [$float; 2]) -> bool {
            // SAFETY: the caller's promise.
            let (bytes, position) = unsafe { (core::slice::from_raw_parts(bytes, length), &mut *position) };
            unpack(bytes).map(|found| *position = found).is_ok()
        }

        /// Writes a skill at its start to `run`; returns whether its parameters were accepted.
        ///
        /// # Safety
        /// `run` points to `ROOM` writable bytes aligned to 8, the others to as many numbers as their types say.
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $new(
            run: *mut MaybeUninit<Run<$float>>,
            weights: *const [[[$float; N]; D]; 3],
            goal: *const [$float; D],
            duration: $float,
            decay: $float,
        ) -> bool {
            // SAFETY: the caller's promise.
            let (run, weights, goal) = unsafe { (&mut *run, &*weights, &*goal) };
            Run::new(weights, goal, duration, decay).map(|built| run.write(built)).is_ok()
        }

        /// Advances `run` and writes its commands.
        ///
        /// # Safety
        /// `run` was written by `new`; the others point to as many numbers as their types say.
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $step(
            run: *mut Run<$float>,
            force: *const [$float; D],
            rate: $float,
            dt: $float,
            commands: *mut [[$float; 4]; D],
        ) {
            // SAFETY: the caller's promise.
            let (run, force, commands) = unsafe { (&mut *run, &*force, &mut *commands) };
            run.step(force, rate, dt, commands);
        }

        /// Updates the controller of `run` and writes its commands.
        ///
        /// # Safety
        /// As for `step`.
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $update(
            run: *mut Run<$float>,
            force: *const [$float; D],
            request: u32,
            rate: $float,
            dt: $float,
            commands: *mut [[$float; 4]; D],
        ) {
            // SAFETY: the caller's promise.
            let (run, force, commands) = unsafe { (&mut *run, &*force, &mut *commands) };
            run.update(force, request, rate, dt, commands);
        }
    };
}

export!(f32, hpf_f32_new, hpf_f32_step, hpf_f32_update, hpf_f32_unpack, hpf_f32_pose);
export!(f64, hpf_f64_new, hpf_f64_step, hpf_f64_update, hpf_f64_unpack, hpf_f64_pose);
