//! A 1 kHz loop in six axes: position and orientation follow one skill, the tool gives way with a stiffness that has
//! directions, and the sensor feels the tool's weight, which turns with it.

use hpf_core::admittance::step_coupled;
use hpf_core::orientation::{Chart, Commanded, angular_velocity, commanded, offset_rate, step_rotation_coupled};
use hpf_core::rotation::Quaternion;
use hpf_core::wrench::{ToolLoad, Wrench, WrenchSensor};
use hpf_core::{AxisPrimitives, Basis, ConfigError, Gain, HybridPrimitive, Law, Movement, Phase, Symmetric};

const DOWN: [f64; 3] = [0.0, 0.0, -9.81];

fn main() -> Result<(), ConfigError> {
    // 0.3 m along x, while the tool turns by 2 rad about an axis that is none of the base's.
    let chart = Chart::new(Quaternion::rpy([0.0, 0.4, 0.0])?);
    let [rx, ry, rz] = chart.coordinates(&(Quaternion::about([1.0, 1.0, 0.5], 2.0)? * chart.goal()));
    let phase = Phase::new(2.0, 100.0_f64.ln())?;
    let basis = Basis::equally_spaced(phase.decay(), 0.6, [0.0; 5], [0.0; 5])?;
    let axis = |start, goal| {
        let gain = Gain::new(1.0, 100.0, [10.0; 5])?; // not used: the loop has its own stiffness
        let movement = Movement::new(start, goal, 25.0, 1.0, [0.0; 5])?;
        Ok::<_, ConfigError>(AxisPrimitives { movement, stiffness: gain, damping: gain, law: Law::FirstOrder })
    };
    let still = axis(0.0, 0.0)?;
    let axes = [axis(0.0, 0.3)?, still, still, axis(rx, 0.0)?, axis(ry, 0.0)?, axis(rz, 0.0)?];
    let skill = HybridPrimitive::new(phase, [basis; 3], axes)?;

    let sensor = WrenchSensor { load: ToolLoad::new(0.8, [0.0, 0.0, 0.06])?, bias: Wrench::NONE };
    let stiffness = Symmetric::diagonal([400.0, 60.0, 60.0]); // in the tool's frame: stiff along its x
    let (damping, turning, turning_damping) = (50.0, Symmetric::isotropic(5.0), Symmetric::isotropic(1.0));
    let (mut state, mut offset, mut turned) = (skill.initial_state(), [0.0; 3], [0.0; 3]);
    let mut tool = chart.orientation([rx, ry, rz]);
    println!("  t [s]  x, y, z [mm]               off [mm]  off [deg]  to go [deg]");
    for tick in 1..=3000_u32 {
        // Read the sensor: the weight in its frame, and a push of 6 N downwards from 1 s on.
        let push = Wrench { force: [0.0, 0.0, if tick > 1000 { -6.0 } else { 0.0 }], torque: [0.1, 0.0, 0.0] };
        let weight = sensor.load.weight(&tool, DOWN);
        let reading = weight.without(&Wrench::NONE.without(&push.turned_back(&tool)));
        let felt = sensor.compensated(&reading, &tool, DOWN).turned(&tool);

        let [x, y, z, r @ ..] = skill.step(&mut state, [0.0; 6], 1.0, 1e-3);
        let (r, rate) = (r.map(|axis| axis.position), r.map(|axis| axis.velocity));
        let reference = Commanded { orientation: chart.orientation(r), velocity: angular_velocity(r, rate) };
        let directed = stiffness.turned(&reference.orientation);
        offset = step_coupled(offset, &directed, &Symmetric::isotropic(damping), felt.force, 1e-3);
        turned = step_rotation_coupled(turned, &turning, &turning_damping, felt.torque, 1e-3).offset;
        let command = commanded(turned, offset_rate(turned, &turning, &turning_damping, felt.torque), &reference);

        // Send position and orientation to the robot; consecutive quaternions do not jump.
        tool = command.orientation.near(&tool);
        if tick % 500 == 0 {
            let [x, y, z] = [x.position + offset[0], y.position + offset[1], z.position + offset[2]].map(|p| 1e3 * p);
            let off = 1e3 * hpf_core::rotation::length(offset);
            let [bent, left] = [reference.orientation, chart.goal()].map(|other| tool.distance(&other).to_degrees());
            let t = f64::from(tick) * 1e-3;
            println!("{t:7.2}  {x:7.1} {y:7.1} {z:7.1}  {off:15.1} {bent:10.2} {left:12.2}");
        }
    }
    Ok(())
}
