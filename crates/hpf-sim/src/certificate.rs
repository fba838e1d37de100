//! Certificates of a policy: what it can do at worst, on paper, before it runs.
//!
//! Gains are those at the middle of each step, over the movement and as long again at its goal, where the phase still
//! falls; the reference is that of the movement, at the nominal rate. The mathematics is [`hpf_core::passivity`].

use hpf_core::admittance::{Inertial, OffsetMotion};
use hpf_core::passivity::{
    Case, Contact, ForceLoop, MOST_DELAY, Sampling, first_order_fails_at, inertial_decay, largest_offset,
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
    /// Cut-off of the force filter [Hz], if there is one.
    pub cutoff: Option<f64>,
    /// Time constant with which the robot follows its command [s].
    pub lag: f64,
    /// Tool, and what it touches.
    pub contact: Contact,
}

impl Conditions {
    /// A control rate [Hz], an age of the force [s], a largest force [N or N m]; no filter, no lag, no masses.
    pub fn new(rate: f64, delay: f64, load: f64) -> Self {
        Self { rate, delay, load, cutoff: None, lag: 0.0, contact: Contact::default() }
    }

    /// Steps are longer where a force would be older than the steps that a loop looks back: cautious, by a thousandth.
    fn sampling(&self) -> Sampling {
        let dt = self.rate.recip().max(self.delay / MOST_DELAY);
        Sampling { dt, delay: self.delay, cutoff: self.cutoff, lag: self.lag }
    }
}

/// Instants of a schedule at which its force loop is looked at, beside that of the least damping and of the largest
/// stiffness.
const LOOPS: usize = 8;

/// Instants at which the largest offset of a tool with inertia is looked for.
const INSTANTS: usize = 64;

/// What one axis can do at worst.
///
/// The reference is that of the movement and of one duration after it, in which it settles at the goal.
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
    /// Stiffness [N/m] below which a contact is stable under the gains of every instant looked at; infinite where all are.
    pub contact_stiffness: f64,
    /// What limits it.
    pub contact_case: Case,
    /// When in the movement it is that low [s].
    pub contact_at: f64,
    /// Mass [kg] below which a tool behind the sensor is stable in free air, likewise.
    pub tool_mass: f64,
    /// Mass [kg] up to which it is, whatever the delay and the lag.
    pub safe_tool_mass: f64,
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
    /// [`ConfigError`] for a rate or cut-off that is not positive, a delay, load, lag, mass or damping that is negative, and a
    /// schedule of too many steps.
    pub fn certify(&self, conditions: &Conditions) -> Result<Vec<Certificate>, ConfigError> {
        let Conditions { rate, delay, load, cutoff, lag, contact } = *conditions;
        let within = |field, value: f64, min, max| {
            let fits = value.is_finite() && value >= min && value <= max;
            if fits { Ok(()) } else { Err(ConfigError::OutOfRange { field, value, min, max }) }
        };
        within("rate", rate, f64::MIN_POSITIVE, 1e6)?;
        // A step of a slow loop may be longer than any sensor is late.
        within("delay", delay, 0.0, rate.recip().max(10.0))?;
        within("load", load, 0.0, 1e9)?;
        cutoff.map_or(Ok(()), |cutoff| within("cutoff", cutoff, f64::MIN_POSITIVE, 1e9))?;
        within("lag", lag, 0.0, 1e3)?;
        within("tool mass", contact.tool, 0.0, 1e6)?;
        within("contact mass", contact.mass, 0.0, 1e6)?;
        within("contact damping", contact.damping, 0.0, 1e9)?;
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
    /// Stiffness from which on the force loop is unstable at the least stiffness and damping that the task allows [N/m].
    pub limit: f64,
}

/// Rates that are looked at for the least one [Hz].
const RATES: [f64; 2] = [1.0, 1e7];

