//! Bernstein polynomials of degree 5 composed with polynomials of degree 2: a patch along a path through its domain,
//! with coefficients that bound it everywhere.

use super::bezier::{bernstein, choose, restriction};
use crate::math::dense::Dense;
use crate::math::functions::{cos, real, sqrt};

/// The degree of the path in each variable.
const STEP_DEGREE: usize = 2;
/// The degree of a patch of bidegree 5 along a path: 2 times (5 + 5).
const PATH_DEGREE: usize = 20;
/// The degree of the short form in each variable.
const SHORT_DEGREE: usize = 5;
/// Number of coefficients of a short form, and of Bernstein polynomials of a patch.
pub(super) const SHORT_TERMS: usize = (SHORT_DEGREE + 1) * (SHORT_DEGREE + 1);

/// Bernstein coefficients, in two variables, of the two coordinates of a path through the domain of a patch.
pub(super) type Path = [[[f64; STEP_DEGREE + 1]; STEP_DEGREE + 1]; 2];

/// A polynomial of two variables in the scaled Bernstein basis, where products are plain products of coefficients. If
/// no coefficient is negative, nothing cancels: each step has a relative error of one rounding.
#[derive(Debug, Clone)]
struct Scaled {
    degree: usize,
    terms: Vec<f64>,
}

impl Scaled {
    fn of(path: &[[f64; STEP_DEGREE + 1]; STEP_DEGREE + 1]) -> Self {
        let binomial = [1.0, 2.0, 1.0];
        let scaled = |i: usize| (0..=STEP_DEGREE).map(move |j| binomial[i] * binomial[j] * path[i][j]);
        Self { degree: STEP_DEGREE, terms: (0..=STEP_DEGREE).flat_map(scaled).collect() }
    }

    fn one() -> Self {
        Self { degree: 0, terms: vec![1.0] }
    }

    fn times(&self, other: &Self) -> Self {
        let degree = self.degree + other.degree;
        let (width, own, its) = (degree + 1, self.degree + 1, other.degree + 1);
        let mut terms = vec![0.0; width * width];
        for (i, row) in self.terms.chunks_exact(own).enumerate() {
            for (k, factors) in other.terms.chunks_exact(its).enumerate() {
                let into = &mut terms[(i + k) * width..][..width];
                for (j, x) in row.iter().enumerate() {
                    for (term, y) in into[j..].iter_mut().zip(factors) {
                        *term += x * y;
                    }
                }
            }
        }
        Self { degree, terms }
    }

    /// Returns the six Bernstein polynomials of degree 5 of this polynomial, whose values lie in the unit interval.
    fn bernstein(&self, rest: &Self) -> [Self; 6] {
        let powers = |base: &Self| {
            let mut powers = vec![Self::one()];
            (0..5).for_each(|k| powers.push(powers[k].times(base)));
            powers
        };
        let (own, rest) = (powers(self), powers(rest));
        std::array::from_fn(|a| {
            let mut product = own[a].times(&rest[5 - a]);
            product.terms.iter_mut().for_each(|term| *term *= choose(5, a));
            product
        })
    }
}

/// A patch along a path, as sums over its 36 points: short forms of degree 5, and bounds of their errors.
#[derive(Debug)]
pub(super) struct Composed {
    /// Coefficient k of the short form of the patch's Bernstein polynomial ab: `short[k][ab]`.
    pub(super) short: Vec<[f64; SHORT_TERMS]>,
    /// Bound of the error of each short form.
    pub(super) neglected: [f64; SHORT_TERMS],
    /// Exact coefficients of degree 20 of each Bernstein polynomial of the patch.
    exact: Vec<Vec<f64>>,
}

/// Returns the weights that elevate a polynomial of some degree to degree [`PATH_DEGREE`].
fn raising(degree: usize) -> Vec<Vec<f64>> {
    let more = PATH_DEGREE - degree;
    let weight = |i: usize, j: usize| {
        if i < j || i - j > more { 0.0 } else { choose(degree, j) * choose(more, i - j) / choose(PATH_DEGREE, i) }
    };
    (0..=PATH_DEGREE).map(|i| (0..=degree).map(|j| weight(i, j)).collect()).collect()
}

/// Returns the coefficients of degree 20 of a polynomial of lower degree, given by rows.
pub(super) fn raised_whole(degree: usize, terms: &[f64]) -> Vec<f64> {
    let raising = raising(degree);
    let width = degree + 1;
    let rows: Vec<Vec<f64>> = raising
        .iter()
        .map(|weights| {
            (0..width).map(|j| weights.iter().enumerate().map(|(i, w)| w * terms[i * width + j]).sum()).collect()
        })
        .collect();
    let across = |row: &Vec<f64>| -> Vec<f64> {
        raising.iter().map(|weights| weights.iter().zip(row).map(|(w, x)| w * x).sum()).collect()
    };
    rows.iter().flat_map(across).collect()
}

