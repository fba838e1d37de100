//! One movement of a policy in flash: what the host and the microcontroller both compute, to the bit.

#![no_std]

use hpf_core::controller::{AxisOutput, Controller, Input, Request, Settings};
use hpf_core::limits::Limits;
use hpf_core::passivity::EnergyTank;
use hpf_core::{AxisPrimitives, Basis, ConfigError, Gain, HybridPrimitive, Movement, Phase, Real};

/// Functions of each basis.
pub const N: usize = 20;
/// Axes.
pub const D: usize = 2;
/// Updates of one movement: two seconds at 1 kHz, and half a second at the goal.
pub const UPDATES: u32 = 2500;
/// Updates in double precision, which a single-precision unit has to emulate.
pub const DOUBLE_UPDATES: u32 = 500;

const DECAY: f64 = 4.605_17;
const GOAL: [f64; D] = [0.30, -0.15];

/// The policy, in flash.
static MOVEMENT: [[f32; N]; D] = [
    [-40., -30., -20., -5., 10., 25., 35., 45., 55., 60., 55., 50., 40., 30., 20., 10., 5., 0., 0., 0.],
    [10., 0., -10., -20., -30., -30., -20., -10., 0., 10., 20., 25., 20., 15., 10., 5., 5., 0., 0., 0.],
];
static STIFFNESS: [[f32; N]; D] = [
    [60., 60., 65., 70., 80., 90., 100., 120., 140., 160., 180., 200., 220., 240., 260., 280., 290., 300., 300., 300.],
    [
        300., 300., 290., 280., 260., 240., 220., 200., 190., 180., 170., 160., 155., 150., 150., 150., 150., 150.,
        150., 150.,
    ],
];
static DAMPING: [[f32; N]; D] =
    [[20., 20., 21., 22., 24., 26., 28., 30., 33., 36., 40., 43., 46., 50., 53., 56., 58., 60., 60., 60.], [50.; N]];

/// The two families of basis functions.
#[derive(Clone, Copy, Debug)]
pub enum Family {
    /// Gaussians of the phase.
    Phase,
    /// Gaussians of time.
    Time,
}

/// A controller with the policy's weights in flash, limits, filter, dead zone and tank on.
pub type Arm = Controller<f32, &'static [f32; N], D>;

/// The same in double precision, its lists in place.
pub type DoubleArm = Controller<f64, [f64; N], D>;

/// Room for the lists of a basis, which the caller owns.
pub type Room = [[f32; N]; 2];

/// Fills `room` with a basis and builds the controller on it.
///
/// # Errors
/// None for this policy.
pub fn arm(family: Family, room: &'static mut Room) -> Result<Arm, ConfigError> {
    let filled = basis(family)?;
    let [centers, shape] = room;
    centers.copy_from_slice(filled.centers());
    shape.copy_from_slice(filled.widths());
    controller(filled.stored(&*centers, &*shape)?, MOVEMENT.each_ref(), STIFFNESS.each_ref(), DAMPING.each_ref())
}

/// Builds the controller in double precision.
///
/// # Errors
/// None for this policy.
pub fn double_arm(family: Family) -> Result<DoubleArm, ConfigError> {
    let double = |lists: &[[f32; N]; D]| lists.map(|list| list.map(f64::from));
    controller(basis(family)?, double(&MOVEMENT), double(&STIFFNESS), double(&DAMPING))
}

fn basis<T: Real>(family: Family) -> Result<Basis<T, [T; N]>, ConfigError> {
    let (decay, overlap, room) = (T::of(DECAY), T::of(0.6), [T::ZERO; N]);
    match family {
        Family::Phase => Basis::equally_spaced(decay, overlap, room, room),
        Family::Time => Basis::equally_spaced_in_time(decay, overlap, room, room),
    }
}

