//! A compliant skill of one axis: it grows stiffer along the way, and is pushed with 10 N from 0.5 s to 1.5 s.

use hpf_core::{AxisPrimitives, Basis, ConfigError, Gain, HybridPrimitive, Law, Movement, Phase};

fn main() -> Result<(), ConfigError> {
    let phase = Phase::new(2.0_f64, 100.0_f64.ln())?;
    let basis = Basis::equally_spaced(phase.decay(), 0.6, [0.0; 5], [0.0; 5])?;
    let axis = AxisPrimitives {
        movement: Movement::new(0.0, 0.3, 25.0, 0.3, [0.0; 5])?,
        stiffness: Gain::new(30.0, 400.0, [50.0, 100.0, 200.0, 300.0, 400.0])?,
        damping: Gain::new(10.0, 100.0, [20.0; 5])?,
        law: Law::FirstOrder,
    };
    let skill = HybridPrimitive::new(phase, [basis; 3], [axis])?;

    let dt = 0.01;
    let mut state = skill.initial_state();
    println!("  t [s]  force [N]  stiffness [N/m]  reference [m]  offset [mm]  tool [m]");
    for i in 1..=200_u32 {
        let force = if (51..=150).contains(&i) { 10.0 } else { 0.0 };
        let [command] = skill.step(&mut state, [force], 1.0, dt);
        if i % 20 == 0 {
            let (t, [axis]) = (f64::from(i) * dt, state.axes);
            let (reference, offset) = (axis.reference.position, 1e3 * axis.offset);
            let (stiffness, tool) = (command.stiffness, command.position);
            println!("{t:7.2} {force:10.1} {stiffness:16.1} {reference:14.4} {offset:12.2} {tool:9.4}");
        }
    }
    Ok(())
}
