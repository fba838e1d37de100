//! The least of a quadratic in a box, by active sets.
//!
//! ```text
//! minimise  g^T x + 1/2 x^T H x   with  lo <= x <= hi,  lo <= 0 <= hi,  H positive definite
//! ```
//! From x = 0: step towards the least over the free coordinates until the first bound, which then holds its
//! coordinate; at the least, let go of the coordinate that pulls inward most. Each step lowers the quadratic
//! (Nocedal, Wright, Numerical Optimization, 2006, Algorithm 16.3).

use nalgebra::{DMatrix, DVector};

/// Steps per coordinate after which the search ends where it is: a point in the box, lower than x = 0.
const STEPS_PER_COORDINATE: usize = 4;

/// A pull inward smaller than this, relative to the largest slope at x = 0, is rounding.
const SLOPE_ROUNDING: f64 = 1e-10;

/// The least of the quadratic in the box; `None` where H is not positive definite.
pub(crate) fn box_step(h: &DMatrix<f64>, g: &DVector<f64>, lo: &[f64], hi: &[f64]) -> Option<DVector<f64>> {
    let n = g.len();
    let mut x = DVector::zeros(n);
    let mut held = vec![false; n];
    let rounding = SLOPE_ROUNDING * g.amax();
    for _ in 0..STEPS_PER_COORDINATE * n + 1 {
        let free: Vec<usize> = (0..n).filter(|&j| !held[j]).collect();
        let slope = h * &x + g;
        let inner = h.select_rows(&free).select_columns(&free).cholesky()?;
        let step = inner.solve(&DVector::from_iterator(free.len(), free.iter().map(|&j| -slope[j])));
        // The share of the step up to the first bound.
        let (mut share, mut blocking) = (1.0, None);
        for (&j, d) in free.iter().zip(&step) {
            let bound = if *d > 0.0 { hi[j] } else { lo[j] };
            if *d != 0.0 && (bound - x[j]) / d < share {
                (share, blocking) = (((bound - x[j]) / d).max(0.0), Some((j, bound)));
            }
        }
        for (&j, d) in free.iter().zip(&step) {
            x[j] = (x[j] + share * d).max(lo[j]).min(hi[j]);
        }
        if let Some((j, bound)) = blocking {
            x[j] = bound;
            held[j] = true;
            continue;
        }
        let slope = h * &x + g;
        let inward = |j: usize| if x[j] <= lo[j] { -slope[j] } else { slope[j] };
        let release = (0..n).filter(|&j| held[j] && lo[j] < hi[j]).max_by(|&a, &b| inward(a).total_cmp(&inward(b)));
        match release {
            Some(j) if inward(j) > rounding => held[j] = false,
            _ => break,
        }
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(n: usize) -> (DMatrix<f64>, DVector<f64>) {
        let mut value = 0.3_f64;
        let mut next = || {
            value = (value * 997.13).fract();
            2.0 * value - 1.0
        };
        let root = DMatrix::from_fn(n, n, |_, _| next());
        let g = DVector::from_fn(n, |_, _| 3.0 * next());
        (root.tr_mul(&root) + DMatrix::identity(n, n) * 0.1, g)
    }

    #[test]
    fn without_bounds_in_reach_the_slope_is_zero() {
        let (h, g) = problem(12);
        let x = box_step(&h, &g, &[-1e9; 12], &[1e9; 12]).unwrap();
        assert!((&h * &x + &g).amax() < 1e-9);
    }

    #[test]
    fn at_the_least_no_free_slope_is_left_and_no_bound_pulls_inward() {
        let (h, g) = problem(30);
        let (lo, hi) = (vec![-0.4; 30], vec![0.3; 30]);
        let x = box_step(&h, &g, &lo, &hi).unwrap();
        let slope = &h * &x + &g;
        let mut on_bound = 0;
        for j in 0..30 {
            assert!((lo[j]..=hi[j]).contains(&x[j]));
            on_bound += usize::from(x[j] == lo[j] || x[j] == hi[j]);
            // 1e-8: rounding of 30 products of numbers near 10.
            let fits = if x[j] == lo[j] {
                slope[j] > -1e-8
            } else if x[j] == hi[j] {
                slope[j] < 1e-8
            } else {
                slope[j].abs() < 1e-8
            };
            assert!(fits, "coordinate {j}: {} {}", x[j], slope[j]);
        }
        assert!(on_bound > 3);
    }

    #[test]
    fn a_closed_box_leaves_its_point() {
        let (h, g) = problem(3);
        let x = box_step(&h, &g, &[0.0; 3], &[0.0; 3]).unwrap();
        assert_eq!(x, DVector::zeros(3));
    }
}
