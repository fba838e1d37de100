//! The cost of a motion while it is made: a sample at a time, for several rollouts at once.

use hpf_core::{Lanes, Real};
use hpf_learn::Cost;

use super::{Approach, CostModel, Term};
use crate::simulation::{Sample, Sink};
use crate::task::{REST_VELOCITY_TIME, Task};
use crate::trace::Trace;

/// What one axis is measured by; the factor of a running term holds the half, the weight and the step.
#[derive(Clone, Debug)]
pub(super) struct AxisPrices {
    steps: usize,
    goal: f64,
    half_goal_weight: f64,
    half_end_velocity_weight: f64,
    /// Steps of the rest time that costs something.
    rest_steps: usize,
    /// Of a square at a sample of the rest time; half as much at both its ends.
    rest: f64,
    /// Of the square of the velocity there.
    rest_velocity: f64,
    /// In the order of time.
    via: Vec<ViaPrice>,
    half_via_weight: f64,
    /// Of the square of a change of velocity.
    acceleration: f64,
    /// Of the squares at both ends of a step together, as those below.
    stiffness: f64,
    damping: f64,
    tracking: f64,
    contact_force: f64,
    set_point: f64,
}

/// A via point among the samples.
#[derive(Clone, Debug)]
struct ViaPrice {
    /// The sample before it.
    before: usize,
    /// Where it lies between that and the next, from 0 to 1.
    share: f64,
    /// The step that answers for it.
    step: usize,
    position: f64,
}

impl AxisPrices {
    pub(super) fn new(task: &Task, a: usize) -> Self {
        let (steps, cost) = (task.steps(), &task.cost);
        let dt = task.duration / steps as f64;
        let mut via: Vec<_> = task
            .via_point
            .iter()
            .filter_map(|via| {
                let time = via.time?;
                let at = (time / dt).clamp(0.0, steps as f64);
                let before = (at.floor() as usize).min(steps.saturating_sub(1));
                // The step that ends at or after the via point answers for it, with all before it.
                let step = ((time / dt - 1e-6).ceil() as usize).clamp(1, steps) - 1;
                Some(ViaPrice { before, share: at - before as f64, step, position: via.position[a] })
            })
            .collect();
        via.sort_by_key(|via| via.before);
        let trapezoid = |weight: f64| 0.25 * weight * dt;
        let rest = 0.5 * task.rest_weight(a) * dt;
        let contact = task.contact.as_ref().filter(|contact| contact.axis() == task.axis[a].name);
        let touching = |weight: f64| contact.map_or(0.0, |_| trapezoid(weight));
        Self {
            steps,
            goal: task.axis[a].goal,
            half_goal_weight: 0.5 * cost.goal.of(a),
            half_end_velocity_weight: 0.5 * cost.end_velocity.of(a),
            rest_steps: task.rest_steps(),
            rest,
            rest_velocity: rest * (REST_VELOCITY_TIME * task.duration).powi(2),
            via,
            half_via_weight: 0.5 * cost.via_point.of(a),
            acceleration: 0.5 * cost.acceleration.of(a) / dt,
            stiffness: trapezoid(cost.stiffness.of(a)),
            damping: trapezoid(cost.damping.of(a)),
            tracking: touching(cost.tracking),
            contact_force: touching(cost.contact_force),
            set_point: contact.map_or(0.0, |contact| contact.surface(0.0, task.axis[a].start).set_point),
        }
    }
}

/// What several rollouts cost, one per lane.
pub(crate) struct CostAccumulator<'a, const N: usize> {
    running: &'a mut [[f64; N]],
    terms: [Lanes<N>; Term::ALL.len()],
    terminal: Lanes<N>,
}

impl<'a, const N: usize> CostAccumulator<'a, N> {
    /// An empty one; `running` holds a zero for every step.
    pub(crate) fn new(running: &'a mut [[f64; N]]) -> Self {
        Self { running, terms: [Lanes::ZERO; Term::ALL.len()], terminal: Lanes::ZERO }
    }

    /// What the rollout in `lane` cost by term, and at its end.
    pub(crate) fn sums(&self, lane: usize) -> ([f64; Term::ALL.len()], f64) {
        (self.terms.map(|term| term.0[lane]), self.terminal.0[lane])
    }

    /// Writes what the rollout in `lane` cost.
    pub(crate) fn write(&self, lane: usize, cost: &mut Cost) {
        let (terms, terminal) = self.sums(lane);
        cost.running.clear();
        cost.running.extend(self.running.iter().map(|row| row[lane]));
        cost.terms.clear();
        cost.terms.extend(terms);
        cost.terminal = terminal;
    }
}

/// Adds the samples of one axis to an accumulator.
pub(crate) struct Meter<'m, 'b, const N: usize> {
    prices: &'m AxisPrices,
    accumulator: &'m mut CostAccumulator<'b, N>,
    /// What is to be added to the running terms when all samples are taken.
    sums: [Lanes<N>; RUNNING.len()],
    before: Before<N>,
    /// The via points that are still to come.
    via: &'m [ViaPrice],
}

/// The terms that every step adds to: acceleration, and the squares of a sample.
const RUNNING: [Term; 5] = [Term::Acceleration, Term::Stiffness, Term::Damping, Term::Tracking, Term::ContactForce];

/// The sample before.
#[derive(Clone, Copy)]
struct Before<const N: usize> {
    position: Lanes<N>,
    velocity: Lanes<N>,
    /// Squares of stiffness, damping, deviation and force error.
    squares: [Lanes<N>; 4],
}

