//! Upper bounds of the joint spectral radius, by branch and bound.
//!
//! Take any norm, any t and any finite tree of products in which every inner node has one child per matrix. If the norm
//! of each leaf of l factors is at most `t^l`, the joint spectral radius is at most t, because every long product
//! splits into leaves. The norm is the greatest row sum in some coordinates. Products are computed in f64 together with
//! a bound of their rounding errors, which is added to the norms.
//!
//! Source: Gripenberg, Linear Algebra and its Applications 234 (1996), 43-60.

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{FromPrimitive, One, Zero};

use super::lower::Lower;
use super::matrices::{ExactMatrix, multiply, price, product, row_norm};
use super::norms::ROUNDING_UNIT;
use crate::math::exact::{Exact, above, binary, rounded};
use crate::math::functions::{pow, real, sqrt};
use crate::watch::{Stopped, Watch};

/// Maximum number of factors of a product. Completed trees have leaves of far fewer factors. With half of it some
/// near-extremal products stay undecided; twice of it spends the budget on a single branch.
const MAX_LENGTH: usize = 2048;
/// Relative gaps above the lower bound at which upper bounds are attempted, one after another. Each step narrows the
/// interval to a half or a third. Finer steps try more trees for less.
const ATTEMPTED_GAPS: [f64; 16] =
    [1.0, 0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 1e-3, 5e-4, 2e-4, 1e-4, 1e-5, 1e-6];
/// Maximum size of matrices for which ellipsoidal coordinates are computed, exactly; larger matrices are only scaled.
/// The 2n-point schemes have matrices of size 2n - 2, which is 30 for n = 16, the largest. Half of it leaves those from
/// n = 9 on wider intervals; twice of it takes eight times as long and more, because the fractions grow.
const MAX_TURNED: usize = 30;
/// Denominator of the entries of coordinate transformations. Half or twice as many steps are as good; finer ones make
/// longer fractions.
const TRANSFORM_DENOMINATOR: f64 = 4096.0;
/// Maximum number of products by which coordinates are compared, for matrices of the usual size; of larger matrices
/// fewer are made. Half of it compares two matrices by products of one factor less, which tell good coordinates from
/// bad ones less surely; twice of it takes twice the time for one factor more.
const TRIAL_WORDS: usize = 256;
/// Share by which a trial stays below a threshold that a bound is to beat, so that rounding does not leave it above.
/// Half of it is still millions of roundings; twice of it misses bounds that are between 1e-9 and 2e-9 below.
const BELOW_THRESHOLD_SHARE: f64 = 1e-9;
/// Least stretch of a coordinate that rows scarcely reach, as a share of the largest. Half and twice of it change
/// bounds of such matrices only; none at all would divide by 0.
const LEAST_STRETCH: f64 = 1e-6;
/// The part of the identity in the ellipsoid, which keeps it from being flat. Half of it lets it become flatter, so
/// that rounding counts more; twice of it keeps it farther from the one that the matrices leave invariant.
const ROUND_SHARE: f64 = 1e-2;

/// An upper bound of the joint spectral radius.
#[derive(Debug, Clone, PartialEq)]
pub struct Upper {
    /// The bound as a fraction, if a single step of all matrices gives it.
    pub exact: Option<Exact>,
    /// The bound in f64, rounded up.
    pub value: f64,
    /// The name of the norm in which the bound was found.
    pub norm: &'static str,
    /// The number of products examined.
    pub nodes: u64,
}

impl Upper {
    /// Adds the products that were examined for another purpose.
    pub(super) fn after(self, nodes: u64) -> Self {
        Self { nodes: self.nodes + nodes, ..self }
    }

    /// Returns whether the joint spectral radius is proved to be below `x`.
    pub fn stays_below(&self, x: &Exact) -> bool {
        self.exact.as_ref().map_or_else(|| binary(self.value) < *x, |bound| bound < x)
    }
}

/// A square matrix of integers, row by row.
type WholeMatrix = Vec<Vec<BigInt>>;

/// The matrices in one choice of coordinates.
struct Family {
    norm: &'static str,
    n: usize,
    matrices: Vec<Vec<f64>>,
}

