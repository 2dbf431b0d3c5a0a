//! Small matrices and the eigenspaces of their largest eigenvalues.

use crate::math::functions::{exp, ln, sqrt};

/// Squarings before a step of the inner iteration, on matrices of a few rows: it applies their 32nd power.
/// Half of it applies the 4th power, which takes 8 times as many steps; twice of it the 1,024th, in which eigenvalues
/// below 0.96 of the largest are lost to rounding.
const SQUARINGS: usize = 5;
/// Most of these steps.
/// With 32nd powers these are 25,600 steps, which part eigenvalues whose quotient is 0.9988. Half of it parts 0.9977,
/// twice of it 0.9994, and takes twice as long where they are equal.
const MAX_INNER: usize = 800;
/// K vectors.
pub(super) type Vectors<const K: usize> = [Vec<f64>; K];

/// The combinations of rows that span the space of the K largest eigenvalues of a small matrix, and the size of the
/// largest other one.
pub(super) fn leading_block<const K: usize>(h: &[Vec<f64>]) -> Option<(Vectors<K>, f64)> {
    let (block, others) = leading_basis::<K>(h)?;
    let rest: Vec<Vec<f64>> = others.iter().map(|u| times(u, h)).collect();
    let rest: Vec<Vec<f64>> = rest.iter().map(|u| others.iter().map(|v| dot(u, v)).collect()).collect();
    Some((block, spectral_radius(rest)))
}

/// The combinations of rows that span the space of the K largest eigenvalues of a small matrix, and what completes them
/// to an orthonormal basis: `u -> u H`, iterated until the first no longer mix with the others.
pub(super) fn leading_basis<const K: usize>(h: &[Vec<f64>]) -> Option<(Vectors<K>, Vec<Vec<f64>>)> {
    let width = h.len();
    let mut power = h.to_vec();
    for _ in 0..SQUARINGS {
        let largest = power.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let scaled: Vec<Vec<f64>> = power.iter().map(|row| row.iter().map(|x| x / largest).collect()).collect();
        power = scaled.iter().map(|row| times(row, &scaled)).collect();
    }
    let mut basis: Vec<Vec<f64>> =
        (0..width).map(|i| (0..width).map(|k| f64::from(u8::from(i == k))).collect()).collect();
    for _ in 0..MAX_INNER {
        basis = basis.iter().map(|u| times(u, &power)).collect();
        orthonormalise(&mut basis);
        let (first, others) = basis.split_first_chunk::<K>()?;
        let image = first.each_ref().map(|u| times(u, h));
        let size = image.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let mixing = image.iter().flat_map(|u| others.iter().map(|v| dot(u, v).abs()));
        if mixing.fold(0.0, f64::max) <= 1e-13 * size {
            return Some((first.clone(), others.to_vec()));
        }
    }
    None
}

/// `|B^m|^(1/m)` for `m = 2^24`, far enough for blocks that are not diagonalisable.
fn spectral_radius(mut b: Vec<Vec<f64>>) -> f64 {
    let (mut logarithm, mut share) = (0.0, 1.0);
    for _ in 0..24 {
        let largest = b.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        if largest == 0.0 {
            return 0.0;
        }
        logarithm += share * ln(largest);
        share /= 2.0;
        b.iter_mut().flatten().for_each(|x| *x /= largest);
        b = b.iter().map(|row| times(row, &b)).collect();
    }
    exp(logarithm)
}

/// `u H`.
pub(super) fn times(u: &[f64], h: &[Vec<f64>]) -> Vec<f64> {
    (0..h.len()).map(|k| u.iter().zip(h).map(|(x, row)| x * row[k]).sum()).collect()
}

pub(super) fn mixed(mix: &[f64], vectors: &[Vec<f64>]) -> Vec<f64> {
    let n = vectors[0].len();
    (0..n).map(|k| mix.iter().zip(vectors).map(|(factor, vector)| factor * vector[k]).sum()).collect()
}

/// Gram and Schmidt, twice, so that nearly parallel vectors end orthogonal too. What vanishes becomes zero.
pub(super) fn orthonormalise(vectors: &mut [Vec<f64>]) {
    for i in 0..vectors.len() {
        let (before, rest) = vectors.split_at_mut(i);
        let vector = &mut rest[0];
        let original = sqrt(dot(vector, vector));
        for _ in 0..2 {
            for other in before.iter() {
                let part = dot(vector, other);
                vector.iter_mut().zip(other).for_each(|(x, y)| *x -= part * y);
            }
        }
        let length = sqrt(dot(vector, vector));
        let scale = if length > 1e-14 * original && length > 1e-280 { 1.0 / length } else { 0.0 };
        vector.iter_mut().for_each(|x| *x *= scale);
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
