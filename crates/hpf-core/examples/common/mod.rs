//! A skill that the examples of the controller share: 0.3 m in two seconds, ever stiffer.

use hpf_core::controller::{Controller, Input, Settings};
use hpf_core::limits::Limits;
use hpf_core::{AxisPrimitives, Basis, ConfigError, Gain, HybridPrimitive, Law, Movement, Phase};

/// A controller of one axis for a robot at 0 m.
pub fn arm() -> Result<Controller<f64, [f64; 5], 1>, ConfigError> {
    let phase = Phase::new(2.0, 100.0_f64.ln())?;
    let basis = Basis::equally_spaced(phase.decay(), 0.6, [0.0; 5], [0.0; 5])?;
    let axis = AxisPrimitives {
        movement: Movement::new(0.0, 0.3, 25.0, 0.3, [-20.0, -10.0, 20.0, 40.0, 0.0])?,
        stiffness: Gain::new(30.0, 400.0, [50.0, 100.0, 200.0, 300.0, 400.0])?,
        damping: Gain::new(10.0, 100.0, [20.0; 5])?,
        law: Law::FirstOrder,
    };
    let limits = Limits { force: 40.0, offset: 0.1, velocity: 0.5, acceleration: 5.0, position: [-0.1, 0.5] };
    Controller::new(HybridPrimitive::new(phase, [basis; 3], [axis])?, Settings::compliant([limits]), [0.0])
}

/// A fresh reading of `force` [N], at the nominal rate, asking for nothing.
pub fn felt(force: f64) -> Input<f64, 1> {
    Input { measured_force: [force], force_age: 0, measured_position: None, rate: 1.0, request: None }
}