fn controller<T: Real + PartialOrd, S: AsRef<[T]> + Copy>(
    basis: Basis<T, S>,
    [mx, my]: [S; D],
    [kx, ky]: [S; D],
    [dx, dy]: [S; D],
) -> Result<Controller<T, S, D>, ConfigError> {
    let axis = |goal, movement, stiffness, damping| {
        let goal = T::of(goal);
        Ok::<_, ConfigError>(AxisPrimitives {
            movement: Movement::new(T::ZERO, goal, T::of(25.0), goal, movement)?,
            stiffness: Gain::new(T::of(30.0), T::of(400.0), stiffness)?,
            damping: Gain::new(T::of(10.0), T::of(100.0), damping)?,
        })
    };
    let [gx, gy] = GOAL;
    let axes = [axis(gx, mx, kx, dx)?, axis(gy, my, ky, dy)?];
    let skill = HybridPrimitive::new(Phase::new(T::of(2.0), T::of(DECAY))?, [basis; 3], axes)?;
    let limits = Limits {
        force: T::of(50.0),
        offset: T::of(0.2),
        velocity: T::ONE,
        acceleration: T::of(20.0),
        position: [T::of(-0.5), T::of(0.5)],
    };
    let mut settings = Settings::compliant([limits; D]);
    settings.conditioning.cutoff = Some(T::of(100.0));
    settings.conditioning.dead_zone = [T::of(0.5); D];
    settings.tank = Some(EnergyTank::new(T::of(2.0), T::ZERO, T::of(0.9), T::of(100.0))?);
    Controller::new(skill, settings, [T::ZERO; D])
}

/// One step of the loop at 1 kHz [s].
pub fn dt<T: Real>() -> T {
    T::of(1e-3)
}

/// The input of update `tick`: a push to and fro, a broken reading every 97 updates.
pub fn input<T: Real>(tick: u32) -> Input<T, D> {
    // A triangle, so that no library function shapes the input.
    let ramp = (tick % 400) as f32 * 0.05;
    let push = if ramp < 10.0 { ramp } else { 20.0 - ramp };
    let push = if tick % 97 == 96 { T::of(f64::NAN) } else { T::of(f64::from(push)) };
    let request = (tick == 0).then_some(Request::Start);
    Input { measured_force: [push, -push], force_age: 0, measured_position: None, rate: T::ONE, request }
}

/// FNV-1a over the bits of every command.
#[derive(Clone, Copy, Debug)]
pub struct Fingerprint(pub u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fingerprint {
    /// Adds the command of one axis.
    pub fn add<T: Real>(&mut self, command: &AxisOutput<T>) {
        for value in [command.position, command.velocity, command.stiffness, command.damping] {
            for byte in value.to_f64().to_bits().to_le_bytes() {
                self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
    }

    /// That of the commands of updates 0 to `updates` of `arm`.
    pub fn of<T: Real + PartialOrd, S: AsRef<[T]>>(arm: &mut Controller<T, S, D>, updates: u32) -> Self {
        let mut print = Self::default();
        for tick in 0..updates {
            for axis in &arm.update(&input(tick), dt()).axes {
                print.add(axis);
            }
        }
        print
    }
}

/// What a movement of each family must come to, on every machine: the failing test below prints it.
pub const GOLDEN: [(Family, u64); 2] = [(Family::Phase, 0x6dbc_bbea_74cf_2396), (Family::Time, 0x4127_dccd_393f_caf9)];

/// The same in double precision, the first [`DOUBLE_UPDATES`] updates.
pub const DOUBLE_GOLDEN: [(Family, u64); 2] =
    [(Family::Phase, 0x87f9_dfa4_131a_fc2f), (Family::Time, 0x0441_67c0_38ca_efce)];

#[cfg(test)]
mod tests {
    extern crate std;
    use std::boxed::Box;

    use super::*;

    #[test]
    fn the_host_computes_the_golden_bits() {
        for (family, golden) in GOLDEN {
            let mut arm = arm(family, Box::leak(Box::default())).unwrap();
            let print = Fingerprint::of(&mut arm, UPDATES);
            assert_eq!(print.0, golden, "{family:?}: {:#018x}", print.0);
        }
    }

    #[test]
    fn the_host_computes_the_golden_bits_in_double_precision() {
        for (family, golden) in DOUBLE_GOLDEN {
            let print = Fingerprint::of(&mut double_arm(family).unwrap(), DOUBLE_UPDATES);
            assert_eq!(print.0, golden, "{family:?}: {:#018x}", print.0);
        }
    }
}
