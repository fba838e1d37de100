//! What `scripts/instructions.sh` counts: so many movements of 2000 updates each, without measuring anything itself.
//!
//! Arguments: scalar (f32, f64), family (phase, time), axes (2, 6), movements.

#[allow(dead_code, reason = "the other benches use more of it")]
mod common;

use core::hint::black_box;
use std::process::ExitCode;

use common::{Family, controller, input};
use hpf_core::Real;

/// Updates of one movement, 2 s at 1 kHz.
const UPDATES: u32 = 2000;

fn run<T: Real + PartialOrd, const D: usize>(family: Family, movements: u32) {
    let (start, input, dt) = (controller::<T, D>(family), input(), T::of(1e-3));
    for _ in 0..movements {
        let mut arm = start;
        for _ in 0..UPDATES {
            black_box(arm.update(black_box(&input), black_box(dt)).axes);
        }
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let [scalar, family, axes, movements] = arguments[..] else {
        println!("run by scripts/instructions.sh, under valgrind");
        return ExitCode::SUCCESS;
    };
    let family = if family == "time" { Family::Time } else { Family::Phase };
    let Ok(movements) = movements.parse() else { return ExitCode::FAILURE };
    match (scalar, axes) {
        ("f32", "2") => run::<f32, 2>(family, movements),
        ("f32", "6") => run::<f32, 6>(family, movements),
        ("f64", "2") => run::<f64, 2>(family, movements),
        ("f64", "6") => run::<f64, 6>(family, movements),
        _ => return ExitCode::FAILURE,
    }
    ExitCode::SUCCESS
}
