//! Numbers of a task file that may be drawn anew for every motion.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A number, or a distribution that it is drawn from.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Quantity {
    /// The same in every motion.
    Fixed(f64),
    /// Drawn for each.
    Drawn(Distribution),
}

/// What a number is drawn from.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Distribution {
    /// Evenly between two numbers.
    Uniform([f64; 2]),
    /// Normally: mean and standard deviation.
    Normal([f64; 2]),
    /// One of these, each as likely.
    Choice(#[schemars(length(min = 1, max = 1000))] Vec<f64>),
}

impl From<f64> for Quantity {
    fn from(number: f64) -> Self {
        Self::Fixed(number)
    }
}

impl Quantity {
    /// The number, or the mean of what it is drawn from.
    pub fn mean(&self) -> f64 {
        match self {
            Self::Fixed(number) | Self::Drawn(Distribution::Normal([number, _])) => *number,
            Self::Drawn(Distribution::Uniform([low, high])) => 0.5 * (low + high),
            Self::Drawn(Distribution::Choice(values)) => values.iter().sum::<f64>() / values.len() as f64,
        }
    }

    /// Whether it is the same in every motion.
    pub fn is_fixed(&self) -> bool {
        matches!(self, Self::Fixed(_))
    }

    /// The number below which a share `share` in (0, 1) of all draws lie: evenly drawn shares make draws.
    ///
    /// ```
    /// use hpf_sim::environment::{Distribution, Quantity};
    /// let amplitude = Quantity::Drawn(Distribution::Uniform([-10.0, 10.0]));
    /// assert_eq!(amplitude.quantile(0.75), 5.0);
    /// let bias = Quantity::Drawn(Distribution::Normal([1.0, 2.0]));
    /// assert!((bias.quantile(0.975) - (1.0 + 2.0 * 1.959_963_984_540_054)).abs() < 1e-12);
    /// ```
    pub fn quantile(&self, share: f64) -> f64 {
        match self {
            Self::Fixed(number) => *number,
            Self::Drawn(Distribution::Uniform([low, high])) => low + share * (high - low),
            Self::Drawn(Distribution::Normal([mean, deviation])) => mean + deviation * normal_quantile(share),
            Self::Drawn(Distribution::Choice(values)) => {
                values[((share * values.len() as f64) as usize).min(values.len() - 1)]
            }
        }
    }

    /// The same as a fixed number, drawn by `draw`.
    pub(crate) fn drawn(&self, draw: &mut impl FnMut(&Self) -> f64) -> Self {
        if self.is_fixed() { self.clone() } else { Self::Fixed(draw(self)) }
    }
}

/// The number below which a standard normal one lies with this `probability`.
fn normal_quantile(probability: f64) -> f64 {
    // Nothing beyond nine deviations is ever drawn: a share of 1e-19 is zero or one.
    let (mut low, mut high) = (-9.0, 9.0);
    for _ in 0..f64::MANTISSA_DIGITS + 4 {
        let middle = 0.5 * (low + high);
        if 0.5 * libm::erfc(-middle * core::f64::consts::FRAC_1_SQRT_2) < probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
