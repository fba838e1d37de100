//! What crosses the border: plain structs of C, each with its size and version first.

use core::ffi::c_char;

use hpf_core::Real;

/// Version of this interface; every struct carries it.
pub const HPF_ABI_VERSION: u32 = 2;
/// Most axes of a controller.
pub const HPF_AXES_MAX: usize = 7;
/// Most functions of a basis.
pub const HPF_BASES_MAX: usize = 64;

/// Family of a basis: Gaussians of the phase, centers equally spaced in time.
pub const HPF_BASIS_PHASE: u32 = 0;
/// Family of a basis: Gaussians of time, one exponential per step.
pub const HPF_BASIS_TIME: u32 = 1;
/// Family of a basis: Gaussians of the phase with the given centers and widths, as a policy file has them.
pub const HPF_BASIS_STORED: u32 = 2;

/// Storage of lists: copied into the controller's memory; the caller's may go.
pub const HPF_LISTS_COPIED: u32 = 0;
/// Storage of lists: used where they are, in flash; they must stay there, unchanged, as long as the controller is used.
pub const HPF_LISTS_BORROWED: u32 = 1;

/// Compliance of an axis: gives way by the admittance.
pub const HPF_COMPLIANT: u32 = 0;
/// Compliance of an axis: follows the reference, force is watched for its trip level only.
pub const HPF_RIGID: u32 = 1;
/// Compliance of an axis: gives way, and presses on the environment with `press`.
pub const HPF_PRESS: u32 = 2;

/// Request: none.
pub const HPF_NO_REQUEST: u32 = 0;
/// Request: start the movement from where the command is.
pub const HPF_START: u32 = 1;
/// Request: pause on the path.
pub const HPF_HOLD: u32 = 2;
/// Request: go on along the path.
pub const HPF_RESUME: u32 = 3;
/// Request: stop on the path for good.
pub const HPF_STOP: u32 = 4;
/// Request: go to another goal, `target`.
pub const HPF_GOAL: u32 = 5;
/// Request: call the present force zero; without contact, in Idle, once HPF_TARE_READY is set; refused before.
pub const HPF_TARE: u32 = 6;
/// Request: back to Idle at the measured position, `target`, of a robot at rest.
pub const HPF_RESET: u32 = 7;

/// Mode: stands still where it was put, waiting for a start.
pub const HPF_MODE_IDLE: u32 = 0;
/// Mode: follows the skill; at the goal, holds it compliantly.
pub const HPF_MODE_RUN: u32 = 1;
/// Mode: pauses on the path, compliant; resumable.
pub const HPF_MODE_HOLD: u32 = 2;
/// Mode: stopped for good, still compliant where it has moved before; latched until reset.
pub const HPF_MODE_STOP: u32 = 3;
/// Mode: stopped and rigid, because an input is lost; latched until reset.
pub const HPF_MODE_FAULT: u32 = 4;

/// Flag of an output: the movement has ended; set once.
pub const HPF_ENDED: u32 = 1;
/// Flag of an output: dt was not finite or below 1 us, the command stands still.
pub const HPF_BAD_TIME: u32 = 2;
/// Flag of an output: dt was longer than allowed and was cut.
pub const HPF_LONG_TIME: u32 = 4;
/// Flag of an output: the force of an axis was not finite, or all of it too old; the last good one stands in.
pub const HPF_BAD_FORCE: u32 = 8;
/// Flag of an output: a force has been bad for longer than its limit; offsets are frozen, the path stops.
pub const HPF_FORCE_LOST: u32 = 16;
/// Flag of an output: rate or measured position was not finite and was not used.
pub const HPF_BAD_INPUT: u32 = 32;
/// Flag of an output: the request was refused.
pub const HPF_REFUSED: u32 = 64;
/// Flag of an output: a force was above its trip level.
pub const HPF_FORCE_TRIPPED: u32 = 128;
/// Flag of an output: the robot was further from the command than allowed.
pub const HPF_TRACKING_TRIPPED: u32 = 256;
/// Flag of an output: the tank has held back stiffness, motion along the path or a force set-point, or the port a
/// motion.
pub const HPF_ENERGY_SHORT: u32 = 512;
/// Flag of an output: a measured position has been bad for longer than its limit; the path stops.
pub const HPF_POSITION_LOST: u32 = 1024;
/// Flag of an output: the rate has been bad for longer than its limit; the path stops.
pub const HPF_RATE_LOST: u32 = 2048;
/// Flag of an output: dt has been bad or long for more steps than its limit; the path stops.
pub const HPF_TIME_LOST: u32 = 4096;
/// Flag of an output, in Idle: the force has stood still long enough for HPF_TARE.
pub const HPF_TARE_READY: u32 = 8192;

/// Limit that has cut a command: the force into the model.
pub const HPF_HIT_FORCE: u32 = 1;
/// Limit that has cut a command: the offset from the reference.
pub const HPF_HIT_OFFSET: u32 = 2;
/// Limit that has cut a command: the velocity.
pub const HPF_HIT_VELOCITY: u32 = 4;
/// Limit that has cut a command: the acceleration.
pub const HPF_HIT_ACCELERATION: u32 = 8;
/// Limit that has cut a command: the workspace.
pub const HPF_HIT_POSITION: u32 = 16;

