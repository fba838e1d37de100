//! What crosses the border is what the controller says, bit for bit; what cannot cross is refused with a reason.

use core::ffi::CStr;
use core::mem::offset_of;
use core::ptr::{null, null_mut};

use hpf_c::abi::*;
use hpf_c::f32::hpf_f32_axes_2;
use hpf_c::f64::*;
use hpf_c::instance::*;
use hpf_c::status::*;
use hpf_core::controller::{Controller, Request};
use hpf_core::passivity::{EnergyTank, Port};
use hpf_core::{AxisPrimitives, Basis, Damping, Gain, HybridPrimitive, Law, Movement, Phase, limits};

const DECAY: f64 = 4.6;
const N: usize = 20;

/// A struct of C, prepared as `HPF_PREPARE` does.
fn prepared<V>() -> V {
    // SAFETY: every struct of the border holds numbers and raw pointers: zeros are a value, size and version come first.
    unsafe {
        let mut value: V = core::mem::zeroed();
        (&raw mut value).cast::<[u32; 2]>().write([size_of::<V>() as u32, HPF_ABI_VERSION]);
        value
    }
}

fn weights(axis: usize) -> [[f64; N]; 3] {
    let wave = |i: usize| ((3 * i + axis) as f64).sin();
    [
        core::array::from_fn(|i| 2.0 * wave(i)),
        core::array::from_fn(|i| 200.0 + 100.0 * wave(i)),
        core::array::from_fn(|i| 50.0 + 20.0 * wave(i)),
    ]
}

/// What a C program holds, and what the tests spoil.
struct Caller {
    lists: [[[f64; N]; 3]; HPF_AXES_MAX],
    centers: [f64; N],
    widths: [f64; N],
    policy: Policy<f64>,
    settings: Settings<f64>,
    position: [f64; HPF_AXES_MAX],
    memory: Vec<u64>,
    error: Error,
}

impl Caller {
    fn new(axes: u32, family: u32, lists: u32) -> Box<Self> {
        let basis = Basis::equally_spaced(DECAY, 0.6, [0.0; N], [0.0; N]).unwrap();
        let mut caller = Box::new(Self {
            lists: core::array::from_fn(weights),
            centers: basis.centers().try_into().unwrap(),
            widths: basis.widths().try_into().unwrap(),
            policy: prepared(),
            settings: prepared(),
            position: [0.01; HPF_AXES_MAX],
            memory: vec![0; 4096],
            error: prepared(),
        });
        let basis = BasisPolicy {
            family,
            count: N as u32,
            overlap: 0.6,
            centers: caller.centers.as_ptr(),
            widths: caller.widths.as_ptr(),
        };
        let policy = &mut caller.policy;
        (policy.axes, policy.lists, policy.duration, policy.decay) = (axes, lists, 2.0, DECAY);
        (policy.movement_basis, policy.stiffness_basis, policy.damping_basis) = (basis, basis, basis);
        for (axis, [movement, stiffness, damping]) in policy.axis.iter_mut().zip(&caller.lists) {
            *axis = AxisPolicy {
                start: 0.0,
                goal: 0.3,
                alpha: 25.0,
                forcing_scale: 0.3,
                movement_weights: movement.as_ptr(),
                stiffness_min: 30.0,
                stiffness_max: 400.0,
                stiffness_weights: stiffness.as_ptr(),
                damping_min: 10.0,
                damping_max: 100.0,
                damping_weights: damping.as_ptr(),
                mass: 0.0,
                damping_ratio: 0.0,
                damping_floor: 0.0,
            };
        }
        let [first, ..] = &mut policy.axis;
        (first.mass, first.damping_ratio, first.damping_floor) = (2.0, 1.0, 10.0);
        let limit = Limits {
            force: 50.0,
            offset: 0.2,
            velocity: 0.5,
            acceleration: 10.0,
            position_min: -0.5,
            position_max: 0.6,
        };
        // SAFETY: both outlive the call.
        let status = unsafe { hpf_f64_compliant(&mut caller.settings, axes, [limit; HPF_AXES_MAX].as_ptr()) };
        assert_eq!(status, HPF_OK);
        let settings = &mut caller.settings;
        settings.cutoff = 100.0;
        (settings.tank_capacity, settings.tank_refill, settings.tank_power) = (2.0, 0.9, 1e3);
        caller
    }

