//! `[learning]`: how to learn.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::PerAxis;

/// What can be learned of an axis.
pub(super) const PRIMITIVES: [&str; 4] = ["movement", "stiffness", "damping", "goal"];

/// How to learn.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Learning {
    /// The learning method. Keys that only PI2 takes need it named.
    pub method: Method,
    /// Where the settings below start from.
    pub preset: Preset,
    /// Number of updates.
    #[schemars(range(min = 1, max = 1_000_000))]
    pub updates: usize,
    /// Rollouts per update.
    #[schemars(range(min = 2, max = 100_000))]
    pub rollouts: usize,
    /// Stop before more motions than this are made; every motion counts, evaluations too.
    #[schemars(range(min = 1, max = 9_223_372_036_854_775_807_i64))]
    pub max_rollouts: Option<usize>,
    /// What is learned: `"movement"`, `"stiffness"`, `"damping"`, `"goal"`, each of all axes or, as `"x.movement"`, of
    /// one; the rest keeps its start values. Left out: movement, stiffness and damping.
    #[schemars(length(min = 1, max = 100))]
    pub learn: Vec<String>,
    /// Motions of one rollout, each with its draws, where something is drawn; a rollout costs their mean.
    #[schemars(range(min = 1, max = 10_000))]
    pub draws: usize,
    /// Motions that the measures of a policy are taken over, where something is drawn: none that learning has seen.
    #[schemars(range(min = 1, max = 10_000))]
    pub evaluation_draws: usize,
    /// Standard deviation of the exploration at the first update.
    pub noise: Noise,
    /// When exploration is drawn; the preset decides where this is left out.
    pub exploration: Option<ExplorationKind>,
    /// How exploration shrinks over the updates.
    pub anneal: AnnealKind,
    /// Exploration at the last update, as a fraction of the first.
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1))]
    pub final_noise: f64,
    /// How costs become weights; the preset decides where this is left out.
    pub temperature: Option<TemperatureKind>,
    /// Which cost a step answers for; the preset decides where this is left out.
    pub credit: Option<CreditKind>,
    /// Let the exploration of each parameter follow the rollouts that weigh; left out, it keeps its shape.
    pub covariance: Option<CovarianceKind>,
    /// Whether an update moves the weights along the basis vectors only; the preset decides where this is left out.
    pub projection: Option<bool>,
    /// Limits that every planned motion keeps, by prediction; with `method = "model"`, which makes no others. The first
    /// motion is the start policy's.
    pub safety: Option<Safety>,
    /// The path that learning starts from.
    pub initial_path: InitialPath,
    /// Seed of all random numbers.
    #[schemars(range(max = 9_223_372_036_854_775_807_i64))]
    pub seed: u64,
}

impl Default for Learning {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            preset: Preset::Pi2,
            updates: 100,
            rollouts: 20,
            max_rollouts: None,
            learn: PRIMITIVES[..3].iter().map(|part| (*part).to_owned()).collect(),
            draws: 4,
            evaluation_draws: 100,
            noise: Noise::default(),
            exploration: None,
            anneal: AnnealKind::Linear,
            final_noise: 0.1,
            temperature: None,
            credit: None,
            covariance: None,
            projection: None,
            safety: None,
            initial_path: InitialPath::Pull,
            seed: 1,
        }
    }
}

/// Limits of planned motions.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Safety {
    /// Largest force on the tool, of a contact that with which it presses, above 0 [N or N m].
    pub max_force: Option<PerAxis>,
    /// Largest velocity of the tool, above 0 [axis unit/s].
    pub max_velocity: Option<PerAxis>,
    /// Where the tool may be: smallest and largest position of each axis [axis unit].
    pub workspace: Option<Vec<[f64; 2]>>,
}

/// A learning method.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
pub enum Method {
    /// Policy improvement with path integrals.
    #[serde(rename = "pi2")]
    Pi2,
    /// Gauss-Newton on the signals of a rollout: of the other keys it takes `updates`, `rollouts` (most made at a
    /// time), `max_rollouts`, `noise` (the largest perturbations), `initial_path` and `seed`.
    #[serde(rename = "gauss-newton")]
    GaussNewton,
    /// A model of the environment, fitted to the motions made and planned in: a few motions, none of them random. The keys
    /// of `gauss-newton` but `rollouts` and `noise`.
    #[serde(rename = "model")]
    Model,
    /// `model` where motions are recorded with position and force, then `gauss-newton` where the environment has signals;
    /// else the costs of the steps (their roots, then the squares that they are
    /// made of), then PI2; the keys of `gauss-newton`.
    #[serde(rename = "auto")]
    Auto,
    /// Evolution by covariance matrix adaptation, on the total cost: the keys of `gauss-newton`, `noise` being the
    /// standard deviations at the first update and `rollouts` the size of the population.
    #[serde(rename = "cma-es")]
    CmaEs,
}

impl Method {
    /// Its name in task files, summaries and logs.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pi2 => "pi2",
            Self::GaussNewton => "gauss-newton",
            Self::Model => "model",
            Self::Auto => "auto",
            Self::CmaEs => "cma-es",
        }
    }
}

/// Settings of PI2 to start from.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// The canonical method: one draw per rollout, range weights with h = 10, cost to go.
    Pi2,
    /// The paper's reading: noise at every step, a fixed lambda, the full sum as cost.
    Paper,
    /// Black box: an update is the weighted mean of the rollouts' parameters, by their full cost.
    #[serde(rename = "pi-bb")]
    BlackBox,
}

/// Standard deviation of the exploration, by primitive.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Noise {
    /// Of the movement's weights [1].
    pub movement: PerAxis,
    /// Of the stiffness's weights [N/m].
    pub stiffness: PerAxis,
    /// Of the damping's weights [N s/m].
    pub damping: PerAxis,
    /// Of the goal, where it is learned [axis unit].
    pub goal: PerAxis,
}

impl Default for Noise {
    fn default() -> Self {
        Self {
            movement: PerAxis::All(10.0),
            stiffness: PerAxis::All(20.0),
            damping: PerAxis::All(5.0),
            goal: PerAxis::All(0.01),
        }
    }
}

/// When exploration is drawn.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ExplorationKind {
    /// Once per rollout.
    Rollout,
    /// Once per rollout; at each step only the parameter of the most active basis function explores.
    Basis,
    /// At every step.
    Step,
}

/// How exploration shrinks.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum AnnealKind {
    /// Not at all.
    None,
    /// In equal differences.
    Linear,
    /// In equal ratios.
    Geometric,
}

/// How costs become weights: "rank", or a table with one of the keys.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TemperatureKind {
    /// By the order of the costs alone.
    Rank,
    /// softmax(-range (S - min)/(max - min)).
    Range(#[schemars(extend("exclusiveMinimum" = 0))] f64),
    /// softmax(-S/lambda), in the unit of the cost.
    Lambda(#[schemars(extend("exclusiveMinimum" = 0))] f64),
    /// As range, with the range at which this many rollouts count.
    EffectiveSize(#[schemars(range(min = 1))] f64),
}

/// Which cost a step answers for.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CreditKind {
    /// What comes after it.
    ToGo,
    /// The whole rollout's.
    Total,
}

/// Bounds of an exploration that adapts, as fractions of `noise`.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CovarianceKind {
    /// Least standard deviation.
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1))]
    pub floor: f64,
    /// Largest standard deviation.
    #[schemars(range(min = 1))]
    pub ceiling: f64,
}

/// The path that learning starts from.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum InitialPath {
    /// The bare pull to the goal: all weights zero.
    Pull,
    /// Minimum jerk from start to goal, fitted.
    MinimumJerk,
}