/// A basis of 2 to HPF_BASES_MAX functions.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BasisPolicy<T> {
    /// HPF_BASIS_...
    pub family: u32,
    /// Number of functions.
    pub count: u32,
    /// Height at which neighbours meet, in (0, 1); not used by HPF_BASIS_STORED.
    pub overlap: T,
    /// HPF_BASIS_STORED: centers, oldest phase first.
    pub centers: *const T,
    /// HPF_BASIS_STORED: widths.
    pub widths: *const T,
}

/// The primitives of one axis and its law; lists have one weight per function of their basis, oldest phase first.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AxisPolicy<T> {
    /// Where the movement starts [axis unit].
    pub start: T,
    /// Where it ends [axis unit].
    pub goal: T,
    /// Spring factor.
    pub alpha: T,
    /// Scale of the forcing term [axis unit].
    pub forcing_scale: T,
    /// Weights of the movement.
    pub movement_weights: *const T,
    /// Smallest stiffness [N/m].
    pub stiffness_min: T,
    /// Largest stiffness [N/m].
    pub stiffness_max: T,
    /// Weights of the stiffness [N/m].
    pub stiffness_weights: *const T,
    /// Smallest damping [N s/m].
    pub damping_min: T,
    /// Largest damping [N s/m].
    pub damping_max: T,
    /// Weights of the damping [N s/m].
    pub damping_weights: *const T,
    /// Virtual mass m of the second-order law m e'' + d e' + k e = f [kg]; 0: first order, d e' + k e = f.
    pub mass: T,
    /// Second order only: d = max(2 damping_ratio sqrt(m k), damping_floor), 1 is critical; 0: d is the damping above.
    pub damping_ratio: T,
    /// Least damping [N s/m] where there is a damping ratio, else 0.
    pub damping_floor: T,
}

/// A skill: the numbers of a policy file.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Policy<T> {
    /// Size of this struct.
    pub struct_size: u32,
    /// HPF_ABI_VERSION.
    pub abi_version: u32,
    /// Number of axes, that of the instance.
    pub axes: u32,
    /// HPF_LISTS_...
    pub lists: u32,
    /// Duration of the movement [s].
    pub duration: T,
    /// The phase falls to exp(-decay) over the duration.
    pub decay: T,
    /// Basis of every movement.
    pub movement_basis: BasisPolicy<T>,
    /// Basis of every stiffness.
    pub stiffness_basis: BasisPolicy<T>,
    /// Basis of every damping.
    pub damping_basis: BasisPolicy<T>,
    /// The first `axes` are used.
    pub axis: [AxisPolicy<T>; HPF_AXES_MAX],
}

/// Limits of one axis, applied last.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Limits<T> {
    /// Largest force that enters the model [N].
    pub force: T,
    /// Largest offset from the reference [axis unit].
    pub offset: T,
    /// Largest commanded velocity [axis unit/s].
    pub velocity: T,
    /// Largest change of the commanded velocity [axis unit/s^2].
    pub acceleration: T,
    /// Smallest commanded position [axis unit].
    pub position_min: T,
    /// Largest commanded position [axis unit].
    pub position_max: T,
}

/// Settings of one axis.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AxisSettings<T> {
    /// HPF_COMPLIANT, HPF_RIGID or HPF_PRESS.
    pub compliance: u32,
    /// Set to 0.
    pub reserved: u32,
    /// Force on the environment [N]; HPF_PRESS only.
    pub press: T,
    /// What a command never exceeds.
    pub limits: Limits<T>,
    /// Compensated force above which the controller stops [N].
    pub trip_force: T,
    /// Distance between command and robot above which it stops [axis unit].
    pub tracking: T,
}

/// Everything beside the skill.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Settings<T> {
    /// Size of this struct.
    pub struct_size: u32,
    /// HPF_ABI_VERSION.
    pub abi_version: u32,
    /// The first ones, as many as the controller has axes, are used.
    pub axis: [AxisSettings<T>; HPF_AXES_MAX],
    /// Mass that hangs on the sensor [kg].
    pub tool_mass: T,
    /// Gravity along each axis [m/s^2].
    pub gravity: [T; HPF_AXES_MAX],
    /// Half width of the dead zone of each axis [N].
    pub dead_zone: [T; HPF_AXES_MAX],
    /// Cut-off of the force filter [Hz]; 0: no filter.
    pub cutoff: T,
    /// The most the energy tank holds [J]; 0: no tank.
    pub tank_capacity: T,
    /// What switching leaves in it [J].
    pub tank_reserve: T,
    /// Share of dissipated energy that comes back.
    pub tank_refill: T,
    /// The most that switching may put into one axis [W].
    pub tank_power: T,
    /// The most a force reading may be off, after tare, of each axis [N]; used where has_port is not 0.
    pub port_force_bias: [T; HPF_AXES_MAX],
    /// Longest step; a longer dt is cut to it [s]. 1 us to 1 s.
    pub longest_step: T,
    /// Time for the rate to go from 0 to 1 or back under way [s]; a start takes none. At most 10 s.
    pub ramp: T,
    /// How long a bad force, measured position or rate may be bridged [s]. At most 1 s.
    pub hold: T,
    /// Oldest reading that is still good [steps].
    pub oldest_force: u32,
    /// Whether the tank's energy is kept at the physical port too, by measured_position; 0: it is not.
    pub has_port: u32,
    /// How many steps a fresh force reading may be late, 0 to 6; used where has_port is not 0.
    pub port_force_delay: u32,
    /// Set to 0.
    pub reserved: u32,
}