    fn bytes(&self) -> usize {
        let mut bytes = 0;
        // SAFETY: all outlive the call.
        let status = unsafe { hpf_f64_size(hpf_f64_instance(self.policy.axes), &self.policy, &mut bytes) };
        assert_eq!(status, HPF_OK);
        bytes
    }

    fn create_in(&mut self, bytes: usize) -> Result<*mut Handle<f64>, i32> {
        let mut controller = null_mut();
        // SAFETY: the lists are those of a box that outlives the controller, the memory is larger than any `bytes` here.
        let status = unsafe {
            hpf_f64_create(
                hpf_f64_instance(self.policy.axes.clamp(1, 7)),
                self.memory.as_mut_ptr().cast(),
                bytes,
                &self.policy,
                &self.settings,
                self.position.as_ptr(),
                &mut controller,
                &mut self.error,
            )
        };
        assert_eq!(status, self.error.status);
        assert_eq!(controller.is_null(), status != HPF_OK);
        if status == HPF_OK { Ok(controller) } else { Err(status) }
    }

    fn create(&mut self) -> Result<*mut Handle<f64>, i32> {
        self.create_in(8 * 4096)
    }

    fn reason(&self) -> &str {
        // SAFETY: the text ends with a zero byte.
        unsafe { CStr::from_ptr(self.error.text.as_ptr()) }.to_str().unwrap()
    }
}

/// The same skill and settings, without C.
fn controller<const D: usize>(time: bool, port: bool) -> Controller<f64, [f64; N], D> {
    let zeros = [0.0; N];
    let basis = match time {
        true => Basis::equally_spaced_in_time(DECAY, 0.6, zeros, zeros),
        false => Basis::equally_spaced(DECAY, 0.6, zeros, zeros),
    };
    let ratio = Damping::Ratio { ratio: 1.0, floor: 10.0 };
    let axes = core::array::from_fn(|axis| {
        let [movement, stiffness, damping] = weights(axis);
        AxisPrimitives {
            movement: Movement::new(0.0, 0.3, 25.0, 0.3, movement).unwrap(),
            stiffness: Gain::new(30.0, 400.0, stiffness).unwrap(),
            damping: Gain::new(10.0, 100.0, damping).unwrap(),
            law: if axis == 0 { Law::SecondOrder { mass: 2.0, damping: ratio } } else { Law::FirstOrder },
        }
    });
    let skill = HybridPrimitive::new(Phase::new(2.0, DECAY).unwrap(), [basis.unwrap(); 3], axes).unwrap();
    let limit = limits::Limits { force: 50.0, offset: 0.2, velocity: 0.5, acceleration: 10.0, position: [-0.5, 0.6] };
    let mut settings = hpf_core::controller::Settings::compliant([limit; D]);
    settings.conditioning.cutoff = Some(100.0);
    settings.tank = Some(EnergyTank::new(2.0, 0.0, 0.9, 1e3).unwrap());
    settings.port = port.then_some(Port { force_delay: 2, force_bias: [0.5; D] });
    Controller::new(skill, settings, [0.01; D]).unwrap()
}

