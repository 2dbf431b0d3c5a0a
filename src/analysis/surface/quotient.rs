//! The smoothness of limits of regular nets, whatever factors the symbol has, by the joint spectral radius of a step on
//! the points that influence a cell, modulo polynomials.
//!
//! The matrices `A_e`, `A_e[f][c] = a[e + f - d c]`, map the points around a cell to those around each of the `d^2`
//! cells that it becomes. With K sum rules they map samples of polynomials of a degree below K to such samples. On the
//! quotient space they have a joint spectral radius rho. Limits are C^k for all k < K with `rho < d^-k`, and have the
//! Hoelder exponent `-log_d(rho)` as far as that is below K. If the shifts of the basic limit function are stable, as
//! they are for interpolating schemes, limits are not C^k for k < K with `rho >= d^-k`, nor for k = K. Schemes with
//! `rho >= 1` diverge, whether their shifts are stable or not, because differences do not shrink.
//!
//! The coordinates of the quotient are the values outside a triangle of points, minus the values of the polynomial
//! through the points of the triangle. Weights are replaced by the nearest fractions with small denominators.
//!
//! Source: Han and Jia, SIAM Journal on Mathematical Analysis 29 (1998), 1177-1199; Jia, Transactions of the AMS 351
//! (1999), 4089-4112.

use std::collections::BTreeMap;

use num_traits::{One, Zero};

use super::characteristic::around_square;
use super::regular::RegularMask;
use super::sectors::LatticePoint;
use crate::analysis::smoothness::{ExactMatrix, RadiusBounds, radius_bounds};
use crate::math::exact::{self, Exact, binary, rounded};
use crate::math::functions::ln;
use crate::math::number::Number;
use crate::watch::{Stopped, Watch};

/// Maximum number of sum rules that are tested. Schemes on meshes that are no splines have four. Half of it would miss
/// some; twice of it only takes time.
const MAX_SUM_RULES: i32 = 8;
/// Maximum number of points outside the triangle. Masks with 9 x 9 entries have some forty. Half of it leaves out the
/// push-back with k = 1; twice of it takes eight times as long and more.
const MAX_QUOTIENT_POINTS: usize = 48;
/// Bound of the rounding of logarithms and their quotient in an exponent, for which it is widened. It is some thousand
/// roundings of an exponent, which has a few; half of it still covers them, twice of it widens exponents by as much.
const EXPONENT_ROUNDING: f64 = 1e-12;
/// Largest distance of a weight from the fraction that it stands for: 45 roundings of 1, as sums of weights have. Half
/// of it may take weights of long words as binary numbers, with which proofs take longer; twice of it may take a weight
/// for a fraction that it is not, if both differ in the 14th digit.
const FRACTION_DISTANCE: f64 = 1e-14;

/// Bounds of the joint spectral radius, and of the smoothness that follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Quotient {
    /// The number of sum rules K.
    pub sum_rules: i32,
    /// The bounds of the radius.
    pub radius: RadiusBounds,
    /// A lower bound of the Hoelder exponent.
    pub least_holder: f64,
    /// An upper bound of the Hoelder exponent, if one is proved.
    pub most_holder: Option<f64>,
    /// The largest k for which limits are proved to be C^k; -1 if not even convergence is proved.
    pub proved_c: i64,
    /// The smallest k for which C^k is disproved, if any.
    pub disproved_c: Option<i64>,
}

/// A mask of fractions.
type ExactMask = BTreeMap<LatticePoint, Exact>;

impl Quotient {
    /// Returns what at most `nodes` matrix products prove; `None` if the mask has no sum rules, has a weight without a
    /// fraction, or is too wide.
    ///
    /// # Errors
    /// [`Stopped`].
    pub(super) fn of(regular: &RegularMask, nodes: u64, watch: &Watch) -> Result<Option<Self>, Stopped> {
        let Some(mask) = fractions(regular) else { return Ok(None) };
        let (order, d) = (sum_rules(&mask, regular.arity), regular.arity);
        let points = around_square(&regular.mask, d);
        let Some((corners, others)) =
            split_points(&points, order).filter(|(_, others)| others.len() <= MAX_QUOTIENT_POINTS)
        else {
            return Ok(None);
        };
        let matrices: Vec<ExactMatrix> =
            (0..d * d).map(|e| left_over(&mask, d, [e % d, e / d], &corners, &others)).collect();
        let threshold = |k: i32| Exact::whole(d.into()).pow(-k);
        let thresholds: Vec<Exact> = (0..order).map(threshold).collect();
        let radius = radius_bounds(&matrices, &thresholds, nodes, watch)?;
        let proved_c = (0..order).rev().find(|&k| radius.upper.stays_below(&threshold(k))).map_or(-1, i64::from);
        let is_stable = proved_c >= 0 && interpolates(&mask, d);
        let lower = radius.lower.as_ref().filter(|_| is_stable);
        let rough = lower.and_then(|lower| (0..order).find(|&k| lower.reaches(&threshold(k))));
        let diverges = radius.lower.as_ref().is_some_and(|lower| lower.reaches(&threshold(0)));
        let disproved_c = if diverges { Some(0) } else { is_stable.then(|| i64::from(rough.unwrap_or(order))) };
        let exponent = |radius: f64| -ln(radius) / ln(f64::from(d));
        let over = radius.upper.exact.as_ref().map_or(radius.upper.value, rounded);
        let least_holder = (exponent(over) - EXPONENT_ROUNDING).min(f64::from(order));
        let most_holder = lower.map(|lower| (exponent(lower.value) + EXPONENT_ROUNDING).min(f64::from(order)));
        Ok(Some(Self { sum_rules: order, radius, least_holder, most_holder, proved_c, disproved_c }))
    }
}

