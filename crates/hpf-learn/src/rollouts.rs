//! Rollouts in parallel: evaluated in any order, kept in theirs, so that threads never change a number.

use rayon::prelude::*;

use crate::{Cost, Draws, Parameters, Problem};

/// Makes rollouts, again and again in the same workspaces.
pub(crate) struct Crew<P: Problem> {
    workspaces: Vec<P::Workspace>,
}

impl<P: Problem> Crew<P> {
    pub(crate) fn new() -> Self {
        Self { workspaces: Vec::new() }
    }

    /// Makes a rollout of each of `samples` on the current rayon pool, and writes what it cost.
    pub(crate) fn roll_out(&mut self, problem: &P, draws: Draws, samples: &[Parameters<'_>], costs: &mut [Cost]) {
        let together = problem.together().max(1);
        let groups = costs.len().div_ceil(together);
        if self.workspaces.len() < groups {
            self.workspaces.resize_with(groups, || problem.workspace());
        }
        let workspaces = &mut self.workspaces[..groups];
        if groups > 1 && rayon::current_num_threads() > 1 {
            let groups = costs.par_chunks_mut(together).zip(samples.par_chunks(together)).zip(workspaces);
            // Singly, for a thread does not give away half of what it has taken.
            groups
                .with_max_len(1)
                .for_each(|((costs, samples), workspace)| problem.rollouts(draws, samples, workspace, costs));
        } else {
            let groups = costs.chunks_mut(together).zip(samples.chunks(together)).zip(workspaces);
            groups.for_each(|((costs, samples), workspace)| problem.rollouts(draws, samples, workspace, costs));
        }
    }
}
