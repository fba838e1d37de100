//! The C interface as a caller misuses it: structs of any bits, pointers that are null or not aligned, memory of any size,
//! calls in any order. Every call returns the status that the header states, a refused one changes nothing, and what a
//! controller says is finite and within its limits, the same in two places.
#![no_main]

use core::ffi::{CStr, c_void};
use core::ptr::{null, null_mut};

use hpf_c::abi::*;
use hpf_c::f32::hpf_f32_update;
use hpf_c::f64::*;
use hpf_c::instance::{HPF_ALIGNMENT, HPF_F64_BYTES_BASE, HPF_F64_BYTES_PER_AXIS, Handle};
use hpf_c::status::*;
use libfuzzer_sys::arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;

const AXES: usize = HPF_AXES_MAX;

/// As many as a basis may have: whatever its count, the lists are there.
static LISTS: [[f64; HPF_BASES_MAX]; 5] = {
    let mut lists = [
        [0.0; HPF_BASES_MAX],
        [120.0; HPF_BASES_MAX],
        [40.0; HPF_BASES_MAX],
        [0.0; HPF_BASES_MAX],
        [9.0; HPF_BASES_MAX],
    ];
    let mut i = 0;
    while i < HPF_BASES_MAX {
        lists[0][i] = if i % 2 == 0 { 60.0 } else { -40.0 };
        lists[3][i] = 1.0 / (1.0 + i as f64);
        i += 1;
    }
    lists
};

/// A struct of zeros, prepared.
fn prepared<T>() -> T {
    // SAFETY: the structs of the border hold numbers and raw pointers, of which zeros are values; size and version come
    // first.
    unsafe {
        let mut made: T = core::mem::zeroed();
        (&raw mut made).cast::<[u32; 2]>().write([size_of::<T>() as u32, HPF_ABI_VERSION]);
        made
    }
}

/// The bytes of a struct without padding.
fn bytes<T>(value: &T) -> &[u8] {
    // SAFETY: as many as it has, of a struct that began as zeros.
    unsafe { core::slice::from_raw_parts((&raw const *value).cast(), size_of::<T>()) }
}

/// Writes other bits over some four or eight bytes behind size and version of a struct that holds numbers only.
fn spoil<T>(value: &mut T, input: &mut Unstructured<'_>) -> Result<()> {
    let at = 1 + usize::arbitrary(input)? % (size_of::<T>() / 8 - 1);
    let named = [f64::NAN, f64::INFINITY, -1.0, 0.0, 5e-324, 1e9, 1e-9, 1e300].map(f64::to_bits);
    let bits = match usize::from(u8::arbitrary(input)? % 16) {
        choice if choice < named.len() => named[choice],
        8 | 9 => u64::from(u8::arbitrary(input)? % 4) << 32 | u64::from(u8::arbitrary(input)? % 4),
        _ => u64::arbitrary(input)?,
    };
    // SAFETY: within the struct, aligned to 8 as it is.
    unsafe { (&raw mut *value).cast::<u64>().add(at).write(bits) };
    Ok(())
}

fn number(input: &mut Unstructured<'_>, lo: f64, hi: f64) -> Result<f64> {
    Ok(match u8::arbitrary(input)? {
        0 => f64::from_bits(u64::arbitrary(input)?),
        _ => lo + (hi - lo) * f64::from(u16::arbitrary(input)?) / 65535.0,
    })
}

fn one_in(input: &mut Unstructured<'_>, n: u8) -> Result<bool> {
    Ok(u8::arbitrary(input)? % n == n - 1)
}

