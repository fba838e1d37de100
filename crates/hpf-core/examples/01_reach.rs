//! A movement alone: 0.4 m in one second, bent by a forcing term that lifts it early and lets it land softly.

use hpf_core::{Basis, ConfigError, Movement, Phase, PhasePoint, Transition};

fn main() -> Result<(), ConfigError> {
    let phase = Phase::new(1.0_f64, 100.0_f64.ln())?;
    let basis = Basis::equally_spaced(phase.decay(), 0.6, [0.0; 5], [0.0; 5])?;
    let movement = Movement::new(0.0, 0.4, 25.0, 0.4, [-120.0, -60.0, 60.0, 240.0, 0.0])?;

    let dt = 0.01;
    let transition = Transition::new(movement.alpha(), dt / phase.duration());
    let mut state = movement.initial_state();
    println!("  t [s]    x [m]  x' [m/s]");
    for i in 0..100_u32 {
        let PhasePoint { s, gate } = phase.at((f64::from(i) + 0.5) * dt); // forcing at mid-step: second order
        let [mixed] = basis.mix(s, [movement.weights()]);
        transition.apply(&mut state, movement.goal(), movement.forcing(gate, mixed));
        if (i + 1) % 10 == 0 {
            let bar = "#".repeat((100.0 * state.position).max(0.0) as usize);
            let velocity = state.scaled_velocity / phase.duration();
            println!("{:7.2} {:8.4} {velocity:9.4}  {bar}", f64::from(i + 1) * dt, state.position);
        }
    }
    Ok(())
}
