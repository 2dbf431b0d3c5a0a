//! The eigenvectors of the largest eigenvalues of a local subdivision matrix without the eigenvalue 1.
//!
//! They are computed by orthogonal iteration, with a few vectors more than needed, and a Rayleigh-Ritz step: sums and
//! products in a fixed order, so that every machine computes the same bits. (A general eigensolver would add a
//! dependency, and its result for a double eigenvalue would depend on rounding.) The eigenvalue 1 is split off exactly:
//! M keeps rows that sum to 0 and columns that the limit mask maps to 0.

use super::small::{Vectors, leading_basis, leading_block, mixed, orthonormalise, times};
use crate::math::dense::{dot, xorshift};
use crate::math::functions::{real, sqrt};

/// Number of vectors that are iterated together. At most five of them are taken as eigenvectors, so that three are left
/// to estimate the next eigenvalues. With half of it the longest chains are not found, and convergence is slower; with
/// twice of it each orthogonalisation takes four times as long.
const ITERATED_VECTORS: usize = 8;
/// Number of steps before convergence is first checked; each later check comes after twice as many more. These steps
/// separate eigenvalues whose quotient is 0.53 up to [`MAX_RESIDUAL`]. With half of it most masks need a second check;
/// with twice of it all masks take 80 steps.
const FIRST_CHECK_STEPS: usize = 40;
/// Number of checks after which the third eigenvalue counts as equal to the second. They take 40 (2^8 - 1) = 10,200
/// steps, which separate eigenvalues whose quotient is 0.9975 up to [`MAX_RESIDUAL`]. One check less halves the steps
/// and the time of a refusal, for a quotient of 0.995; one more doubles them, for 0.9988.
const MAX_LOOKS: usize = 8;
/// Minimum gap between the second eigenvalue and the third, relative to the second. It is well above the root of the
/// rounding of 1, 1.5e-8, by which rounding separates equal eigenvalues of a chain. Half of it comes closer to that;
/// twice of it refuses surfaces whose third eigenvalue is less than 2e-5 below the second.
const LEAST_EIGENVALUE_GAP: f64 = 1e-5;
/// Maximum norm of the part of the images of the two vectors outside their span, relative to their eigenvalues. It is
/// 45,000 times the rounding of 1, as sums over wide discs need, and a hundredth of the smallest sine that counts in
/// the characteristic map. Half of it may need another check; twice of it may save one, with less accurate last digits.
const MAX_RESIDUAL: f64 = 1e-11;
/// How far below 0 the discriminant of the two largest eigenvalues may be, relative to the square of their sum, so that
/// they count as a double real one, of which rounding makes a pair of conjugates. The discriminant is wrong by a few
/// [`MAX_RESIDUAL`] at most. At this value the imaginary parts are 3.2e-5 of the eigenvalue; with half of it 2.2e-5,
/// with twice of it 4.5e-5.
const DOUBLE_EIGENVALUE_SPREAD: f64 = 1e-9;
/// Largest absolute entry of a power of the nilpotent part of a repeated eigenvalue, relative to the eigenvalue, that
/// counts as zero. It is a hundred times [`MAX_RESIDUAL`]; half of it is fifty times, twice of it two hundred, and all
/// are far below [`LEAST_NILPOTENT_SIZE`].
const LARGEST_ZERO: f64 = 1e-9;
/// Minimum size of the nilpotent part of a repeated eigenvalue, or of its last power that is not zero, relative to the
/// eigenvalue. A part between [`LARGEST_ZERO`] and this size is taken neither for rounding nor for a chain, and there
/// are no tangents. At this size the directions of a chain have eight digits if the residual is [`MAX_RESIDUAL`]. Half
/// of it leaves a third of a digit less; twice of it refuses chains whose part is below 2e-3.
pub(super) const LEAST_NILPOTENT_SIZE: f64 = 1e-3;

/// The eigenvectors that dominate after many steps.
pub(super) enum Leading {
    /// An orthonormal basis of the plane of the two largest eigenvalues.
    Plane([Vec<f64>; 2]),
    /// An eigenvector and a chain of a repeated second eigenvalue.
    Chain(Chain),
    /// An orthonormal basis of the space of a triple eigenvalue, and the matrix of the map in this basis.
    Thrice(Vectors<3>, [[f64; 3]; 3]),
}

