//! Tangents of the limit: left eigenvectors of the two eigenvalues after 1 of a local subdivision matrix.
//!
//! With right eigenvectors `1, x, y, ...` and left ones `l, t, u, ...` of the eigenvalues `1 > a >= b > ...`, the
//! points around a centre are `1 (l p) + a^k x (t p) + b^k y (u p) + ...` after `k` levels: `(x, y)` is the
//! characteristic map, `t p` and `u p` span the tangent plane. Source: U. Reif, CAGD 12 (1995), 153-174; D. Zorin,
//! Constructive Approximation 16 (2000), 359-397.
//!
//! The eigenvectors are computed by orthogonal iteration, with a few vectors more than needed, and a Rayleigh-Ritz
//! step: sums and products in a fixed order, so that every machine computes the same bits. (A general eigensolver would
//! add a dependency, and its result for a double eigenvalue would depend on rounding.) The eigenvalue 1 is split off
//! exactly: M keeps rows that sum to 0 and columns that the limit mask maps to 0.

use super::disc::Centre;
use super::small::{Vectors, dot, leading_basis, leading_block, mixed, orthonormalise, times};
use crate::math::functions::{exp, ln, real, sqrt};
use crate::math::planar;
use crate::math::vector::cross;

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
/// Maximum number of faces around a vertex, or of corners of a face, for which tangents are searched. Around n faces
/// the eigenvalues of the vectors that oscillate once and four times around the centre differ by about `100/n^2`,
/// relative to their size, so that from some 300 faces on all steps together do not separate them up to
/// [`MAX_RESIDUAL`]; beyond the maximum the search is known to fail. The time of each step is proportional to the
/// number of faces. Half of it would refuse without a search what fails anyway; twice of it searches twice as long in
/// vain.
const MAX_TANGENT_VALENCE: usize = 2048;
/// Weight of the last vector of a chain in the characteristic map, relative to the first; small, as it is after many
/// levels. Where the other vectors vanish, for example on a boundary that is refined by itself, only the last vector
/// separates the points. Lengths and sines below 1e-9 count as zero: half and twice of it keep three digits above that.
const LAST_VECTOR_WEIGHT: f64 = 1e-6;
/// Maximum norm of the part of the images of the two vectors outside their span, relative to their eigenvalues. It is
/// 45,000 times the rounding of 1, as sums over wide discs need, and a hundredth of the smallest sine that counts. Half
/// of it may need another check; twice of it may save one, with less accurate last digits.
const MAX_RESIDUAL: f64 = 1e-11;

/// The reason for which there are no tangents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoTangents {
    /// No two eigenvectors span a tangent plane: the eigenvalues are not positive reals or not separated from the next
    /// ones, or points of the characteristic map coincide.
    Eigenvalues,
    /// The characteristic map folds over.
    Folded,
}

impl NoTangents {
    /// Returns the reason as a sentence about a place.
    pub(super) fn at(self, place: &str) -> String {
        match self {
            Self::Folded => format!("the surface folds over at {place}"),
            Self::Eigenvalues => format!("the surface has no tangent plane at {place}"),
        }
    }
}

