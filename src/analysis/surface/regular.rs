//! The mask of a scheme on regular nets, and its factors.
//!
//! In lattice coordinates the new point f is the sum over old points c of `a[f - d c] p[c]`; the symbol is `a(z) = sum
//! a[k] z^k = d^2 product of (sigma_u / d)^m_u b(z)` over directions u, with `sigma_u = 1 + z^u + ... + z^((d-1) u)`.
//! If the residual b is one term, the limit is a box spline.
//!
//! Source: de Boor, Hollig and Riemenschneider, Box Splines (1993), chapters I and VII; Dyn and Levin, Acta Numerica 11
//! (2002), section 4.

use std::collections::BTreeMap;

use super::local::Applied;
use super::sectors::{LatticePoint, NetKind};
use crate::analysis::limit::Unlimited;
use crate::math::mask::Mask;
use crate::watch::Watch;

/// Largest remainder of a division of a mask that is regarded as rounding, for weights of about 1: some thousand
/// roundings. Half of it misses factors of long masks; twice of it finds factors in masks that are twice as far from
/// having them.
const FACTOR_REMAINDER: f64 = 1e-12;
/// Largest absolute weight that is regarded as 0, five roundings of 1: terms that cancel leave one or two. Half of it
/// may keep what some cancellations leave; twice of it drops weights of up to 2e-15.
pub(super) const ZERO_WEIGHT: f64 = 1e-15;
/// A Laurent polynomial in two variables, by exponents.
pub(super) type Polynomial = BTreeMap<LatticePoint, f64>;

/// The rule of a regular net.
#[derive(Debug, Clone, PartialEq)]
pub struct RegularMask {
    /// The kind of the faces and of the centre.
    pub kind: NetKind,
    /// The number of pieces of an edge.
    pub arity: i32,
    /// The mask a, without zeros.
    pub mask: BTreeMap<[i32; 2], f64>,
    /// The number of factors in each of [`Self::DIRECTIONS`].
    pub factors: [u32; 4],
    /// The residual b, whose entries sum to 1.
    pub residual: BTreeMap<[i32; 2], f64>,
}

impl RegularMask {
    /// The directions in which factors are divided out: the sides of quads and triangles, and both diagonals.
    pub const DIRECTIONS: [[i32; 2]; 4] = [[1, 0], [0, 1], [1, 1], [1, -1]];

    /// Reads the mask off the rows around a regular vertex, or face.
    pub(super) fn of(applied: &Applied, watch: &Watch) -> Result<Self, Unlimited> {
        let (kind, d) = (applied.kind, applied.arity);
        // the points of sector 0 up to this radius include one period
        let radius = if kind == NetKind::Triangles { 2 * d - 1 } else { d };
        let local = applied.wide_enough(kind.regular(), radius, watch)?.ok_or(Unlimited::Unsettled)?;
        let from = i32::from(kind.has_centre());
        let period = |[x, y]: &LatticePoint| (from..from + d).contains(x) && (0..d).contains(y);
        let mut mask = Polynomial::new();
        for ([x, y], row) in local.rows.iter().filter(|(point, _)| period(point)) {
            for (place, weight) in row {
                let [i, j] = place.map_or([0, 0], |(sector, p)| kind.rotated(p, i32::try_from(sector).unwrap_or(0)));
                *mask.entry([x - d * i, y - d * j]).or_insert(0.0) += weight;
            }
        }
        mask.retain(|_, weight| weight.abs() > ZERO_WEIGHT);
        let size = f64::from(d);
        let mut residual: Polynomial = mask.iter().map(|(&k, &a)| (k, a / (size * size))).collect();
        let mut factors = [0; 4];
        for (factor, &direction) in factors.iter_mut().zip(&Self::DIRECTIONS) {
            while let Some(quotient) = divided(&residual, direction, d) {
                residual = quotient.into_iter().map(|(k, b)| (k, b * size)).collect();
                *factor += 1;
            }
        }
        Ok(Self { kind, arity: d, mask, factors, residual })
    }

    /// Returns whether the limit is a box spline.
    pub fn is_box_spline(&self) -> bool {
        self.residual.len() == 1 && (self.factors[2] == 0 || self.factors[3] == 0)
    }

    /// Returns the largest k for which a box spline is C^k: two less than the least number of directions without which
    /// the others do not span the plane.
    pub fn spline_smoothness(&self) -> Option<i64> {
        let all: u32 = self.factors.iter().sum();
        let most = self.factors.iter().max().copied().unwrap_or(0);
        self.is_box_spline().then(|| i64::from(all - most) - 2)
    }

