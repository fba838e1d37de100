//! Rollouts in parallel: evaluated in any order, kept in theirs, so that threads never change a number.

use rayon::prelude::*;

use crate::{Cost, Draws, Parameters, Problem};

/// Makes a rollout of each of `parameters` on the current rayon pool, and writes what it cost.
pub(crate) fn roll_out<P: Problem>(problem: &P, draws: Draws, parameters: &[Parameters<'_>], costs: &mut [Cost]) {
    let together = problem.together().max(1);
    costs.par_chunks_mut(together).zip(parameters.par_chunks(together)).for_each_init(
        || problem.workspace(),
        |workspace, (costs, parameters)| problem.rollouts(draws, parameters, workspace, costs),
    );
}
