//! The matrices whose products describe how differences of the data evolve. For a residual b with entries 0 to n,
//! `N = max(1, ceil(n / (d-1)))` and e from 0 to d - 1, the N x N matrices are `(T_e)[p][q] = b[r + p - d i(q)]` with
//! `r = e + d N` and `i(q) = floor((r + N - 1) / d) - (N - 1) + q`.
//!
//! Source: Daubechies and Lagarias, SIAM Journal on Mathematical Analysis 23 (1992), 1031-1079.

use std::iter::Sum;
use std::ops::Mul;

use num_traits::{Signed, Zero};

use crate::math::exact::Exact;

/// Size of the matrices whose product costs one unit of the budget, that of the 16-point scheme; products of larger
/// matrices cost in proportion to their time. Half or twice of it allows one eighth or eight times as many products of
/// larger matrices.
const USUAL_SIZE: usize = 14;

/// A square matrix of fractions, row by row.
pub(in crate::analysis) type ExactMatrix = Vec<Vec<Exact>>;

/// Returns the matrices `T_0, ..., T_(d-1)` of a residual.
pub(super) fn of_residual(residual: &[Exact], arity: i64) -> Vec<ExactMatrix> {
    let last = i64::try_from(residual.len()).unwrap_or(1) - 1;
    let n = (last + arity - 2).div_euclid(arity - 1).max(1);
    let entry = |j: i64| {
        let found = usize::try_from(j).ok().and_then(|j| residual.get(j));
        found.cloned().unwrap_or_else(Exact::zero)
    };
    let matrix = |e: i64| {
        let r = e + arity * n;
        let i = (r + n - 1).div_euclid(arity) - (n - 1);
        (0..n).map(|p| (0..n).map(|q| entry(r + p - arity * (i + q))).collect()).collect()
    };
    (0..arity).map(matrix).collect()
}

/// Returns the product of two square matrices.
pub(super) fn product<T: Zero + Sum>(a: &[Vec<T>], b: &[Vec<T>]) -> Vec<Vec<T>>
where
    for<'a> &'a T: Mul<Output = T>,
{
    let cell = |row: &[T], k: usize| {
        let terms = row.iter().zip(b).filter(|(x, other)| !x.is_zero() && !other[k].is_zero());
        terms.map(|(x, other)| x * &other[k]).sum()
    };
    a.iter().map(|row| (0..b.len()).map(|k| cell(row, k)).collect()).collect()
}

/// Returns the greatest sum of absolute values in a row.
pub(super) fn row_norm(a: &ExactMatrix) -> Exact {
    let sums = a.iter().map(|row| row.iter().map(Exact::abs).sum::<Exact>());
    sums.max().unwrap_or_else(Exact::zero)
}

/// Writes the product of two n x n matrices in f64, row by row, to `out`.
pub(super) fn multiply(a: &[f64], b: &[f64], n: usize, out: &mut Vec<f64>) {
    out.clear();
    out.resize(n * n, 0.0);
    for (row, result) in a.chunks_exact(n).zip(out.chunks_exact_mut(n)) {
        for (x, other) in row.iter().zip(b.chunks_exact(n)) {
            if *x != 0.0 {
                result.iter_mut().zip(other).for_each(|(sum, y)| *sum += x * y);
            }
        }
    }
}

/// Returns the cost of a product of two n x n matrices in units of the budget.
pub(super) fn price(n: usize) -> u64 {
    (n.pow(3) as u64).div_ceil(USUAL_SIZE.pow(3) as u64)
}