/// One step's input; of each list the first numbers, as many as the controller has axes, are used.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Input<T> {
    /// Size of this struct.
    pub struct_size: u32,
    /// HPF_ABI_VERSION.
    pub abi_version: u32,
    /// Steps since the force was read: 0 is fresh.
    pub force_age: u32,
    /// Whether measured_position is to be watched; 0: it is not known.
    pub has_position: u32,
    /// HPF_START and so on, once; HPF_NO_REQUEST.
    pub request: u32,
    /// Set to 0.
    pub reserved: u32,
    /// Force of the environment ON the tool as the sensor reads it [N].
    pub measured_force: [T; HPF_AXES_MAX],
    /// Position of the robot [axis unit].
    pub measured_position: [T; HPF_AXES_MAX],
    /// Goal of HPF_GOAL, position of HPF_RESET [axis unit].
    pub target: [T; HPF_AXES_MAX],
    /// Rate of time along the path, in [0, 1].
    pub rate: T,
}

/// The command of one axis.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AxisOutput<T> {
    /// Commanded position [axis unit].
    pub position: T,
    /// Commanded velocity: how fast it got there from the last command [axis unit/s].
    pub velocity: T,
    /// Stiffness [N/m].
    pub stiffness: T,
    /// Damping [N s/m].
    pub damping: T,
    /// Offset: commanded minus reference position [axis unit].
    pub offset: T,
    /// Force as the model saw it, conditioned and limited [N].
    pub force: T,
    /// HPF_HIT_..., added.
    pub hits: u32,
    /// Always 0.
    pub reserved: u32,
}

/// One step's output.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Output<T> {
    /// Size of this struct; set it before the call.
    pub struct_size: u32,
    /// HPF_ABI_VERSION; set it before the call.
    pub abi_version: u32,
    /// HPF_MODE_...
    pub mode: u32,
    /// HPF_ENDED and so on, added.
    pub flags: u32,
    /// Phase: 1 at the start, falling.
    pub phase: T,
    /// Rate at which time has run along the path.
    pub rate: T,
    /// Energy in the tank [J]; 0 without one.
    pub energy: T,
    /// Energy at the physical port [J]; 0 without one.
    pub port_energy: T,
    /// The first ones, as many as the controller has axes, are written.
    pub axis: [AxisOutput<T>; HPF_AXES_MAX],
}

/// How often each has happened since the controller was made; they stop at their largest value.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Counters {
    /// Size of this struct; set it before the call.
    pub struct_size: u32,
    /// HPF_ABI_VERSION; set it before the call.
    pub abi_version: u32,
    /// Steps with a dt that was not finite or below 1 us.
    pub bad_time: u32,
    /// Steps with a dt that was too long.
    pub long_time: u32,
    /// Steps with a force that was not finite or too old.
    pub bad_force: u32,
    /// Steps with a rate or a measured position that was not finite.
    pub bad_input: u32,
    /// Requests and settings that the controller has refused.
    pub refused: u32,
    /// Forces above their trip level and robots that did not follow.
    pub trips: u32,
    /// Entries into Fault.
    pub faults: u32,
    /// Always 0.
    pub reserved: u32,
}

/// Why a skill or settings were refused.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Error {
    /// Size of this struct; set it before the call.
    pub struct_size: u32,
    /// HPF_ABI_VERSION; set it before the call.
    pub abi_version: u32,
    /// What the call returned.
    pub status: i32,
    /// Always 0.
    pub reserved: u32,
    /// The value found, where there is one.
    pub value: f64,
    /// The smallest value allowed, where there is one.
    pub min: f64,
    /// The largest value allowed, where there is one.
    pub max: f64,
    /// The parameter and what is wrong with it, ended by 0.
    pub text: [c_char; 128],
}

/// A struct that begins with its size and the version, both `u32`.
///
/// # Safety
/// It does, is `repr(C)`, and any bits are a value of it.
pub(crate) unsafe trait Versioned {}

// SAFETY: each is repr(C), begins with the two, and holds numbers and raw pointers only.
unsafe impl<T: Real> Versioned for Policy<T> {}
// SAFETY: as above.
unsafe impl<T: Real> Versioned for Settings<T> {}
// SAFETY: as above.
unsafe impl<T: Real> Versioned for Input<T> {}
// SAFETY: as above.
unsafe impl<T: Real> Versioned for Output<T> {}
// SAFETY: as above.
unsafe impl Versioned for Counters {}
// SAFETY: as above.
unsafe impl Versioned for Error {}