impl Composed {
    /// Composes the patch with the path whose coordinates have these Bernstein coefficients, all in the unit interval.
    pub(super) fn along(path: &Path) -> Self {
        let [first, second] = path.map(|coordinate| {
            let rest = coordinate.map(|row| row.map(|x| 1.0 - x));
            Scaled::of(&coordinate).bernstein(&Scaled::of(&rest))
        });
        let binomials: Vec<f64> = (0..=PATH_DEGREE).map(|i| choose(PATH_DEGREE, i)).collect();
        let plain = |product: Scaled| -> Vec<f64> {
            let width = PATH_DEGREE + 1;
            product.terms.iter().enumerate().map(|(k, x)| x / (binomials[k / width] * binomials[k % width])).collect()
        };
        let pairs = first.iter().flat_map(|a| second.iter().map(move |b| (a, b)));
        let exact: Vec<Vec<f64>> = pairs.map(|(a, b)| plain(a.times(b))).collect();
        let columns: Vec<[f64; SHORT_TERMS]> = short_forms(path);
        let neglected = std::array::from_fn(|ab| {
            let raised = raised_whole(SHORT_DEGREE, &columns[ab]);
            raised.iter().zip(&exact[ab]).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
        });
        let short = (0..SHORT_TERMS).map(|k| std::array::from_fn(|ab| columns[ab][k])).collect();
        Self { short, neglected, exact }
    }

    /// Returns the greatest distance between a planar polynomial of degree 20 and a planar patch along the path.
    pub(super) fn distance(&self, target: &[Vec<f64>; 2], patch: &[[f64; 2]; SHORT_TERMS]) -> f64 {
        let mut most = 0.0_f64;
        for k in 0..target[0].len() {
            let mut miss = [target[0][k], target[1][k]];
            for (exact, point) in self.exact.iter().zip(patch) {
                miss = [miss[0] - exact[k] * point[0], miss[1] - exact[k] * point[1]];
            }
            most = most.max(miss[0] * miss[0] + miss[1] * miss[1]);
        }
        sqrt(most)
    }

    /// Discards the data that only [`Composed::distance`] needs.
    pub(super) fn without_exact(self) -> Self {
        Self { exact: Vec::new(), ..self }
    }
}

/// Returns short forms that interpolate the Bernstein polynomials of a patch along a path at Chebyshev points.
fn short_forms(path: &Path) -> Vec<[f64; SHORT_TERMS]> {
    const N: usize = SHORT_DEGREE + 1;
    let nodes: [f64; N] = std::array::from_fn(|k| 0.5 - 0.5 * cos(std::f64::consts::PI * (real(k) + 0.5) / real(N)));
    let values = nodes.map(bernstein::<N>);
    let matrix = Dense { n: N, a: values.iter().flatten().copied().collect() };
    let unit = |k: usize| -> Vec<f64> { (0..N).map(|i| if i == k { 1.0 } else { 0.0 }).collect() };
    let inverse: Vec<Vec<f64>> = (0..N).map(|k| matrix.solved(0.0, &unit(k), f64::MIN_POSITIVE)).collect(); // columns
    let at = nodes.map(bernstein::<{ STEP_DEGREE + 1 }>);
    let mut forms = vec![[0.0; SHORT_TERMS]; SHORT_TERMS];
    for x in 0..N {
        for y in 0..N {
            let [first, second] = path.map(|c| {
                let sum = |row: &[f64; STEP_DEGREE + 1]| row.iter().zip(&at[y]).map(|(c, b)| c * b).sum::<f64>();
                bernstein::<N>(c.iter().zip(&at[x]).map(|(row, b)| b * sum(row)).sum())
            });
            for (ab, form) in forms.iter_mut().enumerate() {
                let value = first[ab / N] * second[ab % N];
                for (k, term) in form.iter_mut().enumerate() {
                    *term += inverse[x][k / N] * inverse[y][k % N] * value;
                }
            }
        }
    }
    forms
}

/// Returns the coefficients, of degree 5, of the restriction of a cubic to the interval from x to y.
pub(super) fn part_of_cubic([x, y]: [f64; 2]) -> [[f64; 4]; SHORT_DEGREE + 1] {
    let part: [[f64; 4]; 4] = restriction([x, y]);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            (0..4)
                .filter(|k| *k <= i && i - k <= 2)
                .map(|k| choose(3, k) * choose(2, i - k) / choose(5, i) * part[k][j])
                .sum()
        })
    })
}
