//! The update of PI2 in groups of rollouts and tiles of steps, in scratch that are used again.
//!
//! With the table P (steps x K), the exploration E (K x parameters) and `a_{t,j}` the normalised (N-t) psi_{t,j}, over
//! the basis' length where projected:
//! ```text
//! projected:  along_t = phi_t . (P E)_t,  [dw]_j = sum_t a_{t,j} phi_{t,j} along_t      else  [dw]_j = sum_t a_{t,j} (P E)_{t,j}
//! ```
//! What belongs to a rollout mostly stays with the thread that works on it. Groups tell each other little: the least and
//! most S of each step, then the sum of its weights, then their parts of dw; ranks and effective sizes alone need all S.
//! Groups are joined two halves at a time, always the same halves: the same bits for any number of threads.

use hpf_core::Real;
use rayon::prelude::*;

use super::bases::Bases;
use super::group::{Group, MEMBERS, Pass, Weights, Work};
use super::{Batch, Credit};
use crate::instructions::{Instructions, NullaryFnOnce};
use crate::weighting::{Pack, Ranking, Scale};
use crate::{Cost, Temperature};

/// Costs of steps from which on threads share an update: fewer cost more time to hand over than to work on.
const SHARED: usize = 16_000;
/// Tiles in which one thread compares rollouts of all groups at a time, where that takes long.
const TILES: usize = 8;

/// Scratch memory of an update.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    groups: Vec<Group>,
    /// How costs weigh: by the scale of each tile, or by rank in each tile of each group.
    scales: Vec<Scale>,
    ranks: Vec<[Pack; MEMBERS]>,
    ranking: Ranking,
}

/// What an update is made from.
#[derive(Clone, Copy)]
pub(super) struct Inputs<'a> {
    pub(super) bases: &'a Bases,
    pub(super) steps: usize,
    pub(super) temperature: Temperature,
    pub(super) credit: Credit,
    pub(super) weights: &'a [f64],
    pub(super) batch: &'a Batch,
    pub(super) costs: &'a [Cost],
    pub(super) instructions: Instructions,
}

impl Inputs<'_> {
    /// Whether all steps answer for the whole rollout.
    pub(super) fn is_total(&self) -> bool {
        self.credit == Credit::Total
    }

    /// Tiles of steps that have an S of their own.
    pub(super) fn rows(&self) -> usize {
        if self.is_total() { 1 } else { self.bases.tiles() }
    }

    /// Threads that share the work.
    fn threads(&self) -> usize {
        if self.costs.len() * self.steps < SHARED { 1 } else { rayon::current_num_threads() }
    }
}

impl Scratch {
    /// Notes which costs are finite and sums them up over the steps; `false` where none is finite.
    pub(super) fn take(&mut self, inputs: &Inputs<'_>) -> bool {
        self.groups.resize_with(inputs.costs.len().div_ceil(MEMBERS), Group::default);
        each(&mut self.groups, inputs, Pass::Gather);
        self.kept().next().is_some()
    }

    /// The rollouts whose costs are finite.
    pub(super) fn kept(&self) -> impl Iterator<Item = usize> + '_ {
        let members = self.groups.iter().flat_map(|group| group.is_kept);
        members.enumerate().filter(|(_, is_kept)| *is_kept).map(|(k, _)| k)
    }

    /// Works out the change of the parameters from what was taken.
    pub(super) fn improve(&mut self, inputs: &Inputs<'_>) {
        let count = self.kept().count();
        let Self { groups, scales, ranks, ranking } = self;
        let rows = inputs.rows();
        let least = core::mem::take(&mut groups[0].least);
        let most = core::mem::take(&mut groups[0].most);
        let (temperature, extremes) = (inputs.temperature, [&least[..], &most[..]]);
        let compare = |first: usize, compared: Compared<'_>| {
            inputs.instructions.run(Compare { temperature, groups, extremes, first, compared });
        };
        let tiles = if inputs.threads() > 1 { TILES } else { rows };
        let weights = match temperature {
            Temperature::Rank => {
                ranking.set(count);
                ranks.resize(groups.len() * rows, [Pack::ZERO; MEMBERS]);
                let parts = ranks.par_chunks_mut(tiles * groups.len()).enumerate();
                parts.for_each(|(i, ranks)| compare(i * tiles, Compared::Ranks(ranking, ranks)));
                Weights::Ranks(ranks, groups.len())
            }
            Temperature::EffectiveSize(_) => {
                scales.resize(rows, Scale::default());
                let parts = scales.par_chunks_mut(tiles).enumerate();
                parts.for_each(|(i, scales)| compare(i * tiles, Compared::Scales(scales)));
                Weights::Scales(scales)
            }
            Temperature::Range(_) | Temperature::Lambda(_) => Weights::Extremes(temperature, extremes),
        };
        each(groups, inputs, Pass::Weigh(weights));
        (groups[0].least, groups[0].most) = (least, most);
        let sums = core::mem::take(&mut groups[0].sums);
        each(groups, inputs, Pass::Improve(&sums));
        groups[0].sums = sums;
    }

    /// The change of each parameter.
    pub(super) fn changes(&self) -> &[f64] {
        &self.groups[0].change
    }
}

/// One stage of all groups; what they find is joined in the first.
fn each(groups: &mut [Group], inputs: &Inputs<'_>, stage: Pass<'_>) {
    part(groups, 0, inputs, stage, inputs.threads().next_power_of_two());
}

/// [`each`] of the groups from `first` on, in so many parts at the same time.
fn part(groups: &mut [Group], first: usize, inputs: &Inputs<'_>, stage: Pass<'_>, parts: usize) {
    if parts > 1 && groups.len() > 1 {
        let half = half(groups);
        let (left, right) = groups.split_at_mut(half);
        let on_right = || part(right, first + half, inputs, stage, parts / 2);
        rayon::join(|| part(left, first, inputs, stage, parts / 2), on_right);
        stage.join(&mut left[0], &right[0]);
    } else {
        inputs.instructions.run(Work { inputs, stage, first, groups });
        join(groups, stage);
    }
}

/// Joins what was found of each group in the first of them.
fn join(groups: &mut [Group], stage: Pass<'_>) {
    if groups.len() > 1 {
        let (left, right) = groups.split_at_mut(half(groups));
        join(left, stage);
        join(right, stage);
        stage.join(&mut left[0], &right[0]);
    }
}

/// Where groups are split and joined.
fn half(groups: &[Group]) -> usize {
    groups.len() / 2
}

/// How costs weigh, found by comparing those of all groups, for compilation in every set of instructions.
struct Compare<'a> {
    temperature: Temperature,
    groups: &'a [Group],
    extremes: [&'a [Pack]; 2],
    /// The first of the tiles.
    first: usize,
    compared: Compared<'a>,
}

enum Compared<'a> {
    Scales(&'a mut [Scale]),
    Ranks(&'a Ranking, &'a mut [[Pack; MEMBERS]]),
}

impl NullaryFnOnce for Compare<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { temperature, groups, extremes: [least, most], first, compared } = self;
        match compared {
            Compared::Scales(scales) => {
                for (row, scale) in (first..).zip(scales) {
                    let costs = groups.iter().flat_map(|group| group.kept(row));
                    *scale = temperature.scale(least[row], most[row], costs);
                }
            }
            Compared::Ranks(ranking, ranks) => {
                for (row, ranks) in (first..).zip(ranks.chunks_exact_mut(groups.len())) {
                    ranking.weigh(|| groups.iter().flat_map(move |group| &group.shares[row]), ranks.as_flattened_mut());
                }
            }
        }
    }
}
