//! Proofs that limits of regular nets are C^k, by norms of difference schemes, and bounds that follow from them.
//!
//! With a scheme c whose symbol has factors in two directions u, v that span the lattice, the differences along u are
//! refined by `c / sigma_u`. Where some powers of both such schemes are contractions, c converges. The derivatives
//! `d^k c / (sigma_u^i sigma_v^(k-i))` that converge for all i prove C^k.
//!
//! Source: Dyn and Levin, Acta Numerica 11 (2002), section 4.3; Cavaretta, Dahmen and Micchelli, Memoirs of the AMS 453
//! (1991), chapter 8.

use super::iterated::Iterated;
use super::regular::{Polynomial, RegularMask, divided};
use super::sectors::Point;

/// Most steps of a difference scheme whose norm is looked at.
/// Butterfly needs two, Kobbelt's scheme three; with six bounds of basic limit functions are sharp enough to follow
/// their characteristic maps. Half of it proves less near the ends of ranges; twice of it takes masks of a million
/// entries.
const MAX_STEPS: usize = 6;
/// Largest k that is looked for.
/// Schemes that are no products and no splines are C^2 at best. Half of it would miss that, twice of it only takes
/// time.
const MAX_ORDER: usize = 3;

/// A proof that limits are C^k: the norms of the difference schemes along two directions, one pair for each derivative.
#[derive(Debug, Clone, PartialEq)]
pub struct LatticeCertificate {
    /// The order k.
    pub k: usize,
    /// Most steps L of a difference scheme that were needed.
    pub l: u32,
    /// The largest of the norms after the steps that they needed, below 1.
    pub norm: f64,
}

/// Norms of the powers 0, 1, ... of a difference scheme, the last of them below 1.
#[derive(Debug, Clone)]
struct Contraction {
    norms: Vec<f64>,
}

/// The certificates for k = 0, 1, ..., as far as there are any.
pub(super) fn certificates(regular: &RegularMask) -> Vec<LatticeCertificate> {
    (0..=MAX_ORDER).map_while(|k| certificate(regular, k)).collect()
}

fn certificate(regular: &RegularMask, k: usize) -> Option<LatticeCertificate> {
    let order = |i: usize| u32::try_from(i).unwrap_or(u32::MAX);
    let mut best: Option<LatticeCertificate> = None;
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
                best = Some(LatticeCertificate { k, l, norm });
            }
        }
    }
    best
}

/// Pairs of directions that span the lattice.
fn spanning() -> impl Iterator<Item = [usize; 2]> {
    let spans = |[i, k]: &[usize; 2]| {
        let ([a, b], [c, d]) = (RegularMask::DIRECTIONS[*i], RegularMask::DIRECTIONS[*k]);
        (a * d - b * c).abs() == 1
    };
    (0..4).flat_map(|i| (i + 1..4).map(move |k| [i, k])).filter(spans)
}

/// The mask of a derivative, which refines the differences `p[c + u] - p[c]` times the density of points: for each of
/// the directions, so often, `d z^((d-1) u) / sigma_u` times the mask.
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

/// The steps and the norm that prove a derivative to converge.
fn converges(regular: &RegularMask, along: &[(usize, u32)]) -> Option<(u32, f64)> {
    let mask = derivative(regular, along)?;
    let [first, second] = contractions(&mask, regular.arity)?.map(|(_, contraction)| contraction);
    let steps = first.norms.len().max(second.norms.len()) - 1;
    let last = |contraction: &Contraction| contraction.norms.last().copied().unwrap_or(1.0);
    Some((u32::try_from(steps).unwrap_or(0), last(&first).max(last(&second))))
}

/// Two directions that span the lattice along which differences contract.
fn contractions(mask: &Polynomial, d: i32) -> Option<[(Point, Contraction); 2]> {
    let found: Vec<Option<Contraction>> =
        RegularMask::DIRECTIONS.iter().map(|&w| contraction(&divided(mask, w, d)?, d)).collect();
    let pair = spanning().find(|[i, k]| found[*i].is_some() && found[*k].is_some())?;
    let [a, b] = pair.map(|i| found[i].clone().map(|contraction| (RegularMask::DIRECTIONS[i], contraction)));
    Some([a?, b?])
}

/// The norms of powers of a scheme until one is below 1.
fn contraction(mask: &Polynomial, d: i32) -> Option<Contraction> {
    let mut norms = vec![1.0];
    for norm in Iterated::new(mask, d).take(MAX_STEPS) {
        norms.push(norm);
        if norm < 1.0 {
            return Some(Contraction { norms });
        }
    }
    None
}

/// A bound of the sum of sizes of all basic limit functions of a scheme at any place: 1 where no weight is below 0.
///
/// After each number of steps points are at most as large as the norm of these steps. From there on a point moves, from
/// level to level, by at most the sum of sizes of weights times steps from its old point to the next
/// one, times the differences along these steps; differences of data of size 1 are 2 at most, and shrink as the
/// contractions say; the least bound of all numbers of steps counts.
pub(super) fn lebesgue_bound(mask: &Polynomial, d: i32) -> Option<f64> {
    if mask.values().all(|&a| a >= -1e-15) {
        return Some(1.0 + 1e-12);
    }
    let pair = contractions(mask, d)?;
    let tail = |contraction: &Contraction| {
        let (last, before) = contraction.norms.split_last()?;
        Some(before.iter().sum::<f64>() / (1.0 - last))
    };
    let tails = [tail(&pair[0].1)?, tail(&pair[1].1)?];
    let directions = [pair[0].0, pair[1].0];
    let beyond = |costs: [f64; 2]| 2.0 * farthest(mask, d, directions, costs);
    let (first, second) = (divided(mask, directions[0], d)?, divided(mask, directions[1], d)?);
    let differences = Iterated::new(&first, d).zip(Iterated::new(&second, d));
    // how far points move after some steps, beside how large they are then
    let after = Iterated::new(mask, d).zip(differences).take(MAX_STEPS);
    let bounds = after.map(|(norm, (a, b))| norm + beyond([tails[0] * a, tails[1] * b]));
    Some(bounds.fold(1.0 + beyond(tails), f64::min))
}

/// The greatest sum of sizes of weights of a new point, each times the steps along two directions from its old point to
/// the nearest one, a step along each of them counting as much as `costs` says.
fn farthest(mask: &Polynomial, d: i32, [u, v]: [Point; 2], costs: [f64; 2]) -> f64 {
    let determinant = u[0] * v[1] - u[1] * v[0];
    let steps = |[x, y]: Point| {
        let a = (x * v[1] - y * v[0]) / determinant;
        let b = (u[0] * y - u[1] * x) / determinant;
        costs[0] * f64::from(a.abs()) + costs[1] * f64::from(b.abs())
    };
    let mut rows: std::collections::BTreeMap<Point, Vec<(Point, f64)>> = std::collections::BTreeMap::new();
    for (k, a) in mask {
        let old = k.map(|x| -x.div_euclid(d));
        rows.entry(k.map(|x| x.rem_euclid(d))).or_default().push((old, *a));
    }
    let nearest = |row: &Vec<(Point, f64)>| {
        let from = |origin: Point| {
            let moved = |(old, a): &(Point, f64)| a.abs() * steps([old[0] - origin[0], old[1] - origin[1]]);
            row.iter().map(moved).sum::<f64>()
        };
        row.iter().map(|(old, _)| from(*old)).fold(f64::INFINITY, f64::min)
    };
    rows.values().map(nearest).fold(0.0, f64::max)
}