impl CostModel {
    /// What adds the samples of axis `a` to `accumulator`.
    #[inline(always)]
    pub(crate) fn meter<'m, 'b, const N: usize>(
        &'m self,
        a: usize,
        accumulator: &'m mut CostAccumulator<'b, N>,
    ) -> Meter<'m, 'b, N> {
        let prices = &self.axes[a];
        let zero = Lanes::ZERO;
        let before = Before { position: zero, velocity: zero, squares: [zero; 4] };
        Meter { prices, accumulator, sums: [zero; RUNNING.len()], before, via: &prices.via }
    }

    /// Writes what `trace` costs.
    pub(crate) fn evaluate(&self, trace: &Trace, cost: &mut Cost) {
        cost.running.clear();
        cost.running.resize(trace.steps(), 0.0);
        let mut accumulator = CostAccumulator::new(cost.running.as_chunks_mut::<1>().0);
        for (a, axis) in trace.axes.iter().enumerate() {
            let contact = trace.contact.as_ref().filter(|contact| contact.axis == a);
            let mut meter = self.meter(a, &mut accumulator);
            for i in 0..=trace.steps() + trace.rest_steps {
                let lane = |signal: &[f64]| Lanes([signal[i]]);
                meter.take(
                    i,
                    &Sample {
                        reference_position: lane(&axis.reference_position),
                        reference_velocity: lane(&axis.reference_velocity),
                        position: lane(&axis.position),
                        velocity: lane(&axis.velocity),
                        force: lane(&axis.force),
                        stiffness: lane(&axis.stiffness),
                        damping: lane(&axis.damping),
                        contact: contact.map(|contact| [lane(&contact.deviation), lane(&contact.force)]),
                    },
                );
            }
        }
        let (terms, terminal) = accumulator.sums(0);
        cost.terminal = terminal;
        cost.terms.clear();
        cost.terms.extend(terms);
        for via in &self.free_via {
            let near = Approach::nearest(via, trace);
            let price = self.via_distance_weight * near.outside;
            // The step that ends there answers for it, with all before it.
            cost.running[near.sample.max(1) - 1] += price;
            cost.terms[Term::ViaPoint as usize] += price;
        }
    }
}

impl<const N: usize> Meter<'_, '_, N> {
    /// The running costs of the step that ends here.
    #[inline(always)]
    fn charge_step(&mut self, step: usize, change: Lanes<N>, squares: &[Lanes<N>; 4]) {
        let prices = self.prices;
        let both_ends = |j: usize| self.before.squares[j] + squares[j];
        let terms = [
            (prices.acceleration, change * change),
            (prices.stiffness, both_ends(0)),
            (prices.damping, both_ends(1)),
            (prices.tracking, both_ends(2)),
            (prices.contact_force, both_ends(3)),
        ];
        let mut all = Lanes(self.accumulator.running[step]);
        for (sum, (factor, squares)) in self.sums.iter_mut().zip(terms) {
            // A weight of zero leaves a term out: it does not make a NaN of an infinity.
            if factor > 0.0 {
                let cost = Lanes::of(factor) * squares;
                *sum += cost;
                all += cost;
            }
        }
        self.accumulator.running[step] = all.0;
    }

    /// What sample `i` of the rest time costs.
    #[inline(always)]
    fn charge_rest(&mut self, i: usize, sample: &Sample<N>) {
        let prices = self.prices;
        let error = sample.position - Lanes::of(prices.goal);
        let (position, velocity) = (error * error, sample.velocity * sample.velocity);
        let share = if i == 0 || i == prices.rest_steps { 0.5 } else { 1.0 };
        let cost = Lanes::of(share * prices.rest) * position + Lanes::of(share * prices.rest_velocity) * velocity;
        self.accumulator.terminal += cost;
        self.accumulator.terms[Term::Rest as usize] += cost;
    }

    /// The via points passed between the sample before and `position`.
    #[inline(always)]
    fn charge_via(&mut self, i: usize, position: Lanes<N>) {
        while let [via, rest @ ..] = self.via
            && via.before + 1 == i
        {
            let passed = self.before.position + Lanes::of(via.share) * (position - self.before.position);
            let error = passed - Lanes::of(via.position);
            let cost = Lanes::of(self.prices.half_via_weight) * error * error;
            self.accumulator.running[via.step] = (Lanes(self.accumulator.running[via.step]) + cost).0;
            self.accumulator.terms[Term::ViaPoint as usize] += cost;
            self.via = rest;
        }
    }
}

impl<const N: usize> Sink<N> for Meter<'_, '_, N> {
    #[inline(always)]
    fn take(&mut self, i: usize, sample: &Sample<N>) {
        let steps = self.prices.steps;
        if i >= steps && self.prices.rest > 0.0 {
            self.charge_rest(i - steps, sample);
        }
        if i > steps {
            return;
        }
        let [deviation, force_error] = match sample.contact {
            Some([deviation, force]) => [deviation, force - Lanes::of(self.prices.set_point)],
            None => [Lanes::ZERO; 2],
        };
        let squares = [sample.stiffness, sample.damping, deviation, force_error].map(|signal| signal * signal);
        if i > 0 {
            self.charge_step(i - 1, sample.velocity - self.before.velocity, &squares);
            self.charge_via(i, sample.position);
        }
        if i == steps {
            let error = sample.position - Lanes::of(self.prices.goal);
            let goal = Lanes::of(self.prices.half_goal_weight) * error * error;
            let end_velocity = Lanes::of(self.prices.half_end_velocity_weight) * sample.velocity * sample.velocity;
            for (term, sum) in RUNNING.into_iter().zip(self.sums) {
                self.accumulator.terms[term as usize] += sum;
            }
            self.accumulator.terminal += goal + end_velocity;
            self.accumulator.terms[Term::Goal as usize] += goal;
            self.accumulator.terms[Term::EndVelocity as usize] += end_velocity;
        }
        self.before = Before { position: sample.position, velocity: sample.velocity, squares };
    }
}