/// Returns the nearby fraction with a small denominator, or the exact value of the weight if there is none.
pub(super) fn fraction(a: f64) -> Option<Exact> {
    let near = exact::simple(a)?;
    // a weight farther from the fraction is taken as the exact binary number
    let is_near = rounded(&near).to_bits() == a.to_bits() || (rounded(&near) - a).abs() <= FRACTION_DISTANCE;
    Some(if is_near { near } else { binary(a) })
}

/// Converts the mask to fractions.
fn fractions(regular: &RegularMask) -> Option<ExactMask> {
    regular.mask.iter().map(|(&k, &a)| Some((k, fraction(a)?))).collect()
}

/// Returns the exponents of the monomials x^i y^j of a degree below `order`.
fn monomials(order: i32) -> impl Iterator<Item = [i32; 2]> {
    (0..order).flat_map(|degree| (0..=degree).map(move |i| [i, degree - i]))
}

fn power([x, y]: LatticePoint, [i, j]: [i32; 2]) -> Exact {
    Exact::whole(x.into()).pow(i) * Exact::whole(y.into()).pow(j)
}

/// Returns the number K of sum rules: the sums of `a[k] k^m` over the residue classes are equal for all powers m below
/// K.
fn sum_rules(mask: &ExactMask, d: i32) -> i32 {
    let same = |powers: [i32; 2]| {
        let mut sums: BTreeMap<LatticePoint, Exact> = BTreeMap::new();
        for (k, a) in mask {
            *sums.entry(k.map(|x| x.rem_euclid(d))).or_insert_with(Exact::zero) += a * power(*k, powers);
        }
        let first = sums.get(&[0, 0]).cloned().unwrap_or_else(Exact::zero);
        let all = usize::try_from(d * d).is_ok_and(|n| sums.len() == n) && sums.values().all(|sum| *sum == first);
        all && (powers != [0, 0] || first.is_one())
    };
    let holds = |degree: &i32| (0..=*degree).all(|i| same([i, degree - i]));
    i32::try_from((0..MAX_SUM_RULES).take_while(holds).count()).unwrap_or(0)
}

/// Splits the points into a triangle of points that determines a polynomial of a degree below the order, and the
/// others.
fn split_points(points: &[LatticePoint], order: i32) -> Option<(Vec<LatticePoint>, Vec<LatticePoint>)> {
    let triangle = |[x, y]: LatticePoint| monomials(order).map(|[i, j]| [x + i, y + j]).collect::<Vec<_>>();
    let corners = points.iter().map(|&p| triangle(p)).find(|all| all.iter().all(|p| points.contains(p)))?;
    let others = points.iter().copied().filter(|p| !corners.contains(p)).collect::<Vec<_>>();
    (order > 0 && !others.is_empty()).then_some((corners, others))
}

/// Returns the matrix of one of the finer cells on the quotient modulo polynomials.
fn left_over(
    mask: &ExactMask,
    d: i32,
    e: LatticePoint,
    corners: &[LatticePoint],
    others: &[LatticePoint],
) -> ExactMatrix {
    let [x, y] = corners[0];
    let order = corners.iter().map(|p| p[0] - x + p[1] - y).max().unwrap_or(0);
    let at = |f: LatticePoint, c: LatticePoint| mask.get(&[0, 1].map(|axis| e[axis] + f[axis] - d * c[axis])).cloned();
    let row = |&f: &LatticePoint| {
        let lagrange = |p: &LatticePoint| lagrange(order, [p[0] - x, p[1] - y], [f[0] - x, f[1] - y]);
        let shares: Vec<(LatticePoint, Exact)> = corners.iter().map(|p| (*p, lagrange(p))).collect();
        let cell = |&c: &LatticePoint| {
            let through = shares.iter().filter_map(|(p, share)| Some(share * at(*p, c)?));
            at(f, c).unwrap_or_else(Exact::zero) - through.sum::<Exact>()
        };
        others.iter().map(cell).collect()
    };
    others.iter().map(row).collect()
}

/// Evaluates the polynomial of a degree that is 1 at the point (i, j) of the triangle `i, j >= 0, i + j <= degree` and
/// 0 at all its other points.
fn lagrange(degree: i32, [i, j]: LatticePoint, [x, y]: LatticePoint) -> Exact {
    let falling = |x: i32, n: i32| (0..n).map(|k| Exact::ratio((x - k).into(), (k + 1).into())).product::<Exact>();
    falling(x, i) * falling(y, j) * falling(degree - x - y, degree - i - j)
}

/// Returns whether the scheme interpolates, in which case shifts are stable.
fn interpolates(mask: &ExactMask, d: i32) -> bool {
    let mut kept = mask.iter().filter(|(k, _)| k.iter().all(|x| x % d == 0));
    kept.all(|(k, a)| if *k == [0, 0] { a.is_one() } else { a.is_zero() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_of_a_triangle_are_1_at_one_of_its_points() {
        for point in monomials(4) {
            for at in monomials(4) {
                assert_eq!(lagrange(3, point, at), Exact::whole(i64::from(point == at)));
            }
        }
        // x^2 through its values on the triangle
        let value: Exact = monomials(4).map(|p| lagrange(3, p, [5, -2]) * Exact::whole(i64::from(p[0] * p[0]))).sum();
        assert_eq!(value, Exact::whole(25));
    }
}
