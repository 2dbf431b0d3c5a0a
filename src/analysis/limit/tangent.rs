//! Tangents of the limit: left eigenvectors of the two eigenvalues after 1 of a local subdivision matrix.
//!
//! With right eigenvectors `1, x, y, ...` and left ones `l, t, u, ...` of the eigenvalues `1 > a >= b > ...`, the
//! points around a centre are `1 (l p) + a^k x (t p) + b^k y (u p) + ...` after `k` levels: `(x, y)` is the
//! characteristic map, `t p` and `u p` span the tangent plane. Source: U. Reif, CAGD 12 (1995), 153-174; D. Zorin,
//! Constructive Approximation 16 (2000), 359-397.
//!
//! The eigenvectors are found in [`leading`](super::leading).

use super::disc::Centre;
use super::leading::{Chain, LEAST_NILPOTENT_SIZE, Leading, leading};
use super::small::{Vectors, mixed};
use crate::math::dense::dot;
use crate::math::functions::{exp, ln, real, sqrt};
use crate::math::planar;
use crate::math::vector::{cross, length, minus};

/// Maximum number of faces around a vertex, or of corners of a face, for which tangents are searched. Around n faces
/// the eigenvalues of the vectors that oscillate once and four times around the centre differ by about `100/n^2`,
/// relative to their size, so that from some 300 faces on all steps of [`leading`] together do not separate them;
/// beyond the maximum the search is known to fail. The time of each step is proportional to the number of faces. Half
/// of it would refuse without a search what fails anyway; twice of it searches twice as long in vain.
const MAX_TANGENT_VALENCE: usize = 2048;
/// Weight of the last vector of a chain in the characteristic map, relative to the first; small, as it is after many
/// levels. Where the other vectors vanish, for example on a boundary that is refined by itself, only the last vector
/// separates the points. Half and twice of it stay three digits above [`LEAST_MAPPED_LENGTH`] and
/// [`LEAST_MAPPED_SINE`], below which lengths and sines count as zero.
const LAST_VECTOR_WEIGHT: f64 = 1e-6;
/// Minimum absolute value of the product of a left eigenvector with its right one, both of a length near 1, or of the
/// determinant of such products. Coordinates of the characteristic map are divided by it; a product of 0 says that the
/// two belong to different eigenvalues. At this value the rounding of 1 leaves seven digits; half of it leaves a third
/// of a digit less, twice of it as much more, and refuses what lies between.
const LEAST_LEFT_RIGHT_PRODUCT: f64 = 1e-9;
/// Minimum distance of neighbouring points of the characteristic map, relative to its largest coordinate; below it they
/// coincide. Points with equal coordinates differ by the residual of the eigenvectors, 1e-11, of which it is a hundred
/// times. Half of it is fifty times; twice of it refuses edges that are 2e-9 of the map long.
const LEAST_MAPPED_LENGTH: f64 = 1e-9;
/// Minimum absolute sine of an angle of a face in the characteristic map that tells to which side the face turns. It is
/// a hundred times the residual of the eigenvectors, 1e-11. Half of it is fifty times; twice of it counts angles of
/// 2e-9 radians as straight.
const LEAST_MAPPED_SINE: f64 = 1e-9;

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
    let found = |leading: Option<Leading>| leading.ok_or(NoTangents::Eigenvalues);
    let [[t, u], [x, y]] = match (found(leading(n, &back, sum_to_zero))?, found(leading(n, &forth, off_limit))?) {
        (Leading::Plane([t, u]), Leading::Plane([x, y])) => {
            // scaled so that t and u are dual to them: (x, y) times the inverse of ((t x, t y), (u x, u y))
            let [[a, b], [c, d]] = [[dot(&t, &x), dot(&t, &y)], [dot(&u, &x), dot(&u, &y)]];
            let determinant = a * d - b * c;
            if determinant.abs() < LEAST_LEFT_RIGHT_PRODUCT {
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
    if along.abs() < LEAST_LEFT_RIGHT_PRODUCT || step.abs() < LEAST_LEFT_RIGHT_PRODUCT {
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
    if length < LEAST_NILPOTENT_SIZE || factor < LEAST_NILPOTENT_SIZE {
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
    if determinant.abs() < LEAST_LEFT_RIGHT_PRODUCT {
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
            let (a, b) = (minus(r, q), minus(p, q));
            let lengths = [a, b].map(length);
            if lengths[0].min(lengths[1]) <= LEAST_MAPPED_LENGTH * extent {
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
    if sines.iter().all(|&sine| sine > LEAST_MAPPED_SINE) && alone > -LEAST_MAPPED_SINE {
        Ok(true)
    } else if sines.iter().all(|&sine| sine < -LEAST_MAPPED_SINE) && alone < LEAST_MAPPED_SINE {
        Ok(false)
    } else {
        Err(NoTangents::Folded)
    }
}
