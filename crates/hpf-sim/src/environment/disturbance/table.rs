//! A force from a table: linear between its rows, held at its ends.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A force from a CSV file, linear between its rows and held at its ends.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Table {
    /// Axis it acts on.
    pub axis: String,
    /// CSV file beside the task file, with a header `time_s,force_n` and rising times.
    pub file: String,
    /// What the file says; filled by whoever reads files.
    #[serde(skip)]
    pub samples: Samples,
}

/// Rows of a force table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    times: Vec<f64>,
    forces: Vec<f64>,
}

/// Why a force table was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TableError {
    /// It has no row.
    #[error("the table has no row")]
    Empty,
    /// A number is infinite or NaN.
    #[error("a number is not finite")]
    NotFinite {
        /// Counted from 0.
        row: usize,
    },
    /// A time is not above the one before.
    #[error("the time does not rise")]
    NotRising {
        /// Counted from 0.
        row: usize,
    },
}

impl TableError {
    /// The row it is about, counted from 0.
    pub fn row(&self) -> Option<usize> {
        match *self {
            Self::Empty => None,
            Self::NotFinite { row } | Self::NotRising { row } => Some(row),
        }
    }
}

impl Samples {
    /// A table from rows of time [s] and force [N].
    ///
    /// # Errors
    /// [`TableError`] for no rows, numbers that are not finite, and times that do not rise.
    pub fn new(rows: &[(f64, f64)]) -> Result<Self, TableError> {
        if rows.is_empty() {
            return Err(TableError::Empty);
        }
        let mut last = f64::NEG_INFINITY;
        for (index, &(time, force)) in rows.iter().enumerate() {
            if !time.is_finite() || !force.is_finite() {
                return Err(TableError::NotFinite { row: index });
            }
            if time <= last {
                return Err(TableError::NotRising { row: index });
            }
            last = time;
        }
        Ok(Self { times: rows.iter().map(|row| row.0).collect(), forces: rows.iter().map(|row| row.1).collect() })
    }

    /// The rows, for writing them out again.
    pub fn rows(&self) -> impl Iterator<Item = (f64, f64)> {
        self.times.iter().copied().zip(self.forces.iter().copied())
    }
}

impl Table {
    pub(super) fn force(&self, time: f64) -> f64 {
        let Samples { times, forces } = &self.samples;
        let next = times.partition_point(|&t| t <= time);
        match (next.checked_sub(1), forces.get(next)) {
            (Some(before), Some(after)) => {
                let share = (time - times[before]) / (times[next] - times[before]);
                forces[before] + share * (after - forces[before])
            }
            (Some(before), None) => forces[before],
            (None, first) => first.copied().unwrap_or(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_linear_between_rows_and_held_at_its_ends() {
        let samples = Samples::new(&[(1.0, 2.0), (2.0, 4.0), (4.0, 0.0)]).unwrap();
        let table = Table { axis: "x".into(), file: String::new(), samples };
        assert_eq!(
            [0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0].map(|time| table.force(time)),
            [2.0, 2.0, 3.0, 4.0, 2.0, 0.0, 0.0]
        );
    }

    #[test]
    fn bad_tables_are_refused_by_row() {
        assert_eq!(Samples::new(&[]), Err(TableError::Empty));
        assert_eq!(Samples::new(&[(0.0, 1.0), (0.0, 2.0)]), Err(TableError::NotRising { row: 1 }));
        assert_eq!(Samples::new(&[(0.0, f64::NAN)]), Err(TableError::NotFinite { row: 0 }));
    }
}
