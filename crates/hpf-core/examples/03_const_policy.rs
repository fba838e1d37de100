//! A learned policy as it sits in the flash of a microcontroller: constant arrays, single precision, no heap.

use hpf_core::{AxisPrimitives, Basis, ConfigError, Gain, HybridPrimitive, Law, Movement, Phase};

const N: usize = 4;
const DECAY: f32 = 4.605_17;
const GOAL: [f32; 2] = [0.30, -0.15];
const MOVEMENT: [[f32; N]; 2] = [[-40.0, 25.0, 60.0, 0.0], [10.0, -30.0, 20.0, 5.0]];
const STIFFNESS: [[f32; N]; 2] = [[60.0, 90.0, 180.0, 300.0], [300.0, 300.0, 200.0, 150.0]];
const DAMPING: [[f32; N]; 2] = [[20.0, 25.0, 40.0, 60.0], [50.0; N]];

fn policy() -> Result<HybridPrimitive<f32, [f32; N], 2>, ConfigError> {
    let basis = Basis::equally_spaced(DECAY, 0.6, [0.0; N], [0.0; N])?;
    let axis = |i: usize| -> Result<_, ConfigError> {
        Ok(AxisPrimitives {
            movement: Movement::new(0.0, GOAL[i], 25.0, GOAL[i], MOVEMENT[i])?,
            stiffness: Gain::new(30.0, 400.0, STIFFNESS[i])?,
            damping: Gain::new(10.0, 100.0, DAMPING[i])?,
            law: Law::FirstOrder,
        })
    };
    HybridPrimitive::new(Phase::new(1.5, DECAY)?, [basis; 3], [axis(0)?, axis(1)?])
}

fn main() -> Result<(), ConfigError> {
    let policy = policy()?;
    let mut state = policy.initial_state();
    println!("policy {} bytes, state {} bytes", size_of_val(&policy), size_of_val(&state));
    for tick in 1..=1500_u32 {
        let [x, y] = policy.step(&mut state, [2.0, f32::NAN], 1.0, 1e-3); // the second sensor is broken
        if tick % 250 == 0 {
            println!("{tick:5} ms  x {:7.4} m at {:5.1} N/m  y {:7.4} m", x.position, x.stiffness, y.position);
        }
    }
    Ok(())
}
