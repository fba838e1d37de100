//! The update of PI2 as small matrix products over the steps, in rooms that are used again.
//!
//! With the table P (steps x K), the exploration E (K x parameters) and `a_{t,j}` the normalised (N-t) psi_{t,j}, over
//! the basis' length where projected:
//! ```text
//! projected:  along_t = phi_t . (P E)_t,  [dw]_j = sum_t a_{t,j} phi_{t,j} along_t      else  [dw]_j = sum_t a_{t,j} (P E)_{t,j}
//! ```
//! Steps are worked on in stretches of [`STRETCH`], in parallel, and the stretches' sums added in their order: the same
//! bits for any number of threads. Costs to go run from the last step to the first, through all stretches: they are summed
//! up twice, at first for the stretches' starts alone, so that little is handed from thread to thread.

use core::ops::Range;

use hpf_core::{Lanes, Real};
use pulp::NullaryFnOnce;
use rayon::prelude::*;

use super::{Batch, Credit};
use crate::weighting::{Costs, LANES, Pack, packs, softmax, sum_of};
use crate::{Block, Cost, Parameters, Temperature};

/// Steps that one thread works on at a time.
const STRETCH: usize = 64;
/// Costs of steps from which on threads share in summing them up.
const SUMMED_IN_PARALLEL: usize = 5000;
/// Steps whose products are made together: a number of the exploration is read once for all of them.
const TILE: usize = 4;

/// What an update needs of the bases: in packs, each block from a pack of its own on, noughts behind its last number.
#[derive(Clone, Debug)]
pub(super) struct Bases {
    blocks: Vec<Place>,
    /// Packs of one row.
    width: usize,
    /// phi: steps x width; empty where nothing is projected.
    features: Vec<Pack>,
    /// a_{t,j}, times phi_{t,j}/(phi_t^T phi_t) where projected: steps x width.
    averaging: Vec<Pack>,
}

/// Where the parameters of one block are.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Among all parameters.
    start: usize,
    count: usize,
    /// Among the packs of a row.
    pack: usize,
}

impl Place {
    fn packs(&self) -> Range<usize> {
        self.pack..self.pack + packs(self.count)
    }
}

impl Bases {
    pub(super) fn new(blocks: &[Block], steps: usize, is_projected: bool) -> Self {
        let (mut start, mut width) = (0, 0);
        let places = blocks.iter().map(|block| {
            let place = Place { start, count: block.count, pack: width };
            (start, width) = (start + block.count, width + packs(block.count));
            place
        });
        let places: Vec<Place> = places.collect();
        let mut features = vec![Pack::ZERO; if is_projected { steps * width } else { 0 }];
        let mut averaging = vec![Pack::ZERO; steps * width];
        for (block, place) in blocks.iter().zip(&places) {
            let n = block.count;
            let mut sums = vec![0.0; n];
            for (t, row) in block.activations.chunks_exact(n).take(steps).enumerate() {
                sums.iter_mut().zip(row).for_each(|(sum, psi)| *sum += (steps - t) as f64 * psi);
            }
            for t in 0..steps {
                let [phi, psi] = [&block.features, &block.activations].map(|table| &table[t * n..(t + 1) * n]);
                let inverse_norm = 1.0 / phi.iter().map(|x| x * x).sum::<f64>();
                for j in 0..n {
                    // A function too narrow to be seen at any step has nothing to learn from.
                    let share = if sums[j] > 0.0 { (steps - t) as f64 * psi[j] / sums[j] } else { 0.0 };
                    let (pack, lane) = (t * width + place.pack + j / LANES, j % LANES);
                    if is_projected {
                        features[pack].0[lane] = phi[j];
                    }
                    averaging[pack].0[lane] = if is_projected { share * phi[j] * inverse_norm } else { share };
                }
            }
        }
        Self { blocks: places, width, features, averaging }
    }