/// Computes the least upper bound that `budget` products prove. At the `thresholds`, which decide about smoothness,
/// bounds slightly below are attempted too.
///
/// # Errors
/// [`Stopped`].
pub(super) fn bound(
    matrices: &[ExactMatrix],
    lower: &Lower,
    thresholds: &[Exact],
    budget: u64,
    watch: &Watch,
) -> Result<Upper, Stopped> {
    let one_step = matrices.iter().map(row_norm).max().unwrap_or_else(Exact::zero);
    let value = above(&one_step);
    let mut best = Upper { norm: "row sums", value, exact: Some(one_step.clone()), nodes: 0 };
    if lower.reaches(&one_step) {
        return Ok(best);
    }
    let mut ladder: Vec<f64> = ATTEMPTED_GAPS.iter().map(|gap| lower.value * (1.0 + gap)).collect();
    let decisive = thresholds.iter().map(|x| rounded(x) * (1.0 - BELOW_THRESHOLD_SHARE)).filter(|x| *x > lower.value);
    ladder.extend(decisive);
    ladder.sort_by(|a, b| b.total_cmp(a));
    let families = families(matrices, lower.value);
    let mut left = budget;
    for (place, family) in families.iter().enumerate() {
        // the most promising coordinates may use half of the budget, the others the rest
        let share = if place + 1 == families.len() { left } else { left / 2 };
        let climbed = family.climb(&ladder, share, watch)?;
        left -= climbed.nodes;
        best.nodes += climbed.nodes;
        if climbed.bound < best.value {
            best = Upper { norm: family.norm, value: climbed.bound, exact: None, ..best };
        }
    }
    Ok(best)
}

/// Returns the two most promising choices of coordinates for norms, those first in which products of some length have
/// the smallest norms.
fn families(matrices: &[ExactMatrix], lower: f64) -> Vec<Family> {
    let n = matrices[0].len();
    let transposed: Vec<ExactMatrix> = matrices.iter().map(transpose).collect();
    let mut families = vec![
        Family::new("row sums", matrices),
        Family::new("column sums", &transposed),
        Family { norm: "weighted row sums", n, matrices: scaled(matrices) },
        Family { norm: "weighted column sums", n, matrices: scaled(&transposed) },
    ];
    let turned = [("ellipsoidal row sums", matrices), ("ellipsoidal column sums", &transposed)];
    for (norm, all) in turned.into_iter().filter(|_| n <= MAX_TURNED) {
        families.extend(in_ellipsoid(all, lower, n).map(|matrices| Family { norm, n, matrices }));
    }
    let mut rated: Vec<(f64, Family)> = families.into_iter().map(|family| (family.trial(), family)).collect();
    rated.sort_by(|a, b| a.0.total_cmp(&b.0));
    rated.truncate(2);
    rated.into_iter().map(|(_, family)| family).collect()
}

fn transpose(matrix: &ExactMatrix) -> ExactMatrix {
    (0..matrix.len()).map(|k| matrix.iter().map(|row| row[k].clone()).collect()).collect()
}

/// Returns the matrices `D^-1 T D`, row by row, scaled by the eigenvector D of the sum of their absolute values, so
/// that no row dominates; D has few digits, and each entry is rounded once.
fn scaled(matrices: &[ExactMatrix]) -> Vec<Vec<f64>> {
    let n = matrices[0].len();
    let mut stretch = vec![1.0; n];
    for _ in 0..32 {
        let row = |p: usize| {
            let of_one = |matrix: &ExactMatrix| -> f64 {
                matrix[p].iter().zip(&stretch).map(|(x, s)| rounded(x).abs() * s).sum()
            };
            matrices.iter().map(of_one).fold(0.0, f64::max)
        };
        let next: Vec<f64> = (0..n).map(row).collect();
        let most = next.iter().fold(0.0, |most: f64, x| most.max(*x));
        if most == 0.0 {
            break;
        }
        stretch = next.iter().zip(&stretch).map(|(x, s)| (x / most + s).max(LEAST_STRETCH) / 2.0).collect();
    }
    let stretch: Vec<BigInt> = stretch.iter().map(|&s| coarse(s, true)).collect();
    let entry = |p: usize, q: usize, x: &Exact| over(x.numer() * &stretch[q], x.denom() * &stretch[p]);
    let row = |(p, row): (usize, &Vec<Exact>)| row.iter().enumerate().map(|(q, x)| entry(p, q, x)).collect::<Vec<_>>();
    matrices.iter().map(|matrix| matrix.iter().enumerate().flat_map(row).collect()).collect()
}

/// Returns the f64 nearest to a fraction without cancelling common divisors.
fn over(a: BigInt, b: BigInt) -> f64 {
    rounded(&Exact::new_raw(a, b))
}