/// A pointer as it should be, mostly, and the status that it leads to: null, not aligned, another version, another size.
fn handed<T>(value: &mut T, versioned: bool, input: &mut Unstructured<'_>) -> Result<(*mut T, i32)> {
    let pointer = &raw mut *value;
    Ok(match u8::arbitrary(input)? {
        0 => (null_mut(), HPF_NULL_POINTER),
        1 => (pointer.wrapping_byte_add(1), HPF_MISALIGNED),
        2 if versioned => {
            // SAFETY: size and version come first.
            unsafe {
                pointer
                    .cast::<u32>()
                    .add(1)
                    .write(HPF_ABI_VERSION.wrapping_add(u32::from(u8::arbitrary(input)? % 9) + 1))
            };
            (pointer, HPF_WRONG_VERSION)
        }
        3 if versioned => {
            // SAFETY: as above.
            unsafe { pointer.cast::<u32>().write(size_of::<T>() as u32 ^ (1 << (u8::arbitrary(input)? % 32))) };
            (pointer, HPF_WRONG_SIZE)
        }
        _ => (pointer, HPF_OK),
    })
}

/// A skill: plain, or with some choices and numbers that are none.
fn policy(input: &mut Unstructured<'_>) -> Result<Policy<f64>> {
    let mut policy: Policy<f64> = prepared();
    policy.axes = 1 + u32::from(u8::arbitrary(input)? % 7);
    policy.lists = u32::from(u8::arbitrary(input)? % 2);
    (policy.duration, policy.decay) = (number(input, 0.1, 2.0)?, number(input, 1.0, 6.0)?);
    let family = u32::from(u8::arbitrary(input)? % 3);
    let count = 2 + u32::from(u8::arbitrary(input)? % 8);
    for basis in [&mut policy.movement_basis, &mut policy.stiffness_basis, &mut policy.damping_basis] {
        (basis.family, basis.count, basis.overlap) = (family, count, 0.6);
        (basis.centers, basis.widths) = (LISTS[3].as_ptr(), LISTS[4].as_ptr());
        if one_in(input, 16)? {
            basis.count = u32::from(u8::arbitrary(input)?);
            basis.family = u32::from(u8::arbitrary(input)? % 4);
            basis.overlap = number(input, 0.0, 1.0)?;
        }
    }
    for axis in &mut policy.axis {
        (axis.start, axis.goal, axis.alpha, axis.forcing_scale) = (0.0, number(input, -0.3, 0.3)?, 25.0, 0.3);
        (axis.stiffness_min, axis.stiffness_max) = (number(input, 10.0, 100.0)?, 400.0);
        (axis.damping_min, axis.damping_max) = (10.0, 100.0);
        // Either order, damping from either source, and now and then numbers that make no law.
        match u8::arbitrary(input)? % 8 {
            0..=2 => {}
            3 | 4 => axis.mass = number(input, 0.1, 10.0)?,
            5 | 6 => {
                axis.mass = number(input, 0.1, 10.0)?;
                (axis.damping_ratio, axis.damping_floor) = (number(input, 0.2, 2.0)?, number(input, 1.0, 20.0)?);
            }
            _ => {
                for value in [&mut axis.mass, &mut axis.damping_ratio, &mut axis.damping_floor] {
                    *value = if bool::arbitrary(input)? { number(input, -1.0, 1.0)? } else { 0.0 };
                }
            }
        }
        let [movement, stiffness, damping, ..] = &LISTS;
        for (slot, list) in [
            (&mut axis.movement_weights, movement),
            (&mut axis.stiffness_weights, stiffness),
            (&mut axis.damping_weights, damping),
        ] {
            *slot = match u8::arbitrary(input)? {
                0 => null(),
                1 => list.as_ptr().wrapping_byte_add(4),
                _ => list.as_ptr(),
            };
        }
    }
    if one_in(input, 32)? {
        policy.lists = u32::arbitrary(input)?;
    }
    Ok(policy)
}

/// Memory of so many bytes and no more, which the address sanitizer watches.
struct Memory(Vec<u64>);

impl Memory {
    fn new(bytes: usize) -> Self {
        Self(vec![0x5a5a_5a5a_5a5a_5a5a; bytes / HPF_ALIGNMENT])
    }

    fn at(&mut self) -> *mut c_void {
        self.0.as_mut_ptr().cast()
    }
}

/// An error says what the call returned, in words that end.
fn explained(error: &Error, status: i32) {
    let text =
        CStr::from_bytes_until_nul(&bytes(error)[core::mem::offset_of!(Error, text)..]).expect("a text that ends");
    assert_eq!((error.status, text.is_empty()), (status, status == HPF_OK), "{text:?}");
}

