//! What the weights of an axis make of its bases, a few steps at a time.

use hpf_core::{Lanes, Real};
use hpf_learn::Parameters;

use super::table::{TILE, Table};

/// The bases of a task over time, shared by all axes and rollouts.
#[derive(Clone, Debug)]
pub(super) struct Tables {
    /// At mid-steps.
    pub(super) movement: Table,
    /// At half steps.
    pub(super) stiffness: Table,
    /// At half steps.
    pub(super) damping: Table,
}

/// The mixtures of [`TILE`] steps; those past the last step mean nothing.
pub(super) struct Tile<const N: usize> {
    /// At mid-steps.
    pub(super) movement: [Lanes<N>; TILE],
    /// Stiffness [N/m] at the middle and at the end of each step.
    pub(super) stiffness: [[Lanes<N>; 2]; TILE],
    /// Damping [N s/m] at the middle and at the end of each step.
    pub(super) damping: [[Lanes<N>; 2]; TILE],
}

/// The mixtures of one axis over a rollout.
pub(super) trait Profiles<const N: usize> {
    /// Stiffness and damping at the start.
    fn start(&self) -> [Lanes<N>; 2];

    /// The mixtures of the steps from `first` on.
    fn tile(&self, first: usize) -> Tile<N>;

    /// The goal during `step`, where it is a parameter.
    fn goal(&self, step: usize) -> Option<Lanes<N>>;
}

/// One set of weights per lane for the whole rollout.
pub(super) struct Constant<'a, const N: usize> {
    pub(super) tables: &'a Tables,
    pub(super) movement: &'a [Lanes<N>],
    pub(super) stiffness: &'a [Lanes<N>],
    pub(super) damping: &'a [Lanes<N>],
    /// Empty, or the goal.
    pub(super) goal: &'a [Lanes<N>],
}

impl<const N: usize> Profiles<N> for Constant<'_, N> {
    #[inline(always)]
    fn start(&self) -> [Lanes<N>; 2] {
        let [stiffness] = self.tables.stiffness.mix_rows(0, self.stiffness);
        let [damping] = self.tables.damping.mix_rows(0, self.damping);
        [stiffness, damping]
    }

    #[inline(always)]
    fn tile(&self, first: usize) -> Tile<N> {
        Tile {
            movement: self.tables.movement.mix_rows(first, self.movement),
            stiffness: half_steps(&self.tables.stiffness, first, self.stiffness),
            damping: half_steps(&self.tables.damping, first, self.damping),
        }
    }

    #[inline(always)]
    fn goal(&self, _: usize) -> Option<Lanes<N>> {
        self.goal.first().copied()
    }
}

/// Middle and end of each step; four rows at a time, because more sums than that do not fit into the registers.
#[inline(always)]
fn half_steps<const N: usize>(table: &Table, first: usize, weights: &[Lanes<N>]) -> [[Lanes<N>; 2]; TILE] {
    let [a, b, c, d] = table.mix_rows(2 * first + 1, weights);
    let [e, f, g, h] = table.mix_rows(2 * first + 5, weights);
    [[a, b], [c, d], [e, f], [g, h]]
}

/// Weights of one rollout that may change with every step. The middle of a step takes the step's, a sample those of the
/// step that it starts.
pub(super) struct Rowwise<'a> {
    pub(super) tables: &'a Tables,
    pub(super) parameters: Parameters<'a>,
    /// Where the axis' parameters start, and where each primitive's and the goal end.
    pub(super) ends: [usize; 5],
    pub(super) steps: usize,
}

impl Rowwise<'_> {
    /// Stiffness and damping at the half step `row`, by the weights of `step`.
    fn gains(&self, row: usize, step: usize) -> [Lanes<1>; 2] {
        let [_, movement_end, stiffness_end, end, _] = self.ends;
        let weights = self.parameters.at(step);
        let stiffness = self.tables.stiffness.mix(row, &weights[movement_end..stiffness_end]);
        [Lanes([stiffness]), Lanes([self.tables.damping.mix(row, &weights[stiffness_end..end])])]
    }
}

impl Profiles<1> for Rowwise<'_> {
    fn start(&self) -> [Lanes<1>; 2] {
        self.gains(0, 0)
    }

    fn tile(&self, first: usize) -> Tile<1> {
        let zero = Lanes::ZERO;
        let mut tile = Tile { movement: [zero; TILE], stiffness: [[zero; 2]; TILE], damping: [[zero; 2]; TILE] };
        let [start, movement_end, ..] = self.ends;
        for (j, i) in (first..self.steps).take(TILE).enumerate() {
            let weights = &self.parameters.at(i)[start..movement_end];
            tile.movement[j] = Lanes([self.tables.movement.mix(i, weights)]);
            let ([middle_stiffness, middle_damping], [stiffness, damping]) =
                (self.gains(2 * i + 1, i), self.gains(2 * i + 2, i + 1));
            tile.stiffness[j] = [middle_stiffness, stiffness];
            tile.damping[j] = [middle_damping, damping];
        }
        tile
    }

    fn goal(&self, step: usize) -> Option<Lanes<1>> {
        let [.., start, end] = self.ends;
        self.parameters.at(step)[start..end].first().map(|goal| Lanes([*goal]))
    }
}
