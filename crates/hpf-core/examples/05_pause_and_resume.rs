//! A pause button: held from 0.6 s to 1.2 s, the tool stops on its path and goes on along it, compliant all the while.

mod common;

use hpf_core::ConfigError;
use hpf_core::controller::{Input, Request};

fn main() -> Result<(), ConfigError> {
    let mut arm = common::arm()?;
    println!("  t [s]  mode  rate   phase  tool [m]  velocity [m/s]");
    for tick in 0..3200_u32 {
        let request = match tick {
            0 => Some(Request::Start),
            600 => Some(Request::Hold),
            1200 => Some(Request::Resume),
            _ => None,
        };
        let output = arm.update(&Input { request, ..common::felt(0.0) }, 1e-3);
        if output.status.ended {
            println!("         the movement has ended");
        }
        if (tick + 1) % 200 == 0 {
            let (t, mode, [axis]) = (f64::from(tick + 1) * 1e-3, format!("{:?}", output.mode), output.axes);
            let (rate, phase) = (output.rate, output.phase);
            println!("{t:7.2}  {mode:4} {rate:5.2} {phase:7.4} {:9.4} {:15.4}", axis.position, axis.velocity);
        }
    }
    Ok(())
}
