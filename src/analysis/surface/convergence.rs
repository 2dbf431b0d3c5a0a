//! Proofs that limits of regular nets are C^k by norms of difference schemes, and bounds of basic limit functions.
//!
//! For a scheme c whose symbol has factors in two directions u, v that span the lattice, `c / sigma_u` refines the
//! differences along u. If some powers of both difference schemes are contractions, c converges. Limits are C^k if the
//! derivatives `d^k c / (sigma_u^i sigma_v^(k-i))` converge for all i.
//!
//! Source: Dyn and Levin, Acta Numerica 11 (2002), section 4.3; Cavaretta, Dahmen and Micchelli, Memoirs of the AMS 453
//! (1991), chapter 8.

use super::iterated::Iterated;
use super::regular::{Polynomial, RegularMask, ZERO_WEIGHT, divided};
use super::sectors::LatticePoint;
use crate::analysis::smoothness::SmoothnessCertificate;

/// Maximum number of steps of a difference scheme whose norm is computed. Butterfly needs two, Kobbelt's scheme three;
/// with six the bounds of basic limit functions are sharp enough for the proofs about their characteristic maps. Half
/// of it proves less near the ends of ranges; twice of it takes masks of a million entries.
const MAX_DIFFERENCE_STEPS: usize = 6;
/// Maximum k for which a proof is attempted. Schemes that are neither products nor splines are C^2 at best. Half of it
/// would miss that; twice of it only takes time.
const MAX_PROOF_ORDER: usize = 3;
/// Upper bound of what rounding adds to sums of weights that are 1, after some levels: 4,500 roundings of 1. Half of it
/// would still cover them; twice of it raises the bound in the 12th digit.
const BASIC_SUM_ROUNDING: f64 = 1e-12;

/// Norms of the powers 0, 1, ... of a difference scheme, the last of them below 1.
type Contraction = Vec<f64>;

/// Returns the certificates for k = 0, 1, ..., up to the first k without one.
pub(super) fn certificates(regular: &RegularMask) -> Vec<SmoothnessCertificate> {
    (0..=MAX_PROOF_ORDER).map_while(|k| certificate(regular, k)).collect()
}

fn certificate(regular: &RegularMask, k: usize) -> Option<SmoothnessCertificate> {
    let order = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
    let mut best: Option<SmoothnessCertificate> = None;
    for [u, v] in spanning() {
        let derivative = |i: usize| {
            let has = regular.factors[u] >= order(i) && regular.factors[v] >= order(k - i);
            has.then(|| converges(regular, &[(u, order(i)), (v, order(k - i))])).flatten()
        };
        let all: Option<Vec<(u32, f64)>> = (0..=k).map(derivative).collect();
        if let Some(all) = all {
            let l = all.iter().map(|found| found.0).max().unwrap_or(0);
            let norm = all.iter().map(|found| found.1).fold(0.0, f64::max);
            if best.as_ref().is_none_or(|best| l < best.l) {
                best = Some(SmoothnessCertificate { k, l, norm });
            }
        }
    }
    best
}

/// Returns the pairs of directions that span the lattice.
fn spanning() -> impl Iterator<Item = [usize; 2]> {
    let spans = |[i, k]: &[usize; 2]| {
        let ([a, b], [c, d]) = (RegularMask::DIRECTIONS[*i], RegularMask::DIRECTIONS[*k]);
        (a * d - b * c).abs() == 1
    };
    (0..4).flat_map(|i| (i + 1..4).map(move |k| [i, k])).filter(spans)
}

/// Returns the mask that refines a derivative, the differences `p[c + u] - p[c]` times the density of points: for each
/// direction, `times` times, the mask is multiplied by `d z^((d-1) u) / sigma_u`.
pub(super) fn derivative(regular: &RegularMask, along: &[(usize, u32)]) -> Option<Polynomial> {
    let d = regular.arity;
    let mut mask = regular.mask.clone();
    for &(direction, times) in along {
        for _ in 0..times {
            mask = divided(&mask, RegularMask::DIRECTIONS[direction], d)?;
            let [u, v] = RegularMask::DIRECTIONS[direction].map(|x| (d - 1) * x);
            mask = mask.into_iter().map(|([x, y], a)| ([x + u, y + v], a * f64::from(d))).collect();
        }
    }
    Some(mask)
}