/// Returns two tangents as weights of the points around a centre. Their cross product points to the side from which the
/// `faces` at the centre are counter-clockwise. `limit` is the limit mask of the centre; `back` multiplies a row by M,
/// `forth` multiplies M by a column.
///
/// # Errors
/// [`NoTangents`].
pub(super) fn of<'a>(
    centre: Centre,
    faces: impl Iterator<Item = &'a [u32]>,
    limit: &[f64],
    back: impl Fn(&[f64]) -> Vec<f64>,
    forth: impl Fn(&[f64]) -> Vec<f64>,
) -> Result<[Vec<f64>; 2], NoTangents> {
    let n = limit.len();
    let faces: Vec<&[u32]> = faces.collect();
    let around = if let (Centre::Face(_), Some(face)) = (centre, faces.first()) { face.len() } else { faces.len() };
    if around > MAX_TANGENT_VALENCE {
        return Err(NoTangents::Eigenvalues);
    }
    let off_limit = |column: &mut [f64]| {
        let value = dot(limit, column);
        column.iter_mut().for_each(|x| *x -= value);
    };
    let [[t, u], [x, y]] = match (leading(n, &back, sum_to_zero)?, leading(n, &forth, off_limit)?) {
        (Leading::Plane([t, u]), Leading::Plane([x, y])) => {
            // scaled so that t and u are dual to them: (x, y) times the inverse of ((t x, t y), (u x, u y))
            let [[a, b], [c, d]] = [[dot(&t, &x), dot(&t, &y)], [dot(&u, &x), dot(&u, &y)]];
            let determinant = a * d - b * c;
            if determinant.abs() < 1e-9 {
                return Err(NoTangents::Eigenvalues);
            }
            let place = |(x, y): (&f64, &f64)| [(x * d - y * c) / determinant, (y * a - x * b) / determinant];
            let (x, y) = x.iter().zip(&y).map(place).map(|[x, y]| (x, y)).unzip();
            [[t, u], [x, y]]
        }
        (Leading::Chain(rows), Leading::Chain(columns)) if rows.steps.len() == columns.steps.len() => {
            chained(rows, columns)?
        }
        (Leading::Thrice(rows, map), Leading::Thrice(columns, _)) => thrice(&rows, &map, &columns)?,
        _ => return Err(NoTangents::Eigenvalues),
    };
    let is_left = turns_left(centre, &faces, |i| [x[i as usize], y[i as usize]])?;
    Ok(if is_left { [t, u] } else { [u, t] })
}

/// Returns the tangents and the characteristic map if the second eigenvalue b has a chain `M y_1 = b y_1`,
/// `M y_i = b (y_i + y_(i-1))` of length L. With `u M = b u` and `e = 1/k` the points after k levels are
///
/// ```text
/// 1 (l p) + a^k x (t p) + C(k, L-1) b^k (y_1 + (L-1) e y_2 + (L-1) (L-2) e^2 y_3 + ...) (u p) / (u y_L) + ...
/// ```
///
/// The map takes `e^(L-1)` to be [`LAST_VECTOR_WEIGHT`].
fn chained(rows: Chain, columns: Chain) -> Result<[[Vec<f64>; 2]; 2], NoTangents> {
    let (length, t, mut u) = (columns.steps.len(), rows.first, rows.steps.into_iter().next().unwrap_or_default());
    let mut x = columns.first;
    let along = dot(&t, &x);
    let across = dot(&u, &x) / along;
    u.iter_mut().zip(&t).for_each(|(u, t)| *u -= across * t);
    let step = dot(&u, &columns.steps[length - 1]);
    if along.abs() < 1e-9 || step.abs() < 1e-9 {
        return Err(NoTangents::Eigenvalues);
    }
    x.iter_mut().for_each(|x| *x /= along);
    let late = exp(ln(LAST_VECTOR_WEIGHT) / real(length - 1));
    let mut y = vec![0.0; x.len()];
    let mut factor = 1.0 / step;
    for (i, column) in columns.steps.iter().enumerate() {
        y.iter_mut().zip(column).for_each(|(y, column)| *y += factor * column);
        factor *= real(length - 1 - i) * late;
    }
    let back = dot(&t, &y);
    y.iter_mut().zip(&x).for_each(|(y, x)| *y -= back * x);
    Ok([[t, u], [x, y]])
}

