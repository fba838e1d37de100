//! A simulation as something to learn.

use core::slice;

use hpf_learn::{
    Anneal, AutoOptions, Block, CmaEsOptions, Cost, Covariance, Credit, Draws, Exploration, GaussNewtonOptions, Method,
    Model, Parameters, Pi2Options, Problem, SignalModel, Temperature, Wants, fit,
};

use crate::environment::cantilever::minimum_jerk;
use crate::model::EnvironmentModel;
use crate::policy::{AxisPolicy, Policy};
use crate::simulation::{LANES, Simulation, Workspace};
use crate::task::{self, AnnealKind, CreditKind, ExplorationKind, InitialPath, Learning, Preset, TemperatureKind};

impl Problem for Simulation {
    type Workspace = Workspace;

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn steps(&self) -> usize {
        self.step_count()
    }

    fn terms(&self) -> &[&'static str] {
        self.term_names()
    }

    fn workspace(&self) -> Workspace {
        Workspace::default()
    }

    fn motions(&self) -> usize {
        self.task.draws()
    }

    fn is_random(&self) -> bool {
        self.is_random
    }

    fn may_run_ahead(&self) -> bool {
        true
    }

    fn rollout(&self, draws: Draws, parameters: Parameters<'_>, workspace: &mut Workspace, cost: &mut Cost) {
        self.roll_draws(draws, &[parameters], workspace, slice::from_mut(cost));
    }

    fn batch_size(&self) -> usize {
        LANES
    }

    fn rollouts(&self, draws: Draws, parameters: &[Parameters<'_>], workspace: &mut Workspace, costs: &mut [Cost]) {
        self.roll_draws(draws, parameters, workspace, costs);
    }

    fn signals(&self) -> Option<&SignalModel> {
        Some(&self.signals)
    }

    fn measure(
        &self,
        draws: Draws,
        parameters: Parameters<'_>,
        workspace: &mut Workspace,
        cost: &mut Cost,
        signals: &mut Vec<f64>,
    ) {
        self.observe_draws((draws, 0), parameters, Wants::Signals, workspace, cost, signals);
    }

    fn model(&self) -> Option<Box<dyn Model>> {
        EnvironmentModel::new(self).map(|model| Box::new(model) as Box<dyn Model>)
    }

    fn observe(
        &self,
        (draws, number): (Draws, usize),
        parameters: Parameters<'_>,
        wants: Wants,
        workspace: &mut Workspace,
        cost: &mut Cost,
        shown: &mut Vec<f64>,
    ) {
        self.observe_draws((draws, number), parameters, wants, workspace, cost, shown);
    }
}

impl Learning {
    /// The method that the keys of `[learning]` ask for.
    pub fn method(&self) -> Method {
        let signals = GaussNewtonOptions { rollouts: self.rollouts, updates: self.updates, seed: self.seed };
        match self.method {
            task::Method::Pi2 => Method::Pi2(self.pi2_options()),
            task::Method::GaussNewton => Method::GaussNewton(signals),
            task::Method::Auto => {
                Method::Auto(AutoOptions { rollouts: self.rollouts, updates: self.updates, seed: self.seed })
            }
            task::Method::Model => {
                Method::Model(AutoOptions { rollouts: self.rollouts, updates: self.updates, seed: self.seed })
            }
            task::Method::CmaEs => {
                Method::CmaEs(CmaEsOptions { rollouts: self.rollouts, updates: self.updates, seed: self.seed })
            }
        }
    }

