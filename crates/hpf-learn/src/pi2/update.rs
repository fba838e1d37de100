//! The update of PI2 as small matrix products over the steps, in rooms that are used again.
//!
//! With the table P (steps x K), the exploration E (K x parameters) and `a_{t,j}` the normalised (N-t) psi_{t,j}, over
//! the basis' length where projected:
//! ```text
//! projected:  along_t = phi_t . (P E)_t,  [dw]_j = sum_t a_{t,j} phi_{t,j} along_t      else  [dw]_j = sum_t a_{t,j} (P E)_{t,j}
//! ```
//! Steps are worked on in stretches of [`STRETCH`], in parallel, and the stretches' sums added in their order: the same
//! bits for any number of threads.

use hpf_core::{Lanes, Real};
use pulp::NullaryFnOnce;
use rayon::prelude::*;

use super::{Batch, Credit};
use crate::weighting::{Costs, LANES, Pack, packs, softmax, sum_of};
use crate::{Block, Cost, Temperature};

/// Steps that one thread works on at a time.
const STRETCH: usize = 64;
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
    fn packs(&self) -> core::ops::Range<usize> {
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
    /// S, then P, of the kept rollouts: steps x packs, or one row where all steps share it.
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
    pub(super) instructions: pulp::Arch,
}

impl Rooms {
    /// Notes which costs are finite and sums them up over the steps; `false` where none is finite.
    pub(super) fn take(&mut self, inputs: &Inputs<'_>, costs: &[Cost]) -> bool {
        self.kept.clear();
        self.kept.extend(0..costs.len());
        self.sum_up(inputs, costs);
        // A sum that has become infinite or NaN stays so: the last one tells of all.
        let table = &self.table;
        let is_finite = |k: &usize| table.get(k / LANES).is_some_and(|pack| pack[k % LANES].is_finite());
        if !self.kept.iter().all(is_finite) {
            self.kept.retain(is_finite);
            self.sum_up(inputs, costs);
        }
        !self.kept.is_empty()
    }

    /// S of the kept rollouts: the cost to go of every step, or the total in one row.
    fn sum_up(&mut self, inputs: &Inputs<'_>, costs: &[Cost]) {
        let (steps, width) = (inputs.steps, packs(self.kept.len()));
        let rows = if inputs.credit == Credit::ToGo { steps } else { 1 };
        self.table.clear();
        self.table.resize(rows * width, [0.0; LANES]);
        for (pack, kept) in self.kept.chunks(LANES).enumerate() {
            // Lanes behind the last rollout repeat the first of theirs.
            let own: [&Cost; LANES] = core::array::from_fn(|lane| &costs[*kept.get(lane).unwrap_or(&kept[0])]);
            let running = own.map(|cost| &cost.running[..steps]);
            let mut to_go = Lanes(own.map(|cost| cost.terminal));
            for t in (0..steps).rev() {
                to_go += Lanes(running.map(|running| running[t]));
                if rows > 1 || t == 0 {
                    self.table[t * width + pack] = to_go.0;
                }
            }
        }
    }

    /// Works out the change of the parameters from what was taken.
    pub(super) fn improve(&mut self, inputs: &Inputs<'_>) {
        let Self { kept, table, exploration, stretches } = self;
        let (bases, batch, count) = (inputs.bases, inputs.batch, kept.len());
        if inputs.credit == Credit::Total {
            let mut order = core::mem::take(&mut stretches_of(stretches, 1)[0].order);
            softmax(&mut Costs { packs: table, count }, inputs.temperature, &mut order);
            stretches[0].order = order;
        }
        exploration.clear();
        if batch.rows == 1 {
            exploration.resize(count * bases.width, Pack::ZERO);
            for (&k, row) in kept.iter().zip(exploration.chunks_exact_mut(bases.width)) {
                bases.pack_difference(batch.sample(k).at(0), inputs.weights, row);
            }
        }
        let (kept, exploration) = (kept.as_slice(), exploration.as_slice());
        let stretches = stretches_of(stretches, inputs.steps.div_ceil(STRETCH));
        let work = |(index, stretch, table): (usize, &mut Stretch, Table<'_>)| {
            let first = index * STRETCH;
            let steps = first..(first + STRETCH).min(inputs.steps);
            inputs.instructions.dispatch(Work { inputs, kept, exploration, steps, stretch, table });
        };
        let width = packs(count);
        let is_parallel = stretches.len() > 1 && rayon::current_num_threads() > 1;
        match (inputs.credit, is_parallel) {
            (Credit::ToGo, true) => {
                let tables = table.par_chunks_mut(STRETCH * width).map(Table::Costs);
                stretches.par_iter_mut().enumerate().zip(tables).for_each(|((i, s), table)| work((i, s, table)));
            }
            (Credit::ToGo, false) => {
                let tables = table.chunks_mut(STRETCH * width).map(Table::Costs);
                stretches.iter_mut().enumerate().zip(tables).for_each(|((i, s), table)| work((i, s, table)));
            }
            (Credit::Total, true) => {
                let table = table.as_slice();
                stretches.par_iter_mut().enumerate().for_each(|(i, s)| work((i, s, Table::Shared(table))));
            }
            (Credit::Total, false) => {
                stretches.iter_mut().enumerate().for_each(|(i, s)| work((i, s, Table::Shared(table))));
            }
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

/// The weights of the rollouts in a stretch of steps.
enum Table<'a> {
    /// Still costs, a row per step.
    Costs(&'a mut [[f64; LANES]]),
    /// One row for all steps.
    Shared(&'a [[f64; LANES]]),
}

/// One stretch, for compilation in every set of instructions.
struct Work<'a> {
    inputs: &'a Inputs<'a>,
    kept: &'a [usize],
    exploration: &'a [Pack],
    steps: core::ops::Range<usize>,
    stretch: &'a mut Stretch,
    table: Table<'a>,
}

impl NullaryFnOnce for Work<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { inputs, kept, exploration, steps, stretch, table } = self;
        let Stretch { change, exploration: own, order } = stretch;
        let (bases, width) = (inputs.bases, packs(kept.len()));
        let (table, pitch): (&[[f64; LANES]], usize) = match table {
            Table::Costs(table) => {
                for packs in table.chunks_exact_mut(width) {
                    softmax(&mut Costs { packs, count: kept.len() }, inputs.temperature, order);
                }
                (table, width)
            }
            Table::Shared(table) => (table, 0),
        };
        change.clear();
        change.resize(bases.width, Pack::ZERO);
        let weights_of = |t: usize| &table[(t - steps.start) * pitch..][..width].as_flattened()[..kept.len()];
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