fn same_over_a_movement<const D: usize>(family: u32, lists: u32) {
    let mut caller = Caller::new(D as u32, family, lists);
    // One of the ways to keep lists meets the physical port too, with a robot that is where it was told to be.
    let port = lists == HPF_LISTS_COPIED;
    if port {
        (caller.settings.has_port, caller.settings.port_force_delay) = (1, 2);
        caller.settings.port_force_bias = [0.5; HPF_AXES_MAX];
    }
    let exact = caller.bytes();
    let numbers = 2 * N + if lists == HPF_LISTS_COPIED { 3 * N * D } else { 0 };
    assert!(exact <= HPF_F64_BYTES_BASE + D * HPF_F64_BYTES_PER_AXIS + 8 * numbers);
    let handle = caller.create_in(exact).unwrap();
    let mut ours = controller::<D>(family == HPF_BASIS_TIME, port);
    let mut output: Output<f64> = prepared();
    for tick in 0..3700_u32 {
        let (request, choice) = match tick {
            0 => (Some(Request::Start), HPF_START),
            400 => (Some(Request::Hold), HPF_HOLD),
            700 => (Some(Request::Resume), HPF_RESUME),
            900 => (Some(Request::Goal([0.2; D])), HPF_GOAL),
            1000 => (Some(Request::Tare), HPF_TARE), // refused in Run
            2500 => (Some(Request::Stop), HPF_STOP),
            2900 => (Some(Request::Reset([0.1; D])), HPF_RESET),
            3500 => (Some(Request::Tare), HPF_TARE),
            _ => (None, HPF_NO_REQUEST),
        };
        let force = match tick {
            1500 => f64::NAN,
            2900.. => 8.0, // in Idle, still
            _ => 40.0 * (0.01 * f64::from(tick)).sin(),
        };
        let dt = if tick == 1200 { -1.0 } else { 1e-3 };
        let mut input: Input<f64> = prepared();
        (input.request, input.rate, input.force_age) = (choice, 0.9, u32::from(tick == 1600) * 9);
        input.target = [if choice == HPF_GOAL { 0.2 } else { 0.1 }; HPF_AXES_MAX];
        input.measured_force = [force; HPF_AXES_MAX];
        let position = if tick == 2000 {
            Some([f64::NAN; D])
        } else {
            port.then(|| ours.output().axes.each_ref().map(|axis| axis.position))
        };
        input.has_position = u32::from(position.is_some());
        for (to, from) in input.measured_position.iter_mut().zip(position.into_iter().flatten()) {
            *to = from;
        }
        // SAFETY: all outlive the call.
        assert_eq!(unsafe { hpf_f64_update(handle, &input, dt, &mut output) }, HPF_OK);
        let expected = ours.update(
            &hpf_core::controller::Input {
                measured_force: [force; D],
                force_age: input.force_age,
                measured_position: position,
                rate: 0.9,
                request,
            },
            dt,
        );
        let bits = |numbers: [f64; 6]| numbers.map(f64::to_bits);
        for (found, wanted) in output.axis.iter().zip(&expected.axes) {
            assert_eq!(
                bits([found.position, found.velocity, found.stiffness, found.damping, found.offset, found.force]),
                bits([wanted.position, wanted.velocity, wanted.stiffness, wanted.damping, wanted.offset, wanted.force]),
            );
            let hits = [
                (wanted.hits.force, HPF_HIT_FORCE),
                (wanted.hits.offset, HPF_HIT_OFFSET),
                (wanted.hits.velocity, HPF_HIT_VELOCITY),
                (wanted.hits.acceleration, HPF_HIT_ACCELERATION),
                (wanted.hits.position, HPF_HIT_POSITION),
            ];
            assert!(hits.into_iter().all(|(hit, flag)| hit == (found.hits & flag != 0)));
        }
        assert_eq!([output.phase, output.rate, output.energy], [expected.phase, expected.rate, expected.energy]);
        assert_eq!(output.port_energy, expected.port_energy);
        assert!(port || output.port_energy == 0.0);
        assert_eq!(output.mode, expected.mode as u32);
        let status = expected.status;
        let flags = [
            (status.ended, HPF_ENDED),
            (status.bad_time, HPF_BAD_TIME),
            (status.long_time, HPF_LONG_TIME),
            (status.bad_force, HPF_BAD_FORCE),
            (status.force_lost, HPF_FORCE_LOST),
            (status.bad_input, HPF_BAD_INPUT),
            (status.refused, HPF_REFUSED),
            (status.force_tripped, HPF_FORCE_TRIPPED),
            (status.tracking_tripped, HPF_TRACKING_TRIPPED),
            (status.energy_short, HPF_ENERGY_SHORT),
            (status.position_lost, HPF_POSITION_LOST),
            (status.rate_lost, HPF_RATE_LOST),
            (status.time_lost, HPF_TIME_LOST),
            (status.tare_ready, HPF_TARE_READY),
        ];
        assert!(flags.into_iter().all(|(set, flag)| set == (output.flags & flag != 0)), "tick {tick}");
    }
    let mut bias = [f64::NAN; HPF_AXES_MAX];
    // SAFETY: both outlive the call.
    assert_eq!(unsafe { hpf_f64_bias(handle, bias.as_mut_ptr()) }, HPF_OK);
    assert!(bias.iter().enumerate().all(|(i, &bias)| if i < D { bias == 8.0 } else { bias.is_nan() }), "{bias:?}");
    let mut counters: Counters = prepared();
    // SAFETY: both outlive the call.
    assert_eq!(unsafe { hpf_f64_counters(handle, &mut counters) }, HPF_OK);
    let wanted = ours.counters();
    assert_eq!(
        [counters.bad_time, counters.bad_force, counters.bad_input, counters.refused, counters.trips, counters.faults],
        [wanted.bad_time, wanted.bad_force, wanted.bad_input, wanted.refused, wanted.trips, wanted.faults],
    );
    assert_eq!([counters.bad_time, counters.bad_force, counters.bad_input, counters.refused], [1, 2, 1, 1]);
}