/// Returns the tangents and the characteristic map if the second eigenvalue a has multiplicity three, with
/// `R M = a (I + N) R` for three rows R and `N = p q`, `q p = 0`. After k levels the points v become
/// `1 (l v) + a^k Y (I + k N) (R v) + ...` with the columns Y for which `R Y = I`. The combinations of R with factors
/// orthogonal to p, such as q, are the tangents.
fn thrice(rows: &Vectors<3>, map: &[[f64; 3]; 3], columns: &Vectors<3>) -> Result<[[Vec<f64>; 2]; 2], NoTangents> {
    let a = (map[0][0] + map[1][1] + map[2][2]) / 3.0;
    let n: [[f64; 3]; 3] =
        std::array::from_fn(|i| std::array::from_fn(|k| map[i][k] / a - f64::from(u8::from(i == k))));
    // p and q up to factors: the longest column and the longest row of N
    let longest =
        |all: [[f64; 3]; 3]| all.into_iter().max_by(|a, b| dot(a, a).total_cmp(&dot(b, b))).unwrap_or_default();
    let (p, q) = (longest([0, 1, 2].map(|k| [0, 1, 2].map(|i| n[i][k]))), longest(n));
    let (length, factor) = (sqrt(dot(&p, &p)), sqrt(dot(&q, &q)));
    if length < 1e-3 || factor < 1e-3 {
        return Err(NoTangents::Eigenvalues);
    }
    let p = p.map(|x| x / length);
    let along = q.map(|x| x / factor);
    let across = cross(p, along);
    let sign =
        if (0..9).map(|at| n[at / 3][at % 3] * p[at / 3] * along[at % 3]).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
    // Y = C G^-1 with G = R C
    let g: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|k| dot(&rows[i], &columns[k])));
    let cofactors = [cross(g[1], g[2]), cross(g[2], g[0]), cross(g[0], g[1])];
    let determinant = dot(&g[0], &cofactors[0]);
    if determinant.abs() < 1e-9 {
        return Err(NoTangents::Eigenvalues);
    }
    let place = |i: usize| -> [f64; 2] {
        let c = [0, 1, 2].map(|k| columns[k][i]);
        let y = cofactors.map(|cofactor| dot(&cofactor, &c) / determinant);
        [sign * dot(&y, &p) + LAST_VECTOR_WEIGHT * dot(&y, &along), LAST_VECTOR_WEIGHT * dot(&y, &across)]
    };
    let (x, y) = (0..rows[0].len()).map(place).map(|[x, y]| (x, y)).unzip();
    Ok([[mixed(&along, rows), mixed(&across, rows)], [x, y]])
}

/// Subtracts the mean of a row from its entries.
pub(super) fn sum_to_zero(row: &mut [f64]) {
    let mean = row.iter().sum::<f64>() / real(row.len());
    row.iter_mut().for_each(|x| *x -= mean);
}

/// Returns whether the faces at the centre turn to the left at all their vertices in the plane of the characteristic
/// map; `false` means that all turn to the right. A face that is the only one around a vertex may be straight there.
///
/// # Errors
/// [`NoTangents::Eigenvalues`] if neighbouring points coincide, as on a boundary that shrinks faster than the inside;
/// [`NoTangents::Folded`] if the faces turn both ways or not at all.
fn turns_left(centre: Centre, faces: &[&[u32]], place: impl Fn(u32) -> [f64; 2]) -> Result<bool, NoTangents> {
    let mut sines = Vec::new();
    let mut alone = 0.0;
    let extent =
        faces.iter().flat_map(|face| face.iter()).flat_map(|&v| place(v)).fold(0.0, |most: f64, x| most.max(x.abs()));
    for face in faces {
        for i in 0..face.len() {
            let [p, q, r] = [i + face.len() - 1, i, i + 1].map(|k| place(face[k % face.len()]));
            let (a, b) = ([r[0] - q[0], r[1] - q[1]], [p[0] - q[0], p[1] - q[1]]);
            let lengths = [a, b].map(|[x, y]| sqrt(x * x + y * y));
            if lengths[0].min(lengths[1]) <= 1e-9 * extent {
                return Err(NoTangents::Eigenvalues);
            }
            let sine = planar::cross(a, b) / (lengths[0] * lengths[1]);
            if faces.len() == 1 && centre == Centre::Vertex(face[i]) {
                alone = sine;
            } else {
                sines.push(sine);
            }
        }
    }
    if sines.iter().all(|&sine| sine > 1e-9) && alone > -1e-9 {
        Ok(true)
    } else if sines.iter().all(|&sine| sine < -1e-9) && alone < 1e-9 {
        Ok(false)
    } else {
        Err(NoTangents::Folded)
    }
}