impl Task {
    /// The least rate of a loop that measures the force of this task's contact and is stable at the least damping that the
    /// task allows [Hz]; none where no rate is enough, and without a contact.
    pub fn least_rate(&self) -> Option<f64> {
        let mut judged = self.clone();
        judged.sensor.get_or_insert_default();
        let stiffness = judged.measured_contact()?.stiffness;
        let mut stable = |rate: f64| {
            // A limit depends on the length of a step alone: one step is enough.
            (judged.rate, judged.duration) = (rate, rate.recip());
            judged.measured_contact().is_some_and(|contact| stiffness < contact.limit)
        };
        let [mut low, mut high] = RATES;
        if stable(low) {
            return Some(low);
        }
        if !stable(high) {
            return None;
        }
        while high > low * (1.0 + 1e-9) {
            let middle = (low * high).sqrt();
            *(if stable(middle) { &mut high } else { &mut low }) = middle;
        }
        Some(high)
    }

    /// The contact of a task whose force is measured, where it has both.
    pub fn measured_contact(&self) -> Option<MeasuredContact> {
        let contact = self.contact.as_ref()?;
        let axis = self.axis_index(contact.axis())?;
        if self.sensor.is_none() && self.actuator.is_none() {
            return None;
        }
        let steps = 2 * self.steps();
        let surface = |i: usize| contact.surface(i as f64 / steps as f64, self.axis[axis].start).stiffness;
        let delay = self.sensor.as_ref().map_or(0.0, |sensor| sensor.delay);
        let lag = self.actuator.as_ref().map_or(0.0, |actuator| actuator.lag);
        let sampling = Conditions { lag, ..Conditions::new(self.rate, delay, 0.0) }.sampling();
        let mass = self.admittance.mass.as_ref().map(|mass| mass.of(axis));
        let around = ForceLoop::new(mass, self.stiffness.min.of(axis), self.damping.min.of(axis), &sampling).ok()?;
        let (limit, _) = around.stiffness_limit(&Contact::default());
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
        // The share of offset and velocity before a step in the offset at the end.
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

/// What the force loop can stand at the worst of the instants looked at.
struct WorstLoop {
    stiffness: f64,
    case: Case,
    step: usize,
    tool_mass: f64,
    safe_tool_mass: f64,
}

fn worst_loop(gains: &[(f64, f64)], mass: Option<f64>, conditions: &Conditions) -> Result<WorstLoop, ConfigError> {
    let steps = 0..gains.len();
    let softest = steps.clone().min_by(|&a, &b| gains[a].1.total_cmp(&gains[b].1));
    let stiffest = steps.max_by(|&a, &b| gains[a].0.total_cmp(&gains[b].0));
    let even = (0..LOOPS).map(|i| i * (gains.len() - 1) / (LOOPS - 1));
    let endless = f64::INFINITY;
    let mut worst =
        WorstLoop { stiffness: endless, case: Case::Carried, step: 0, tool_mass: endless, safe_tool_mass: endless };
    for step in softest.into_iter().chain(stiffest).chain(even) {
        let (stiffness, damping) = gains[step];
        let around = ForceLoop::new(mass, stiffness, damping, &conditions.sampling())?;
        let (stiffness, case) = around.stiffness_limit(&conditions.contact);
        if stiffness < worst.stiffness {
            worst = WorstLoop { stiffness, case, step, ..worst };
        }
        worst.tool_mass = worst.tool_mass.min(around.tool_mass_limit());
        worst.safe_tool_mass = worst.safe_tool_mass.min(around.safe_tool_mass());
    }
    Ok(worst)
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
            let [profile] = skill.at(skill.phase().at((step as f64 + 0.5) * h).s);
            (profile.stiffness, profile.damping)
        })
        .collect();
    let [axis] = skill.axes();
    let least_damping = gains.iter().map(|gain| gain.1).fold(f64::INFINITY, f64::min);

    let (decay, offset) = match mass {
        Some(mass) => {
            let law = Inertial::new(mass, axis.stiffness.max(), axis.damping.max(), h)?;
            (inertial_decay(gains.iter().copied(), mass, h), largest_inertial_offset(&gains, &law, conditions.load, h))
        }
        None => (None, largest_offset(gains.iter().copied(), conditions.load, h)),
    };
    let worst = worst_loop(&gains, mass, conditions)?;
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
        contact_stiffness: worst.stiffness,
        contact_case: worst.case,
        contact_at: worst.step as f64 * h,
        tool_mass: worst.tool_mass,
        safe_tool_mass: worst.safe_tool_mass,
        peak_velocity: velocity,
        peak_acceleration: acceleration,
        rest_distance: rest,
    })
}
