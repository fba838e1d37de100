//! Some rollouts of an update of PI2: what they cost from each step on, weigh, and ask for.

use core::iter;
use core::ops::Range;

use hpf_core::{Lanes, Real};

use super::update::Inputs;
use crate::Temperature;
use crate::instructions::NullaryFnOnce;
use crate::weighting::{LANES, Pack, Scale, least, most};

/// Rollouts of a group: their weights in the steps of a tile fit into registers.
pub(super) const MEMBERS: usize = 8;

/// The rollouts, and scratch for what comes of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Group {
    /// Which take part: those that are there and cost a finite amount.
    pub(super) is_kept: [bool; MEMBERS],
    /// S of each tile of steps, then what it weighs, a pack of each rollout; of those that take no part NaN, then zero.
    pub(super) shares: Vec<[Pack; MEMBERS]>,
    /// Of each tile, and of all groups that were joined to this one, as the sums and the change below.
    pub(super) least: Vec<Pack>,
    pub(super) most: Vec<Pack>,
    pub(super) sums: Vec<Pack>,
    /// dw as far as it comes from these rollouts.
    pub(super) change: Vec<f64>,
    /// Of a block: eps of each parameter in all steps, or where it changes with them in those of a tile; and along of each
    /// tile, or where nothing is projected dw of each parameter, yet to be summed over the lanes.
    constant: Vec<[f64; MEMBERS]>,
    varying: Vec<[Pack; MEMBERS]>,
    along: Vec<Pack>,
}

/// What is done with a group, one after the other.
#[derive(Clone, Copy)]
pub(super) enum Pass<'a> {
    /// Sums up its costs.
    Gather,
    /// Turns them into weights.
    Weigh(Weights<'a>),
    /// Works out its part of dw, given the sum of all weights in each tile.
    Improve(&'a [Pack]),
}

/// How costs become weights.
#[derive(Clone, Copy)]
pub(super) enum Weights<'a> {
    /// By how far they are from the least, given least and most of each tile.
    Extremes(Temperature, [&'a [Pack]; 2]),
    /// By a scale for each tile.
    Scales(&'a [Scale]),
    /// By rank: for each tile those of all groups.
    Ranks(&'a [[Pack; MEMBERS]], usize),
}

impl Pass<'_> {
    /// Adds what was found of another group.
    pub(super) fn join(&self, group: &mut Group, other: &Group) {
        fn zip<T: Copy>(into: &mut [T], other: &[T], join: impl Fn(T, T) -> T) {
            into.iter_mut().zip(other).for_each(|(into, other)| *into = join(*into, *other));
        }
        match self {
            Self::Gather => {
                zip(&mut group.least, &other.least, least);
                zip(&mut group.most, &other.most, most);
            }
            Self::Weigh(_) => zip(&mut group.sums, &other.sums, |a, b| a + b),
            Self::Improve(_) => zip(&mut group.change, &other.change, |a, b| a + b),
        }
    }
}

/// A stage of some groups, for compilation in every set of instructions.
pub(super) struct Work<'a> {
    pub(super) inputs: &'a Inputs<'a>,
    pub(super) stage: Pass<'a>,
    /// Of the first among all groups.
    pub(super) first: usize,
    pub(super) groups: &'a mut [Group],
}

impl NullaryFnOnce for Work<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { inputs, stage, first, groups } = self;
        match stage {
            Pass::Gather => {
                for (index, group) in (first..).zip(groups) {
                    group.gather(inputs, index * MEMBERS);
                }
            }
            Pass::Weigh(weights) => {
                for (index, group) in (first..).zip(groups) {
                    group.weigh(weights, index);
                }
            }
            Pass::Improve(sums) => {
                for group in &mut *groups {
                    group.normalise(sums);
                }
                // All groups before the next block: its tables stay in the cache.
                for block in inputs.bases.blocks() {
                    for (index, group) in (first..).zip(&mut *groups) {
                        group.improve(inputs, index * MEMBERS, block);
                    }
                }
            }
        }
    }
}

