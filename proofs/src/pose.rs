//! Orientation, stiffness with directions and rhythm: built and stepped in one function.

use hpf_core::admittance::{CoupledInertia, CoupledMotion};
use hpf_core::frame::PathFrame;
use hpf_core::orientation::{
    Chart, Commanded, angular_velocity, commanded, forcing_scale, offset_rate, reference_power, step_rotation,
    step_rotation_coupled, within_cone,
};
use hpf_core::passivity::EnergyTank;
use hpf_core::rhythm::{PeriodicBasis, Rhythm, RhythmicMovement, Turn};
use hpf_core::rotation::{Quaternion, Wxyz};
use hpf_core::wrench::{ToolLoad, Wrench, WrenchSensor};
use hpf_core::{Basis, ConfigError, MatrixGain, Movement, Real, Symmetric};

/// Functions of each basis.
const N: usize = 5;
/// Numbers that go in: an orientation, an offset, a torque and a velocity.
pub const IN: usize = 13;
/// Numbers that come out: an orientation, an angular velocity and a position.
pub const OUT: usize = 8;

/// A step of `dt` of everything there is; writes the commanded orientation w, x, y, z, angular velocity, and the rhythm's position.
pub fn pose<T: Real + PartialOrd>(input: &[T; IN], dt: T, out: &mut [T; OUT]) -> Result<(), ConfigError> {
    let [w, x, y, z, offset @ .., tx, ty, tz, vx, vy, vz] = *input;
    let (torque, velocity) = ([tx, ty, tz], [vx, vy, vz]);
    let goal = Quaternion::new(Wxyz { w, x, y, z })?;
    let chart = Chart::new(goal);
    let mut frame = PathFrame::new(T::of(1e-3))?;
    let path = frame.follow(velocity);

    let mut sensor = WrenchSensor { load: ToolLoad::new(T::ONE, velocity)?, bias: Wrench::NONE };
    let reading = Wrench { force: velocity, torque }.about(offset).turned_back(&goal);
    sensor.tare(&sensor.compensated(&reading, &goal, torque));
    let felt = sensor.compensated(&reading, &path, torque).turned(&path);

    let matrix = Symmetric::diagonal([T::of(30.0), T::of(5.0), T::of(10.0)]).turned(&path).clamped(T::ONE, T::of(30.0));
    let lists = matrix.numbers().map(|number| [number; N]);
    let gain = MatrixGain::new(T::ONE, T::of(30.0), lists)?;
    let basis = Basis::equally_spaced(T::of(4.6), T::of(0.6), [T::ZERO; N], [T::ZERO; N])?;
    let tank = EnergyTank::new(T::ONE, T::ZERO, T::ONE, T::of(100.0))?;
    let mut energy = tank.full();
    let wanted = gain.at(&basis, T::of(0.5));
    let stiffness = tank.stiffness_matrix(&mut energy, &Symmetric::isotropic(T::of(5.0)), &wanted, offset, dt);
    let damping = Symmetric::isotropic(T::of(2.0));

    let inertia = CoupledInertia::new(T::ONE, T::ONE, T::ONE, T::of(30.0), T::of(0.01))?;
    let mut motion = CoupledMotion { offset, velocity };
    inertia.step(&mut motion, &stiffness, felt.force, dt);
    let axes = step_rotation(motion.offset, [T::ONE; 3], [T::ONE; 3], torque, dt).offset;
    let step = step_rotation_coupled(offset, &stiffness, &damping, torque, dt);
    tank.book(&mut energy, step.work(offset, torque).safe());
    let capped = within_cone(step.offset, T::of(2.0) + forcing_scale(axes) * dt);
    let rate = offset_rate(capped, &stiffness, &damping, torque);
    let (r, r_rate) = chart.rechart(&Chart::new(path), chart.coordinates(&path), velocity);
    let reference = Commanded { orientation: chart.orientation(r).near(&goal), velocity: angular_velocity(r, r_rate) };
    let command = commanded(capped, rate, &reference);

    let periodic = PeriodicBasis::new(T::of(0.6), [T::ZERO; N], [T::ZERO; N])?;
    let movement = Movement::new(T::ZERO, T::ONE, T::of(25.0), T::ONE, [tx, ty, tz, vx, vy])?;
    let rhythm = RhythmicMovement::new(Rhythm::new(T::of(1.5))?, periodic, movement)?;
    let (mut turn, mut state) = (Turn::START, rhythm.limit_cycle(100));
    rhythm.step(&mut turn, &mut state, reference_power(capped, torque, velocity), dt + energy.level());

    let Wxyz { w, x, y, z } = command.orientation.numbers();
    let [wx, wy, wz] = command.velocity;
    *out = [w, x, y, z, wx, wy, wz, state.position];
    #[cfg(feature = "negative-panic-pose")]
    {
        out[dt.to_f64() as usize] = T::ZERO; // out of bounds from 8 s on
    }
    Ok(())
}
