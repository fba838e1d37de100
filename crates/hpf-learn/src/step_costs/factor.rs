//! The squares that one cost is made of, from costs.
//!
//! With `r(x) = 1/2 |s + A x|^2` known around x = 0 by its value, its rises `r(h_j e_j) - r(0)` and its turns, the
//! differences `(r(v_k + h_j e_j) - r(v_k) - r(h_j e_j) + r(0))/h_j` of these at the ways v_k:
//! ```text
//! U      = A^T A V                         the turns, exact where s answers linearly, however long h_j and v_k
//! A      = L^-1/2 Q^T U^T,  V^T U = Q L Q^T
//! g_j    = rise_j/h_j - h_j/2 |A e_j|^2    slopes
//! s      : least squares of A^T s = g
//! ```
//! A^T A so found is that of the cost where it has at most as many squares as there are ways, else the largest share of
//! it (Nystrom's approximation). What s leaves of the cost and of its slope is one more square, a root: it has the value
//! `sqrt(2 r - |s|^2)` and the slope `(g - A^T s)` over it.
//!
//! Sources: Williams, Seeger, NIPS 13:682, 2000; Halko, Martinsson, Tropp, SIAM Review 53:217, 2011.

use nalgebra::{DMatrix, DVector};

/// Directions with a smaller share than this of the largest turn are rounding.
const LEAST_TURN: f64 = 1e-8;
/// The same for what a slope tells of s.
const LEAST_SLOPE: f64 = 1e-10;
/// A rest with a smaller share of the cost than this is rounding.
const LEAST_REST: f64 = 1e-6;
/// How much less than the largest a pair of rollouts must tell of a direction of s for the expected value to weigh as
/// much as it.
const TRUST: f64 = 3e-3;

/// What is known of a cost around a base.
pub(super) struct Differences {
    /// At the base.
    pub(super) cost: f64,
    /// Change of the cost, per parameter.
    pub(super) rises: DVector<f64>,
    /// Change of the slope, parameters x ways.
    pub(super) turns: DMatrix<f64>,
}

/// s and A of a cost that was told at `lengths` along each parameter and at `ways`, one square more than ways.
pub(super) fn factor(
    differences: &Differences,
    lengths: &DVector<f64>,
    ways: &DMatrix<f64>,
) -> (DVector<f64>, DMatrix<f64>) {
    let Differences { cost, rises, turns } = differences;
    let (n, count) = ways.shape();
    let overlap = ways.tr_mul(turns);
    let eigen = (0.5 * (&overlap + overlap.transpose())).symmetric_eigen();
    let least = LEAST_TURN * eigen.eigenvalues.amax();
    let mut a = DMatrix::zeros(count + 1, n);
    for (i, turn) in eigen.eigenvalues.iter().enumerate().filter(|(_, turn)| **turn > least) {
        a.set_row(i, &(turns * eigen.eigenvectors.column(i) / turn.sqrt()).transpose());
    }
    let slope = DVector::from_fn(n, |j, _| rises[j] / lengths[j] - 0.5 * lengths[j] * a.column(j).norm_squared());
    let mut s = ridge(&(&a * a.transpose()), &(&a * &slope), LEAST_SLOPE);
    let whole = 2.0 * cost;
    shorten(&mut s, whole);
    let rest = whole - s.norm_squared();
    if rest > LEAST_REST * whole {
        let left = (slope - a.tr_mul(&s)) / rest.sqrt();
        s[count] = rest.sqrt();
        a.set_row(count, &left.transpose());
    }
    (s, a)
}

/// s where the cost is half the square of `root` and differs by `changes` between rollouts both ways, between which s
/// differs by the rows of `answers`: `s^T answer = change`, as near to what is `expected` as that allows.
pub(super) fn locate(
    expected: DVector<f64>,
    answers: &DMatrix<f64>,
    changes: &DVector<f64>,
    root: f64,
) -> DVector<f64> {
    let miss = changes - answers * &expected;
    let mut s = expected + ridge(&answers.tr_mul(answers), &answers.tr_mul(&miss), TRUST);
    // The last square takes what the others leave.
    let last = s.len() - 1;
    s[last] = 0.0;
    shorten(&mut s, root * root);
    s[last] = (root * root - s.norm_squared()).max(0.0).sqrt();
    s
}

