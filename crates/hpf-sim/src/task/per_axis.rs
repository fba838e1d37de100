//! A key with a value for each axis.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A value for every axis: one number for all, or an array in axis order.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
pub enum PerAxis {
    /// The same for all axes.
    All(f64),
    /// One per axis.
    Each(Vec<f64>),
}

impl Default for PerAxis {
    fn default() -> Self {
        Self::All(0.0)
    }
}

impl PerAxis {
    /// How many values are written down, where there is one for each axis.
    pub(crate) fn count(&self) -> Option<usize> {
        match self {
            Self::All(_) => None,
            Self::Each(values) => Some(values.len()),
        }
    }

    /// The value of axis `index`.
    ///
    /// # Panics
    /// Where the array is shorter; a checked task's never is.
    pub fn of(&self, index: usize) -> f64 {
        match self {
            Self::All(value) => *value,
            Self::Each(values) => values[index],
        }
    }

    /// The value of axis `index`, where there is one.
    pub(crate) fn get(&self, index: usize) -> Option<f64> {
        match self {
            Self::All(value) => Some(*value),
            Self::Each(values) => values.get(index).copied(),
        }
    }

    /// Where the `index`th of [`values`](Self::values) stands, in a file that has this under `path`.
    pub(crate) fn place(&self, path: &str, index: usize) -> String {
        match self {
            Self::All(_) => path.to_owned(),
            Self::Each(_) => format!("{path}.{index}"),
        }
    }

    /// All values written down.
    pub fn values(&self) -> &[f64] {
        match self {
            Self::All(value) => core::slice::from_ref(value),
            Self::Each(values) => values,
        }
    }
}
