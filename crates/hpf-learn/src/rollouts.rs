//! Rollouts in parallel: evaluated in any order, kept in theirs, so that threads never change a number.

use rayon::prelude::*;

use crate::{Batch, Cost, Draws, Parameters, Problem};

/// Most rollouts that one call of [`Problem::rollouts`] gets.
const MOST_TOGETHER: usize = 64;

/// Makes rollouts, again and again in the same workspaces.
pub(crate) struct Crew<P: Problem> {
    workspaces: Vec<P::Workspace>,
}

impl<P: Problem> Crew<P> {
    pub(crate) fn new() -> Self {
        Self { workspaces: Vec::new() }
    }

    /// Makes a rollout of each sample of `batch` on the current rayon pool, and writes what it cost.
    pub(crate) fn roll_out(&mut self, problem: &P, draws: Draws, batch: &Batch, costs: &mut [Cost]) {
        let together = problem.together().clamp(1, MOST_TOGETHER);
        let groups = costs.len().div_ceil(together);
        if self.workspaces.len() < groups {
            self.workspaces.resize_with(groups, || problem.workspace());
        }
        let roll = |group: usize, costs: &mut [Cost], workspace: &mut P::Workspace| {
            let mut parameters = [Parameters::Constant(&[]); MOST_TOGETHER];
            let parameters = &mut parameters[..costs.len()];
            for (slot, k) in parameters.iter_mut().zip(group * together..) {
                *slot = batch.sample(k);
            }
            problem.rollouts(draws, parameters, workspace, costs);
        };
        let workspaces = &mut self.workspaces[..groups];
        if groups > 1 && rayon::current_num_threads() > 1 {
            let groups = costs.par_chunks_mut(together).zip(workspaces).enumerate();
            groups.for_each(|(group, (costs, workspace))| roll(group, costs, workspace));
        } else {
            let groups = costs.chunks_mut(together).zip(workspaces).enumerate();
            groups.for_each(|(group, (costs, workspace))| roll(group, costs, workspace));
        }
    }
}