    /// Writes `sample - weights` into `row`.
    fn pack_difference(&self, sample: &[f64], weights: &[f64], row: &mut [Pack]) {
        for place in &self.blocks {
            let own = place.start..place.start + place.count;
            let pairs = sample[own.clone()].chunks(LANES).zip(weights[own].chunks(LANES));
            for (pack, (sample, weights)) in row[place.packs()].iter_mut().zip(pairs) {
                *pack = Pack::ZERO;
                for ((slot, sample), weight) in pack.0.iter_mut().zip(sample).zip(weights) {
                    *slot = sample - weight;
                }
            }
        }
    }
}

/// Rooms for an update.
#[derive(Clone, Debug, Default)]
pub(super) struct Rooms {
    /// Rollouts whose costs are finite.
    pub(super) kept: Vec<usize>,
    /// S of the kept rollouts at the start of each stretch: packs x stretches. Where all steps share it P, a number for
    /// each rollout.
    table: Vec<[f64; LANES]>,
    /// E of parameters that are constant over a rollout: kept x width.
    exploration: Vec<Pack>,
    stretches: Vec<Stretch>,
}

/// Rooms for one stretch of steps.
#[derive(Clone, Debug, Default)]
struct Stretch {
    /// Its part of dw: width.
    change: Vec<Pack>,
    /// E of one step, where it changes with the steps.
    exploration: Vec<Pack>,
    /// S, then P, of its steps: steps x packs.
    shares: Vec<[f64; LANES]>,
    order: Vec<usize>,
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
    pub(super) instructions: pulp::Arch,
}

impl Inputs<'_> {
    /// Stretches that have an S of their own.
    fn rows(&self) -> usize {
        if self.credit == Credit::ToGo { self.steps.div_ceil(STRETCH) } else { 1 }
    }

    /// What the ends of a pack of rollouts cost; lanes behind the last repeat the first of theirs.
    #[inline(always)]
    fn terminal(&self, kept: &[usize]) -> Pack {
        Lanes(core::array::from_fn(|lane| self.costs[*kept.get(lane).unwrap_or(&kept[0])].terminal))
    }

    /// Adds the costs of a pack of rollouts to `to_go`, the last of `steps` first, and hands out what each step comes to.
    #[inline(always)]
    fn sum_back(&self, kept: &[usize], steps: Range<usize>, to_go: &mut Pack, mut take: impl FnMut(usize, Pack)) {
        let lane = |lane: usize| &self.costs[*kept.get(lane).unwrap_or(&kept[0])].running[steps.clone()];
        let running: [&[f64]; LANES] = core::array::from_fn(lane);
        let mut sum = *to_go;
        for t in (0..steps.len()).rev() {
            sum += Lanes(running.map(|running| running[t]));
            take(t, sum);
        }
        *to_go = sum;
    }
}

impl Rooms {
    /// Notes which costs are finite, sums them up over the steps, and how far the samples are from the weights; `false`
    /// where none is finite.
    pub(super) fn take(&mut self, inputs: &Inputs<'_>) -> bool {
        self.kept.clear();
        self.kept.extend(0..inputs.costs.len());
        self.sum_up(inputs);
        // A sum that has become infinite or NaN stays so: the last one tells of all.
        let (table, rows) = (&self.table, inputs.rows());
        let is_finite = |k: &usize| table.get(k / LANES * rows).is_some_and(|pack| pack[k % LANES].is_finite());
        if !self.kept.iter().all(is_finite) {
            self.kept.retain(is_finite);
            self.sum_up(inputs);
        }
        !self.kept.is_empty()
    }

