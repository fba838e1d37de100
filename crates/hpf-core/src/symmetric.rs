//! Symmetric matrices of three axes: stiffness and damping with directions.
//!
//! ```text
//! K = C diag(k) C^T          k: the principal values, along the columns of C
//! clamped                    C diag(min(max(k, lo), hi)) C^T: the nearest matrix with eigenvalues in [lo, hi]
//! ```
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | K | [`Symmetric`] | N/m or N m/rad; N s/m or N m s/rad |
//! | k | [`Eigen::values`] | the same |
//! | C | [`Eigen::vectors`], orthonormal | 1 |
//!
//! Eigenvalues by Jacobi's rotations: a fixed number of sweeps, so the cost is constant. Each value is right to a few units
//! in the last place of the largest.
//!
//! Source: Golub, Van Loan, Matrix Computations, 4th edition, 8.5, 2013.

use crate::domain::single;
use crate::rotation::{Matrix, Quaternion, dot, times};
use crate::{ConfigError, Real, error};

/// A symmetric matrix of three axes.
///
/// ```
/// use hpf_core::Symmetric;
/// // 400 N/m along the diagonal of x and y, 30 N/m across it and along z.
/// let stiffness = Symmetric { xx: 215.0_f64, xy: 185.0, yy: 215.0, zz: 30.0, ..Symmetric::diagonal([0.0; 3]) };
/// let [x, y, z] = stiffness.times([0.01, 0.01, 0.0]);
/// assert!((x - 4.0).abs() < 1e-15 && (y - 4.0).abs() < 1e-15 && z == 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetric<T> {
    /// First row, first column.
    pub xx: T,
    /// First row, second column, and the other way round.
    pub xy: T,
    /// First row, third column, and the other way round.
    pub xz: T,
    /// Second row, second column.
    pub yy: T,
    /// Second row, third column, and the other way round.
    pub yz: T,
    /// Third row, third column.
    pub zz: T,
}

/// Eigenvalues of a symmetric matrix, in no order, and their eigenvectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eigen<T> {
    /// The eigenvalues.
    pub values: [T; 3],
    /// The eigenvectors, one for each value, orthonormal.
    pub vectors: [[T; 3]; 3],
}

/// Sweeps of Jacobi's method: off-diagonal parts square with each, from the third sweep on.
const SWEEPS: u32 = 5;

/// So many suffice in single precision.
const SINGLE_SWEEPS: u32 = 4;

/// An off-diagonal number that is a smaller part of the diagonal changes no digit of an eigenvalue.
const NEGLIGIBLE: f64 = 1e-20;

/// The same in single precision.
const SINGLE_NEGLIGIBLE: f64 = 1e-12;

/// The least principal value of a damping matrix, of what is factored: a smaller one counts as this.
const SMALLEST_PIVOT: f64 = 1e-18;

impl<T: Real> Symmetric<T> {
    /// The diagonal matrix of three values.
    #[inline]
    pub fn diagonal([xx, yy, zz]: [T; 3]) -> Self {
        Self { xx, xy: T::ZERO, xz: T::ZERO, yy, yz: T::ZERO, zz }
    }

    /// The same value in all directions.
    #[inline]
    pub fn isotropic(value: T) -> Self {
        Self::diagonal([value; 3])
    }

    /// The matrix of a whole one by rows.
    ///
    /// # Errors
    /// [`ConfigError`] for numbers that are not finite, and where mirror images differ by more than rounding: 1e-6 of
    /// the largest number.
    pub fn of_rows(field: &'static str, rows: &Matrix<T>) -> Result<Self, ConfigError> {
        error::finite_list(field, rows.as_flattened(), 9)?;
        let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = *rows;
        let largest = rows.as_flattened().iter().fold(T::ZERO, |largest, part| largest.max(part.abs()));
        let most = largest.to_f64() * 1e-6;
        for gap in [xy - yx, xz - zx, yz - zy] {
            error::within(field, gap, -most, most)?;
        }
        let mean = |a: T, b: T| (a + b) * T::of(0.5);
        Ok(Self { xx, xy: mean(xy, yx), xz: mean(xz, zx), yy, yz: mean(yz, zy), zz })
    }

