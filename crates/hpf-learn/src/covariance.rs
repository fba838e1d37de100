//! Covariance: how the shape of the exploration follows what was learned.

/// How the exploration's standard deviations change with the updates, before the annealing scales them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Covariance {
    /// Not at all.
    Fixed,
    /// Each parameter's follows the spread of the rollouts that weigh: `sigma_j^2 <- (1 - r) sigma_j^2 + r sum_k P_k
    /// eps_jk^2`, r = [`ADAPTATION_RATE`], P of the rollouts' total costs (PI2-CMA's diagonal: Stulp, Sigaud, ICML
    /// 2012). Step-wise noise cannot tell its own parameters apart and adapts by its mean over the steps.
    Diagonal {
        /// Least value, as a fraction of the block's noise.
        floor: f64,
        /// Largest value, as a fraction of the block's noise.
        ceiling: f64,
    },
}

/// Share of the new spread in an update of the covariance.
pub const ADAPTATION_RATE: f64 = 0.5;

impl Covariance {
    /// The standard deviation after an update, as a fraction of the block's noise, from the mean square exploration
    /// of the rollouts that weigh, in the same measure.
    pub(crate) fn next(&self, sigma: f64, mean_square: f64) -> f64 {
        match *self {
            Self::Fixed => sigma,
            Self::Diagonal { floor, ceiling } => {
                let square = (1.0 - ADAPTATION_RATE) * sigma * sigma + ADAPTATION_RATE * mean_square;
                square.sqrt().max(floor).min(ceiling)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_moves_halfway_in_squares_and_stays_between_its_bounds() {
        let covariance = Covariance::Diagonal { floor: 0.1, ceiling: 2.0 };
        assert!((covariance.next(1.0, 0.5) - 0.75_f64.sqrt()).abs() < 1e-15);
        assert_eq!(covariance.next(0.1, 0.0), 0.1);
        assert_eq!(covariance.next(2.0, 100.0), 2.0);
        assert_eq!(Covariance::Fixed.next(0.7, 100.0), 0.7);
    }
}
