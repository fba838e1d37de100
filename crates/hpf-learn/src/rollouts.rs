//! Rollouts in parallel: made in any order, kept in theirs, so that threads never change a number.

use rayon::prelude::*;

use crate::session::{Ask, Session};
use crate::{Cost, Draws, Parameters, Problem, Wants};

/// Makes rollouts, again and again in the same memory.
pub(crate) struct RolloutPool<P: Problem> {
    workspaces: Vec<P::Workspace>,
    /// What each rollout cost that was made last; others may follow.
    pub(crate) costs: Vec<Cost>,
    /// The signals of each, where they were asked for.
    pub(crate) signals: Vec<Vec<f64>>,
}

impl<P: Problem> Default for RolloutPool<P> {
    fn default() -> Self {
        Self { workspaces: Vec::new(), costs: Vec::new(), signals: Vec::new() }
    }
}

impl<P: Problem> RolloutPool<P> {
    /// Makes the batch that `session` asks for next; returns how many rollouts it has. Behind them in `costs` is that of
    /// `evaluated`, where there are such parameters: as one more rollout, where a group has room for it.
    pub(crate) fn make_next(&mut self, problem: &P, session: &mut Session, evaluated: Option<&[f64]>) -> usize {
        if let Some((learner, batch)) = session.drawing() {
            // A thread draws what it rolls out: the numbers need not go from one to the other.
            let (count, size) = (learner.begin(batch), problem.batch_size());
            let draws = Draws::Update(learner.update());
            let groups = learner.groups(batch, size);
            let (last, evaluated) = (groups.len() - 1, evaluated.map(Parameters::Constant));
            let (joined, own) = if count % size == 0 { (None, evaluated) } else { (evaluated, None) };
            let groups = groups.enumerate().map(|(i, mut group)| {
                group.extend(joined.filter(|_| i == last));
                group
            });
            let groups = groups.chain(own.map(|evaluated| vec![evaluated]));
            self.make_groups(problem, draws, count + usize::from(evaluated.is_some()), groups);
            return count;
        }
        let number = session.made();
        let ask = session.ask_batch();
        if ask.wants != Wants::Costs {
            self.observe(problem, number, &ask);
        } else {
            self.make(problem, ask.draws, &ask.samples);
        }
        ask.samples.len()
    }

    /// Makes a rollout of each of `samples`.
    pub(crate) fn make(&mut self, problem: &P, draws: Draws, samples: &[Parameters<'_>]) {
        self.make_groups(problem, draws, samples.len(), samples.par_chunks(problem.batch_size()));
    }

    /// Makes `count` rollouts, a group on one thread.
    fn make_groups<'s, G: IndexedParallelIterator>(&mut self, problem: &P, draws: Draws, count: usize, groups: G)
    where
        G::Item: AsRef<[Parameters<'s>]>,
    {
        let together = problem.batch_size();
        let workspaces = first(&mut self.workspaces, groups.len(), || problem.workspace());
        let costs = first(&mut self.costs, count, Cost::default);
        // Singly, for a thread does not give away half of what it has taken.
        costs
            .par_chunks_mut(together)
            .zip(groups)
            .zip(workspaces)
            .with_max_len(1)
            .for_each(|((costs, samples), workspace)| problem.rollouts(draws, samples.as_ref(), workspace, costs));
    }

    /// Makes a rollout of each sample of `ask`, the first of them rollout `number`, with what is wanted of it.
    fn observe(&mut self, problem: &P, number: usize, ask: &Ask<'_>) {
        let count = ask.samples.len();
        let costs = first(&mut self.costs, count, Cost::default);
        let signals = first(&mut self.signals, count, Vec::new);
        costs.par_iter_mut().zip(signals).zip(&ask.samples).enumerate().for_each_init(
            || problem.workspace(),
            |workspace, (k, ((cost, signals), sample))| {
                problem.observe((ask.draws, number + k), *sample, ask.wants, workspace, cost, signals);
            },
        );
    }
}

/// The first `count` entries, made where there are fewer.
fn first<T>(entries: &mut Vec<T>, count: usize, make: impl FnMut() -> T) -> &mut [T] {
    entries.resize_with(count.max(entries.len()), make);
    &mut entries[..count]
}