/// Returns the matrices, row by row, in coordinates in which an ellipsoid that they leave nearly invariant is a ball:
/// `L^T T L^-T` with one rounding per entry, where `P = L L^T` is the limit of `P <- I + sum T^T P T / (d rho^2)` and L
/// has entries of few digits.
fn in_ellipsoid(matrices: &[ExactMatrix], lower: f64, n: usize) -> Option<Vec<Vec<f64>>> {
    let flat: Vec<Vec<f64>> = matrices.iter().map(|matrix| matrix.iter().flatten().map(rounded).collect()).collect();
    let identity = |k: usize| if k.is_multiple_of(n + 1) { 1.0 } else { 0.0 };
    let mut p: Vec<f64> = (0..n * n).map(identity).collect();
    let share = 1.0 / (lower * lower * 1.02);
    let (mut half, mut whole) = (Vec::new(), Vec::new());
    for _ in 0..60 {
        let mut next: Vec<f64> = (0..n * n).map(|k| ROUND_SHARE * identity(k)).collect();
        for t in &flat {
            let turned: Vec<f64> = (0..n * n).map(|k| t[(k % n) * n + k / n]).collect();
            multiply(&turned, &p, n, &mut half);
            multiply(&half, t, n, &mut whole);
            next.iter_mut().zip(&whole).for_each(|(sum, x)| *sum += share * x);
        }
        let trace: f64 = (0..n).map(|i| next[i * n + i]).sum();
        let scale = real(n) / trace;
        p = next.iter().map(|x| x * scale).collect();
    }
    let l = cholesky(&p, n)?;
    // upper triangular: L^T, as whole numbers
    let to: Vec<Vec<BigInt>> = (0..n)
        .map(|i| (0..n).map(|k| if k < i { BigInt::zero() } else { coarse(l[k * n + i], i == k) }).collect())
        .collect();
    let (back, determinant) = adjugate_of_upper(&to);
    Some(matrices.iter().map(|t| in_coordinates(t, &to, &back, &determinant)).collect())
}

/// Returns `U T adj(U) / det(U)`, row by row, in integer arithmetic with one rounding per entry.
fn in_coordinates(t: &ExactMatrix, to: &WholeMatrix, back: &WholeMatrix, determinant: &BigInt) -> Vec<f64> {
    let common = t.iter().flatten().fold(BigInt::one(), |common, x| common.lcm(x.denom()));
    let whole: WholeMatrix =
        t.iter().map(|row| row.iter().map(|x| x.numer() * (&common / x.denom())).collect()).collect();
    let under = common * determinant;
    let turned = product(&product(to, &whole), back);
    turned.into_iter().flatten().map(|x| over(x, under.clone())).collect()
}

/// Returns a number in units of 1/4096; diagonal entries are never 0.
fn coarse(x: f64, diagonal: bool) -> BigInt {
    let rounded = (x * TRANSFORM_DENOMINATOR).round();
    BigInt::from_f64(if diagonal && rounded == 0.0 { 1.0 } else { rounded }).unwrap_or_else(BigInt::zero)
}

fn cholesky(p: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut l = vec![0.0; n * n];
    for i in 0..n {
        for k in 0..=i {
            let sum: f64 = (0..k).map(|m| l[i * n + m] * l[k * n + m]).sum();
            let rest = p[i * n + k] - sum;
            l[i * n + k] = if i > k {
                rest / l[k * n + k]
            } else if rest > 0.0 {
                sqrt(rest)
            } else {
                return None;
            };
        }
    }
    Some(l)
}

/// Returns the adjugate of an upper triangular matrix and its determinant; their quotient is the inverse.
fn adjugate_of_upper(u: &WholeMatrix) -> (WholeMatrix, BigInt) {
    let n = u.len();
    let determinant: BigInt = (0..n).map(|i| &u[i][i]).product();
    let mut adjugate = vec![vec![BigInt::zero(); n]; n];
    for k in 0..n {
        adjugate[k][k] = &determinant / &u[k][k];
        for i in (0..k).rev() {
            let sum: BigInt = (i + 1..=k).map(|m| &u[i][m] * &adjugate[m][k]).sum();
            adjugate[i][k] = -sum / &u[i][i];
        }
    }
    (adjugate, determinant)
}

impl Family {
    fn new(norm: &'static str, matrices: &[ExactMatrix]) -> Self {
        let n = matrices[0].len();
        let flat = |matrix: &ExactMatrix| matrix.iter().flatten().map(rounded).collect();
        Self { norm, n, matrices: matrices.iter().map(flat).collect() }
    }

    /// Returns the greatest l-th root of the norms of all products of l factors.
    fn trial(&self) -> f64 {
        let mut products = vec![self.matrices[0].clone()];
        products.extend(self.matrices[1..].iter().cloned());
        let mut length = 1.0;
        let most = TRIAL_WORDS / usize::try_from(price(self.n)).unwrap_or(1);
        while products.len() * self.matrices.len() <= most {
            let mut longer = Vec::with_capacity(products.len() * self.matrices.len());
            for left in &products {
                for right in &self.matrices {
                    let mut matrix = Vec::new();
                    multiply(left, right, self.n, &mut matrix);
                    longer.push(matrix);
                }
            }
            (products, length) = (longer, length + 1.0);
        }
        let norms = products.iter().map(|matrix| norm(matrix, self.n));
        pow(norms.fold(0.0, f64::max), 1.0 / length)
    }
}

