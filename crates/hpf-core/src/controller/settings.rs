//! The settings of a controller: everything beside the skill, plain numbers checked as a whole.

use crate::admittance::Inertial;
use crate::conditioning::ForceConditioning;
use crate::domain::{LONGEST_HOLD, LONGEST_RAMP, LONGEST_STEP, SHORTEST_STEP};
use crate::limits::Limits;
use crate::passivity::{EnergyTank, Port};
use crate::{AxisPrimitives, ConfigError, Real, error};

/// Everything beside the skill; all of it may change between steps, see
/// [`Controller::set`](super::Controller::set).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<T, const D: usize> {
    /// One entry per axis.
    pub axes: [AxisSettings<T>; D],
    /// From the sensor's reading to the force that the model sees.
    pub conditioning: ForceConditioning<T, D>,
    /// Guard of passivity, if there is one.
    pub tank: Option<EnergyTank<T>>,
    /// The tank's energy kept at the physical port too, by what is measured; a controller with a port needs a measured
    /// position, and does not move without.
    pub port: Option<Port<T, D>>,
    /// Time and its faults.
    pub timing: Timing<T>,
}

/// Settings of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisSettings<T> {
    /// What it does with force.
    pub compliance: Compliance<T>,
    /// What a command never exceeds.
    pub limits: Limits<T>,
    /// Compensated force above which the controller stops [N].
    pub trip_force: T,
    /// Distance between command and robot above which it stops [axis unit].
    pub tracking: T,
}

/// What an axis does with force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compliance<T> {
    /// Nothing: it follows the reference. The force is watched for its trip level only.
    Rigid,
    /// Gives way by the admittance.
    Compliant,
    /// Gives way, and presses on the environment with this force [N]: `f + setpoint` drives the admittance. In contact
    /// the pressure is the set-point less `k e`; exact where the reference lies on the surface.
    Press(T),
}

/// Time and its faults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing<T> {
    /// Longest step; a longer dt is cut to it [s]. 1 us to 1 s.
    pub longest_step: T,
    /// Time for the rate to go from 0 to 1 or back [s], under way: pause, resume, slower, faster; at most 10 s: by then the
    /// path of a stop stands (in single precision an eighth later, where it takes millions of steps), and the offset dies away. A start takes none. With 0 the path stops and goes at once; what the limits of acceleration cut off
    /// that is an offset from the path.
    pub ramp: T,
    /// How long a bad force, measured position or rate may be bridged [s]; see [`faults`](super::faults). At most 1 s.
    pub hold: T,
    /// Oldest reading that is still good [steps].
    pub oldest_force: u32,
}

impl<T: Real + PartialOrd, const D: usize> Settings<T, D> {
    /// Settings to start from: every axis gives way by the law of its skill, readings are taken as they are, no tank.
    ///
    /// Trips at twice the force limit and where the robot is off by the offset limit; steps up to 10 ms, a ramp of
    /// 0.2 s, and for 20 ms the last good force stands in for one that is bad or more than 4 steps old.
    pub fn compliant(limits: [Limits<T>; D]) -> Self {
        let axis = |limits: Limits<T>| AxisSettings {
            compliance: Compliance::Compliant,
            limits,
            trip_force: limits.force + limits.force,
            tracking: limits.offset,
        };
        let zero = [T::ZERO; D];
        Self {
            axes: limits.map(axis),
            conditioning: ForceConditioning { tool_mass: T::ZERO, gravity: zero, cutoff: None, dead_zone: zero },
            tank: None,
            port: None,
            timing: Timing { longest_step: T::of(0.01), ramp: T::of(0.2), hold: T::of(0.02), oldest_force: 4 },
        }
    }

    /// Checks every value; returns the second-order step of each axis that has one.
    pub(super) fn laws<S: AsRef<[T]>>(
        &self,
        primitives: &[AxisPrimitives<T, S>; D],
    ) -> Result<[Option<Inertial<T>>; D], ConfigError> {
        let Timing { longest_step, ramp, hold, .. } = self.timing;
        error::positive("timing.longest_step", longest_step)?;
        error::within("timing.longest_step", longest_step, SHORTEST_STEP, LONGEST_STEP)?;
        error::within("timing.ramp", ramp, 0.0, LONGEST_RAMP)?;
        error::within("timing.hold", hold, 0.0, LONGEST_HOLD)?;
        self.conditioning.check()?;
        self.check_port()?;
        let mut laws = [None; D];
        for ((law, axis), primitives) in laws.iter_mut().zip(&self.axes).zip(primitives) {
            axis.limits.check()?;
            error::size("trip_force", axis.trip_force)?;
            error::size("tracking", axis.tracking)?;
            if let Compliance::Press(setpoint) = axis.compliance {
                let largest = axis.limits.force.to_f64();
                error::within("press", setpoint, -largest, largest)?;
            }
            *law = primitives.law.inertial(primitives.stiffness.max(), primitives.damping.max(), longest_step)?;
        }
        Ok(laws)
    }
}