    /// The matrix of its six numbers, in the order of the fields.
    #[inline]
    pub fn of([xx, xy, xz, yy, yz, zz]: [T; 6]) -> Self {
        Self { xx, xy, xz, yy, yz, zz }
    }

    /// The six numbers, in the order of the fields.
    #[inline]
    pub fn numbers(&self) -> [T; 6] {
        let Self { xx, xy, xz, yy, yz, zz } = *self;
        [xx, xy, xz, yy, yz, zz]
    }

    /// The whole matrix by rows.
    #[inline]
    pub fn rows(&self) -> Matrix<T> {
        let Self { xx, xy, xz, yy, yz, zz } = *self;
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    }

    /// The matrix times a vector.
    #[inline]
    pub fn times(&self, vector: [T; 3]) -> [T; 3] {
        times(&self.rows(), vector)
    }

    /// `v^T K v`.
    ///
    /// ```
    /// use hpf_core::Symmetric;
    /// assert_eq!(Symmetric::diagonal([1.0, 10.0, 100.0]).quadratic([1.0, 2.0, 3.0]), 941.0);
    /// ```
    #[inline]
    pub fn quadratic(&self, vector: [T; 3]) -> T {
        dot(vector, self.times(vector))
    }

    /// `self + (other - self) share`: with a share in [0, 1], eigenvalues stay between the least and the largest of both.
    #[inline]
    pub fn towards(&self, other: &Self, share: T) -> Self {
        let mut mixed = self.numbers();
        for (slot, other) in mixed.iter_mut().zip(other.numbers()) {
            *slot += (other - *slot) * share;
        }
        Self::of(mixed)
    }

    /// `A K A^T` for a matrix A by rows.
    #[inline]
    fn within(&self, a: &Matrix<T>) -> Self {
        let [x, y, z] = *a;
        let [kx, ky, kz] = [self.times(x), self.times(y), self.times(z)];
        Self { xx: dot(x, kx), xy: dot(x, ky), xz: dot(x, kz), yy: dot(y, ky), yz: dot(y, kz), zz: dot(z, kz) }
    }

    /// `C K C^T`: this matrix of a turned frame, in the fixed one.
    ///
    /// ```
    /// use hpf_core::{Symmetric, rotation::Quaternion};
    /// let tool = Symmetric::diagonal([400.0_f64, 30.0, 30.0]); // stiff along the tool's x
    /// let base = tool.turned(&Quaternion::exp([0.0, 0.0, core::f64::consts::FRAC_PI_4]));
    /// assert!((base.xx - 215.0).abs() < 1e-12 && (base.xy - 185.0).abs() < 1e-12);
    /// ```
    #[inline]
    pub fn turned(&self, orientation: &Quaternion<T>) -> Self {
        self.within(&orientation.matrix())
    }

    /// Eigenvalues and eigenvectors.
    ///
    /// ```
    /// use hpf_core::Symmetric;
    /// let stiffness = Symmetric { xx: 215.0_f64, xy: 185.0, yy: 215.0, zz: 100.0, ..Symmetric::diagonal([0.0; 3]) };
    /// let mut values = stiffness.eigen().values;
    /// values.sort_by(f64::total_cmp);
    /// assert!((values[0] - 30.0).abs() < 1e-12 && (values[1] - 100.0).abs() < 1e-12 && (values[2] - 400.0).abs() < 1e-12);
    /// ```
    pub fn eigen(&self) -> Eigen<T> {
        let Self { mut xx, mut xy, mut xz, mut yy, mut yz, mut zz } = *self;
        let [mut u, mut v, mut w] =
            [[T::ONE, T::ZERO, T::ZERO], [T::ZERO, T::ONE, T::ZERO], [T::ZERO, T::ZERO, T::ONE]];
        for _ in 0..if single::<T>() { SINGLE_SWEEPS } else { SWEEPS } {
            rotate(&mut xx, &mut yy, &mut xy, [&mut xz, &mut yz], [&mut u, &mut v]);
            rotate(&mut xx, &mut zz, &mut xz, [&mut xy, &mut yz], [&mut u, &mut w]);
            rotate(&mut yy, &mut zz, &mut yz, [&mut xy, &mut xz], [&mut v, &mut w]);
        }
        Eigen { values: [xx, yy, zz], vectors: [u, v, w] }
    }