/// The eigenvector of the largest eigenvalue, and the longest chain of the next one.
pub(super) struct Chain {
    pub(super) first: Vec<f64>,
    /// An eigenvector of the second eigenvalue b, then vectors that are mapped to b times the sum of themselves and the
    /// vector before; all up to multiples of `first`.
    pub(super) steps: Vec<Vec<f64>>,
}

/// Finds the dominating eigenvectors of the map `apply` on the vectors of length `n` that `deflate` leaves unchanged.
/// They are found in three cases: the two largest eigenvalues are positive reals and larger than all others; the second
/// is repeated and has a single longest chain; or the largest has multiplicity three. `None` in all other cases.
pub(super) fn leading(n: usize, apply: impl Fn(&[f64]) -> Vec<f64>, deflate: impl Fn(&mut [f64])) -> Option<Leading> {
    let width = ITERATED_VECTORS.min(n - 1);
    let mut vectors = starting_vectors(n, width);
    vectors.iter_mut().for_each(|vector| deflate(vector));
    orthonormalise(&mut vectors);
    for look in 0..MAX_LOOKS {
        for _ in 0..FIRST_CHECK_STEPS << look {
            vectors = vectors.iter().map(|vector| apply(vector)).collect();
            vectors.iter_mut().for_each(|vector| deflate(vector));
            orthonormalise(&mut vectors);
        }
        let images: Vec<Vec<f64>> = vectors.iter().map(|vector| apply(vector)).collect();
        // images = H vectors, up to the part outside their span
        let h: Vec<Vec<f64>> = images.iter().map(|image| vectors.iter().map(|v| dot(image, v)).collect()).collect();
        let Some((block, third)) = leading_block::<2>(&h) else {
            let of_two = || chain::<3>(&h, &vectors, &images);
            let of_three = || chain::<4>(&h, &vectors, &images);
            let of_four = || chain::<5>(&h, &vectors, &images);
            let chain = of_two().or_else(of_three).or_else(of_four).map(Leading::Chain);
            match chain.or_else(|| three_times(&h, &vectors, &images)) {
                Some(leading) => return Some(leading),
                None => continue,
            }
        };
        let (found, [[a, b], [c, d]], left_over) = seen(&block, &vectors, &images);
        let size = a.abs() + b.abs() + c.abs() + d.abs();
        if left_over <= MAX_RESIDUAL * size {
            let (trace, determinant) = (a + d, a * d - b * c);
            let discriminant = trace * trace - 4.0 * determinant;
            let second = (trace - sqrt(discriminant.max(0.0))) / 2.0;
            let real = discriminant >= -DOUBLE_EIGENVALUE_SPREAD * trace * trace;
            let ahead = real && third < (1.0 - LEAST_EIGENVALUE_GAP) * second;
            return ahead.then_some(Leading::Plane(found));
        }
    }
    None
}

/// Returns the space of the largest eigenvalue a, if it has multiplicity three and its matrix is `a (I + N)` with
/// `N^2 = 0`.
fn three_times(h: &[Vec<f64>], vectors: &[Vec<f64>], images: &[Vec<f64>]) -> Option<Leading> {
    let (block, fourth) = leading_block::<3>(h)?;
    let (found, map, left_over) = seen(&block, vectors, images);
    let a = (map[0][0] + map[1][1] + map[2][2]) / 3.0;
    let nilpotent: Vec<Vec<f64>> =
        (0..3).map(|i| (0..3).map(|k| map[i][k] / a - f64::from(u8::from(i == k))).collect()).collect();
    let square = nilpotent.iter().map(|row| times(row, &nilpotent));
    let vanishes = square.flatten().all(|x| x.abs() <= LARGEST_ZERO);
    (vanishes && left_over <= MAX_RESIDUAL * a && fourth < (1.0 - LEAST_EIGENVALUE_GAP) * a)
        .then_some(Leading::Thrice(found, map))
}

/// Returns the vectors of a leading block, the matrix of the map in terms of these vectors, and the norm of the part of
/// their images outside their span.
fn seen<const K: usize>(
    block: &Vectors<K>,
    vectors: &[Vec<f64>],
    images: &[Vec<f64>],
) -> (Vectors<K>, [[f64; K]; K], f64) {
    let found = std::array::from_fn(|i| mixed(&block[i], vectors));
    let image: [Vec<f64>; K] = std::array::from_fn(|i| mixed(&block[i], images));
    let map: [[f64; K]; K] = std::array::from_fn(|i| std::array::from_fn(|k| dot(&image[i], &found[k])));
    let n = vectors[0].len();
    let left_over: [f64; K] = std::array::from_fn(|i| {
        let rest =
            |at: usize| found.iter().zip(&map[i]).fold(image[i][at], |x, (vector, factor)| x - factor * vector[at]);
        (0..n).map(|k| rest(k) * rest(k)).sum::<f64>()
    });
    (found, map, sqrt(left_over.iter().sum()))
}