// Loops over packs are written so that lanes are what is compiled to vectors: with `push`, with sums that have to be made
// in their order, or unrolled. Left to itself, the compiler gathers a lane of eight packs into a vector.
impl Group {
    /// The costs of tile `row` of those that take part.
    #[inline(always)]
    pub(super) fn kept(&self, row: usize) -> impl Iterator<Item = Pack> + Clone {
        let members = self.is_kept.iter().zip(&self.shares[row]);
        members.filter(|(is_kept, _)| **is_kept).map(|(_, share)| *share)
    }

    /// Takes the rollouts from `first` on.
    #[inline(always)]
    fn gather(&mut self, inputs: &Inputs<'_>, first: usize) {
        let Self { is_kept, shares, least: low, most: high, .. } = self;
        let nothing = Pack::of(f64::NAN);
        shares.clear();
        shares.resize(inputs.rows(), [nothing; MEMBERS]);
        *is_kept = [false; MEMBERS];
        for (i, cost) in inputs.costs[first..].iter().take(MEMBERS).enumerate() {
            // A cost of a total alone has no steps.
            let (whole, rest) = cost.running.get(..inputs.steps).unwrap_or_default().as_chunks::<LANES>();
            let mut last = [0.0; LANES];
            last[..rest.len()].copy_from_slice(rest);
            // A cost to go that cannot be told may lie behind others that can.
            let (mut to_go, mut is_sound) = (cost.terminal, cost.terminal.is_finite());
            for tile in (0..inputs.steps.div_ceil(LANES)).rev() {
                let mut sums = *whole.get(tile).unwrap_or(&last);
                for lane in (1..LANES).rev() {
                    sums[lane - 1] += sums[lane];
                }
                let sums = Lanes(sums) + Pack::of(to_go);
                is_sound &= sums.is_finite();
                to_go = sums.0[0];
                if let Some(shares) = shares.get_mut(tile) {
                    shares[i] = sums;
                }
            }
            is_kept[i] = is_sound;
            if !is_sound {
                shares.iter_mut().for_each(|shares| shares[i] = nothing);
            } else if inputs.is_total() {
                shares[0][i] = Pack::of(to_go);
            }
        }
        low.clear();
        high.clear();
        for shares in shares {
            low.push(shares.iter().fold(Pack::of(f64::INFINITY), |low, share| least(low, *share)));
            high.push(shares.iter().fold(Pack::of(f64::NEG_INFINITY), |high, share| most(high, *share)));
        }
    }

    /// Turns S into weights.
    #[inline(always)]
    fn weigh(&mut self, weights: Weights<'_>, index: usize) {
        let Self { is_kept, shares, sums, .. } = self;
        sums.clear();
        for (row, shares) in shares.iter_mut().enumerate() {
            let scale = match weights {
                Weights::Extremes(temperature, [least, most]) => {
                    temperature.scale(least[row], most[row], iter::empty())
                }
                Weights::Scales(scales) => scales[row],
                Weights::Ranks(ranks, groups) => {
                    *shares = ranks[row * groups + index];
                    Scale::default()
                }
            };
            let mut sum = Pack::ZERO;
            for (i, share) in shares.iter_mut().enumerate() {
                let weight = if let Weights::Ranks(..) = weights { *share } else { scale.weigh(*share) };
                *share = if is_kept[i] { weight } else { Pack::ZERO };
                sum += *share;
            }
            sums.push(sum);
        }
    }

    /// Makes the weights of each step sum to one.
    #[inline(always)]
    fn normalise(&mut self, sums: &[Pack]) {
        for (shares, sum) in self.shares.iter_mut().zip(sums) {
            let inverse = Pack::ONE / *sum;
            for share in shares {
                *share = *share * inverse;
            }
        }
        self.change.clear();
    }