    /// Returns the masks of the curve schemes for points that are constant along y, and along x.
    pub fn curves(&self) -> Option<[Mask; 2]> {
        let d = f64::from(self.arity);
        let curve = |axis: usize| {
            let (first, last) = (self.mask.keys().map(|k| k[axis]).min()?, self.mask.keys().map(|k| k[axis]).max()?);
            let sum = |x: i32| self.mask.iter().filter(|(k, _)| k[axis] == x).map(|(_, a)| a).sum::<f64>() / d;
            Mask::new(first, &(first..=last).map(sum).collect::<Vec<_>>())
        };
        Some([curve(0)?, curve(1)?])
    }

    /// Returns the masks of two curve schemes whose tensor product the rule is, if it is one.
    pub fn tensor(&self) -> Option<[Mask; 2]> {
        let curves = self.curves()?;
        let [a, b] = &curves;
        let at = |mask: &Mask, x: i32| usize::try_from(x - mask.first).ok().and_then(|at| mask.values.get(at).copied());
        let all = (a.first..=a.last()).flat_map(|x| (b.first..=b.last()).map(move |y| [x, y]));
        let product = |[x, y]: [i32; 2]| at(a, x).unwrap_or(0.0) * at(b, y).unwrap_or(0.0);
        let fits = |k: [i32; 2]| (self.mask.get(&k).copied().unwrap_or(0.0) - product(k)).abs() <= FACTOR_REMAINDER;
        let inside = |[x, y]: &LatticePoint| (a.first..=a.last()).contains(x) && (b.first..=b.last()).contains(y);
        (self.mask.keys().all(inside) && all.into_iter().all(fits)).then_some(curves)
    }

    /// Returns the least and the greatest exponent in x, y and x + y: the ends of the support of the basic limit
    /// function, times d - 1.
    pub(super) fn ends(mask: &Polynomial) -> [[i32; 2]; 3] {
        let value = |k: &LatticePoint| [k[0], k[1], k[0] + k[1]];
        let mut ends = [[i32::MAX, i32::MIN]; 3];
        for k in mask.keys() {
            for (end, x) in ends.iter_mut().zip(value(k)) {
                *end = [end[0].min(x), end[1].max(x)];
            }
        }
        ends
    }
}

/// Returns the quotient by `1 + z^u + ... + z^((d-1) u)` if there is no remainder.
pub(super) fn divided(c: &Polynomial, [u, v]: LatticePoint, d: i32) -> Option<Polynomial> {
    let mut quotient = Polynomial::new();
    let mut rest = c.clone();
    let size: f64 = c.values().map(|x| x.abs()).sum();
    // along each line in the direction u the first remaining term is a term of the quotient; x increases along all
    // directions but one, along which y does
    let ahead = |[x, y]: &LatticePoint| x * u.signum() * 4096 + y * v.signum();
    let mut order: Vec<LatticePoint> = rest.keys().copied().collect();
    order.sort_by_key(ahead);
    let last = |rest: &Polynomial| rest.values().all(|x| x.abs() <= FACTOR_REMAINDER * size);
    let extent = order.last().map_or(0, ahead) - order.first().map_or(0, ahead);
    debug_assert!(extent >= 0, "sorted");
    let mut queue: std::collections::BTreeSet<_> = order.iter().map(|k| (ahead(k), *k)).collect();
    let end: [i32; 2] = [0, 1].map(|axis| c.keys().map(|k| k[axis]).max().unwrap_or(0));
    let start: [i32; 2] = [0, 1].map(|axis| c.keys().map(|k| k[axis]).min().unwrap_or(0));
    while let Some((_, k)) = queue.pop_first() {
        let x = rest.get(&k).copied().unwrap_or(0.0);
        if x.abs() <= FACTOR_REMAINDER * size {
            continue;
        }
        // the last term of the factor would lie beyond the mask
        let far = [k[0] + (d - 1) * u, k[1] + (d - 1) * v];
        if (0..2).any(|axis| far[axis] < start[axis] || far[axis] > end[axis]) {
            return None;
        }
        quotient.insert(k, x);
        for step in 0..d {
            let at = [k[0] + step * u, k[1] + step * v];
            *rest.entry(at).or_insert(0.0) -= x;
            if step > 0 {
                queue.insert((ahead(&at), at));
            }
        }
    }
    (last(&rest) && !quotient.is_empty()).then_some(quotient)
}
