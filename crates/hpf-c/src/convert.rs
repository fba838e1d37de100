//! Between what crosses the border and what the controller takes and gives.

use hpf_core::conditioning::ForceConditioning;
use hpf_core::controller::{self as control, Compliance, Mode, Request, Timing};
use hpf_core::passivity::{EnergyTank, Port};
use hpf_core::{Real, limits};

use crate::abi::*;
use crate::status::{HPF_UNKNOWN_CHOICE, Refusal};

/// The first `D` numbers of a list.
fn first<T: Real, const D: usize>(list: &[T; HPF_AXES_MAX]) -> [T; D] {
    let mut found = [T::ZERO; D];
    found.iter_mut().zip(list).for_each(|(slot, &value)| *slot = value);
    found
}

/// Flags, the first in the lowest bit.
fn bits<const N: usize>(flags: [bool; N]) -> u32 {
    flags.into_iter().rev().fold(0, |bits, flag| bits << 1 | u32::from(flag))
}

impl<T: Real> Limits<T> {
    /// As the controller takes them.
    pub(crate) fn read(&self) -> limits::Limits<T> {
        let &Self { force, offset, velocity, acceleration, position_min, position_max } = self;
        limits::Limits { force, offset, velocity, acceleration, position: [position_min, position_max] }
    }
}

impl<T: Real + PartialOrd> AxisSettings<T> {
    fn read(&self) -> Result<control::AxisSettings<T>, Refusal> {
        let compliance = match self.compliance {
            HPF_COMPLIANT => Compliance::Compliant,
            HPF_RIGID => Compliance::Rigid,
            HPF_PRESS => Compliance::Press(self.press),
            _ => return Err(HPF_UNKNOWN_CHOICE.into()),
        };
        let (trip_force, tracking) = (self.trip_force, self.tracking);
        Ok(control::AxisSettings { compliance, limits: self.limits.read(), trip_force, tracking })
    }
}

impl<T: Real + PartialOrd> Settings<T> {
    /// As the controller takes them.
    pub(crate) fn read<const D: usize>(&self) -> Result<control::Settings<T, D>, Refusal> {
        let some = |value: T| (value != T::ZERO).then_some(value);
        let mut settings = control::Settings::compliant([self.axis[0].limits.read(); D]);
        for (slot, axis) in settings.axes.iter_mut().zip(&self.axis) {
            *slot = axis.read()?;
        }
        settings.conditioning = ForceConditioning {
            tool_mass: self.tool_mass,
            gravity: first(&self.gravity),
            cutoff: some(self.cutoff),
            dead_zone: first(&self.dead_zone),
        };
        settings.tank = some(self.tank_capacity)
            .map(|capacity| EnergyTank::new(capacity, self.tank_reserve, self.tank_refill, self.tank_power))
            .transpose()?;
        settings.port = (self.has_port != 0)
            .then(|| Port { force_delay: self.port_force_delay, force_bias: first(&self.port_force_bias) });
        let &Self { longest_step, ramp, hold, oldest_force, .. } = self;
        settings.timing = Timing { longest_step, ramp, hold, oldest_force };
        Ok(settings)
    }

    /// Writes [`control::Settings::compliant`] of one `limits` per axis; the axes beyond are left as they are.
    pub(crate) fn write_compliant(&mut self, limits: &[Limits<T>]) {
        for (axis, &limits) in self.axis.iter_mut().zip(limits) {
            let control::Settings { axes: [from], timing, .. } = control::Settings::compliant([limits.read()]);
            *axis = AxisSettings {
                compliance: HPF_COMPLIANT,
                reserved: 0,
                press: T::ZERO,
                limits,
                trip_force: from.trip_force,
                tracking: from.tracking,
            };
            (self.longest_step, self.ramp, self.hold) = (timing.longest_step, timing.ramp, timing.hold);
            self.oldest_force = timing.oldest_force;
        }
        let none = [T::ZERO; HPF_AXES_MAX];
        (self.tool_mass, self.gravity, self.dead_zone, self.cutoff) = (T::ZERO, none, none, T::ZERO);
        (self.tank_capacity, self.tank_reserve) = (T::ZERO, T::ZERO);
        (self.tank_refill, self.tank_power, self.reserved) = (T::ZERO, T::ZERO, 0);
        (self.has_port, self.port_force_delay, self.port_force_bias) = (0, 0, none);
    }
}

impl<T: Real> Input<T> {
    /// As the controller takes it.
    pub(crate) fn read<const D: usize>(&self) -> Result<control::Input<T, D>, Refusal> {
        let request = match self.request {
            HPF_NO_REQUEST => None,
            HPF_START => Some(Request::Start),
            HPF_HOLD => Some(Request::Hold),
            HPF_RESUME => Some(Request::Resume),
            HPF_STOP => Some(Request::Stop),
            HPF_GOAL => Some(Request::Goal(first(&self.target))),
            HPF_TARE => Some(Request::Tare),
            HPF_RESET => Some(Request::Reset(first(&self.target))),
            _ => return Err(HPF_UNKNOWN_CHOICE.into()),
        };
        Ok(control::Input {
            measured_force: first(&self.measured_force),
            force_age: self.force_age,
            measured_position: (self.has_position != 0).then(|| first(&self.measured_position)),
            rate: self.rate,
            request,
        })
    }
}

impl<T: Real> Output<T> {
    /// Writes what the controller says.
    pub(crate) fn write<const D: usize>(&mut self, from: &control::Output<T, D>) {
        self.mode = match from.mode {
            Mode::Idle => HPF_MODE_IDLE,
            Mode::Run => HPF_MODE_RUN,
            Mode::Hold => HPF_MODE_HOLD,
            Mode::Stop => HPF_MODE_STOP,
            Mode::Fault => HPF_MODE_FAULT,
        };
        let status = from.status;
        self.flags = bits([
            status.ended,
            status.bad_time,
            status.long_time,
            status.bad_force,
            status.force_lost,
            status.bad_input,
            status.refused,
            status.force_tripped,
            status.tracking_tripped,
            status.energy_short,
            status.position_lost,
            status.rate_lost,
            status.time_lost,
            status.tare_ready,
        ]);
        (self.phase, self.rate, self.energy) = (from.phase, from.rate, from.energy);
        self.port_energy = from.port_energy;
        for (slot, axis) in self.axis.iter_mut().zip(&from.axes) {
            let &control::AxisOutput { position, velocity, stiffness, damping, offset, force, hits } = axis;
            let hits = bits([hits.force, hits.offset, hits.velocity, hits.acceleration, hits.position]);
            *slot = AxisOutput { position, velocity, stiffness, damping, offset, force, hits, reserved: 0 };
        }
    }
}

impl Counters {
    /// Writes what the controller has counted.
    pub(crate) fn write(&mut self, from: &control::Counters) {
        let &control::Counters { bad_time, long_time, bad_force, bad_input, refused, trips, faults } = from;
        let Self { struct_size, abi_version, .. } = *self;
        *self = Self {
            struct_size,
            abi_version,
            bad_time,
            long_time,
            bad_force,
            bad_input,
            refused,
            trips,
            faults,
            reserved: 0,
        };
    }
}
