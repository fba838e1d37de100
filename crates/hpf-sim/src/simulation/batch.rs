//! Rollouts for learning: costs without traces, [`LANES`] rollouts at a time in the best instructions there are.

use hpf_core::{Lanes, Real};
use hpf_learn::instructions::NullaryFnOnce;
use hpf_learn::{Cost, Draws, Parameters};

use super::Simulation;
use super::motion::{Sample, Sink};
use super::profiles::{Constant, Rowwise};
use super::scenario::Scenario;
use crate::cost::{CostAccumulator, Priced};
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
    /// What costs are taken of, axis by axis, one entry per sample.
    record: Vec<Priced<LANES>>,
    /// Deviation and contact force of the axis that touches something, one entry per sample.
    contact: Vec<[Lanes<LANES>; 2]>,
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
                // What is not priced is not made.
                let trace = workspace.trace.get_or_insert_with(|| self.blank_trace());
                for (&parameters, cost) in parameters.iter().zip(costs) {
                    self.rollout_over(self.priced_steps, scenario, parameters, trace);
                    self.cost_into(trace, cost);
                }
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
        let Workspace { weights, record, contact, running, .. } = workspace;
        weights.resize(self.parameter_count(), Lanes::ZERO);
        // Idle lanes repeat the first rollout: numbers as ordinary as its own.
        for lane in 0..LANES {
            let row = parameters.get(lane).unwrap_or(&parameters[0]).at(0);
            weights.iter_mut().zip(row).for_each(|(slot, weight)| slot.0[lane] = *weight);
        }
        running.clear();
        running.resize(self.step_count(), [0.0; LANES]);
        let samples = self.priced_steps + 1;
        record.resize(self.axes.len() * samples, Priced::ZERO);
        contact.resize(self.contact.as_ref().map_or(0, |_| samples), [Lanes::ZERO; 2]);
        let mut accumulator = CostAccumulator::new(running);
        let record = Record { samples, record, contact };
        let batch = LaneBatch { simulation: self, scenario, weights, record, accumulator: &mut accumulator };
        self.instructions.run(batch);
        for (lane, cost) in costs.iter_mut().enumerate() {
            accumulator.write(lane, cost);
        }
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
    record: Record<'a>,
    accumulator: &'a mut CostAccumulator<'b, LANES>,
}

impl NullaryFnOnce for LaneBatch<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { simulation, scenario, weights, mut record, accumulator } = self;
        simulation.roll(
            simulation.priced_steps,
            scenario,
            |axis| {
                let [start, movement_end, stiffness_end, damping_end, end] = axis.parameters;
                let profiles = Constant {
                    tables: &simulation.tables,
                    movement: &weights[start..movement_end],
                    stiffness: &weights[movement_end..stiffness_end],
                    damping: &weights[stiffness_end..damping_end],
                    goal: &weights[damping_end..end],
                };
                (&axis.lanes, profiles)
            },
            &mut record,
        );
        // Axis after axis: the order in which costs are added up.
        let Record { samples, record, contact } = record;
        let touching = simulation.contact.as_ref().map(|contact| contact.axis);
        for (a, record) in record.chunks_exact(samples).enumerate() {
            let mut meter = simulation.cost.meter(a, accumulator);
            if touching == Some(a) {
                let samples = record.iter().zip(&*contact).enumerate();
                samples.for_each(|(i, (sample, contact))| meter.take(i, sample, Some(*contact)));
            } else {
                record.iter().enumerate().for_each(|(i, sample)| meter.take(i, sample, None));
            }
        }
    }
}

/// Keeps what costs are taken of.
struct Record<'a> {
    /// Of each axis.
    samples: usize,
    record: &'a mut [Priced<LANES>],
    /// Of the axis that touches something.
    contact: &'a mut [[Lanes<LANES>; 2]],
}

impl Sink<LANES> for &mut Record<'_> {
    #[inline(always)]
    fn take(&mut self, a: usize, i: usize, sample: &Sample<LANES>) {
        let Sample { position, velocity, stiffness, damping, contact, .. } = *sample;
        self.record[a * self.samples + i] = Priced { position, velocity, stiffness, damping };
        if let Some(contact) = contact {
            self.contact[i] = contact;
        }
    }
}