#[test]
fn c_moves_as_rust_does_bit_for_bit() {
    same_over_a_movement::<1>(HPF_BASIS_PHASE, HPF_LISTS_COPIED);
    same_over_a_movement::<2>(HPF_BASIS_TIME, HPF_LISTS_COPIED);
    same_over_a_movement::<2>(HPF_BASIS_STORED, HPF_LISTS_COPIED);
    same_over_a_movement::<3>(HPF_BASIS_STORED, HPF_LISTS_BORROWED);
    same_over_a_movement::<7>(HPF_BASIS_TIME, HPF_LISTS_BORROWED);
}

#[test]
fn a_skill_that_cannot_be_is_refused_with_a_reason() {
    type Spoil = fn(&mut Caller);
    let cases: [(Spoil, i32, &str); 21] = [
        (|c| c.policy.struct_size -= 8, HPF_WRONG_SIZE, "struct_size is not that of the library"),
        (|c| c.settings.struct_size += 8, HPF_WRONG_SIZE, "struct_size is not that of the library"),
        (|c| c.policy.abi_version = 1, HPF_WRONG_VERSION, "abi_version is not that of the library"),
        (|c| c.settings.abi_version = 0, HPF_WRONG_VERSION, "abi_version is not that of the library"),
        (|c| c.policy.axes = 0, HPF_WRONG_AXES, "the number of axes is not that of the instance"),
        (|c| c.policy.axes = 8, HPF_WRONG_AXES, "the number of axes is not that of the instance"),
        (|c| c.policy.damping_basis.count = 65, HPF_WRONG_BASES, "a basis has too few or too many functions"),
        (|c| c.policy.movement_basis.count = 1, HPF_WRONG_BASES, "a basis has too few or too many functions"),
        (|c| c.policy.movement_basis.family = 3, HPF_UNKNOWN_CHOICE, "a choice is none of its constants"),
        (|c| c.settings.axis[1].compliance = 3, HPF_UNKNOWN_CHOICE, "a choice is none of its constants"),
        (|c| c.policy.axis[1].damping_weights = null(), HPF_NULL_POINTER, "a pointer is null"),
        (
            |c| c.policy.axis[0].movement_weights = c.policy.axis[0].movement_weights.wrapping_byte_add(1),
            HPF_MISALIGNED,
            "a pointer is not aligned",
        ),
        (|c| c.policy.duration = f64::NAN, HPF_NOT_FINITE, "duration is not a finite number"),
        (|c| c.lists[1][1][3] = f64::NAN, HPF_NOT_FINITE, "weights is not a finite number"),
        (|c| c.settings.hold = -1.0, HPF_OUT_OF_RANGE, "timing.hold lies outside its bounds"),
        (|c| c.policy.axis[0].mass = -1.0, HPF_NOT_POSITIVE, "mass must be positive"),
        (|c| c.policy.axis[0].damping_floor = 0.0, HPF_NOT_POSITIVE, "damping.floor must be positive"),
        (|c| c.policy.axis[0].damping_ratio = 0.0, HPF_OUT_OF_RANGE, "damping.floor lies outside its bounds"),
        (|c| c.policy.axis[1].damping_ratio = 1.0, HPF_OUT_OF_RANGE, "damping.ratio lies outside its bounds"),
        (
            |c| c.settings.axis[1].limits.position_min = 0.7,
            HPF_MIN_ABOVE_MAX,
            "limits.position has its lower bound above its upper bound",
        ),
        (|c| c.position[0] = 0.7, HPF_OUT_OF_RANGE, "position lies outside its bounds"),
    ];
    for (spoil, status, reason) in cases {
        let mut caller = Caller::new(2, HPF_BASIS_TIME, HPF_LISTS_COPIED);
        spoil(&mut caller);
        assert_eq!((caller.create(), caller.reason()), (Err(status), reason));
    }
    let mut caller = Caller::new(2, HPF_BASIS_STORED, HPF_LISTS_COPIED);
    caller.centers[4] = 1.0;
    assert_eq!(
        (caller.create(), caller.reason()),
        (Err(HPF_NOT_DECREASING), "centers must fall from each entry to the next")
    );
    let mut caller = Caller::new(2, HPF_BASIS_TIME, HPF_LISTS_COPIED);
    let bytes = caller.bytes();
    assert_eq!(caller.create_in(bytes - 1), Err(HPF_TOO_SMALL));
    assert!(caller.create_in(bytes).is_ok());
    caller.position[1] = 0.8;
    assert_eq!(caller.create(), Err(HPF_OUT_OF_RANGE));
    assert_eq!([caller.error.value, caller.error.min, caller.error.max], [0.8, -0.5, 0.6]);
}