/// Returns the longest chain of the second eigenvalue, if its multiplicity is K - 1 and one chain is longer than all
/// others.
fn chain<const K: usize>(h: &[Vec<f64>], vectors: &[Vec<f64>], images: &[Vec<f64>]) -> Option<Chain> {
    let (block, after) = leading_block::<K>(h)?;
    let (found, map, left_over) = seen(&block, vectors, images);
    let size: f64 = map.iter().flatten().map(|x| x.abs()).sum();
    // the eigenvector of the largest eigenvalue, and vectors orthogonal to it
    let small: Vec<Vec<f64>> = map.iter().map(|row| row.to_vec()).collect();
    let ([first], others) = leading_basis::<1>(&small)?;
    let image = |u: &[f64]| times(u, &small);
    let largest = dot(&image(&first), &first);
    let rest: Vec<Vec<f64>> = others.iter().map(|u| others.iter().map(|v| dot(&image(u), v)).collect()).collect();
    let repeated = (0..K - 1).map(|i| rest[i][i]).sum::<f64>() / real(K - 1);
    let ahead = after < (1.0 - LEAST_EIGENVALUE_GAP) * repeated && repeated < (1.0 - LEAST_EIGENVALUE_GAP) * largest;
    if left_over > MAX_RESIDUAL * size || !ahead {
        return None;
    }
    let combined = |u: &Vec<f64>| mixed(&mixed(u, &others), &found);
    let steps = longest(rest, repeated)?.iter().map(combined).collect();
    Some(Chain { first: mixed(&first, &found), steps })
}

/// Returns the longest chain `u_1, ..., u_L` of rows of a small matrix B with the only eigenvalue b: `u_L` is a unit
/// vector `(0, .., 1, .., 0)`, and `u_(i-1) = u_i (B - b) / b`. `None` if several chains are longest, if all have
/// length 1, or if B has other eigenvalues.
fn longest(mut matrix: Vec<Vec<f64>>, b: f64) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    (0..n).for_each(|i| matrix[i][i] -= b);
    matrix.iter_mut().flatten().for_each(|x| *x /= b);
    let unit = |i: usize| (0..n).map(|k| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
    let mut powers = vec![(0..n).map(unit).collect::<Vec<_>>()];
    let size = |row: &Vec<f64>| row.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    while powers[powers.len() - 1].iter().map(size).fold(0.0, f64::max) > LARGEST_ZERO {
        if powers.len() > n {
            return None;
        }
        powers.push(powers[powers.len() - 1].iter().map(|row| times(row, &matrix)).collect());
    }
    powers.pop();
    let last = powers.last()?;
    let from = (0..n).max_by(|&i, &k| size(&last[i]).total_cmp(&size(&last[k])))?;
    let eigenvector = &last[from];
    let square = dot(eigenvector, eigenvector);
    let beside = |row: &Vec<f64>| {
        let factor = dot(row, eigenvector) / square;
        row.iter().zip(eigenvector).any(|(x, y)| (x - factor * y).abs() > LARGEST_ZERO)
    };
    if powers.len() < 2 || size(eigenvector) < LEAST_NILPOTENT_SIZE || last.iter().any(beside) {
        return None;
    }
    Some(powers.iter().rev().map(|power| power[from].clone()).collect())
}

/// Returns `width` vectors of length `n` with pseudo-random entries between -0.5 and 0.5: always the same, and without
/// a pattern that a symmetry of a disc could share.
pub(super) fn starting_vectors(n: usize, width: usize) -> Vec<Vec<f64>> {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut next = || {
        #[expect(clippy::cast_precision_loss, reason = "53 bits are kept")]
        let unit = (xorshift(&mut state) >> 11) as f64 / (1_u64 << 53) as f64;
        unit - 0.5
    };
    (0..width).map(|_| (0..n).map(|_| next()).collect()).collect()
}
