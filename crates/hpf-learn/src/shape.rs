//! What must fit together: parameters, tables, bounds, and as many answers as were asked for.

use core::fmt;

use crate::Block;

/// What does not fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A list of another length.
    #[error("{what}: {found} numbers where {expected} belong")]
    Length {
        /// The list.
        what: String,
        /// Its length.
        found: usize,
        /// The length that it must have.
        expected: usize,
    },
    /// Bounds between which there is no number.
    #[error("block `{block}` has no range: {min} to {max}")]
    Range {
        /// Its name.
        block: String,
        /// Its lower bound.
        min: f64,
        /// Its upper bound.
        max: f64,
    },
    /// A noise that is no standard deviation.
    #[error("the noise of block `{block}` must be 0 or positive, not {noise}")]
    Noise {
        /// Its name.
        block: String,
        /// Its noise.
        noise: f64,
    },
}

/// That a list has the length it must have.
pub(crate) fn length(what: impl fmt::Display, found: usize, expected: usize) -> Result<(), ShapeError> {
    if found == expected { Ok(()) } else { Err(ShapeError::Length { what: what.to_string(), found, expected }) }
}

/// That `blocks` are sound, their tables over `steps` too where the method `has_tables`, and that there are `weights` of
/// them.
pub(crate) fn check(blocks: &[Block], steps: usize, weights: usize, has_tables: bool) -> Result<(), ShapeError> {
    for block in blocks {
        let (name, min, max, noise) = (|| block.name.clone(), block.min, block.max, block.noise);
        let tables = [("features", &block.features), ("activations", &block.activations)];
        for (what, table) in tables.into_iter().filter(|_| has_tables) {
            // Rows after the last step are not looked at.
            let size = steps * block.count;
            length(format_args!("{what} of block `{}`", block.name), table.len().min(size), size)?;
        }
        if min.is_nan() || max.is_nan() || min > max {
            return Err(ShapeError::Range { block: name(), min, max });
        }
        if !(noise >= 0.0 && noise.is_finite()) {
            return Err(ShapeError::Noise { block: name(), noise });
        }
    }
    length("weights", weights, blocks.iter().map(|block| block.count).sum())
}
