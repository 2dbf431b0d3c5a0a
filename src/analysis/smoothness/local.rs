//! The behaviour around a place that one step maps to itself: eigenvalues of the local matrix, and its left
//! eigenvectors, which are the weights of limit points and tangents.
//!
//! Source: Dyn, Subdivision schemes in CAGD, 1992, section 2.3.

use num_traits::{One, Zero};

use super::matrices::ExactMatrix;
use super::symbol::Symbol;
use crate::math::elimination::left_null_vector;
use crate::math::exact::{Exact, ExactSequence, rounded};
use crate::math::number::Number;
use crate::math::spectrum::{Eigenvalue, eigenvalues};

/// Maximum number of points around a place for which left eigenvectors are computed. The 16-point scheme has 29. Half
/// of it leaves that scheme without its masks; twice of it takes some thirty times as long, because the numbers of the
/// elimination grow.
const MAX_LOCAL_POINTS: i64 = 40;

/// The points around a place that depend only on each other, with the matrix `(a[j - d i])` of one step.
pub(super) struct Neighbourhood<'a> {
    symbol: &'a Symbol,
    first: i64,
    last: i64,
}

impl<'a> Neighbourhood<'a> {
    pub(super) fn new(symbol: &'a Symbol) -> Self {
        Self::within(symbol, [symbol.first, symbol.last()])
    }

    /// Creates the neighbourhood for the reach of the operators, including weights of 0.
    pub(super) fn reached(symbol: &'a Symbol) -> Self {
        Self::within(symbol, symbol.reach)
    }

    fn within(symbol: &'a Symbol, [first, last]: [i64; 2]) -> Self {
        let d = symbol.arity;
        // the fewest points with floor((n + last) / d) <= n before the place, and likewise after it
        let reach = |end: i64| (end - d).div_euclid(d - 1) + 1;
        let from = -reach(last);
        Self { symbol, first: from, last: reach(-first).max(from) }
    }

    /// Returns the eigenvalues of the local matrix, the largest first. Each factor sigma/d of the symbol contributes
    /// one of `1, 1/d, ..., 1/d^(K-1)`; the others are `d^(1-K)` times the eigenvalues of the residual's matrix.
    pub(super) fn eigenvalues(&self) -> Option<Vec<Eigenvalue>> {
        let Symbol { arity, order, residual, .. } = self.symbol;
        let d = f64::whole(*arity);
        let points = usize::try_from(self.last - self.first + 1).ok()?;
        let scales: Vec<f64> = std::iter::successors(Some(1.0), |x| Some(x / d)).take(order + 1).collect();
        let known = scales.iter().take((*order).min(points)).map(|&re| Eigenvalue { re, im: 0.0 });
        let mut found: Vec<Eigenvalue> = known.collect();
        let n = points.saturating_sub(*order);
        if n > 0 {
            let from = self.first + i64::try_from(*order).ok()?;
            let at = |j: i64| usize::try_from(j - self.symbol.first).ok().and_then(|j| residual.get(j));
            let places = || (from..).take(n);
            let cell = |j: i64, i: i64| at(j - arity * i).map_or(0.0, rounded);
            let matrix: Vec<f64> = places().flat_map(|j| places().map(move |i| cell(j, i))).collect();
            let scale = scales[*order] * d;
            found.extend(eigenvalues(&matrix, n)?.iter().map(|x| Eigenvalue { re: x.re * scale, im: x.im * scale }));
        }
        found.sort_by(|a, b| b.modulus().total_cmp(&a.modulus()));
        Some(found)
    }

    /// Returns the index of the first point.
    pub(super) fn first(&self) -> i64 {
        self.first
    }

    /// Returns the matrix of one step: row j has the weights of new point j.
    pub(super) fn matrix(&self) -> ExactMatrix {
        let places = || self.first..=self.last;
        places().map(|j| places().map(|i| self.symbol.at(j - self.symbol.arity * i)).collect()).collect()
    }

    /// Returns a left eigenvector for an eigenvalue, with any scale, if there is one.
    fn left_eigenvector(&self, eigenvalue: &Exact) -> Option<Vec<Exact>> {
        if self.last - self.first >= MAX_LOCAL_POINTS {
            return None;
        }
        let cell = |j: i64, i: i64| {
            let entry = self.symbol.at(j - self.symbol.arity * i);
            if i == j { entry - eigenvalue } else { entry }
        };
        let matrix: ExactMatrix =
            (self.first..=self.last).map(|j| (self.first..=self.last).map(|i| cell(j, i)).collect()).collect();
        left_null_vector(&matrix)
    }

    /// Returns the weights of the limit point at the place: the left eigenvector for 1, scaled to the sum 1.
    pub(super) fn limit_mask(&self) -> Option<ExactSequence> {
        let vector = self.left_eigenvector(&Exact::one())?;
        let sum: Exact = vector.iter().sum();
        self.weights(&vector, &sum)
    }

    /// Returns the weights of the tangent per unit of the parameter: the left eigenvector for 1/d, scaled to the value
    /// 1 for points whose values are their indices.
    pub(super) fn tangent_mask(&self) -> Option<ExactSequence> {
        let vector = self.left_eigenvector(&Exact::ratio(1, self.symbol.arity))?;
        let slope: Exact = (self.first..).zip(&vector).map(|(i, t)| Exact::whole(i) * t).sum();
        self.weights(&vector, &slope)
    }

    fn weights(&self, vector: &[Exact], over: &Exact) -> Option<ExactSequence> {
        if over.is_zero() {
            return None;
        }
        let from = vector.iter().position(|x| !x.is_zero())?;
        let to = vector.iter().rposition(|x| !x.is_zero())?;
        let values = vector[from..=to].iter().map(|x| x / over).collect();
        Some(ExactSequence { first: self.first + i64::try_from(from).ok()?, values })
    }
}
