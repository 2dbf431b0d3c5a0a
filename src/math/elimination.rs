//! Elimination with exact fractions: signs of determinants, and null vectors.

use std::cmp::Ordering;

use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_traits::{One, Zero};

use crate::math::exact::Exact;

/// Returns the sign of the determinant of a square matrix, by fraction-free elimination.
///
/// Source: Bareiss, Mathematics of Computation 22 (1968), 565-578.
pub fn determinant_sign(matrix: &[Vec<Exact>]) -> Ordering {
    let mut rows: Vec<Vec<BigInt>> = matrix.iter().map(|row| cleared(row)).collect();
    let n = rows.len();
    let mut before = BigInt::one();
    let mut flips = false;
    for k in 0..n {
        let Some(pivot) = (k..n).find(|&i| !rows[i][k].is_zero()) else { return Ordering::Equal };
        flips ^= pivot != k;
        rows.swap(pivot, k);
        let (done, rest) = rows.split_at_mut(k + 1);
        let top = &done[k];
        for row in rest {
            for j in k + 1..n {
                row[j] = (&row[j] * &top[k] - &row[k] * &top[j]) / &before;
            }
        }
        before.clone_from(&rows[k][k]);
    }
    match (before.sign(), flips) {
        (Sign::NoSign, _) => Ordering::Equal,
        (Sign::Plus, false) | (Sign::Minus, true) => Ordering::Greater,
        _ => Ordering::Less,
    }
}

/// Returns a row multiplied by the least common multiple of its denominators, which is positive.
fn cleared(row: &[Exact]) -> Vec<BigInt> {
    let common = row.iter().fold(BigInt::one(), |common, x| common.lcm(x.denom()));
    row.iter().map(|x| x.numer() * (&common / x.denom())).collect()
}

/// Returns the vector `v` with `sum over j of v[j] matrix[j][k] = 0` for every k, up to scale; `None` unless it is
/// unique.
pub fn left_null_vector(matrix: &[Vec<Exact>]) -> Option<Vec<Exact>> {
    let n = matrix.len();
    // the equations are the columns
    let column = |k: usize| matrix.iter().map(|row| row[k].clone()).collect::<Vec<_>>();
    let mut rows: Vec<Vec<BigInt>> = (0..n).map(|k| cleared(&column(k))).collect();
    let mut pivots = Vec::new();
    let mut free = None;
    let mut before = BigInt::one();
    for column in 0..n {
        let at = pivots.len();
        let Some(pivot) = (at..n).find(|&i| !rows[i][column].is_zero()) else {
            if free.replace(column).is_some() {
                return None;
            }
            continue;
        };
        rows.swap(pivot, at);
        let (done, rest) = rows.split_at_mut(at + 1);
        let top = &done[at];
        for row in rest {
            let factor = std::mem::take(&mut row[column]);
            for j in column + 1..n {
                row[j] = (&row[j] * &top[column] - &factor * &top[j]) / &before;
            }
        }
        before.clone_from(&rows[at][column]);
        pivots.push(column);
    }
    let free = free?;
    let mut vector = vec![Exact::zero(); n];
    vector[free] = Exact::one();
    for (row, &column) in rows.iter().zip(&pivots).rev() {
        let terms = (column + 1..n).filter(|&k| !row[k].is_zero() && !vector[k].is_zero());
        let sum: Exact = terms.map(|k| &vector[k] * &row[k]).sum();
        vector[column] = -sum / &row[column];
    }
    Some(vector)
}
