//! A tool of 0.5 kg behind the force sensor, in free air at 1 kHz: how far it swings after a motion of 0.3 m, for a force that
//! is 0 to 5 steps old, and what helps.

use hpf_core::controller::{Controller, Input, Request, Settings};
use hpf_core::limits::Limits;
use hpf_core::passivity::{ForceLoop, Sampling};
use hpf_core::{AxisPrimitives, Basis, ConfigError, Damping, Gain, HybridPrimitive, Law, Movement, Phase};

const DT: f64 = 1e-3;
const TOOL: f64 = 0.5;
const STIFFNESS: f64 = 100.0;
const DAMPING: f64 = 50.0;

/// What is set against the tool's mass: virtual mass [kg], cut-off of the filter [Hz], damping [N s/m].
struct Remedy {
    name: &'static str,
    mass: Option<f64>,
    cutoff: Option<f64>,
    damping: f64,
}

fn arm(remedy: &Remedy) -> Result<Controller<f64, [f64; 5], 1>, ConfigError> {
    let phase = Phase::new(2.0, 100.0_f64.ln())?;
    let basis = Basis::equally_spaced(phase.decay(), 0.6, [0.0; 5], [0.0; 5])?;
    let axis = AxisPrimitives {
        movement: Movement::new(0.0, 0.3, 25.0, 0.3, [0.0; 5])?,
        stiffness: Gain::new(STIFFNESS, STIFFNESS, [STIFFNESS; 5])?,
        damping: Gain::new(remedy.damping, remedy.damping, [remedy.damping; 5])?,
        law: remedy.mass.map_or(Law::FirstOrder, |mass| Law::SecondOrder { mass, damping: Damping::Primitive }),
    };
    let limits = Limits { force: 40.0, offset: 0.1, velocity: 0.5, acceleration: 1000.0, position: [-0.2, 0.6] };
    let mut settings = Settings::compliant([limits]);
    settings.conditioning.tool_mass = TOOL;
    settings.conditioning.cutoff = remedy.cutoff;
    Controller::new(HybridPrimitive::new(phase, [basis; 3], [axis])?, settings, [0.0])
}

/// Width of the tool's path in the last second of four [mm].
fn swing(remedy: &Remedy, delay: usize) -> Result<f64, ConfigError> {
    let mut arm = arm(remedy)?;
    let (mut readings, mut velocity) = ([0.0; 8], 0.0);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for tick in 0..4000 {
        let request = (tick == 0).then_some(Request::Start);
        let measured_force = [readings[delay]];
        let input = Input { measured_force, force_age: 0, measured_position: None, rate: 1.0, request };
        let [axis] = arm.update(&input, DT).axes;
        // The robot follows; the sensor feels the tool's inertia, its mean over the step.
        readings.rotate_right(1);
        readings[0] = -TOOL * (axis.velocity - velocity) / DT;
        velocity = axis.velocity;
        if tick >= 3000 {
            (low, high) = (low.min(axis.position), high.max(axis.position));
        }
    }
    Ok(1e3 * (high - low))
}

fn main() -> Result<(), ConfigError> {
    let remedy = |name, mass, cutoff, damping| Remedy { name, mass, cutoff, damping };
    let remedies = [
        remedy("none", None, None, DAMPING),
        remedy("filter at 30 Hz", None, Some(30.0), DAMPING),
        remedy("filter at 10 Hz", None, Some(10.0), DAMPING),
        remedy("second order, 0.2 kg", Some(0.2), None, DAMPING),
        remedy("second order, 0.5 kg", Some(0.5), None, DAMPING),
        remedy("second order, 1 kg", Some(1.0), None, DAMPING),
        remedy("damping of 1100 N s/m", None, None, 1100.0),
    ];
    println!("swing in mm for a force that is so many steps old; then, of the loop one step late:");
    println!("{:22} {}  heavy  safe kg  limit kg", "remedy", (0..=5).map(|n| format!("{n:7}")).collect::<String>());
    for remedy in &remedies {
        let mut row = format!("{:22} ", remedy.name);
        for delay in 0..=5 {
            row += &format!("{:7.2}", swing(remedy, delay)?);
        }
        let sampling = Sampling { dt: DT, delay: DT, cutoff: remedy.cutoff, lag: 0.0 };
        let around = ForceLoop::new(remedy.mass, STIFFNESS, remedy.damping, &sampling)?;
        let [heavy] = arm(remedy)?.heavy_tool(DT);
        println!("{row}  {:5}  {:7.3}  {:8.3}", heavy, around.safe_tool_mass(), around.tool_mass_limit());
    }
    Ok(())
}
