//! What a learning problem is: parameters in blocks, the cost of a rollout, and where it has them its signals.

use core::ops::Range;

use crate::{Distance, Model};

/// One primitive of one axis: a run of parameters that share a basis.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// What the parameters are, such as `y.stiffness`.
    pub name: String,
    /// Number of parameters: n, one per basis function.
    pub count: usize,
    /// `phi_i` at mid-step: steps x n, one row per step.
    pub features: Vec<f64>,
    /// `psi_i` at mid-step: steps x n, one row per step.
    pub activations: Vec<f64>,
    /// Smallest value of a parameter; infinite where there is none.
    pub min: f64,
    /// Largest value of a parameter; infinite where there is none.
    pub max: f64,
    /// Standard deviation of the exploration at the first update, in the parameters' unit.
    pub noise: f64,
}

/// The parameters of one rollout, all blocks one after the other.
#[derive(Clone, Copy, Debug)]
pub enum Parameters<'a> {
    /// One set for the whole rollout.
    Constant(&'a [f64]),
    /// A set per step: steps x parameters, one row per step.
    PerStep {
        /// The rows, one after the other.
        rows: &'a [f64],
        /// Parameters per row.
        count: usize,
    },
}

impl<'a> Parameters<'a> {
    /// The parameters in force during `step`; past the last row, the last row.
    #[inline]
    pub fn at(&self, step: usize) -> &'a [f64] {
        match *self {
            Self::Constant(row) => row,
            Self::PerStep { rows, count } => {
                let start = (step * count).min(rows.len() - count);
                &rows[start..start + count]
            }
        }
    }

    /// The parameters of a motion for each of `samples`.
    pub(crate) fn constants(samples: impl IntoIterator<Item = &'a Vec<f64>>) -> Vec<Self> {
        samples.into_iter().map(|sample| Self::Constant(sample)).collect()
    }
}

/// What a rollout cost.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cost {
    /// Cost of each step, one entry per step.
    pub running: Vec<f64>,
    /// Cost of the end.
    pub terminal: f64,
    /// The same total split by term, in the order of [`Problem::terms`].
    pub terms: Vec<f64>,
}

impl Cost {
    /// Running and terminal cost together.
    pub fn total(&self) -> f64 {
        self.terminal + self.running.iter().sum::<f64>()
    }
}

/// How a cost is a sum of squares and distances: `J = 1/2 |rho|^2 + 1/2 sum_b w_b^T Q_b w_b + distances`.
///
/// rho are the signals a rollout measures, each times the root of its weight; w_b are the parameters of block b and
/// Q_b what they cost by themselves, known without a rollout. Signals that a [`Distance`] is measured by are not squared.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalModel {
    /// Parameters and the signals they are expected to act on, in order and without gaps: the axes of a robot. Whether
    /// they act on others too is found out.
    pub groups: Vec<SignalGroup>,
    /// Q_b of each block, n x n, one row after the other; empty where its parameters cost nothing by themselves.
    pub price: Vec<Vec<f64>>,
    /// Costs that are distances. Their signals are best scaled so that their squares are about as large as those of
    /// the others: what is small beside the rest is taken for rounding.
    pub distances: Vec<Distance>,
}

/// Parameters that act on signals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignalGroup {
    /// Which parameters, among all.
    pub parameters: Range<usize>,
    /// Which signals, among all.
    pub signals: Range<usize>,
}

/// Which random circumstances a rollout meets, where a problem has any.
///
/// Rollouts that are compared meet the same (common random numbers), so that their costs differ by their parameters
/// alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draws {
    /// Those of an update, from 0: the same for all its rollouts.
    Update(usize),
    /// Those held back for evaluation: learning never sees them.
    HeldOut,
}

/// What a learner wants to know of a motion beside its cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wants {
    /// Nothing.
    Costs,
    /// The signals of [`Problem::signals`].
    Signals,
    /// The motion itself, as [`Problem::model`] reads it.
    Motion,
}

/// Something whose parameters can be learned: a simulator, a robot.
pub trait Problem: Sync {
    /// What one rollout works in, made once per thread and reused.
    type Workspace: Send;

    /// The parameters, block by block.
    fn blocks(&self) -> &[Block];

    /// Number of steps of a rollout.
    fn steps(&self) -> usize;

    /// The names of the cost terms.
    fn terms(&self) -> &[&'static str];

    /// A workspace for rollouts.
    fn workspace(&self) -> Self::Workspace;

    /// Motions that one rollout takes: one per draw of its circumstances.
    fn motions(&self) -> usize {
        1
    }

    /// Whether a rollout costs something else under other [`Draws`], so that what is said of a policy has to come from
    /// draws that learning did not see.
    fn is_random(&self) -> bool {
        self.motions() > 1
    }

    /// Whether a motion may be made before it is certain that it will be used, to keep all threads at work: where motions
    /// are cheap and move nothing. The numbers are the same either way.
    fn may_run_ahead(&self) -> bool {
        false
    }

    /// Makes one rollout and writes what it cost, the mean over `draws`. A rollout that failed costs NaN or infinity.
    fn rollout(&self, draws: Draws, parameters: Parameters<'_>, workspace: &mut Self::Workspace, cost: &mut Cost);

    /// How many rollouts one call of [`Problem::rollouts`] makes best, at least one.
    fn batch_size(&self) -> usize {
        1
    }

    /// Makes a rollout of each of `parameters` and writes what it cost: the same numbers as one by one.
    fn rollouts(
        &self,
        draws: Draws,
        parameters: &[Parameters<'_>],
        workspace: &mut Self::Workspace,
        costs: &mut [Cost],
    ) {
        for (parameters, cost) in parameters.iter().zip(costs) {
            self.rollout(draws, *parameters, workspace, cost);
        }
    }

    /// Whether no more motions can be made, so that what was written last is no result: nothing is told of it.
    fn is_stopped(&self) -> bool {
        false
    }

    /// Whether the start may fail its motion and be learned from all the same: learning then begins at the first motion
    /// near it that does not fail. Where motions always can be made, a start that costs no finite amount is a mistake.
    fn may_start_fail(&self) -> bool {
        false
    }

    /// How the cost is a sum of squares of signals; `None` where a rollout measures none.
    fn signals(&self) -> Option<&SignalModel> {
        None
    }

    /// Makes one rollout as [`Problem::rollout`] does and writes the signals it measured, none where there are none.
    fn measure(
        &self,
        draws: Draws,
        parameters: Parameters<'_>,
        workspace: &mut Self::Workspace,
        cost: &mut Cost,
        signals: &mut Vec<f64>,
    ) {
        self.rollout(draws, parameters, workspace, cost);
        signals.clear();
    }

    /// A model that learns what moves from the motions made; `None` where motions show too little for one.
    fn model(&self) -> Option<Box<dyn Model>> {
        None
    }

    /// Makes rollout `number` of a run as [`Problem::measure`] does, and writes what is wanted of it. Rollouts of the same
    /// parameters may differ by their number: by the noise of what is recorded.
    fn observe(
        &self,
        (draws, number): (Draws, usize),
        parameters: Parameters<'_>,
        wants: Wants,
        workspace: &mut Self::Workspace,
        cost: &mut Cost,
        shown: &mut Vec<f64>,
    ) {
        let _ = (number, wants);
        self.measure(draws, parameters, workspace, cost, shown);
    }
}
