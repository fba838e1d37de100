//! Certificates of a policy: what it can do at worst, on paper, before it runs.
//!
//! Gains are those at the middle of each step, over the movement and as long again at its goal, where the phase still
//! falls; the reference is that of the movement, at the nominal rate. The mathematics is [`hpf_core::passivity`].

use hpf_core::admittance::{Inertial, OffsetMotion};
use hpf_core::passivity::{
    contact_stiffness_limit, first_order_fails_at, inertial_contact_stiffness_limit, inertial_decay, largest_offset,
    switched_energy,
};
use hpf_core::{ConfigError, HybridPrimitive};

use crate::{Policy, Task};

/// Most steps of a schedule that are looked at.
pub const MAX_CERTIFIED_STEPS: f64 = 4e6;

/// What a policy is certified for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Control rate [Hz].
    pub rate: f64,
    /// Age of the measured force [s].
    pub delay: f64,
    /// Largest force of the environment [N or N m].
    pub load: f64,
}

/// Instants at which the largest offset of a tool with inertia is looked for.
const INSTANTS: usize = 64;

/// What one axis can do at worst.
///
/// The reference is that of the movement and of one duration after it, in which it comes to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// First time at which the schedule of gains is not passive from rest, with inertia as without [s].
    pub fails_at: Option<f64>,
    /// Of a law of order 2, a decay that proves its free motion stable [1/s]: a sufficient test (Kronander and Billard,
    /// IEEE T-RO 32(5):1298, 2016). A law of order 1 is always stable.
    pub decay: Option<f64>,
    /// Largest offset under any force within the load [axis unit]; with inertia, the largest at 64 instants.
    pub largest_offset: f64,
    /// Most energy that rising stiffness puts in while the offset stays within the largest [J].
    pub switched_energy: f64,
    /// Least damping of the schedule [N s/m].
    pub least_damping: f64,
    /// Stiffness of a contact from which on the force loop may be unstable [N/m].
    pub contact_stiffness: f64,
    /// Largest speed of the reference [axis unit/s].
    pub peak_velocity: f64,
    /// Largest acceleration of the reference, in size [axis unit/s^2].
    pub peak_acceleration: f64,
    /// Largest distance of the reference from the goal after the duration [axis unit].
    pub rest_distance: f64,
}

impl Policy {
    /// The certificate of each axis, in axis order.
    ///
    /// # Errors
    /// [`ConfigError`] for a rate that is not positive, a delay or load below nought, and a schedule of too many steps.
    pub fn certify(&self, conditions: &Conditions) -> Result<Vec<Certificate>, ConfigError> {
        let Conditions { rate, delay, load } = *conditions;
        let within = |field, value: f64, min, max| {
            let fits = value.is_finite() && value >= min && value <= max;
            if fits { Ok(()) } else { Err(ConfigError::OutOfRange { field, value, min, max }) }
        };
        within("rate", rate, f64::MIN_POSITIVE, 1e6)?;
        within("delay", delay, 0.0, 10.0)?;
        within("load", load, 0.0, 1e9)?;
        within("steps at this rate", 2.0 * self.duration_s * rate, 0.0, MAX_CERTIFIED_STEPS)?;
        let mass = |axis: usize| self.admittance.mass.as_ref().map(|mass| mass[axis]);
        (0..self.axes.len()).map(|axis| certify(&self.axis(axis).to_hybrid()?, mass(axis), conditions)).collect()
    }
}

/// A contact that a task meets with a measured force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredContact {
    /// Largest stiffness of the contact [N/m].
    pub stiffness: f64,
    /// Stiffness from which on the force loop may be unstable at the least damping that the task allows [N/m].
    pub limit: f64,
}

impl Task {
    /// The contact of a task whose force is measured, where it has both. The lag of an actuator counts as delay.
    pub fn measured_contact(&self) -> Option<MeasuredContact> {
        let contact = self.contact.as_ref()?;
        let axis = self.axis_index(contact.axis())?;
        if self.sensor.is_none() && self.actuator.is_none() {
            return None;
        }
        let steps = 2 * self.steps();
        let surface = |i: usize| contact.surface(i as f64 / steps as f64, self.axis[axis].start).stiffness;
        let late = self.sensor.as_ref().map_or(0.0, |sensor| sensor.delay)
            + self.actuator.as_ref().map_or(0.0, |actuator| actuator.lag);
        let (damping, dt) = (self.damping.min.of(axis), self.rate.recip());
        let limit = match &self.admittance.mass {
            Some(mass) => inertial_contact_stiffness_limit(mass.of(axis), damping, late, dt),
            None => contact_stiffness_limit(damping, late, dt),
        };
        Some(MeasuredContact { stiffness: (0..=steps).map(surface).fold(0.0, f64::max), limit })
    }
}