/// A controller twice, and what is known of it.
struct Twins {
    arms: [*mut Handle<f64>; 2],
    axes: usize,
    settings: Settings<f64>,
    last: Output<f64>,
}

impl Twins {
    /// What an update has said: finite, and within the limits.
    fn judge(&mut self, now: &Output<f64>, reset: bool) {
        assert!(now.mode <= HPF_MODE_FAULT && now.flags < 2 * HPF_TARE_READY, "{now:?}");
        assert!((0.0..=1.0).contains(&now.phase) && (0.0..=1.0).contains(&now.rate), "{now:?}");
        assert!(now.energy.is_finite() && now.port_energy.is_finite(), "{now:?}");
        let parts = now.axis.iter().zip(&self.last.axis).zip(&self.settings.axis).take(self.axes);
        for ((axis, last), AxisSettings { limits, .. }) in parts {
            let all = [axis.position, axis.velocity, axis.stiffness, axis.damping, axis.offset, axis.force];
            assert!(all.iter().all(|value| value.is_finite()) && axis.hits < 2 * HPF_HIT_POSITION, "{axis:?}");
            assert!(
                axis.position >= limits.position_min && axis.position <= limits.position_max,
                "{axis:?} {limits:?}"
            );
            assert!(
                axis.offset.abs() <= limits.offset && axis.velocity.abs() <= limits.velocity,
                "{axis:?} {limits:?}"
            );
            assert!(axis.force.abs() <= limits.force, "{axis:?} {limits:?}");
            // No step is longer than a second; a reset is the one jump.
            let moved = (axis.position - last.position).abs();
            let farthest = limits.velocity * self.settings.longest_step;
            assert!(
                reset || moved <= farthest * (1.0 + 1e-9) + 1e-14 * (1.0 + axis.position.abs()),
                "{last:?} {axis:?}"
            );
        }
        // What is beyond the axes is nobody's.
        assert!(now.axis[self.axes..].iter().all(|axis| bytes(axis).iter().all(|&byte| byte == 0)), "{now:?}");
        self.last = *now;
    }

    fn update(&mut self, input: &mut Unstructured<'_>) -> Result<()> {
        let mut given: Input<f64> = prepared();
        (given.request, given.rate) = (u32::from(u8::arbitrary(input)? % 24), 1.0);
        given.request = if given.request > 9 { HPF_NO_REQUEST } else { given.request };
        let force = number(input, -60.0, 60.0)?;
        given.measured_force = [force; AXES];
        given.target = [number(input, -0.45, 0.45)?; AXES];
        if one_in(input, 8)? {
            spoil(&mut given, input)?;
        }
        let dt = number(input, 5e-4, 2e-3)?;
        let known = given.request <= HPF_RESET;
        let repeats = if one_in(input, 4)? { 4 * u16::from(u8::arbitrary(input)?) } else { 1 };
        for repeat in 0..repeats {
            let mut output: Output<f64> = prepared();
            let (mut read, mut written, mut flaws): (*mut _, *mut _, _) =
                (&raw mut given, &raw mut output, [HPF_OK; 2]);
            if repeat == 0 {
                (read, flaws[0]) = handed(&mut given, true, input)?;
                (written, flaws[1]) = handed(&mut output, true, input)?;
            }
            let [flaw, flaw_too] = flaws;
            let expected = [flaw, flaw_too, if known { HPF_OK } else { HPF_UNKNOWN_CHOICE }];
            let expected = expected.into_iter().find(|&status| status != HPF_OK).unwrap_or(HPF_OK);
            let before = output;
            // SAFETY: here and below: pointers are null, not aligned, or to what outlives the call.
            let status = unsafe { hpf_f64_update(self.arms[0], read, dt, written) };
            assert_eq!(status, expected);
            if status != HPF_OK {
                assert_eq!(bytes(&before), bytes(&output), "a refused call has written");
                return self.unchanged();
            }
            let mut twin: Output<f64> = prepared();
            assert_eq!(unsafe { hpf_f64_update(self.arms[1], read, dt, &mut twin) }, HPF_OK);
            assert_eq!(bytes(&twin), bytes(&output), "twins differ");
            self.judge(&output, given.request == HPF_RESET && output.flags & HPF_REFUSED == 0);
            given.request = HPF_NO_REQUEST;
        }
        Ok(())
    }

