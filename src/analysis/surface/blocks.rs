//! The block decomposition of the local subdivision matrix by rotations and by the reflection about a ray.
//!
//! Values `v(s, p) = exp(2 pi i k (s + t_p) / n) u_p`, with the angle `t_p` of the point p as a fraction of a sector,
//! are mapped to values of the same form with the same index k. The reflection replaces `u_p` by `conj(u)` of the
//! mirrored point. With `u_p = c_p` on the axis and `u_p = c + i d`, `u_q = c - i d` for two mirror images, the matrix
//! is therefore real.
//!
//! Source: Ball and Storry, ACM Transactions on Graphics 7 (1988), 83-102; Peters and Reif, Subdivision Surfaces
//! (2008), section 5.

use super::local::{LocalRows, PlacedWeight};
use super::sectors::{LatticePoint, NetKind};
use crate::math::dense::Dense;
use crate::math::functions::{cos, real, sin};
use crate::math::vector::{Complex, complex_product};

/// Largest imaginary part that is regarded as rounding, for weights of about 1: ten thousand roundings. Schemes without
/// the symmetry have imaginary parts of about 1. Half or twice of it decides alike.
const ASYMMETRY: f64 = 1e-12;

/// One component of the real vectors of a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Component {
    /// The value of the centre.
    Centre,
    /// The value of a point on the axis.
    OnAxis(LatticePoint),
    /// The real part of the value of the first of two mirror images.
    Even(LatticePoint, LatticePoint),
    /// The imaginary part of the value of the first of two mirror images.
    Odd(LatticePoint, LatticePoint),
}

/// The block of one Fourier index.
#[derive(Debug, Clone)]
pub(super) struct FourierBlock {
    /// The components of the vectors of the block.
    pub(super) components: Vec<Component>,
    /// The matrix of the block.
    pub(super) matrix: Dense,
}

/// Returns `exp(2 pi i turn / n)`.
pub(super) fn phase(turn: f64, n: usize) -> Complex {
    let angle = std::f64::consts::TAU * turn / real(n);
    [cos(angle), sin(angle)]
}

/// Returns the components of the vectors of the block of an index, for the points up to a radius.
pub(super) fn components(kind: NetKind, radius: i32, index: usize) -> Vec<Component> {
    let mut found = Vec::new();
    if kind.has_centre() && index == 0 {
        found.push(Component::Centre);
    }
    for p in kind.points(radius) {
        let q = kind.mirrored(p);
        match p.cmp(&q) {
            std::cmp::Ordering::Equal => found.push(Component::OnAxis(p)),
            std::cmp::Ordering::Less => found.extend([Component::Even(p, q), Component::Odd(p, q)]),
            std::cmp::Ordering::Greater => {}
        }
    }
    found
}

/// Complex weights of the points of sector 0, and the weight of the centre.
struct SectorFunctional {
    points: Vec<(LatticePoint, Complex)>,
    centre: f64,
}

impl SectorFunctional {
    /// Converts the weights `w(s, q)` of the row of a point p to weights of `u_q`.
    fn of(kind: NetKind, n: usize, index: usize, point: Option<LatticePoint>, row: &[PlacedWeight]) -> Self {
        let from = point.map_or(0.0, |p| kind.turn(p));
        let mut functional = Self { points: Vec::new(), centre: 0.0 };
        for &(place, weight) in row {
            let Some((sector, q)) = place else {
                functional.centre += weight;
                continue;
            };
            let turn = real(index) * (real(sector) + kind.turn(q) - from);
            let [re, im] = phase(turn % real(n), n).map(|x| x * weight);
            match functional.points.iter_mut().find(|(other, _)| *other == q) {
                Some((_, sum)) => *sum = [sum[0] + re, sum[1] + im],
                None => functional.points.push((q, [re, im])),
            }
        }
        functional
    }

    fn at(&self, point: LatticePoint) -> Complex {
        self.points.iter().find(|(p, _)| *p == point).map_or([0.0; 2], |(_, weight)| *weight)
    }

