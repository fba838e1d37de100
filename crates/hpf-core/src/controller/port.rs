//! A controller at its physical port: what is measured is booked, and commands stay where it can be paid for.

use super::{Controller, Input, Settings};
use crate::domain::LARGEST;
use crate::limits::{brake, cut};
use crate::passivity::PortAxis;
use crate::{ConfigError, Real, error};

impl<T: Real + PartialOrd, const D: usize> Settings<T, D> {
    /// Whether the port makes sense.
    pub(super) fn check_port(&self) -> Result<(), ConfigError> {
        let Some(port) = &self.port else { return Ok(()) };
        port.check()?;
        // Without a tank there is nothing to keep books of.
        error::positive("tank.capacity of a port", self.tank.map_or(T::ZERO, |tank| tank.capacity())).map(drop)
    }
}

impl<T: Real + PartialOrd, S: AsRef<[T]>, const D: usize> Controller<T, S, D> {
    /// Begins the books of the port anew: until something is measured the commands stay where they are.
    pub(super) fn open_port(&mut self) {
        self.port_known = false;
        for state in &mut self.axes {
            state.port = PortAxis::at_rest(state.position, T::ZERO);
        }
    }

    /// Books what was measured, where there is a port, and says how far the commands may go.
    #[inline(never)]
    pub(super) fn observe(&mut self, input: &Input<T, D>) {
        let (Some(port), Some(tank)) = (&self.settings.port, &self.settings.tank) else { return };
        let Some(measured) = input.measured_position else { return };
        let fresh = input.force_age == 0 && !self.status.bad_force;
        if !fresh || !measured.iter().all(|position| position.is_finite()) {
            return;
        }
        let measured = measured.map(|position| cut(position, T::ZERO, T::of(LARGEST)).0);
        let forces = self.settings.conditioning.compensated(&self.force, self.good_force);
        let delay = port.force_delay;
        let energy = &mut self.port_energy;
        for (((state, position), force), &bias) in self.axes.iter_mut().zip(measured).zip(forces).zip(&port.force_bias)
        {
            if self.port_known {
                energy.add(state.port.read(position, force, delay, bias));
            } else {
                state.port = PortAxis::at_rest(position, force);
            }
        }
        self.port_known = true;
        *energy = energy.capped(tank.capacity());
        let share = T::of(1.0 / D as f64);
        let (all, left) = (energy.level() * share, tank.available(energy.level()) * share);
        for ((state, settings), &bias) in self.axes.iter_mut().zip(&self.settings.axes).zip(&port.force_bias) {
            state.port.confine(all, left, settings.trip_force, delay, bias);
        }
    }
}

/// The velocity nearest to `wanted` that keeps a command at `position` between `walls`, or takes it back there, and
/// whether it is another.
#[inline(never)]
pub(super) fn confined<T: Real + PartialOrd>(
    wanted: T,
    position: T,
    walls: &[T; 2],
    acceleration: T,
    dt: T,
) -> (T, bool) {
    let [low, high] = walls.map(|wall| wall - position);
    let (braked, _) = brake(wanted, [-low, high], acceleration, dt);
    let found = braked.at_most(high / dt).at_least(low / dt);
    (found, found != wanted)
}