fn norm(matrix: &[f64], n: usize) -> f64 {
    matrix.chunks_exact(n).map(|row| row.iter().copied().map(f64::abs).sum::<f64>()).fold(0.0, f64::max)
}

/// A proved bound of products of matrices divided by `bound`: all their norms are at most `most`.
#[derive(Debug, Clone, Copy)]
struct ProductBound {
    bound: f64,
    most: f64,
}

/// The least proved bound, and the number of products examined.
struct Climbed {
    bound: f64,
    nodes: u64,
}

impl Family {
    /// Tries a ladder of decreasing bounds until a tree of products fails to prove one.
    fn climb(&self, ladder: &[f64], budget: u64, watch: &Watch) -> Result<Climbed, Stopped> {
        let one_step = self.matrices.iter().map(|matrix| norm(matrix, self.n)).fold(0.0, f64::max);
        let mut known = ProductBound { bound: one_step * (1.0 + 64.0 * ROUNDING_UNIT), most: 1.0 };
        let mut left = budget;
        for &bound in ladder.iter().filter(|bound| **bound < one_step) {
            let mut tree = ProductTree::new(self, bound, left, watch);
            let proved = tree.holds(known)?;
            left = tree.left;
            let Some(most) = proved else { break };
            known = ProductBound { bound, most };
        }
        Ok(Climbed { bound: known.bound, nodes: budget - left })
    }
}

/// The tree of products of matrices divided by some t; its leaves must have norms of at most 1.
struct ProductTree<'a> {
    n: usize,
    bound: f64,
    matrices: Vec<Vec<f64>>,
    norms: Vec<f64>,
    left: u64,
    watch: &'a Watch,
}

/// A product on the current path of the tree.
struct PathProduct {
    matrix: Vec<f64>,
    norm: f64,
    /// A bound of all rounding errors so far, each multiplied by the growth of the products after it.
    error: f64,
}

impl<'a> ProductTree<'a> {
    fn new(family: &Family, bound: f64, left: u64, watch: &'a Watch) -> Self {
        let over = |matrix: &Vec<f64>| matrix.iter().map(|x| x / bound).collect::<Vec<f64>>();
        let matrices: Vec<Vec<f64>> = family.matrices.iter().map(over).collect();
        let norms = matrices.iter().map(|matrix| norm(matrix, family.n)).collect();
        Self { n: family.n, bound, matrices, norms, left, watch }
    }

    /// Returns the greatest norm of all products, whatever their length, if all leaves are found within the budget.
    /// Rounding errors grow along the path as products do, which the `known` bound limits.
    fn holds(&mut self, known: ProductBound) -> Result<Option<f64>, Stopped> {
        let (n, price) = (self.n, price(self.n));
        let growth = known.bound / self.bound * (1.0 + 4.0 * ROUNDING_UNIT);
        let gamma = real(n + 6) * ROUNDING_UNIT;
        let identity: Vec<f64> = (0..n * n).map(|k| if k % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
        let mut path = vec![PathProduct { matrix: identity, norm: 1.0, error: 0.0 }];
        let mut next = vec![0];
        let mut spare = Vec::new();
        let mut most: f64 = 1.0;
        while let (Some(place), Some(before)) = (next.last_mut(), path.last()) {
            let factor = *place;
            *place += 1;
            if factor == self.matrices.len() {
                next.pop();
                path.pop();
                continue;
            }
            let Some(left) = self.left.checked_sub(price).filter(|_| path.len() <= MAX_LENGTH) else {
                return Ok(None);
            };
            self.left = left;
            self.watch.advance(price);
            if path.len().is_multiple_of(256) || self.left % 1024 < price {
                self.watch.check()?;
            }
            let mut matrix = std::mem::take(&mut spare);
            multiply(&before.matrix, &self.matrices[factor], n, &mut matrix);
            let error = before.error * growth + gamma * before.norm * self.norms[factor];
            let norm = norm(&matrix, n);
            let greatest = norm * (1.0 + gamma) + known.most * error * (1.0 + gamma);
            if greatest <= 1.0 {
                spare = matrix;
            } else {
                most = most.max(greatest);
                path.push(PathProduct { matrix, norm, error });
                next.push(0);
            }
        }
        Ok(Some(most))
    }
}
