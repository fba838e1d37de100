//! What an update of PI2 needs of the bases, in the order in which it is read.

use core::ops::Range;

use hpf_core::Real;

use crate::Block;
use crate::weighting::{LANES, Pack};

/// The tables of all blocks, a step per lane, zeros behind the last step.
#[derive(Clone, Debug)]
pub(super) struct Bases {
    /// The parameters of each block.
    blocks: Vec<Range<usize>>,
    /// Tiles of steps.
    tiles: usize,
    /// phi, block by block: tiles x parameters; empty where nothing is projected.
    features: Vec<Pack>,
    /// a_{t,j}, times phi_{t,j}/(phi_t^T phi_t) where projected: parameters x tiles.
    averaging: Vec<Pack>,
}

impl Bases {
    pub(super) fn new(blocks: &[Block], steps: usize, is_projected: bool) -> Self {
        let mut count = 0;
        let ranges = blocks.iter().map(|block| {
            count += block.count;
            count - block.count..count
        });
        let ranges: Vec<Range<usize>> = ranges.collect();
        let tiles = steps.div_ceil(LANES);
        let size = tiles * count;
        let mut features = vec![Pack::ZERO; if is_projected { size } else { 0 }];
        let mut averaging = vec![Pack::ZERO; size];
        for (block, range) in blocks.iter().zip(&ranges) {
            let n = block.count;
            let mut sums = vec![0.0; n];
            for (t, row) in block.activations.chunks_exact(n).take(steps).enumerate() {
                sums.iter_mut().zip(row).for_each(|(sum, psi)| *sum += (steps - t) as f64 * psi);
            }
            for t in 0..steps {
                let [phi, psi] = [&block.features, &block.activations].map(|table| &table[t * n..(t + 1) * n]);
                let inverse_norm = 1.0 / phi.iter().map(|x| x * x).sum::<f64>();
                let (tile, lane) = (t / LANES, t % LANES);
                for j in 0..n {
                    // A function too narrow to be seen at any step has nothing to learn from.
                    let share = if sums[j] > 0.0 { (steps - t) as f64 * psi[j] / sums[j] } else { 0.0 };
                    averaging[(range.start + j) * tiles + tile].0[lane] =
                        if is_projected { share * phi[j] * inverse_norm } else { share };
                    if is_projected {
                        features[range.start * tiles + tile * n + j].0[lane] = phi[j];
                    }
                }
            }
        }
        Self { blocks: ranges, tiles, features, averaging }
    }

    /// The parameters of each block.
    #[inline(always)]
    pub(super) fn blocks(&self) -> &[Range<usize>] {
        &self.blocks
    }

    /// Tiles of steps.
    #[inline(always)]
    pub(super) fn tiles(&self) -> usize {
        self.tiles
    }

    /// phi of a block, tile by tile; none where nothing is projected.
    #[inline(always)]
    pub(super) fn features(&self, block: &Range<usize>) -> Option<&[Pack]> {
        self.features.get(block.start * self.tiles..block.end * self.tiles)
    }

    /// What each tile adds to parameter `j`.
    #[inline(always)]
    pub(super) fn averaging(&self, j: usize) -> &[Pack] {
        &self.averaging[j * self.tiles..][..self.tiles]
    }
}
