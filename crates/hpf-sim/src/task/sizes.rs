//! How large the tables are that learning a task works on, and the memory they take.
//!
//! S steps of the movement, R of it and the rest time, A axes, P parameters, K rollouts, G signals of a rollout (what Gauss-Newton learns from):
//! ```text
//! parameters at every step   S P    features and activations of each block: of the simulation, of the learner
//! kept trajectories          7 A R (1 + snapshots)
//! costs of every step        S K    and the weights made of them: ranks, shares, and a few of each group
//! rows of learning           12 updates
//! samples                    K P, or K S P where they change from step to step
//! parameters against signals P G    of Gauss-Newton: rollouts kept, the response
//! parameters squared         P P    of Gauss-Newton: curvature, doubt, price; of CMA-ES: covariance, its parts
//! draws                      4 A R  for every draw: forces, readings
//! evaluations                8 S    for each thread: costs of those made at a time
//! ```
//! The learner keeps steps, and rollouts, in packs of 8 numbers: where there are fewer, it needs as much as for 8.

use super::{ExplorationKind, MAX_NUMBERS, Method, PerAxis, Preset, Task};

/// Most memory that learning may need on one thread [bytes].
pub const MAX_MEMORY: f64 = 4e9;

/// Numbers of a row of `learning.csv`.
const ROW: f64 = 12.0;
/// Numbers that the learner works on together.
const PACK: f64 = 8.0;
/// Signals of an axis in a trajectory.
const SIGNALS: f64 = 7.0;
/// Numbers that one axis meets in a step: forces at both its ends, the error of a reading, whether it is lost.
const MET: f64 = 4.0;
/// Signals that the cost of a step stands for, where there are no others.
const SQUARES: f64 = 4.0;
/// Trajectories at work at once beside those kept: a blank one, two of evaluations, and a table being written as text.
const WORKING: f64 = 8.0;
/// Trajectories that each thread works on.
const PER_THREAD: f64 = 1.0;
/// The program itself, with its threads and a figure being drawn [bytes].
const PROGRAM: f64 = 64e6;

/// A table that learning works on.
pub(super) struct Table {
    /// The key that makes it large.
    pub(super) path: &'static str,
    /// What is in it.
    pub(super) what: &'static str,
    /// How many numbers.
    pub(super) numbers: f64,
    /// How many tables of this size are at work at once.
    copies: f64,
}

impl Task {
    /// The memory that learning needs on `threads` threads [bytes]: an upper bound.
    pub fn memory(&self, threads: usize) -> f64 {
        let tables: f64 = self.tables().iter().map(|table| table.copies * table.numbers).sum();
        let all_steps = self.step_numbers() + self.rest_steps() as f64;
        let trajectory = SIGNALS * self.axis.len() as f64 * all_steps;
        let met = MET * self.axis.len() as f64 * all_steps * self.draws() as f64;
        let working = (WORKING + PER_THREAD * threads as f64) * trajectory + threads as f64 * met;
        let evaluations = PACK * threads as f64 * self.step_numbers();
        PROGRAM + size_of::<f64>() as f64 * (tables + working + evaluations)
    }

    /// Steps as a number that cannot overflow.
    fn step_numbers(&self) -> f64 {
        (self.duration * self.rate).round()
    }

    /// The tables that learning works on.
    pub(super) fn tables(&self) -> Vec<Table> {
        let (learning, cost) = (&self.learning, &self.cost);
        let (steps, axes, rollouts) = (self.step_numbers(), self.axis.len() as f64, learning.rollouts as f64);
        let functions = [self.movement.basis, self.stiffness.basis, self.damping.basis];
        let parameters = axes * functions.iter().map(|basis| basis.count() as f64).sum::<f64>();
        // How much larger a table is when its packs are whole.
        let packed = |count: f64| PACK * (count / PACK).ceil() / count.max(1.0);
        let (packed_steps, packed_rollouts) = (packed(steps), packed(rollouts));
        let all_steps = steps + self.rest_steps() as f64;
        let trajectory = SIGNALS * axes * all_steps;
        let table = |path, what, numbers, copies| Table { path, what, numbers, copies };
        let mut tables = vec![
            table("rate", "parameters at every step", steps * parameters, 4.0 + 2.0 * packed_steps),
            table(
                "output.snapshots",
                "signals of every kept trajectory",
                trajectory * (1.0 + self.snapshots().len() as f64),
                1.0,
            ),
            table(
                "learning.rollouts",
                "costs of every rollout and step",
                steps * rollouts,
                1.0 + 2.5 * packed_steps * packed_rollouts,
            ),
            table("learning.updates", "rows of learning", ROW * learning.updates as f64, 4.0),
            table("learning.draws", "what all draws meet", MET * axes * all_steps * self.draws() as f64, 1.0),
        ];
        if learning.method == Method::Pi2 {
            let changes = match learning.exploration {
                Some(kind) => kind != ExplorationKind::Rollout,
                None => learning.preset == Preset::Paper,
            };
            tables.push(if changes {
                let what = "samples of every rollout, step and parameter";
                table("learning.rollouts", what, steps * rollouts * parameters, 1.0)
            } else {
                table("learning.rollouts", "samples of every rollout and parameter", rollouts * parameters, 1.0)
            });
        } else if learning.method == Method::CmaEs {
            tables.push(table(
                "learning.rollouts",
                "samples of every rollout and parameter",
                rollouts * parameters,
                2.0,
            ));
            tables.push(table("movement.basis", "parameters against parameters", parameters * parameters, 8.0));
        } else {
            let weighs = |weight: &PerAxis| weight.values().iter().any(|&weight| weight > 0.0);
            let free = self.via_point.iter().filter(|via| via.time.is_none() && cost.via_distance > 0.0).count();
            let by_step = axes * (f64::from(u8::from(weighs(&cost.acceleration))) + free as f64)
                + f64::from(u8::from(cost.tracking > 0.0))
                + f64::from(u8::from(cost.contact_force > 0.0));
            let resting = axes * f64::from(u8::from(weighs(&cost.rest)));
            let signals = by_step * (steps + 1.0)
                + resting * 2.0 * (all_steps - steps + 1.0)
                + axes * (2.0 + self.via_point.len() as f64);
            let signals = signals * self.draws() as f64;
            // A process may tell costs alone, of which squares are learned.
            let (signals, copies) = match self.environment {
                Some(_) => (signals.max(SQUARES * (steps + 1.0)), 4.0),
                None => (signals, 3.0),
            };
            tables.push(table("movement.basis", "parameters against signals", parameters * signals, copies));
            tables.push(table("movement.basis", "parameters against parameters", parameters * parameters, 8.0));
        }
        tables
    }

    /// The table with more than [`MAX_NUMBERS`], or where together they need too much memory the largest.
    pub(super) fn too_large(&self) -> Option<Table> {
        let tables = self.tables();
        let needs_too_much = self.memory(1) > MAX_MEMORY;
        let bytes = |table: &Table| table.copies * table.numbers;
        match tables.iter().position(|table| table.numbers > MAX_NUMBERS as f64) {
            Some(index) => tables.into_iter().nth(index),
            None if needs_too_much => tables.into_iter().max_by(|a, b| bytes(a).total_cmp(&bytes(b))),
            None => None,
        }
    }
}
