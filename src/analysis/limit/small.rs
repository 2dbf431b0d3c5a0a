//! Small matrices and the eigenspaces of their largest eigenvalues.

use crate::math::dense::dot;
use crate::math::functions::{exp, ln, sqrt};

/// Number of squarings of the small matrix before it is iterated: each step applies its 32nd power. Half of it applies
/// the 4th power, which takes 8 times as many steps; twice of it the 1,024th, in which eigenvalues below 0.96 of the
/// largest are lost to rounding.
const SMALL_SQUARINGS: usize = 5;
/// Maximum number of steps of the iteration. With 32nd powers they apply the matrix 25,600 times, which separates
/// eigenvalues whose quotient is 0.9988. Half of it separates 0.9977; twice of it separates 0.9994, and takes twice as
/// long if they are equal.
const MAX_INNER: usize = 800;
/// Maximum part of the images of the first vectors in the others, relative to the largest entry of these images, at
/// which the iteration ends. It is 450 roundings of 1, more than those of a few products of eight terms each. Half of
/// it takes a step more where eigenvalues are close; twice of it leaves twice as much of the other eigenvectors.
const MAX_MIXING: f64 = 1e-13;
/// Maximum length of what is left of a vector that depends on those before it, relative to its length before: 45
/// roundings of 1. Half of it comes closer to the rounding of the products that are subtracted, and would make a vector
/// of it; twice of it drops vectors that are within 2e-14 of the span of the others.
const REMAINING_SHARE: f64 = 1e-14;

/// K vectors of equal length.
pub(super) type Vectors<const K: usize> = [Vec<f64>; K];

/// Returns an orthonormal basis of the left eigenspace of the K largest eigenvalues of a small matrix, and the modulus
/// of the largest other eigenvalue; `None` if the iteration does not separate them.
pub(super) fn leading_block<const K: usize>(h: &[Vec<f64>]) -> Option<(Vectors<K>, f64)> {
    let (block, others) = leading_basis::<K>(h)?;
    let rest: Vec<Vec<f64>> = others.iter().map(|u| times(u, h)).collect();
    let rest: Vec<Vec<f64>> = rest.iter().map(|u| others.iter().map(|v| dot(u, v)).collect()).collect();
    Some((block, spectral_radius(rest)))
}

/// Returns an orthonormal basis of the left eigenspace of the K largest eigenvalues of a small matrix, and the vectors
/// that complete it to a basis of the whole space; `None` if the iteration does not separate them.
///
/// Iterates `u -> u H` until the images of the first K vectors have no part in the others.
pub(super) fn leading_basis<const K: usize>(h: &[Vec<f64>]) -> Option<(Vectors<K>, Vec<Vec<f64>>)> {
    let width = h.len();
    let mut power = h.to_vec();
    for _ in 0..SMALL_SQUARINGS {
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
        if mixing.fold(0.0, f64::max) <= MAX_MIXING * size {
            return Some((first.clone(), others.to_vec()));
        }
    }
    None
}

/// Returns the largest modulus of an eigenvalue of B, as `|B^m|^(1/m)` for `m = 2^24`: accurate enough also for blocks
/// that are not diagonalisable.
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

/// Returns the product `u H` of a row and a square matrix.
pub(super) fn times(u: &[f64], h: &[Vec<f64>]) -> Vec<f64> {
    (0..h.len()).map(|k| u.iter().zip(h).map(|(x, row)| x * row[k]).sum()).collect()
}

/// Returns the linear combination of `vectors` with the factors `mix`.
pub(super) fn mixed(mix: &[f64], vectors: &[Vec<f64>]) -> Vec<f64> {
    let n = vectors[0].len();
    (0..n).map(|k| mix.iter().zip(vectors).map(|(factor, vector)| factor * vector[k]).sum()).collect()
}

/// Makes vectors orthonormal by Gram and Schmidt's method, applied twice, so that nearly parallel vectors become
/// orthogonal too. Vectors that depend on those before them become zero.
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
        // a length is a root, so that one above 0 has a finite inverse
        let scale = if length > REMAINING_SHARE * original { 1.0 / length } else { 0.0 };
        vector.iter_mut().for_each(|x| *x *= scale);
    }
}