    /// The nearest matrix, as the squares of its numbers go, whose eigenvalues lie in `[min, max]`.
    ///
    /// ```
    /// use hpf_core::Symmetric;
    /// let clamped = Symmetric::diagonal([10.0_f64, 100.0, 500.0]).clamped(30.0, 400.0);
    /// assert_eq!(clamped, Symmetric::diagonal([30.0, 100.0, 400.0]));
    /// ```
    pub fn clamped(&self, min: T, max: T) -> Self {
        self.eigen().map(|value| value.at_least(min).at_most(max))
    }

    /// The lower triangle L of `L L^T`, by rows.
    #[inline]
    fn factor(&self) -> Matrix<T> {
        let root = |pivot: T| pivot.at_least(T::of(SMALLEST_PIVOT)).sqrt();
        let xx = root(self.xx);
        let (yx, zx) = (self.xy / xx, self.xz / xx);
        let yy = root(self.yy - yx * yx);
        let zy = (self.yz - zx * yx) / yy;
        let zz = root(self.zz - zx * zx - zy * zy);
        [[xx, T::ZERO, T::ZERO], [yx, yy, T::ZERO], [zx, zy, zz]]
    }

    /// `K^-1 v` of a positive definite matrix.
    ///
    /// ```
    /// use hpf_core::Symmetric;
    /// let damping = Symmetric { xy: 1.0_f64, ..Symmetric::diagonal([2.0, 2.0, 4.0]) };
    /// let [x, y, z] = damping.solve([3.0, 3.0, 2.0]);
    /// assert!((x - 1.0).abs() < 1e-15 && (y - 1.0).abs() < 1e-15 && (z - 0.5).abs() < 1e-15);
    /// ```
    #[inline]
    pub fn solve(&self, [x, y, z]: [T; 3]) -> [T; 3] {
        let [[xx, ..], [yx, yy, _], [zx, zy, zz]] = self.factor();
        let x = x / xx;
        let y = (y - yx * x) / yy;
        let z = (z - zx * x - zy * y) / zz;
        let z = z / zz;
        let y = (y - zy * z) / yy;
        let x = (x - yx * y - zx * z) / xx;
        [x, y, z]
    }

    /// The modes of this stiffness and a positive definite damping.
    #[inline]
    pub(crate) fn modes(&self, damping: &Self) -> Modes<T> {
        let [[xx, ..], [yx, yy, _], [zx, zy, zz]] = damping.factor();
        // L^-1, by rows.
        let (ix, iy, iz) = (T::ONE / xx, T::ONE / yy, T::ONE / zz);
        let yx = -yx * ix * iy;
        let inverse = [[ix, T::ZERO, T::ZERO], [yx, iy, T::ZERO], [-(zx * ix + zy * yx) * iz, -zy * iy * iz, iz]];
        let Eigen { values, vectors } = self.within(&inverse).eigen();
        // L^-T v: columns of it are the modes in the axes.
        let shapes = vectors.map(|vector| crate::rotation::transposed_times(&inverse, vector));
        let mut modes = Modes { rates: values, shapes, damped: [[T::ZERO; 3]; 3] };
        for ((rate, damped), &shape) in modes.rates.iter_mut().zip(&mut modes.damped).zip(&modes.shapes) {
            *damped = damping.times(shape);
            if !single::<T>() {
                *rate = self.refined(*rate, shape, *damped);
            }
        }
        modes
    }