#[test]
fn a_call_that_cannot_be_is_refused_and_changes_nothing() {
    let mut caller = Caller::new(2, HPF_BASIS_PHASE, HPF_LISTS_COPIED);
    let handle = caller.create().unwrap();
    let mut input: Input<f64> = prepared();
    let mut output: Output<f64> = prepared();
    let mut bytes = 0;
    // SAFETY: what is not null is there and outlives the calls, but for one instance of the other scalar, which is
    // looked at no further than its mark.
    unsafe {
        let update = |handle, input, output| hpf_f64_update(handle, input, 1e-3, output);
        assert_eq!(update(handle, &input, &mut output), HPF_OK);
        let phase = output.phase;
        input.request = HPF_START;
        assert_eq!(update(null_mut(), &input, &mut output), HPF_NULL_POINTER);
        assert_eq!(update(handle, null(), &mut output), HPF_NULL_POINTER);
        assert_eq!(update(handle, &input, null_mut()), HPF_NULL_POINTER);
        assert_eq!(update(handle.wrapping_byte_add(4), &input, &mut output), HPF_MISALIGNED);
        let mut other = [0_u64; 4096];
        assert_eq!(update(other.as_mut_ptr().cast(), &input, &mut output), HPF_NO_CONTROLLER);
        other.copy_from_slice(&caller.memory);
        assert_eq!(update(other.as_mut_ptr().cast(), &input, &mut output), HPF_NO_CONTROLLER);
        input.struct_size = 0;
        assert_eq!(update(handle, &input, &mut output), HPF_WRONG_SIZE);
        input = prepared();
        input.request = 8;
        assert_eq!(update(handle, &input, &mut output), HPF_UNKNOWN_CHOICE);
        output.abi_version = 7;
        assert_eq!(hpf_f64_output(handle, &mut output), HPF_WRONG_VERSION);
        output.abi_version = HPF_ABI_VERSION;
        assert_eq!(hpf_f64_output(handle, &mut output), HPF_OK);
        assert_eq!((output.phase, output.mode, output.flags), (phase, HPF_MODE_IDLE, 0));
        assert_eq!(hpf_f64_counters(handle, null_mut()), HPF_NULL_POINTER);
        assert_eq!(hpf_f64_bias(handle, null_mut()), HPF_NULL_POINTER);
        assert_eq!(hpf_f64_set(handle, null(), null_mut()), HPF_NULL_POINTER);
        assert_eq!(hpf_f64_compliant(&mut caller.settings, 8, null()), HPF_WRONG_AXES);
        assert_eq!(hpf_f64_size(null(), &caller.policy, &mut bytes), HPF_NULL_POINTER);
        assert_eq!(hpf_f64_size(hpf_f32_axes_2().cast(), &caller.policy, &mut bytes), HPF_NO_CONTROLLER);
        assert_eq!(hpf_f64_size(hpf_f64_axes_3(), &caller.policy, &mut bytes), HPF_WRONG_AXES);
        assert!(hpf_f64_instance(0).is_null() && hpf_f64_instance(8).is_null());

        caller.settings.ramp = f64::NAN;
        assert_eq!(hpf_f64_set(handle, &caller.settings, &mut caller.error), HPF_NOT_FINITE);
        assert_eq!(caller.reason(), "timing.ramp is not a finite number");
        caller.settings.ramp = 0.5;
        assert_eq!(hpf_f64_set(handle, &caller.settings, &mut caller.error), HPF_OK);
        assert_eq!((caller.error.status, caller.reason()), (HPF_OK, ""));
        assert_eq!(hpf_f64_set(handle, &caller.settings, null_mut()), HPF_OK);
        assert_eq!(CStr::from_ptr(hpf_status_text(-1)), c"unknown status");
    }
    assert_eq!(offset_of!(Input<f64>, abi_version), 4);
}