/// The eigenvectors that dominate after many steps.
enum Leading {
    /// An orthonormal basis of the plane of the two largest eigenvalues.
    Plane([Vec<f64>; 2]),
    /// An eigenvector and a chain of a repeated second eigenvalue.
    Chain(Chain),
    /// An orthonormal basis of the space of a triple eigenvalue, and the matrix of the map in this basis.
    Thrice(Vectors<3>, [[f64; 3]; 3]),
}

/// The eigenvector of the largest eigenvalue, and the longest chain of the next one.
struct Chain {
    first: Vec<f64>,
    /// An eigenvector of the second eigenvalue b, then vectors that are mapped to b times the sum of themselves and the
    /// vector before; all up to multiples of `first`.
    steps: Vec<Vec<f64>>,
}

/// Finds the dominating eigenvectors of the map `apply` on the vectors of length `n` that `deflate` leaves unchanged.
/// They are found in three cases: the two largest eigenvalues are positive reals and larger than all others; the second
/// is repeated and has a single longest chain; or the largest has multiplicity three.
///
/// # Errors
/// [`NoTangents::Eigenvalues`] in all other cases.
fn leading(n: usize, apply: impl Fn(&[f64]) -> Vec<f64>, deflate: impl Fn(&mut [f64])) -> Result<Leading, NoTangents> {
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
                Some(leading) => return Ok(leading),
                None => continue,
            }
        };
        let (found, [[a, b], [c, d]], left_over) = seen(&block, &vectors, &images);
        let size = a.abs() + b.abs() + c.abs() + d.abs();
        if left_over <= MAX_RESIDUAL * size {
            let (trace, determinant) = (a + d, a * d - b * c);
            let discriminant = trace * trace - 4.0 * determinant;
            let second = (trace - sqrt(discriminant.max(0.0))) / 2.0;
            let real = discriminant >= -1e-9 * trace * trace;
            let ahead = real && third < (1.0 - LEAST_EIGENVALUE_GAP) * second;
            return if ahead { Ok(Leading::Plane(found)) } else { Err(NoTangents::Eigenvalues) };
        }
    }
    Err(NoTangents::Eigenvalues)
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
    let vanishes = square.flatten().all(|x| x.abs() <= 1e-9);
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
    while powers[powers.len() - 1].iter().map(size).fold(0.0, f64::max) > 1e-9 {
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
        row.iter().zip(eigenvector).any(|(x, y)| (x - factor * y).abs() > 1e-9)
    };
    if powers.len() < 2 || size(eigenvector) < 1e-3 || last.iter().any(beside) {
        return None;
    }
    Some(powers.iter().rev().map(|power| power[from].clone()).collect())
}

/// Returns `width` vectors of length `n` with pseudo-random entries between -0.5 and 0.5: always the same, and without
/// a pattern that a symmetry of a disc could share.
pub(super) fn starting_vectors(n: usize, width: usize) -> Vec<Vec<f64>> {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut next = || {
        // xorshift: G. Marsaglia, Journal of Statistical Software 8 (2003), 1-6
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        #[expect(clippy::cast_precision_loss, reason = "53 bits are kept")]
        let unit = (state >> 11) as f64 / (1_u64 << 53) as f64;
        unit - 0.5
    };
    (0..width).map(|_| (0..n).map(|_| next()).collect()).collect()
}