    /// Adds up what all steps ask of the parameters of a block, the one behind those before.
    #[inline(always)]
    fn improve(&mut self, inputs: &Inputs<'_>, first: usize, block: &Range<usize>) {
        let bases = inputs.bases;
        self.along.clear();
        if let Some(features) = bases.features(block) {
            for (tile, phi) in features.chunks_exact(block.len()).enumerate() {
                self.explore(inputs, first, block, tile);
                let shares = &self.shares[tile.min(self.shares.len() - 1)];
                let mut along = Pack::ZERO;
                if inputs.batch.is_constant() {
                    for (phi, eps) in phi.iter().zip(&self.constant) {
                        along += *phi * product(shares, eps);
                    }
                } else {
                    for (phi, eps) in phi.iter().zip(&self.varying) {
                        along += *phi * product(shares, eps);
                    }
                }
                self.along.push(along);
            }
            for j in block.clone() {
                self.change.push(sum_of(bases.averaging(j), &self.along));
            }
        } else {
            self.along.resize(block.len(), Pack::ZERO);
            for tile in 0..bases.tiles() {
                self.explore(inputs, first, block, tile);
                let shares = &self.shares[tile.min(self.shares.len() - 1)];
                let alongs = self.along.iter_mut().zip(block.clone().map(|j| bases.averaging(j)[tile]));
                if inputs.batch.is_constant() {
                    for ((along, averaging), eps) in alongs.zip(&self.constant) {
                        *along += averaging * product(shares, eps);
                    }
                } else {
                    for ((along, averaging), eps) in alongs.zip(&self.varying) {
                        *along += averaging * product(shares, eps);
                    }
                }
            }
            self.change.extend(self.along.iter().map(|along| along.0.iter().sum::<f64>()));
        }
    }

    /// Notes how far the parameters of a block are from those learned so far, where that differs from the tile before.
    #[inline(always)]
    fn explore(&mut self, inputs: &Inputs<'_>, first: usize, block: &Range<usize>, tile: usize) {
        let Self { is_kept, constant, varying, .. } = self;
        let weights = &inputs.weights[block.clone()];
        let kept = (0..MEMBERS).filter(|i| is_kept[*i]).map(|i| (i, inputs.batch.sample(first + i)));
        if !inputs.batch.is_constant() {
            varying.clear();
            varying.resize(block.len(), [Pack::ZERO; MEMBERS]);
            for (i, sample) in kept {
                for lane in 0..LANES {
                    let sample = &sample.at(tile * LANES + lane)[block.clone()];
                    for ((eps, sample), weight) in varying.iter_mut().zip(sample).zip(weights) {
                        eps[i].0[lane] = sample - weight;
                    }
                }
            }
        } else if tile == 0 {
            constant.clear();
            constant.resize(block.len(), [0.0; MEMBERS]);
            for (i, sample) in kept {
                for ((eps, sample), weight) in constant.iter_mut().zip(&sample.at(0)[block.clone()]).zip(weights) {
                    eps[i] = sample - weight;
                }
            }
        }
    }
}

/// `P E` of a parameter in a tile, given how far it is from that learned so far.
#[inline(always)]
fn product<E: Exploration>(shares: &[Pack; MEMBERS], eps: &[E; MEMBERS]) -> Pack {
    let mut sum = Pack::ZERO;
    for (share, eps) in shares.iter().zip(eps) {
        sum += *share * eps.pack();
    }
    sum
}

/// How far a parameter is from that learned so far.
trait Exploration: Copy {
    /// In each step of a tile.
    fn pack(self) -> Pack;
}

/// The same in all steps.
impl Exploration for f64 {
    #[inline(always)]
    fn pack(self) -> Pack {
        Pack::of(self)
    }
}

impl Exploration for Pack {
    #[inline(always)]
    fn pack(self) -> Pack {
        self
    }
}

/// The sum of all products of `a` and `b`, over the lanes too.
#[inline(always)]
fn sum_of(a: &[Pack], b: &[Pack]) -> f64 {
    let ((fours, rest), (other_fours, other_rest)) = (a.as_chunks::<4>(), b.as_chunks::<4>());
    let mut sum = Pack::ZERO;
    for (a, b) in fours.iter().zip(other_fours) {
        sum += (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]);
    }
    for (a, b) in rest.iter().zip(other_rest) {
        sum += *a * *b;
    }
    sum.0.iter().sum()
}