    /// The Rayleigh quotient of a `mode` and what the damping makes of it: it is right to the square of the mode's own
    /// error, and what it is off by is summed in twice the digits. The slowest of modes that differ by many orders of
    /// magnitude is otherwise right to a unit in the last place of the fastest only, and a long step shows that.
    fn refined(&self, rate: T, mode: [T; 3], damped: [T; 3]) -> T {
        let mut gaps = [T::ZERO; 3];
        for ((gap, row), damped) in gaps.iter_mut().zip(self.rows()).zip(damped) {
            *gap = exact_dot(row, mode, -rate * damped);
        }
        rate + dot(mode, gaps) / dot(mode, damped)
    }
}

/// What a stiffness and a damping do together: each mode gives way at a rate of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Modes<T> {
    /// Rate of each mode [1/s].
    pub rates: [T; 3],
    /// Each mode in the axes, of unit damping.
    pub shapes: [[T; 3]; 3],
    /// The damping times each mode: its scalar product with an offset is the mode's part in it.
    pub damped: [[T; 3]; 3],
}

impl<T: Real> Eigen<T> {
    /// The matrix of these eigenvectors and what `f` makes of each eigenvalue.
    #[inline]
    pub fn map(&self, f: impl Fn(T) -> T) -> Symmetric<T> {
        let mut sum = [T::ZERO; 6];
        for (&value, &[x, y, z]) in self.values.iter().zip(&self.vectors) {
            let value = f(value);
            let parts = [x * x, x * y, x * z, y * y, y * z, z * z];
            sum.iter_mut().zip(parts).for_each(|(slot, part)| *slot += value * part);
        }
        Symmetric::of(sum)
    }
}

/// Makes the off-diagonal number `pq` of the axes p and q zero; `others` are those of p and q with the third axis.
#[inline]
fn rotate<T: Real>(pp: &mut T, qq: &mut T, pq: &mut T, [pr, qr]: [&mut T; 2], [u, v]: [&mut [T; 3]; 2]) {
    // t = tan of the angle, the smaller root of t^2 + 2 t theta - 1 = 0, theta = (qq - pp)/(2 pq); in a form without
    // division by pq: t = 2 pq sign(gap)/(|gap| + sqrt(gap^2 + 4 pq^2)).
    let gap = *qq - *pp;
    let twice = *pq + *pq;
    let span = gap.abs() + (gap * gap + twice * twice).sqrt();
    let signed = gap.select_below(T::ZERO, -twice, twice);
    // An off-diagonal number beyond the digits of the diagonal is zero: its square may be subnormal, which is slow.
    let least = (pp.abs() + qq.abs()) * T::of(if single::<T>() { SINGLE_NEGLIGIBLE } else { NEGLIGIBLE });
    let tangent = least.choose_below(twice.abs(), || signed / span, || T::ZERO);
    let cosine = T::ONE / (T::ONE + tangent * tangent).sqrt();
    let sine = tangent * cosine;
    let shift = tangent * *pq;
    *pp = *pp - shift;
    *qq += shift;
    *pq = T::ZERO;
    (*pr, *qr) = (cosine * *pr - sine * *qr, sine * *pr + cosine * *qr);
    for (u, v) in u.iter_mut().zip(v) {
        (*u, *v) = (cosine * *u - sine * *v, sine * *u + cosine * *v);
    }
}

/// `a . b + c`, products and sums in twice the digits of the scalar (Ogita, Rump, Oishi, SIAM J. Sci. Comput. 26(6):1955,
/// 2005).
fn exact_dot<T: Real>(a: [T; 3], b: [T; 3], c: T) -> T {
    let (mut sum, mut lost) = (c, T::ZERO);
    for (a, b) in a.into_iter().zip(b) {
        let product = a * b;
        let (next, lost_sum) = crate::compensated::two_sum(sum, product);
        lost += lost_sum + product_lost(a, b, product);
        sum = next;
    }
    sum + lost
}

/// What rounding takes from the `product` of two numbers in double precision (Dekker).
#[inline]
fn product_lost<T: Real>(a: T, b: T, product: T) -> T {
    let halves = |x: T| {
        let scaled = x * T::of(134_217_729.0); // 2^27 + 1
        let high = scaled - (scaled - x);
        (high, x - high)
    };
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    ((ah * bh - product) + ah * bl + al * bh) + al * bl
}