/// The solution of `gram x = right`, held small where `gram` says less than `share` of the most it says.
fn ridge(gram: &DMatrix<f64>, right: &DVector<f64>, share: f64) -> DVector<f64> {
    let most = gram.diagonal().amax();
    let held = gram + DMatrix::identity(gram.nrows(), gram.ncols()) * (share * most);
    held.cholesky().map_or_else(|| DVector::zeros(right.len()), |held| held.solve(right))
}

/// Brings `s` to a squared length of at most `most`.
fn shorten(s: &mut DVector<f64>, most: f64) {
    let length = s.norm_squared();
    if length > most {
        *s *= (most / length).sqrt();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: usize = 7;

    fn number(i: usize, j: usize) -> f64 {
        (1.0 + 1.7 * i as f64 + 5.3 * j as f64 + 0.9 * (i * j) as f64).sin()
    }

    /// Half the square of `squares` signals.
    struct Sum(DVector<f64>, DMatrix<f64>);

    impl Sum {
        fn new(squares: usize) -> Self {
            Self(DVector::from_fn(squares, |i, _| 2.0 * number(i, 31)), DMatrix::from_fn(squares, COUNT, number))
        }

        fn cost(&self, x: &DVector<f64>) -> f64 {
            0.5 * (&self.0 + &self.1 * x).norm_squared()
        }

        fn factor(&self, ways: usize) -> Self {
            let lengths = DVector::from_fn(COUNT, |j, _| if j % 2 == 0 { 0.3 } else { -0.2 });
            let ways = DMatrix::from_fn(COUNT, ways, |j, k| 0.5 * number(j + 11, k));
            let rise = |from: &DVector<f64>, j: usize| {
                let mut moved = from.clone();
                moved[j] += lengths[j];
                self.cost(&moved) - self.cost(from)
            };
            let base = DVector::zeros(COUNT);
            let turn = |j: usize, k: usize| (rise(&ways.column(k).into_owned(), j) - rise(&base, j)) / lengths[j];
            let differences = Differences {
                cost: self.cost(&base),
                rises: DVector::from_fn(COUNT, |j, _| rise(&base, j)),
                turns: DMatrix::from_fn(COUNT, ways.ncols(), turn),
            };
            let (s, a) = factor(&differences, &lengths, &ways);
            Self(s, a)
        }
    }

    #[test]
    fn a_cost_of_as_many_squares_as_ways_is_known_everywhere() {
        for squares in 1..=3 {
            let (sum, far) = (Sum::new(squares), DVector::from_fn(COUNT, |j, _| 10.0 * number(j, 17)));
            let found = sum.factor(3);
            for x in [DVector::zeros(COUNT), far] {
                let (is, told) = (sum.cost(&x), found.cost(&x));
                assert!((is - told).abs() < 1e-6 * is, "{squares} squares: {is} {told}");
            }
        }
    }

    #[test]
    fn of_a_cost_of_more_squares_the_value_is_known_and_never_too_much_bend() {
        let sum = Sum::new(5);
        let found = sum.factor(3);
        let base = DVector::zeros(COUNT);
        assert!((found.cost(&base) - sum.cost(&base)).abs() < 1e-12);
        assert!((0..COUNT).map(|j| DVector::from_fn(COUNT, |i, _| number(i, j))).all(|x| {
            let (told, is) = (found.1.rows(0, 3) * &x, &sum.1 * &x);
            told.norm() < (1.0 + 1e-9) * is.norm()
        }));
    }

    #[test]
    fn pairs_of_rollouts_tell_where_squares_are_that_costs_alone_tell_the_length_of() {
        let Sum(s, a) = Sum::new(4);
        let ways = DMatrix::from_fn(COUNT, 6, |j, k| number(j + 3, k + 5));
        let answers = (&a * &ways).transpose();
        let changes = &answers * &s;
        let expected = DVector::from_fn(4, |i, _| s.norm() * if i == 1 { 1.0 } else { 0.0 });
        let before = (&expected - &s).norm();
        let found = locate(expected, &answers, &changes, s.norm());
        assert!((found.norm() - s.norm()).abs() < 1e-12);
        // The last square is taken for positive; which way it points is told by none of the others.
        assert!((found.rows(0, 3) - s.rows(0, 3)).norm() < 0.1 * before, "{found} {s}");
    }
}