    /// S of the kept rollouts at the start of each stretch, and E.
    fn sum_up(&mut self, inputs: &Inputs<'_>) {
        let Self { kept, table, exploration, .. } = self;
        let (rows, bases) = (inputs.rows(), inputs.bases);
        let span = if rows > 1 { STRETCH } else { inputs.steps };
        table.resize(rows * packs(kept.len()), [0.0; LANES]);
        exploration.resize(kept.len() * bases.width, Pack::ZERO);
        let sum_up = |sums: &mut [[f64; LANES]], exploration: &mut [Pack], kept: &[usize]| {
            let mut to_go = inputs.terminal(kept);
            for (row, sum) in sums.iter_mut().enumerate().rev() {
                let start = row * span;
                inputs.sum_back(kept, start..inputs.steps.min(start + span), &mut to_go, |_, _| ());
                *sum = to_go.0;
            }
            for (&k, row) in kept.iter().zip(exploration.chunks_exact_mut(bases.width)) {
                if let Parameters::Constant(sample) = inputs.batch.sample(k) {
                    bases.pack_difference(sample, inputs.weights, row);
                }
            }
        };
        let explored = LANES * bases.width;
        if kept.len() * inputs.steps >= SUMMED_IN_PARALLEL && rayon::current_num_threads() > 1 {
            let packs = table.par_chunks_mut(rows).zip(exploration.par_chunks_mut(explored));
            packs.zip(kept.par_chunks(LANES)).for_each(|((sums, explored), kept)| sum_up(sums, explored, kept));
        } else {
            let packs = table.chunks_mut(rows).zip(exploration.chunks_mut(explored));
            packs.zip(kept.chunks(LANES)).for_each(|((sums, explored), kept)| sum_up(sums, explored, kept));
        }
    }

    /// Works out the change of the parameters from what was taken.
    pub(super) fn improve(&mut self, inputs: &Inputs<'_>) {
        let Self { kept, table, exploration, stretches } = self;
        let count = kept.len();
        if inputs.credit == Credit::Total {
            let mut order = core::mem::take(&mut stretches_of(stretches, 1)[0].order);
            softmax(&mut Costs { packs: table, count }, inputs.temperature, &mut order);
            stretches[0].order = order;
        }
        let (kept, table, exploration) = (kept.as_slice(), table.as_slice(), exploration.as_slice());
        let stretches = stretches_of(stretches, inputs.steps.div_ceil(STRETCH));
        let work = |(index, stretch): (usize, &mut Stretch)| {
            inputs.instructions.dispatch(Work { inputs, kept, table, exploration, index, stretch });
        };
        if stretches.len() > 1 && rayon::current_num_threads() > 1 {
            stretches.par_iter_mut().enumerate().with_max_len(1).for_each(work);
        } else {
            stretches.iter_mut().enumerate().for_each(work);
        }
        let (first, rest) = stretches.split_first_mut().expect("a rollout has a step");
        for stretch in rest {
            first.change.iter_mut().zip(&stretch.change).for_each(|(sum, change)| *sum += *change);
        }
    }

    /// The change of each parameter, one after the other.
    pub(super) fn changes<'r>(&'r self, bases: &'r Bases) -> impl Iterator<Item = f64> + 'r {
        let change = &self.stretches[0].change;
        let of = |place: &'r Place| change[place.packs()].iter().flat_map(|pack| pack.0).take(place.count);
        bases.blocks.iter().flat_map(of)
    }
}

/// The rooms of so many stretches.
fn stretches_of(stretches: &mut Vec<Stretch>, count: usize) -> &mut [Stretch] {
    if stretches.len() < count {
        stretches.resize_with(count, Stretch::default);
    }
    &mut stretches[..count]
}

/// One stretch, for compilation in every set of instructions.
struct Work<'a> {
    inputs: &'a Inputs<'a>,
    kept: &'a [usize],
    table: &'a [[f64; LANES]],
    exploration: &'a [Pack],
    index: usize,
    stretch: &'a mut Stretch,
}

