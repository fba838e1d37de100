//! Rollouts for learning: costs without traces, [`LANES`] rollouts at a time in the best instructions there are.

use hpf_core::{Lanes, Real};
use hpf_learn::instructions::NullaryFnOnce;
use hpf_learn::{Cost, Draws, Parameters};

use super::Simulation;
use super::profiles::{Constant, Rowwise};
use super::scenario::Scenario;
use crate::cost::CostAccumulator;
use crate::trace::Trace;

/// Rollouts that step together: one register of AVX-512, two of AVX2, four of SSE2 or NEON.
pub(crate) const LANES: usize = 8;

/// What a thread makes rollouts in; reused, it allocates nothing.
#[derive(Debug, Default)]
pub struct Workspace {
    /// The motion whose signals were measured last.
    pub trace: Option<Trace>,
    /// What its rollouts meet, and by which draws.
    pub(super) scenarios: Option<(Draws, Vec<Scenario>)>,
    /// Costs of one draw, and signals of one draw after the other.
    pub(super) costs: Vec<Cost>,
    pub(super) signals: Vec<Vec<f64>>,
    /// One entry per parameter.
    weights: Vec<Lanes<LANES>>,
    /// One entry per step.
    running: Vec<[f64; LANES]>,
}

impl Simulation {
    /// Makes a rollout of each of `parameters` and writes what it cost: the same bits together as alone.
    pub(crate) fn roll_costs(
        &self,
        (scenario, draw): (&Scenario, usize),
        parameters: &[Parameters<'_>],
        workspace: &mut Workspace,
        costs: &mut [Cost],
    ) {
        if !self.cost.is_by_axis() || self.records_noise() {
            let trace = workspace.trace.get_or_insert_with(|| self.blank_trace());
            for (&parameters, cost) in parameters.iter().zip(costs) {
                self.rollout_in(scenario, parameters, trace);
                self.add_record_noise(trace, Self::numbers_of(parameters, draw));
                self.cost_into(trace, cost);
            }
            return;
        }
        for (parameters, costs) in parameters.chunks(LANES).zip(costs.chunks_mut(LANES)) {
            let is_constant = |parameters: &Parameters<'_>| matches!(parameters, Parameters::Constant(_));
            if parameters.iter().all(is_constant) {
                self.roll_together(scenario, parameters, workspace, costs);
            } else {
                parameters
                    .iter()
                    .zip(costs)
                    .for_each(|(&parameters, cost)| self.roll_alone(scenario, parameters, cost));
            }
        }
    }

    /// At most [`LANES`] rollouts, the parameters of each constant.
    fn roll_together(
        &self,
        scenario: &Scenario,
        parameters: &[Parameters<'_>],
        workspace: &mut Workspace,
        costs: &mut [Cost],
    ) {
        let Workspace { weights, running, .. } = workspace;
        weights.resize(self.parameter_count(), Lanes::ZERO);
        // Idle lanes repeat the first rollout: numbers as ordinary as its own.
        for lane in 0..LANES {
            let row = parameters.get(lane).unwrap_or(&parameters[0]).at(0);
            weights.iter_mut().zip(row).for_each(|(slot, weight)| slot.0[lane] = *weight);
        }
        running.clear();
        running.resize(self.step_count(), [0.0; LANES]);
        let mut accumulator = CostAccumulator::new(running);
        self.instructions.run(LaneBatch { simulation: self, scenario, weights, accumulator: &mut accumulator });
        for (lane, cost) in costs.iter_mut().enumerate() {
            accumulator.write(lane, cost);
        }
    }

    /// One rollout whose parameters may change with every step.
    fn roll_alone(&self, scenario: &Scenario, parameters: Parameters<'_>, cost: &mut Cost) {
        cost.running.clear();
        cost.running.resize(self.step_count(), 0.0);
        let mut accumulator = CostAccumulator::new(cost.running.as_chunks_mut::<1>().0);
        for (a, axis) in self.axes.iter().enumerate() {
            let profiles = self.rowwise(axis, parameters);
            self.roll_axis(
                a,
                self.priced_steps,
                &axis.alone,
                &profiles,
                &scenario.axes[a],
                self.cost.meter(a, &mut accumulator),
            );
        }
        let (terms, terminal) = accumulator.sums(0);
        cost.terminal = terminal;
        cost.terms.clear();
        cost.terms.extend(terms);
    }

    pub(super) fn rowwise<'a>(&'a self, axis: &super::AxisModel, parameters: Parameters<'a>) -> Rowwise<'a> {
        Rowwise { tables: &self.tables, parameters, ends: axis.parameters, steps: self.drive.len() }
    }
}

/// All axes of [`LANES`] rollouts, for compilation in every set of instructions.
struct LaneBatch<'a, 'b> {
    simulation: &'a Simulation,
    scenario: &'a Scenario,
    weights: &'a [Lanes<LANES>],
    accumulator: &'a mut CostAccumulator<'b, LANES>,
}

impl NullaryFnOnce for LaneBatch<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { simulation, scenario, weights, accumulator } = self;
        for (a, axis) in simulation.axes.iter().enumerate() {
            let [start, movement_end, stiffness_end, damping_end, end] = axis.parameters;
            let profiles = Constant {
                tables: &simulation.tables,
                movement: &weights[start..movement_end],
                stiffness: &weights[movement_end..stiffness_end],
                damping: &weights[stiffness_end..damping_end],
                goal: &weights[damping_end..end],
            };
            let (steps, meter) = (simulation.priced_steps, simulation.cost.meter(a, accumulator));
            simulation.roll_axis(a, steps, &axis.lanes, &profiles, &scenario.axes[a], meter);
        }
    }
}