/// What a controller needs with lists of the caller's in flash, and with copies of its own [bytes].
macro_rules! needs {
    ($scalar:ty, $instance:path, $size:path, $axes:expr) => {
        [(HPF_LISTS_BORROWED, HPF_BASIS_STORED), (HPF_LISTS_COPIED, HPF_BASIS_TIME)].map(|(lists, family)| {
            let mut policy: Policy<$scalar> = prepared();
            (policy.axes, policy.lists) = ($axes, lists);
            (policy.movement_basis.family, policy.movement_basis.count) = (family, 20);
            (policy.stiffness_basis, policy.damping_basis) = (policy.movement_basis, policy.movement_basis);
            let mut bytes = 0;
            // SAFETY: both outlive the call, which looks at no list.
            assert_eq!(unsafe { $size($instance($axes), &policy, &mut bytes) }, HPF_OK);
            bytes
        })
    };
}

#[test]
fn the_page_has_the_memory_that_a_controller_needs() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/embedding.md");
    let page = std::fs::read_to_string(page).unwrap();
    let mut rows = Vec::new();
    for axes in [1, 2, 6, 7] {
        let [flash, copied] = needs!(f32, hpf_c::f32::hpf_f32_instance, hpf_c::f32::hpf_f32_size, axes);
        rows.push(format!("| float, {axes} | {flash} | {copied} |"));
        let [flash, copied] = needs!(f64, hpf_f64_instance, hpf_f64_size, axes);
        rows.push(format!("| double, {axes} | {flash} | {copied} |"));
    }
    println!("{}", rows.join("\n"));
    for row in rows {
        assert!(page.contains(&row), "{row} is not in docs/embedding.md");
    }
}
