//! The bases of a policy: lists of centers and widths, and what they are Gaussians of.

use hpf_core::{Basis, ConfigError, Real};
use serde::{Deserialize, Serialize};

use super::{PolicyError, value_error};
use crate::task::{BasisFamily, MAX_BASIS};

/// What the basis functions of a primitive are Gaussians of.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Family {
    /// The phase; a policy file says nothing of it.
    #[default]
    Phase,
    /// Time: `widths` hold what a function has fallen to j spacings from its center.
    Time {
        /// Value of a function at its neighbour's center.
        overlap: f64,
    },
}

impl Family {
    pub(super) fn is_phase(&self) -> bool {
        *self == Self::Phase
    }
}

/// One basis of a policy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolicyBasis<'p> {
    /// Its family.
    pub family: Family,
    /// Its centers, oldest phase first.
    pub centers: &'p [f64],
    /// Its widths; of the time family, what a function has fallen to j spacings from its center.
    pub widths: &'p [f64],
}

impl PolicyBasis<'_> {
    /// The basis in the scalar `T`, over a phase that falls by `decay`.
    ///
    /// # Errors
    /// [`ConfigError`] where its numbers cannot be in `T`.
    pub fn to_basis<T: Real>(&self, decay: f64) -> Result<Basis<T, Vec<T>>, ConfigError> {
        let list = |numbers: &[f64]| -> Vec<T> { numbers.iter().map(|&number| T::of(number)).collect() };
        match self.family {
            Family::Phase => Basis::new(list(self.centers), list(self.widths)),
            Family::Time { overlap } => {
                let zeros = vec![T::ZERO; self.centers.len()];
                Basis::equally_spaced_in_time(T::of(decay), T::of(overlap), zeros.clone(), zeros)
            }
        }
    }

    /// Checks it, and that it has one weight per function.
    pub(super) fn check(&self, place: &str, decay: f64, weights: &[f64]) -> Result<(), PolicyError> {
        let (centers, widths) = (self.centers, self.widths);
        match self.family {
            Family::Phase => Basis::new(centers, widths),
            Family::Time { overlap } => Basis::stored_in_time(decay, overlap, centers, widths),
        }
        .map_err(|reason| value_error(place, reason))?;
        if centers.len() > MAX_BASIS {
            return Err(value_error(
                place,
                format!("at most {MAX_BASIS} basis functions are allowed, not {}", centers.len()),
            ));
        }
        if weights.len() != centers.len() {
            let reason = format!("{} weights for {} centers", weights.len(), centers.len());
            return Err(value_error(format!("{place}.weights"), reason));
        }
        Ok(())
    }
}

/// Family, centers and widths of a basis of `count` functions, neighbours meeting at `overlap`.
pub(super) fn spaced(
    family: BasisFamily,
    count: usize,
    overlap: f64,
    decay: f64,
) -> Result<(Family, Vec<f64>, Vec<f64>), ConfigError> {
    let zeros = vec![0.0; count];
    let (family, basis) = match family {
        BasisFamily::Phase => (Family::Phase, Basis::equally_spaced(decay, overlap, zeros.clone(), zeros)?),
        BasisFamily::Time => {
            (Family::Time { overlap }, Basis::equally_spaced_in_time(decay, overlap, zeros.clone(), zeros)?)
        }
    };
    Ok((family, basis.centers().to_vec(), basis.widths().to_vec()))
}
