//! A controller with a port on a robot that follows as it likes, within what docs/embedding.md asks of it: towards the
//! command and not beyond, forces below the trip level, readings late and off by no more than was declared. What the
//! environment has done is a sum of its own, true force times true displacement.

use hpf_core::controller::{Controller, Input, Request, Settings};
use hpf_core::passivity::{EnergyTank, Port};
use libfuzzer_sys::arbitrary::{Arbitrary, Result, Unstructured};

use super::draw::{N, Taste, each, number, settings, skill};

/// Updates of one input, at most.
const UPDATES: u32 = 20_000;

/// The longest delay that can be declared [steps].
const LATEST: usize = 6;

/// How the environment pushes for a while.
#[derive(Clone, Copy, Debug)]
enum Push {
    /// With so many newtons.
    Even(f64),
    /// Against the command's motion, or with it.
    Motion(f64),
    /// The other way in every step.
    Shaking(f64),
    /// A spring about a place [N/m, axis unit].
    Spring(f64, f64),
    /// Against where the command still has to take the robot.
    Gap(f64),
}

impl Push {
    fn draw(input: &mut Unstructured<'_>, most: f64) -> Result<Self> {
        let force = number(input, Taste::Plain, -most, most)?;
        Ok(match u8::arbitrary(input)? % 8 {
            0 => Self::Even(force),
            1..=3 => Self::Motion(force),
            4 => Self::Shaking(force),
            5 => Self::Spring(number(input, Taste::Plain, 10.0, 5000.0)?, number(input, Taste::Plain, -0.4, 0.4)?),
            _ => Self::Gap(force),
        })
    }

    fn force(self, step: u32, at: f64, gap: f64, velocity: f64) -> f64 {
        match self {
            Self::Even(force) => force,
            Self::Motion(force) => force * velocity.signum(),
            Self::Shaking(force) => {
                if step % 2 == 0 {
                    force
                } else {
                    -force
                }
            }
            Self::Spring(stiffness, place) => stiffness * (place - at),
            Self::Gap(force) => force * gap.signum(),
        }
    }
}

/// Settings of a port whose limits of motion are out of the way.
fn tied<const D: usize>(input: &mut Unstructured<'_>) -> Result<Option<Settings<f64, D>>> {
    let mut settings: Settings<f64, D> = settings(input, Taste::Plain)?;
    for axis in &mut settings.axes {
        (axis.limits.velocity, axis.limits.acceleration) = (1e4, 1e7);
        if bool::arbitrary(input)? {
            axis.tracking = 1e3;
        }
    }
    let capacity: f64 = number(input, Taste::Plain, 0.05, 2.0)?;
    let share: f64 = number(input, Taste::Plain, 0.0, 1.0)?;
    let reserve = share * capacity;
    settings.tank = EnergyTank::new(capacity, reserve, number(input, Taste::Plain, 0.0, 1.0)?, 100.0).ok();
    let force_delay = u32::from(u8::arbitrary(input)?) % (LATEST as u32 + 1);
    settings.port = Some(Port { force_delay, force_bias: each(input, Taste::Plain, 0.0, 2.0)? });
    Ok(settings.tank.map(|_| settings))
}

fn request<const D: usize>(input: &mut Unstructured<'_>, at: [f64; D]) -> Result<Option<Request<f64, D>>> {
    Ok(match u8::arbitrary(input)? % 16 {
        0..=3 => Some(Request::Start),
        4 => Some(Request::Hold),
        5 => Some(Request::Resume),
        6 => Some(Request::Stop),
        7 | 8 => Some(Request::Goal(each(input, Taste::Plain, -0.4, 0.4)?)),
        // Of a robot at rest where it is.
        9 => Some(Request::Reset(at)),
        _ => None,
    })
}

pub fn play<const D: usize>(input: &mut Unstructured<'_>) -> Result<()> {
    let Some(skill) = skill::<f64, D>(input, Taste::Plain)? else { return Ok(()) };
    let Some(first) = tied::<D>(input)? else { return Ok(()) };
    let (Some(tank), Some(port)) = (first.tank, first.port) else { return Ok(()) };
    let mut at: [f64; D] = each(input, Taste::Plain, -0.3, 0.3)?;
    let Ok(mut arm) = Controller::<f64, [f64; N], D>::new(skill, first, at) else { return Ok(()) };
    let delay = usize::from(u8::arbitrary(input)?) % (port.force_delay as usize + 1);
    let weight = first.conditioning.gravity.map(|gravity| first.conditioning.tool_mass * gravity);

    // The youngest true force first; where the robot was a step ago; the work since the reset [J].
    let mut forces = [[0.0_f64; D]; LATEST + 1];
    let (mut before, mut work, mut passed) = (at, 0.0_f64, 0.0_f64);
    let mut updates = 0;
    while !input.is_empty() && updates < UPDATES {
        if u8::arbitrary(input)? % 16 == 0 {
            let mut other: Settings<f64, D> = settings(input, Taste::Plain)?;
            (other.tank, other.port, other.conditioning) = (first.tank, first.port, first.conditioning);
            for (axis, first) in other.axes.iter_mut().zip(&first.axes) {
                (axis.limits, axis.trip_force) = (first.limits, first.trip_force);
            }
            let _ = arm.set(other);
        }
        let mut pushes = [Push::Even(0.0); D];
        for (push, axis) in pushes.iter_mut().zip(&first.axes) {
            *push = Push::draw(input, axis.trip_force)?;
        }
        // The part of its way that the robot goes in a step, what the readings are off by, where within a step it moves.
        let follows: [f64; D] = each(input, Taste::Plain, 0.0, 1.0)?;
        let off: [f64; D] = each(input, Taste::Plain, -1.0, 1.0)?;
        let late: f64 = number(input, Taste::Plain, 0.0, 1.0)?;
        let dt = number(input, Taste::Plain, 5e-4, 2e-3)?;
        let rate = number(input, Taste::Plain, 0.0, 1.0)?;
        let mut asked = request(input, at)?;
        let repeats = 1 + u32::from(u8::arbitrary(input)?);
        for _ in 0..repeats {
            let mut force = [0.0_f64; D];
            for (i, (force, push)) in force.iter_mut().zip(&pushes).enumerate() {
                let (command, most) = (&arm.output().axes[i], first.axes[i].trip_force);
                *force = push.force(updates, at[i], command.position - at[i], command.velocity).clamp(-most, most);
                // Over the last step the force was between that of its start and that of its end.
                let done: f64 = (forces[0][i] + late * (*force - forces[0][i])) * (at[i] - before[i]);
                (work, passed) = (work + done, passed + done.abs());
            }
            forces.rotate_right(1);
            forces[0] = force;
            assert!(work >= -tank.capacity() - 1e-9 * (1.0 + passed), "{work} J of {}: {first:?}", tank.capacity());
            let mut measured_force = forces[delay];
            for (i, reading) in measured_force.iter_mut().enumerate() {
                *reading += weight[i] + off[i] * port.force_bias[i];
            }
            let given =
                Input { measured_force, force_age: 0, measured_position: Some(at), rate, request: asked.take() };
            let now = arm.update(&given, dt);
            if matches!(given.request, Some(Request::Reset(_))) && !now.status.refused {
                (work, passed) = (0.0, 0.0);
            }
            before = at;
            for ((at, follows), axis) in at.iter_mut().zip(&follows).zip(&now.axes) {
                *at += follows * (axis.position - *at);
            }
            updates += 1;
        }
    }
    Ok(())
}
