//! What of a motion is decided by its policy alone: the reference and the gains.

use hpf_core::{Lanes, Real as _};
use hpf_learn::Parameters;

use super::Simulation;
use super::motion::{Knot, Sample, Sink, Tool, roll};

/// Reference and gains of one axis over a motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Planned {
    /// At samples [m].
    pub(crate) position: Vec<f64>,
    /// At samples [m/s].
    pub(crate) velocity: Vec<f64>,
    /// At half steps [N/m].
    pub(crate) stiffness: Vec<f64>,
    /// At half steps [N s/m].
    pub(crate) damping: Vec<f64>,
}

/// A tool that goes nowhere and notes the gains at mid-steps.
struct Still<'a>(&'a mut Vec<[f64; 2]>);

impl Tool<1> for Still<'_> {
    fn sample(&self, _: usize, now: &Knot<1>) -> Sample<1> {
        Sample {
            reference_position: now.reference_position(),
            reference_velocity: now.reference_velocity,
            position: Lanes::ZERO,
            velocity: Lanes::ZERO,
            force: Lanes::ZERO,
            stiffness: now.stiffness,
            damping: now.damping,
            contact: None,
        }
    }

    fn advance(&mut self, _: usize, _: &Knot<1>, _: &Knot<1>, [stiffness, damping]: [Lanes<1>; 2]) {
        self.0.push([stiffness.to_f64(), damping.to_f64()]);
    }
}

/// Notes what samples say of the plan.
struct Noting<'a>(&'a mut Vec<[f64; 4]>);

impl Sink<1> for Noting<'_> {
    fn take(&mut self, _: usize, sample: &Sample<1>) {
        let Sample { reference_position, reference_velocity, stiffness, damping, .. } = *sample;
        self.0.push([reference_position, reference_velocity, stiffness, damping].map(|lanes| lanes.to_f64()));
    }
}

impl Planned {
    /// This plan less `other`; a signal in which nothing is left is empty.
    pub(crate) fn less(&self, other: &Self) -> Self {
        let less = |a: &[f64], b: &[f64]| -> Vec<f64> {
            let rest: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
            if rest.iter().any(|x| *x != 0.0) { rest } else { Vec::new() }
        };
        Self {
            position: less(&self.position, &other.position),
            velocity: less(&self.velocity, &other.velocity),
            stiffness: less(&self.stiffness, &other.stiffness),
            damping: less(&self.damping, &other.damping),
        }
    }

    /// The sum of position, velocity, stiffness and damping at sample `i`, each times its factor.
    #[inline]
    pub(crate) fn at(&self, i: usize, factors: &[f64]) -> f64 {
        let mut sum = 0.0;
        if let (Some(position), Some(velocity)) = (self.position.get(i), self.velocity.get(i)) {
            sum += factors[0] * position + factors[1] * velocity;
        }
        if let Some(stiffness) = self.stiffness.get(2 * i) {
            sum += factors[2] * stiffness;
        }
        if let Some(damping) = self.damping.get(2 * i) {
            sum += factors[3] * damping;
        }
        sum
    }

    /// The sum of stiffness and damping at the middle of step `i`, each times its factor.
    #[inline]
    pub(crate) fn at_middle(&self, i: usize, factors: &[f64]) -> f64 {
        let stiffness = self.stiffness.get(2 * i + 1).map_or(0.0, |stiffness| factors[0] * stiffness);
        stiffness + self.damping.get(2 * i + 1).map_or(0.0, |damping| factors[1] * damping)
    }
}

/// What a model of the environment may know: the law of the motion, and what it costs.
impl Simulation {
    /// Number of axes.
    pub(crate) fn axis_count(&self) -> usize {
        self.axes.len()
    }

    /// The parameters of axis `a`, among all.
    pub(crate) fn axis_parameters(&self, a: usize) -> core::ops::Range<usize> {
        let [start, .., end] = self.axes[a].parameters;
        start..end
    }

    /// Whether the tool of axis `a` follows the law of first order, without a lag.
    pub(crate) fn has_first_order_law(&self, a: usize) -> bool {
        self.axes[a].inertial.is_none() && self.task.actuator.is_none()
    }

    /// Whether the force is read once a step and held over it.
    pub(crate) fn is_sampled(&self) -> bool {
        self.robot.is_some()
    }

    /// Samples of a motion that its cost is taken of: with the rest time where rest costs something.
    pub(crate) fn priced_samples(&self) -> usize {
        self.priced_steps + 1
    }

    /// Length of a step [s].
    pub(crate) fn step_time(&self) -> f64 {
        self.dt
    }

    /// Largest stiffness of the policy on axis `a` [N/m].
    pub(crate) fn largest_stiffness(&self, a: usize) -> f64 {
        self.axes[a].largest_stiffness
    }

    /// Largest stiffness [N/m] and smallest damping [N s/m] of the policy on axis `a`.
    pub(crate) fn softest(&self, a: usize) -> [f64; 2] {
        let per_axis = self.blocks.len() / self.axes.len();
        [self.largest_stiffness(a), self.blocks[per_axis * a + 2].min]
    }

    /// Scale of the forcing term of axis `a` [axis unit].
    pub(crate) fn forcing_scale(&self, a: usize) -> f64 {
        self.axes[a].alone.forcing_scale()
    }

    /// The axis that the task's contact is on, and +1 or -1 for the way that its deviation is counted.
    pub(crate) fn touched(&self) -> Option<(usize, f64)> {
        self.contact.as_ref().map(|contact| (contact.axis, contact.surfaces[0].direction))
    }

    /// Appends the signals of axis `a` of `trace`.
    pub(crate) fn axis_signals_into(&self, a: usize, trace: &crate::trace::Trace, signals: &mut Vec<f64>) {
        self.cost.axis_signals(a, trace, signals);
    }

    /// The plan of axis `a` with its parameters `weights`.
    pub(crate) fn planned(&self, a: usize, weights: &[f64]) -> Planned {
        let model = &self.axes[a];
        let [start, .., end] = model.parameters;
        let mut all = vec![0.0; self.parameter_count()];
        all[start..end].copy_from_slice(weights);
        let profiles = self.rowwise(model, Parameters::Constant(&all));
        let (mut middle, mut samples) = (Vec::new(), Vec::new());
        roll(&model.alone, &self.drive[..self.priced_steps], &profiles, Still(&mut middle), Noting(&mut samples));
        let mut planned = Planned::default();
        for (i, [position, velocity, stiffness, damping]) in samples.into_iter().enumerate() {
            planned.position.push(position);
            planned.velocity.push(velocity);
            planned.stiffness.push(stiffness);
            planned.damping.push(damping);
            if let Some([stiffness, damping]) = middle.get(i) {
                planned.stiffness.push(*stiffness);
                planned.damping.push(*damping);
            }
        }
        planned
    }
}