/// Returns the number of steps and the norm that prove that a derivative converges.
fn converges(regular: &RegularMask, along: &[(usize, u32)]) -> Option<(u32, f64)> {
    let mask = derivative(regular, along)?;
    let [first, second] = contractions(&mask, regular.arity)?.map(|(_, contraction)| contraction);
    let steps = first.len().max(second.len()) - 1;
    let last = |contraction: &Contraction| contraction.last().copied().unwrap_or(1.0);
    Some((u32::try_from(steps).unwrap_or(0), last(&first).max(last(&second))))
}

/// Returns two directions that span the lattice and along which differences contract.
fn contractions(mask: &Polynomial, d: i32) -> Option<[(LatticePoint, Contraction); 2]> {
    let found: Vec<Option<Contraction>> =
        RegularMask::DIRECTIONS.iter().map(|&w| contraction(&divided(mask, w, d)?, d)).collect();
    let pair = spanning().find(|[i, k]| found[*i].is_some() && found[*k].is_some())?;
    let [a, b] = pair.map(|i| found[i].clone().map(|contraction| (RegularMask::DIRECTIONS[i], contraction)));
    Some([a?, b?])
}

/// Returns the norms of the powers of a scheme until one is below 1; `None` if none is.
fn contraction(mask: &Polynomial, d: i32) -> Option<Contraction> {
    let mut norms = vec![1.0];
    for norm in Iterated::new(mask, d).take(MAX_DIFFERENCE_STEPS) {
        norms.push(norm);
        if norm < 1.0 {
            return Some(norms);
        }
    }
    None
}

/// Returns an upper bound of the sum of absolute values of all basic limit functions of a scheme at any place: 1 if no
/// weight is negative.
///
/// After each number of steps, points are at most as large as the norm of these steps. From then on a point moves at
/// each level by at most the sum, over its weights, of the absolute weight times the lattice steps from its old point
/// to the weighted point, times the differences along these steps. Differences of data of size 1 are 2 at most, and
/// shrink with the contractions. The result is the least bound over all numbers of steps.
pub(super) fn lebesgue_bound(mask: &Polynomial, d: i32) -> Option<f64> {
    if mask.values().all(|&a| a >= -ZERO_WEIGHT) {
        return Some(1.0 + BASIC_SUM_ROUNDING);
    }
    let pair = contractions(mask, d)?;
    let tail = |contraction: &Contraction| {
        let (last, before) = contraction.split_last()?;
        Some(before.iter().sum::<f64>() / (1.0 - last))
    };
    let tails = [tail(&pair[0].1)?, tail(&pair[1].1)?];
    let directions = [pair[0].0, pair[1].0];
    let beyond = |costs: [f64; 2]| 2.0 * farthest(mask, d, directions, costs);
    let (first, second) = (divided(mask, directions[0], d)?, divided(mask, directions[1], d)?);
    let differences = Iterated::new(&first, d).zip(Iterated::new(&second, d));
    // the size of points after some steps, and the bound of their further movement
    let after = Iterated::new(mask, d).zip(differences).take(MAX_DIFFERENCE_STEPS);
    let bounds = after.map(|(norm, (a, b))| norm + beyond([tails[0] * a, tails[1] * b]));
    Some(bounds.fold(1.0 + beyond(tails), f64::min))
}

/// Returns the greatest cost of a new point: the least sum, over all choices of its old point, of absolute weights
/// times the lattice steps to the weighted points along two directions, one step along each direction costing `costs`.
fn farthest(mask: &Polynomial, d: i32, [u, v]: [LatticePoint; 2], costs: [f64; 2]) -> f64 {
    let determinant = u[0] * v[1] - u[1] * v[0];
    let steps = |[x, y]: LatticePoint| {
        let a = (x * v[1] - y * v[0]) / determinant;
        let b = (u[0] * y - u[1] * x) / determinant;
        costs[0] * f64::from(a.abs()) + costs[1] * f64::from(b.abs())
    };
    let mut rows: std::collections::BTreeMap<LatticePoint, Vec<(LatticePoint, f64)>> =
        std::collections::BTreeMap::new();
    for (k, a) in mask {
        let old = k.map(|x| -x.div_euclid(d));
        rows.entry(k.map(|x| x.rem_euclid(d))).or_default().push((old, *a));
    }
    let nearest = |row: &Vec<(LatticePoint, f64)>| {
        let from = |origin: LatticePoint| {
            let moved = |(old, a): &(LatticePoint, f64)| a.abs() * steps([old[0] - origin[0], old[1] - origin[1]]);
            row.iter().map(moved).sum::<f64>()
        };
        row.iter().map(|(old, _)| from(*old)).fold(f64::INFINITY, f64::min)
    };
    rows.values().map(nearest).fold(0.0, f64::max)
}