impl NullaryFnOnce for Work<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { inputs, kept, table, exploration, index, stretch } = self;
        let Stretch { change, exploration: own, shares, order } = stretch;
        let (bases, width) = (inputs.bases, packs(kept.len()));
        let first = index * STRETCH;
        let steps = first..inputs.steps.min(first + STRETCH);
        let (shares, pitch): (&[[f64; LANES]], usize) = match inputs.credit {
            Credit::ToGo => {
                shares.resize(steps.len() * width, [0.0; LANES]);
                for (pack, (kept, starts)) in kept.chunks(LANES).zip(table.chunks(inputs.rows())).enumerate() {
                    let mut to_go = starts.get(index + 1).map_or_else(|| inputs.terminal(kept), |next| Lanes(*next));
                    inputs.sum_back(kept, steps.clone(), &mut to_go, |t, sum| shares[t * width + pack] = sum.0);
                }
                for packs in shares.chunks_exact_mut(width) {
                    softmax(&mut Costs { packs, count: kept.len() }, inputs.temperature, order);
                }
                (shares, width)
            }
            Credit::Total => (table, 0),
        };
        change.clear();
        change.resize(bases.width, Pack::ZERO);
        let weights_of = |t: usize| &shares[(t - steps.start) * pitch..][..width].as_flattened()[..kept.len()];
        if inputs.batch.rows == 1 {
            let whole = steps.start + (steps.len() / TILE) * TILE;
            for t in (steps.start..whole).step_by(TILE) {
                let shares: [_; TILE] = core::array::from_fn(|r| weights_of(t + r));
                bases.add_steps(t, shares, exploration, change);
            }
            for t in whole..steps.end {
                bases.add_steps(t, [weights_of(t)], exploration, change);
            }
        } else {
            own.resize(kept.len() * bases.width, Pack::ZERO);
            for t in steps.clone() {
                for (&k, row) in kept.iter().zip(own.chunks_exact_mut(bases.width)) {
                    bases.pack_difference(inputs.batch.sample(k).at(t), inputs.weights, row);
                }
                bases.add_steps(t, [weights_of(t)], own, change);
            }
        }
    }
}

impl Bases {
    /// Adds what `R` steps from `t` on, with the weights of the rollouts in each, ask for.
    #[inline(always)]
    fn add_steps<const R: usize>(&self, t: usize, shares: [&[f64]; R], exploration: &[Pack], change: &mut [Pack]) {
        let mut step = Products { bases: self, t, shares, exploration, along: [Pack::ZERO; R], change };
        for place in &self.blocks {
            step.along = [Pack::ZERO; R];
            let mut columns = place.packs();
            while columns.len() >= 3 {
                step.add::<3>(columns.start);
                columns.start += 3;
            }
            match columns.len() {
                2 => step.add::<2>(columns.start),
                1 => step.add::<1>(columns.start),
                _ => {}
            }
            if !self.features.is_empty() {
                let along = step.along.map(|along| Pack::of(sum_of(along)));
                for column in place.packs() {
                    let averaging = self.averaging[column + t * self.width..].iter().step_by(self.width);
                    for (along, averaging) in along.into_iter().zip(averaging) {
                        step.change[column] += *averaging * along;
                    }
                }
            }
        }
    }
}

/// The products of `R` steps.
struct Products<'a, const R: usize> {
    bases: &'a Bases,
    t: usize,
    shares: [&'a [f64]; R],
    exploration: &'a [Pack],
    /// `phi . (P E)` of a block, not yet summed over its lanes.
    along: [Pack; R],
    change: &'a mut [Pack],
}

impl<const R: usize> Products<'_, R> {
    /// Takes in `C` packs from `column` on; as many sums as fit into the registers are made at a time.
    #[expect(clippy::needless_range_loop, reason = "iterators nested here are not compiled to vector instructions")]
    #[inline(always)]
    fn add<const C: usize>(&mut self, column: usize) {
        let width = self.bases.width;
        let mut sums = [[Pack::ZERO; C]; R];
        for (k, row) in self.exploration.chunks_exact(width).enumerate() {
            let row = &row[column..column + C];
            for r in 0..R {
                let share = Pack::of(self.shares[r][k]);
                for c in 0..C {
                    sums[r][c] += share * row[c];
                }
            }
        }
        for (r, sums) in sums.into_iter().enumerate() {
            let own = (self.t + r) * width + column;
            for (c, sum) in sums.into_iter().enumerate() {
                match self.bases.features.get(own + c) {
                    Some(phi) => self.along[r] += *phi * sum,
                    None => self.change[column + c] += self.bases.averaging[own + c] * sum,
                }
            }
        }
    }
}
