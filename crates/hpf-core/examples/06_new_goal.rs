//! A new goal in flight: at 1 s the part is found to lie 0.15 m nearer; the velocity bends, nothing jumps.

mod common;

use hpf_core::ConfigError;
use hpf_core::controller::{Input, Request};

fn main() -> Result<(), ConfigError> {
    let mut arm = common::arm()?;
    let mut fastest_change = 0.0_f64;
    let mut last = 0.0;
    println!("  t [s]  tool [m]  velocity [m/s]");
    for tick in 0..3000_u32 {
        let request = match tick {
            0 => Some(Request::Start),
            1000 => Some(Request::Goal([0.15])),
            _ => None,
        };
        let [axis] = arm.update(&Input { request, ..common::felt(0.0) }, 1e-3).axes;
        fastest_change = fastest_change.max((axis.velocity - last).abs() / 1e-3);
        last = axis.velocity;
        if (tick + 1) % 200 == 0 {
            println!("{:7.2} {:9.4} {:15.4}", f64::from(tick + 1) * 1e-3, axis.position, axis.velocity);
        }
    }
    println!("largest acceleration {fastest_change:.2} m/s^2");
    Ok(())
}