    /// The last output is still what it was.
    fn unchanged(&self) -> Result<()> {
        let mut output: Output<f64> = prepared();
        assert_eq!(unsafe { hpf_f64_output(self.arms[0], &mut output) }, HPF_OK);
        assert_eq!(bytes(&output), bytes(&self.last));
        Ok(())
    }

    fn set(&mut self, input: &mut Unstructured<'_>) -> Result<()> {
        let mut settings = self.settings;
        for _ in 0..u8::arbitrary(input)? % 3 {
            spoil(&mut settings, input)?;
        }
        let (mut error, mut twin): (Error, Error) = (prepared(), prepared());
        let (read, flaw) = handed(&mut settings, true, input)?;
        let status = unsafe { hpf_f64_set(self.arms[0], read, &mut error) };
        assert!(flaw == HPF_OK || status == flaw, "{status} for {flaw}");
        explained(&error, status);
        assert_eq!(unsafe { hpf_f64_set(self.arms[1], read, &mut twin) }, status);
        assert_eq!(bytes(&error), bytes(&twin));
        if status == HPF_OK {
            self.settings = settings;
            assert_eq!(unsafe { hpf_f64_output(self.arms[0], &mut self.last) }, HPF_OK);
            return Ok(());
        }
        self.unchanged()
    }

    /// Everything else that can be asked, as it should be and not.
    fn ask(&mut self, input: &mut Unstructured<'_>) -> Result<()> {
        let mut counters: Counters = prepared();
        let mut bias = [7.0_f64; AXES];
        let arm = self.arms[0];
        match u8::arbitrary(input)? % 5 {
            0 => {
                let (written, flaw) = handed(&mut counters, true, input)?;
                assert_eq!(unsafe { hpf_f64_counters(arm, written) }, flaw);
            }
            1 => {
                let (written, flaw) = handed(&mut bias, false, input)?;
                assert_eq!(unsafe { hpf_f64_bias(arm, written.cast()) }, flaw);
                let read = if flaw == HPF_OK { self.axes } else { 0 };
                assert!(
                    bias[..read].iter().all(|bias| bias.is_finite()) && bias[read..].iter().all(|&bias| bias == 7.0)
                );
            }
            2 => {
                // Another scalar's, nobody's, null, and moved: no controller.
                let mut output: hpf_c::abi::Output<f32> = prepared();
                let given: hpf_c::abi::Input<f32> = prepared();
                assert_eq!(unsafe { hpf_f32_update(arm.cast(), &given, 1e-3, &mut output) }, HPF_NO_CONTROLLER);
                let mut nobody = [u64::arbitrary(input)?; 64];
                let (pointer, status) = handed(&mut nobody, false, input)?;
                let expected = if status == HPF_OK { HPF_NO_CONTROLLER } else { status };
                assert_eq!(unsafe { hpf_f64_counters(pointer.cast(), &mut counters) }, expected);
                // SAFETY: a controller is at least as large as its handle.
                unsafe { nobody.as_mut_ptr().cast::<Handle<f64>>().copy_from(arm, 1) };
                assert_eq!(unsafe { hpf_f64_counters(nobody.as_ptr().cast(), &mut counters) }, HPF_NO_CONTROLLER);
            }
            3 => {
                let mut output: Output<f64> = prepared();
                let (written, flaw) = handed(&mut output, true, input)?;
                assert_eq!(unsafe { hpf_f64_output(arm, written) }, flaw);
            }
            _ => {
                let text = hpf_status_text(i32::arbitrary(input)? % 40);
                assert!(!text.is_null() && !unsafe { CStr::from_ptr(text) }.is_empty());
            }
        }
        self.unchanged()
    }
}

