//! A 1 kHz loop with a force sensor: a wall at 0.2 m is met, and from 3 s on the sensor is dead.

mod common;

use hpf_core::ConfigError;
use hpf_core::controller::{Input, Request};

fn main() -> Result<(), ConfigError> {
    let mut arm = common::arm()?;
    let mut position = 0.0_f64;
    println!("  t [s]  mode   force [N]  offset [mm]  tool [m]  hits");
    for tick in 0..3500_u32 {
        // Read the sensors: here a wall of 2 kN/m, and a robot that follows.
        let wall = if tick < 3000 { -2000.0 * (position - 0.2).max(0.0) } else { f64::NAN };
        let request = (tick == 0).then_some(Request::Start);
        let input = Input { measured_position: Some([position]), request, ..common::felt(wall) };

        let output = arm.update(&input, 1e-3);
        let [axis] = output.axes;

        // Send the command to the robot.
        position = axis.position;
        if (tick + 1) % 250 == 0 {
            let (t, mode, hits) = (f64::from(tick + 1) * 1e-3, output.mode, axis.hits);
            let hit = [(hits.force, "force"), (hits.acceleration, "acceleration"), (hits.velocity, "velocity")];
            let hit: Vec<&str> = hit.iter().filter(|(hit, _)| *hit).map(|(_, name)| *name).collect();
            let mode = format!("{mode:?}");
            println!("{t:7.2}  {mode:5} {:10.2} {:12.2} {position:9.4}  {hit:?}", axis.force, 1e3 * axis.offset);
        }
    }
    println!("{:?}", arm.counters());
    Ok(())
}