    /// Returns `a f + b g`.
    fn mixed(a: Complex, f: &Self, b: Complex, g: &Self) -> Self {
        let points = f.points.iter().chain(&g.points).map(|(p, _)| *p).collect::<std::collections::BTreeSet<_>>();
        let weight = |p: LatticePoint| {
            let (x, y) = (complex_product(a, f.at(p)), complex_product(b, g.at(p)));
            [x[0] + y[0], x[1] + y[1]]
        };
        let points = points.into_iter().map(|p| (p, weight(p))).collect();
        Self { points, centre: a[0] * f.centre + b[0] * g.centre }
    }

    /// Returns the real weights of the components, and the largest absolute value of an imaginary part.
    fn read(&self, components: &[Component]) -> (Vec<f64>, f64) {
        let mut left = 0.0_f64;
        let mut real_part = |[re, im]: Complex| {
            left = left.max(im.abs());
            re
        };
        let weight = |component: &Component| match *component {
            Component::Centre => self.centre,
            Component::OnAxis(p) => real_part(self.at(p)),
            Component::Even(p, q) => {
                let (x, y) = (self.at(p), self.at(q));
                real_part([x[0] + y[0], x[1] + y[1]])
            }
            Component::Odd(p, q) => {
                let (x, y) = (self.at(p), self.at(q));
                real_part([y[1] - x[1], x[0] - y[0]])
            }
        };
        (components.iter().map(weight).collect(), left)
    }
}

/// Returns the weights of the components `of` a block in one component of the child; `None` if the rows lack the
/// reflection symmetry.
pub(super) fn row(
    kind: NetKind,
    n: usize,
    index: usize,
    local: &LocalRows,
    component: Component,
    of: &[Component],
) -> Option<Vec<f64>> {
    let functional = |p: LatticePoint| SectorFunctional::of(kind, n, index, Some(p), &local.rows[&p]);
    let found = match component {
        Component::Centre => SectorFunctional::of(kind, n, index, None, &local.centre),
        Component::OnAxis(p) => functional(p),
        Component::Even(p, q) => SectorFunctional::mixed([0.5, 0.0], &functional(p), [0.5, 0.0], &functional(q)),
        // the difference divided by 2 i
        Component::Odd(p, q) => SectorFunctional::mixed([0.0, -0.5], &functional(p), [0.0, 0.5], &functional(q)),
    };
    let (weights, left) = found.read(of);
    (left <= ASYMMETRY).then_some(weights)
}

impl FourierBlock {
    /// Returns the block of an index for the points up to a radius, which must not depend on points beyond it; `None`
    /// if the rows lack the reflection symmetry.
    pub(super) fn of(kind: NetKind, n: usize, index: usize, radius: i32, local: &LocalRows) -> Option<Self> {
        let components = components(kind, radius, index);
        let mut matrix = Dense::zero(components.len());
        for (i, &component) in components.iter().enumerate() {
            let weights = row(kind, n, index, local, component, &components)?;
            weights.iter().enumerate().for_each(|(j, &weight)| *matrix.at_mut(i, j) = weight);
        }
        Some(Self { components, matrix })
    }

    /// Returns the value `u_p` of each point for a vector of the block.
    pub(super) fn values(components: &[Component], vector: &[f64]) -> Vec<(LatticePoint, Complex)> {
        let mut found: Vec<(LatticePoint, Complex)> = Vec::new();
        for (component, &x) in components.iter().zip(vector) {
            match *component {
                Component::Centre => {}
                Component::OnAxis(p) => found.push((p, [x, 0.0])),
                Component::Even(p, q) => found.extend([(p, [x, 0.0]), (q, [x, 0.0])]),
                // the even component of the same pair comes immediately before
                Component::Odd(p, q) => {
                    let parts = found.iter_mut().rev().take(2);
                    parts.for_each(|(at, u)| u[1] = if *at == p { x } else { -x });
                    debug_assert_ne!(p, q, "points on the axis have no odd part");
                }
            }
        }
        found
    }
}
