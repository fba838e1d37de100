//! Products of tall matrices with themselves, in the best instructions there are and with the same bits in all.

use nalgebra::DMatrix;
use pulp::NullaryFnOnce;

/// Numbers that are summed apart: the order of summation is that of the lanes, whatever the processor.
const LANES: usize = 4;
/// Columns multiplied together, so that a number is read once for several products.
const COLUMNS: usize = 4;

/// `J^T J`, one row and column per column of `columns`, each of `rows` numbers.
pub fn gram(columns: &[f64], rows: usize) -> DMatrix<f64> {
    pulp::Arch::new().dispatch(Gram { columns, rows })
}

struct Gram<'a> {
    columns: &'a [f64],
    rows: usize,
}

impl NullaryFnOnce for Gram<'_> {
    type Output = DMatrix<f64>;

    #[inline(always)]
    fn call(self) -> DMatrix<f64> {
        let Self { columns, rows } = self;
        let count = columns.len().checked_div(rows).unwrap_or(0);
        let mut product = DMatrix::zeros(count, count);
        let column = |j: usize| &columns[j * rows..][..rows];
        for j in 0..count {
            let own = column(j);
            let mut i = j;
            while i + COLUMNS <= count {
                let sums = dots::<COLUMNS>(core::array::from_fn(|c| column(i + c)), own);
                for (c, sum) in sums.into_iter().enumerate() {
                    product[(i + c, j)] = sum;
                    product[(j, i + c)] = sum;
                }
                i += COLUMNS;
            }
            for i in i..count {
                let [sum] = dots([column(i)], own);
                product[(i, j)] = sum;
                product[(j, i)] = sum;
            }
        }
        product
    }
}

/// The products of `one` with each of `several`.
#[inline(always)]
fn dots<const N: usize>(several: [&[f64]; N], one: &[f64]) -> [f64; N] {
    let mut sums = [[0.0; LANES]; N];
    let (chunks, rest) = one.as_chunks::<LANES>();
    let parts = several.map(|column| column.as_chunks::<LANES>());
    for (r, own) in chunks.iter().enumerate() {
        for (sum, part) in sums.iter_mut().zip(&parts) {
            for (sum, (a, b)) in sum.iter_mut().zip(part.0[r].iter().zip(own)) {
                *sum += a * b;
            }
        }
    }
    let mut totals = sums.map(|sum| (sum[0] + sum[1]) + (sum[2] + sum[3]));
    for (total, part) in totals.iter_mut().zip(&parts) {
        *total += part.1.iter().zip(rest).map(|(a, b)| a * b).sum::<f64>();
    }
    totals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_entry_is_the_product_of_two_columns() {
        let (rows, count) = (11, 7);
        let columns: Vec<f64> = (0..rows * count).map(|i| ((i * i) as f64 * 0.37).sin()).collect();
        let product = gram(&columns, rows);
        for i in 0..count {
            for j in 0..count {
                let own: f64 = (0..rows).map(|r| columns[i * rows + r] * columns[j * rows + r]).sum();
                // 11 products of numbers below one, summed in another order.
                assert!((product[(i, j)] - own).abs() < 1e-14);
            }
        }
        assert_eq!(gram(&[], 0).nrows(), 0);
    }
}