    /// The settings of PI2 from the keys of `[learning]`: the preset's, where a key is left out.
    pub fn pi2_options(&self) -> Pi2Options {
        let preset = match self.preset {
            Preset::Pi2 => Pi2Options::default(),
            Preset::Paper => Pi2Options::paper(PAPER_LAMBDA),
            Preset::BlackBox => Pi2Options::black_box(),
        };
        Pi2Options {
            rollouts: self.rollouts,
            updates: self.updates,
            temperature: match self.temperature {
                Some(TemperatureKind::Rank) => Temperature::Rank,
                Some(TemperatureKind::EffectiveSize(size)) => Temperature::EffectiveSize(size),
                Some(TemperatureKind::Range(h)) => Temperature::Range(h),
                Some(TemperatureKind::Lambda(lambda)) => Temperature::Lambda(lambda),
                None => preset.temperature,
            },
            credit: match self.credit {
                Some(CreditKind::ToGo) => Credit::ToGo,
                Some(CreditKind::Total) => Credit::Total,
                None => preset.credit,
            },
            exploration: match self.exploration {
                Some(ExplorationKind::Rollout) => Exploration::Rollout,
                Some(ExplorationKind::Basis) => Exploration::Basis,
                Some(ExplorationKind::Step) => Exploration::Step,
                None => preset.exploration,
            },
            anneal: match self.anneal {
                AnnealKind::None => Anneal::None,
                AnnealKind::Linear => Anneal::Linear { last: self.final_noise },
                AnnealKind::Geometric => Anneal::Geometric { last: self.final_noise },
            },
            covariance: match self.covariance {
                Some(bounds) => Covariance::Diagonal { floor: bounds.floor, ceiling: bounds.ceiling },
                None => preset.covariance,
            },
            is_projected: self.projection.unwrap_or(preset.is_projected),
            seed: self.seed,
        }
    }
}

/// lambda of the paper's preset, in the unit of the cost. The paper does not state its value; this one is a choice.
const PAPER_LAMBDA: f64 = 0.1;

/// Penalty of the fit that starts a path: enough to determine the weights, too little to bend the path.
const START_PENALTY: f64 = 1e-9;

impl Simulation {
    /// The parameters of `policy` in the order that rollouts take them: its weights, axis by axis, and after those of
    /// each axis its goal where the task learns goals.
    pub fn parameters(&self, policy: &Policy) -> Vec<f64> {
        let learns_goal = self.task.learns_goal();
        let axis = |axis: &AxisPolicy| {
            let lists = [&axis.movement.weights, &axis.stiffness.weights, &axis.damping.weights];
            lists.into_iter().flatten().copied().chain(learns_goal.then_some(axis.goal)).collect::<Vec<_>>()
        };
        policy.axes.iter().flat_map(axis).collect()
    }

    /// The parameters that learning starts from: the policy's own, or those of the path that the task asks for.
    ///
    /// # Errors
    /// [`fit::FitError`] where the path cannot be fitted, or not by weights that a controller takes.
    pub fn starting_weights(&self, policy: &Policy) -> Result<Vec<f64>, fit::FitError> {
        let mut policy = policy.clone();
        if self.task.learning.initial_path == InitialPath::MinimumJerk {
            let phases = self.blank_trace().phase;
            let middle: Vec<f64> = phases.windows(2).map(|pair| (pair[0] * pair[1]).sqrt()).collect();
            for (axis, blocks) in
                policy.axes.iter_mut().zip(self.blocks.chunks_exact(self.blocks.len() / self.task.axis.len()))
            {
                let steps = self.step_count();
                let path = |i: usize| axis.start + (axis.goal - axis.start) * minimum_jerk(i as f64 / steps as f64);
                let positions: Vec<f64> = (0..=steps).map(path).collect();
                let movement = &mut axis.movement;
                let forcing = fit::movement_forcing(&positions, axis.goal, movement.alpha, 1.0 / steps as f64);
                let rows = blocks[0].features.chunks_exact(blocks[0].count).zip(&middle);
                let scale = movement.forcing_scale;
                let features: Vec<f64> = rows.flat_map(|(row, s)| row.iter().map(move |phi| s * scale * phi)).collect();
                let penalty = START_PENALTY * scale * scale;
                movement.weights = fit::ridge(&features, blocks[0].count, &forcing, penalty)?;
                let weight = movement.weights.iter().fold(0.0_f64, |largest, weight| largest.max(weight.abs()));
                let most = blocks[0].max;
                if weight > most {
                    return Err(fit::FitError::Domain { weight, most });
                }
            }
        }
        Ok(self.parameters(&policy))
    }
}