/// The largest offset [m] that any force of at most `load` [N] can bring about from rest at one of [`INSTANTS`]: the sum
/// of the response to a push in each step before, in size.
fn largest_inertial_offset(gains: &[(f64, f64)], law: &Inertial<f64>, load: f64, h: f64) -> f64 {
    let step = |&(stiffness, damping): &(f64, f64)| {
        let to = |offset: f64, velocity: f64, force: f64| {
            let mut motion = OffsetMotion { offset, velocity };
            law.step(&mut motion, stiffness, damping, force, h);
            [motion.offset, motion.velocity]
        };
        [to(1.0, 0.0, 0.0), to(0.0, 1.0, 0.0), to(0.0, 0.0, 1.0)]
    };
    let steps: Vec<[[f64; 2]; 3]> = gains.iter().map(step).collect();
    let worst = |end: usize| {
        // What offset and velocity before a step come to in the offset at the end.
        let (mut weight, mut sum) = ([1.0, 0.0], 0.0);
        for [offset, velocity, push] in steps[..end].iter().rev() {
            let come_to = |[e, v]: [f64; 2]| weight[0] * e + weight[1] * v;
            sum += come_to(*push).abs();
            weight = [come_to(*offset), come_to(*velocity)];
        }
        load * sum
    };
    (1..=INSTANTS).map(|instant| worst(instant * steps.len() / INSTANTS)).fold(0.0, f64::max)
}

fn certify(
    skill: &HybridPrimitive<f64, Vec<f64>, 1>,
    mass: Option<f64>,
    conditions: &Conditions,
) -> Result<Certificate, ConfigError> {
    let (h, duration) = (conditions.rate.recip(), skill.phase().duration());
    let steps = (duration * conditions.rate).round().max(1.0) as usize;
    let gains: Vec<(f64, f64)> = (0..2 * steps)
        .map(|step| {
            let [profile] = skill.at(skill.phase().at((step as f64 + 0.5) * h));
            (profile.stiffness, profile.damping)
        })
        .collect();
    let [axis] = skill.axes();
    let least_damping = gains.iter().map(|gain| gain.1).fold(f64::INFINITY, f64::min);

    let (decay, offset, contact_stiffness) = match mass {
        Some(mass) => {
            let law = Inertial::new(mass, axis.stiffness.max(), axis.damping.max(), h)?;
            (
                inertial_decay(gains.iter().copied(), mass, h),
                largest_inertial_offset(&gains, &law, conditions.load, h),
                inertial_contact_stiffness_limit(mass, least_damping, conditions.delay, h),
            )
        }
        None => (
            None,
            largest_offset(gains.iter().copied(), conditions.load, h),
            contact_stiffness_limit(least_damping, conditions.delay, h),
        ),
    };
    let (movement, mut state) = (&axis.movement, skill.initial_state());
    let (mut velocity, mut acceleration, mut rest) = (0.0_f64, 0.0_f64, 0.0_f64);
    for step in 0..=2 * steps {
        if step > 0 {
            skill.step(&mut state, [0.0], 1.0, h);
        }
        let ([profile], [at]) = (skill.at(state.phase), state.axes);
        let (alpha, x, z) = (movement.alpha(), at.reference.position, at.reference.scaled_velocity);
        let pull = alpha * (0.25 * alpha * (movement.goal() - x) - z) + profile.forcing;
        velocity = velocity.max((z / duration).abs());
        acceleration = acceleration.max((pull / (duration * duration)).abs());
        if step >= steps {
            rest = rest.max((x - movement.goal()).abs());
        }
    }
    Ok(Certificate {
        fails_at: first_order_fails_at(gains.iter().copied(), h),
        decay,
        largest_offset: offset,
        switched_energy: switched_energy(gains.iter().map(|gain| gain.0), offset),
        least_damping,
        contact_stiffness,
        peak_velocity: velocity,
        peak_acceleration: acceleration,
        rest_distance: rest,
    })
}
