//! Rollouts over draws: a rollout of a task in which something is drawn is one motion for each draw. Its cost is their
//! mean; its signals are those of all motions, each over the root of their number.

use core::ops::Range;
use core::{mem, slice};

use hpf_learn::{Cost, Distance, Draws, Parameters, SignalGroup, SignalModel, Wants};

use super::scenario::{Scenario, Set};
use super::{Simulation, Workspace};
use crate::metrics::{Metric, over_draws};

/// The signals of `draws` motions, axis by axis, from the model of one motion.
pub(super) fn repeated(model: SignalModel, draws: usize) -> SignalModel {
    let SignalModel { groups, price, distances } = model;
    // A mean of distances: the weight is that of one draw, in the unit of signals over the root of their number.
    let share = (draws as f64).sqrt().recip();
    let of_draw = |k: usize, offsets: &Range<usize>| {
        let group =
            groups.iter().find(|group| group.signals.contains(&offsets.start)).expect("a group has each signal");
        let shift = (draws - 1) * group.signals.start + k * group.signals.len();
        offsets.start + shift..offsets.end + shift
    };
    let distance = |distance: &Distance, k: usize| Distance {
        weight: share * distance.weight,
        radius: share * distance.radius,
        offsets: distance.offsets.iter().map(|offsets| of_draw(k, offsets)).collect(),
    };
    let distances = distances.iter().flat_map(|of_one| (0..draws).map(move |k| distance(of_one, k))).collect();
    let whole = |group: &SignalGroup| SignalGroup {
        parameters: group.parameters.clone(),
        signals: draws * group.signals.start..draws * group.signals.end,
    };
    SignalModel { groups: groups.iter().map(whole).collect(), price, distances }
}

/// Adds `cost` to `mean`, over `count` motions; the first of them sets it.
pub(super) fn add_mean(mean: &mut Cost, cost: &Cost, first: bool, count: usize) {
    let share = 1.0 / count as f64;
    if first {
        mean.running.clear();
        mean.running.resize(cost.running.len(), 0.0);
        mean.terms.clear();
        mean.terms.resize(cost.terms.len(), 0.0);
        mean.terminal = 0.0;
    }
    mean.running.iter_mut().zip(&cost.running).for_each(|(mean, cost)| *mean += share * cost);
    mean.terms.iter_mut().zip(&cost.terms).for_each(|(mean, cost)| *mean += share * cost);
    mean.terminal += share * cost.terminal;
}

impl Simulation {
    /// What the motions of `draws` meet, kept in `kept` while the draws stay the same.
    fn scenarios<'w>(&'w self, draws: Draws, kept: &'w mut Option<(Draws, Vec<Scenario>)>) -> &'w [Scenario] {
        if !self.is_random {
            return slice::from_ref(&self.shown);
        }
        if kept.as_ref().is_none_or(|(of, _)| *of != draws) {
            let scenarios = Scenario::of_set(&self.task, Set::Learning(draws), self.task.draws()).collect();
            *kept = Some((draws, scenarios));
        }
        kept.as_ref().map_or(&[], |(_, scenarios)| scenarios)
    }

    /// Makes a rollout of each of `parameters` in every draw and writes what it cost.
    pub(crate) fn roll_draws(
        &self,
        draws: Draws,
        parameters: &[Parameters<'_>],
        workspace: &mut Workspace,
        costs: &mut [Cost],
    ) {
        let (mut kept, mut own) = (workspace.scenarios.take(), mem::take(&mut workspace.costs));
        match self.scenarios(draws, &mut kept) {
            [only] => self.roll_costs((only, 0), parameters, workspace, costs),
            several => {
                own.resize_with(costs.len(), Cost::default);
                for (i, scenario) in several.iter().enumerate() {
                    self.roll_costs((scenario, i), parameters, workspace, &mut own);
                    costs.iter_mut().zip(&own).for_each(|(mean, cost)| add_mean(mean, cost, i == 0, several.len()));
                }
            }
        }
        (workspace.scenarios, workspace.costs) = (kept, own);
    }

    /// Makes rollout `number` in every draw and writes what it cost and what is wanted of it, as recorded.
    pub(crate) fn observe_draws(
        &self,
        (draws, number): (Draws, usize),
        parameters: Parameters<'_>,
        wants: Wants,
        workspace: &mut Workspace,
        cost: &mut Cost,
        signals: &mut Vec<f64>,
    ) {
        let Workspace { trace, scenarios, signals: own, .. } = workspace;
        let trace = trace.get_or_insert_with(|| self.blank_trace());
        let scenarios = self.scenarios(draws, scenarios);
        let count = scenarios.len();
        own.resize_with(count, Vec::new);
        let mut one = Cost::default();
        for (i, (scenario, own)) in scenarios.iter().zip(own.iter_mut()).enumerate() {
            self.rollout_in(scenario, parameters, trace);
            self.add_record_noise(trace, [number as u64, i as u64]);
            self.cost_into(trace, &mut one);
            match count {
                1 => mem::swap(cost, &mut one),
                _ => add_mean(cost, &one, i == 0, count),
            }
            match wants {
                Wants::Motion => self.motion_into(trace, own),
                Wants::Signals => self.signals_into(trace, own),
                Wants::Costs => own.clear(),
            }
        }
        signals.clear();
        if wants != Wants::Signals {
            signals.extend(own.iter().flatten());
            return;
        }
        let share = (count as f64).sqrt().recip();
        for group in &self.signals.groups {
            let range = group.signals.start / count..group.signals.end / count;
            signals.extend(own.iter().flat_map(|own| &own[range.clone()]).map(|signal| share * signal));
        }
    }

    /// What the skill with `weights` costs and is measured by: over `evaluation_draws` motions, none of which learning
    /// has seen, where something is drawn. The cost is their mean.
    pub fn evaluate(&self, weights: &[f64]) -> (Cost, Vec<Metric>) {
        let count = self.task.evaluation_draws();
        let (mut trace, mut mean, mut one) = (self.blank_trace(), Cost::default(), Cost::default());
        let mut metrics = Vec::with_capacity(count);
        for (i, scenario) in Scenario::of_set(&self.task, Set::Evaluation, count).enumerate() {
            self.rollout_in(&scenario, Parameters::Constant(weights), &mut trace);
            self.cost_into(&trace, &mut one);
            add_mean(&mut mean, &one, i == 0, count);
            metrics.push(self.metrics(&trace));
        }
        (mean, over_draws(metrics))
    }
}
