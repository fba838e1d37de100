//! Certificates of a policy: what it can do at worst, on paper, before it runs.
//!
//! Gains are those at the middle of each step, over the movement and as long again at its goal, where the phase still
//! falls; the reference is that of the movement, at the nominal rate. The mathematics is [`hpf_core::passivity`].

use hpf_core::passivity::{contact_stiffness_limit, first_order_fails_at, largest_offset, switched_energy};
use hpf_core::{ConfigError, HybridPrimitive};

use crate::Policy;

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

/// What one axis can do at worst.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// First time at which the schedule of gains is not passive from rest [s].
    pub fails_at: Option<f64>,
    /// Largest offset under any force within the load [axis unit].
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
        (0..self.axes.len()).map(|axis| Ok(certify(&self.axis(axis).to_hybrid()?, conditions))).collect()
    }
}

fn certify(skill: &HybridPrimitive<f64, Vec<f64>, 1>, conditions: &Conditions) -> Certificate {
    let (h, duration) = (conditions.rate.recip(), skill.phase().duration());
    let steps = (duration * conditions.rate).round().max(1.0) as usize;
    let gains: Vec<(f64, f64)> = (0..2 * steps)
        .map(|step| {
            let [profile] = skill.at(skill.phase().at((step as f64 + 0.5) * h));
            (profile.stiffness, profile.damping)
        })
        .collect();
    let offset = largest_offset(gains.iter().copied(), conditions.load, h);
    let least_damping = gains.iter().map(|gain| gain.1).fold(f64::INFINITY, f64::min);

    let [axis] = skill.axes();
    let (movement, mut state) = (&axis.movement, skill.initial_state());
    let (mut velocity, mut acceleration) = (0.0_f64, 0.0_f64);
    for step in 0..=steps {
        if step > 0 {
            skill.step(&mut state, [0.0], 1.0, h);
        }
        let ([profile], [at]) = (skill.at(state.phase), state.axes);
        let (alpha, x, z) = (movement.alpha(), at.reference.position, at.reference.scaled_velocity);
        let pull = alpha * (0.25 * alpha * (movement.goal() - x) - z) + profile.forcing;
        velocity = velocity.max((z / duration).abs());
        acceleration = acceleration.max((pull / (duration * duration)).abs());
    }
    Certificate {
        fails_at: first_order_fails_at(gains.iter().copied(), h),
        largest_offset: offset,
        switched_energy: switched_energy(gains.iter().map(|gain| gain.0), offset),
        least_damping,
        contact_stiffness: contact_stiffness_limit(least_damping, conditions.delay, h),
        peak_velocity: velocity,
        peak_acceleration: acceleration,
    }
}