fn play(input: &mut Unstructured<'_>) -> Result<()> {
    let mut policy = policy(input)?;
    let axes = policy.axes as usize;
    let limits =
        Limits { force: 50.0, offset: 0.2, velocity: 1.0, acceleration: 20.0, position_min: -0.5, position_max: 0.5 };
    let mut settings: Settings<f64> = prepared();
    assert_eq!(unsafe { hpf_f64_compliant(&mut settings, AXES as u32, [limits; AXES].as_ptr()) }, HPF_OK);
    (settings.tank_capacity, settings.tank_refill, settings.tank_power) = (number(input, 0.0, 1.0)?, 0.9, 50.0);
    for _ in 0..u8::arbitrary(input)? % 3 {
        spoil(&mut settings, input)?;
    }

    // What size asks for is enough, and less is not; it is within the bound for static memory.
    let asked = 1 + u32::from(u8::arbitrary(input)? % 9);
    let instance = hpf_f64_instance(if one_in(input, 16)? { asked } else { policy.axes });
    let mut needed = usize::MAX;
    let sized = unsafe { hpf_f64_size(instance, &policy, &mut needed) };
    let mut error: Error = prepared();
    let mut arm = null_mut();
    let mut position = [number(input, -0.4, 0.4)?; AXES];
    if sized != HPF_OK {
        assert_eq!(needed, usize::MAX);
        let mut memory = Memory::new(16384);
        let (place, position) = (memory.at(), position.as_ptr());
        let status =
            unsafe { hpf_f64_create(instance, place, 16384, &policy, &settings, position, &mut arm, &mut error) };
        assert!(arm.is_null());
        assert_eq!(status, sized);
        explained(&error, status);
        return Ok(());
    }
    let of_basis = |basis: &BasisPolicy<f64>| basis.count as usize;
    let numbers =
        [&policy.movement_basis, &policy.stiffness_basis, &policy.damping_basis].map(of_basis).iter().sum::<usize>();
    assert!(needed <= HPF_F64_BYTES_BASE + axes * HPF_F64_BYTES_PER_AXIS + numbers * (2 + axes) * 8);
    let mut small = Memory::new(needed - 8);
    let place = small.at();
    let status = unsafe {
        hpf_f64_create(instance, place, needed - 8, &policy, &settings, position.as_ptr(), &mut arm, null_mut())
    };
    assert_eq!((status, arm.is_null()), (HPF_TOO_SMALL, true));

    let mut memories = [Memory::new(needed), Memory::new(needed)];
    let [first, second] = &mut memories;
    let (read_policy, flaw) = handed(&mut policy, true, input)?;
    let (read_position, flaw_too) = handed(&mut position, false, input)?;
    let place = first.at();
    let status = unsafe {
        hpf_f64_create(instance, place, needed, read_policy, &settings, read_position.cast(), &mut arm, &mut error)
    };
    assert!(flaw == HPF_OK || status == flaw, "{status} for {flaw}");
    assert!(flaw_too == HPF_OK || status != HPF_OK);
    assert_eq!(status == HPF_OK, !arm.is_null());
    explained(&error, status);
    if status != HPF_OK {
        // What was in the memory is no controller.
        let mut counters: Counters = prepared();
        assert_eq!(unsafe { hpf_f64_counters(place.cast(), &mut counters) }, HPF_NO_CONTROLLER);
        return Ok(());
    }
    let mut twin = null_mut();
    let place = second.at();
    let status = unsafe {
        hpf_f64_create(instance, place, needed, read_policy, &settings, read_position.cast(), &mut twin, null_mut())
    };
    assert_eq!(status, HPF_OK);
    let mut last: Output<f64> = prepared();
    assert_eq!(unsafe { hpf_f64_output(arm, &mut last) }, HPF_OK);
    let mut twins = Twins { arms: [arm, twin], axes, settings, last };
    while !input.is_empty() {
        match u8::arbitrary(input)? % 16 {
            0 => twins.set(input)?,
            1 => twins.ask(input)?,
            _ => twins.update(input)?,
        }
    }
    Ok(())
}

fuzz_target!(|bytes: &[u8]| {
    let _ = play(&mut Unstructured::new(bytes));
});
