//! Lower and upper bounds of the factor by which patches stretch distances.

use super::bezier::{BezierNet, restriction};
use super::join::SectorPatch;
use crate::math::functions::{real, sqrt};
use crate::math::vector::{complex_product, dot, minus, plus, times};

/// An interval of each of the two parameters.
pub(super) type Area = [[f64; 2]; 2];

/// Weights that map the coefficients over the unit square to those over some area, in both parameters.
pub(super) type StretchWeights = [[[f64; 6]; 6]; 2];

/// Returns the weights of an area.
pub(super) fn weights(area: Area) -> StretchWeights {
    area.map(restriction::<6>)
}

/// The derivatives of a patch by both parameters, in degree 5.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slopes<const D: usize>([SectorPatch<D>; 2]);

impl<const D: usize> Slopes<D> {
    /// Returns the derivatives over the unit square.
    pub(super) fn of(patch: &SectorPatch<D>) -> Self {
        Self([by_first(patch), by_first(&patch.transposed()).transposed()])
    }

    /// Returns the derivatives with their coefficients over an area.
    pub(super) fn over(&self, [along, across]: &StretchWeights) -> Self {
        Self(self.0.map(|net| net.mapped(along, across)))
    }

    /// Returns pairs of coefficients: of the derivative by the first parameter and by the second.
    fn pairs(&self) -> impl Iterator<Item = ([f64; D], [f64; D])> {
        let [by_u, by_v] = &self.0;
        by_u.0.iter().flatten().copied().zip(by_v.0.iter().flatten().copied())
    }

    /// Returns an upper bound of the ratio of distances of points to distances of their parameters in the area: the
    /// greatest Frobenius norm of the derivative at any coefficient, which is convex and thus a bound between them.
    pub(super) fn most(&self) -> f64 {
        sqrt(self.pairs().map(|(u, v)| dot(u, u) + dot(v, v)).fold(0.0, f64::max))
    }
}

impl Slopes<2> {
    /// A number s such that the images of any two parameters of the area are at least s times as far apart as they are:
    /// the least eigenvalue of the symmetric part of the derivative, turned by a complex number of length 1, at any
    /// coefficient. It is concave, so that coefficients bound it between them, and on a convex area it bounds the
    /// quotient: `(a - b) (X(a) - X(b)) = integral of (a - b) DX (a - b)`.
    pub(super) fn least(&self, turn: [f64; 2]) -> f64 {
        let eigenvalue = |(u, v)| {
            let [u, v] = [u, v].map(|slope| complex_product(turn, slope));
            let (sum, difference, off) = (u[0] + v[1], u[0] - v[1], v[0] + u[1]);
            (sum - sqrt(difference * difference + off * off)) / 2.0
        };
        self.pairs().map(eigenvalue).fold(f64::INFINITY, f64::min)
    }

    /// Returns the bound of [`Self::least`] for the rotation that makes the derivative in the middle symmetric.
    pub(super) fn least_straightened(&self) -> f64 {
        let middle = [0.5; 2];
        let [u, v] = self.0.map(|net| net.at(middle));
        let turn = [u[0] + v[1], v[0] - u[1]];
        let long = sqrt(dot(turn, turn));
        if long > 0.0 { self.least(turn.map(|x| x / long)) } else { 0.0 }
    }
}

/// Returns the derivative by the first parameter, in degree 5.
fn by_first<const D: usize>(net: &SectorPatch<D>) -> SectorPatch<D> {
    let step = |i: usize, j: usize| minus(net.0[i + 1][j], net.0[i][j]);
    BezierNet(std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            // derivative of degree 4, elevated: coefficient i is i/5 of the previous one plus the rest of its own
            let before = if i > 0 { times(real(i), step(i - 1, j)) } else { [0.0; D] };
            let own = if i < 5 { times(real(5 - i), step(i, j)) } else { [0.0; D] };
            plus(before, own)
        })
    }))
}
