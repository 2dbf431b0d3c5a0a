//! B-spline curves and surfaces with clamped ends and single inner knots.

use super::net::BicubicNet;
use crate::math::functions::real;
use crate::math::vector::{Vector, plus, times};

/// Maximum degree of a surface.
const MAX_SURFACE_DEGREE: usize = 5;

/// A B-spline curve.
#[derive(Debug, Clone, PartialEq)]
pub struct BSplineCurve {
    /// The degree.
    pub degree: usize,
    /// Its knots, ascending: the first and the last have multiplicity `degree + 1`, the others 1.
    pub knots: Vec<f64>,
    /// Control points, `knots.len() + degree - 1` of them, in model units.
    pub points: Vec<Vector>,
}

/// A tensor-product B-spline surface over `0..spans[0] x 0..spans[1]`, with a knot at each whole number.
#[derive(Debug, Clone, PartialEq)]
pub struct BSplineSurface {
    /// The degree in both directions.
    pub degree: usize,
    /// Number of pieces along u and v.
    pub spans: [usize; 2],
    /// Control points, `points[i][j]`, `i` along u, `j` along v; `spans + degree` in each direction.
    pub points: Vec<Vec<Vector>>,
}

fn between(t: f64, a: Vector, b: Vector) -> Vector {
    plus(times(1.0 - t, a), times(t, b))
}

impl BSplineCurve {
    /// Returns all knots with their multiplicities.
    fn full(&self) -> Vec<f64> {
        let (first, last) = (self.knots[0], self.knots[self.knots.len() - 1]);
        let ends = |knot| std::iter::repeat_n(knot, self.degree);
        ends(first).chain(self.knots.iter().copied()).chain(ends(last)).collect()
    }

    /// Returns the polar form of the piece between full knots `span` and `span + 1` at `degree` arguments.
    fn polar(&self, full: &[f64], span: usize, at: &[f64]) -> Vector {
        let d = self.degree;
        let mut points: Vec<Vector> = self.points[span - d..=span].to_vec();
        for (r, &t) in at.iter().enumerate() {
            for i in 0..d - r {
                let (low, high) = (full[span - d + 1 + i + r], full[span + 1 + i]);
                points[i] = between((t - low) / (high - low), points[i], points[i + 1]);
            }
        }
        points[0]
    }

    /// Returns the point at the middle of the parameter range.
    pub(super) fn middle(&self) -> Vector {
        let middle = 0.5 * (self.knots[0] + self.knots[self.knots.len() - 1]);
        let full = self.full();
        let span = full.partition_point(|&knot| knot <= middle) - 1;
        self.polar(&full, span, &vec![middle; self.degree])
    }

    /// Returns the exact piece over `[s, e]`: its control points are polar values at its own knots.
    #[must_use]
    pub(super) fn piece(&self, [s, e]: [f64; 2]) -> Self {
        let inner = self.knots.iter().copied().filter(|&knot| s < knot && knot < e);
        let knots: Vec<f64> = std::iter::once(s).chain(inner).chain([e]).collect();
        let mut piece = Self { degree: self.degree, knots, points: Vec::new() };
        if piece.knots == self.knots {
            return self.clone();
        }
        let (full, own) = (self.full(), piece.full());
        let n = piece.knots.len() + self.degree - 1;
        let points = (0..n).map(|i| {
            let at = &own[i + 1..=i + self.degree];
            let mut spans = (i..=i + self.degree).filter(|&j| own[j] < own[j + 1]);
            let middle = spans.next().map_or(s, |j| 0.5 * (own[j] + own[j + 1]));
            let span = full.partition_point(|&knot| knot <= middle) - 1;
            self.polar(&full, span, at)
        });
        piece.points = points.collect();
        piece
    }
}

impl BSplineSurface {
    /// Returns the Bezier surface of some control points.
    pub(super) fn bezier<const N: usize>(points: &[[Vector; N]; N]) -> Self {
        Self { degree: N - 1, spans: [1, 1], points: points.iter().map(|row| row.to_vec()).collect() }
    }

    /// Returns the surface of a uniform bicubic B-spline with the control points `net`, `spans + 3` in each direction.
    pub(super) fn of_uniform(net: &[Vec<Vector>]) -> Self {
        let rows: Vec<Vec<Vector>> = net.iter().map(|row| clamped(row)).collect();
        let spans = [rows.len() - 3, rows.first().map_or(0, Vec::len) - 3];
        let columns: Vec<Vec<Vector>> =
            (0..spans[1] + 3).map(|j| clamped(&rows.iter().map(|row| row[j]).collect::<Vec<_>>())).collect();
        let points = (0..spans[0] + 3).map(|i| columns.iter().map(|column| column[i]).collect()).collect();
        Self { degree: 3, spans, points }
    }

    /// Returns the surface with u and v exchanged, which is seen from its other side.
    #[must_use]
    pub(super) fn transposed(&self) -> Self {
        let n = self.spans[1] + self.degree;
        let points = (0..n).map(|j| self.points.iter().map(|row| row[j]).collect()).collect();
        Self { degree: self.degree, spans: [self.spans[1], self.spans[0]], points }
    }

    /// Returns the knots along u or v.
    pub fn knots(&self, direction: usize) -> Vec<f64> {
        (0..=self.spans[direction]).map(real).collect()
    }

    /// Returns a boundary curve; counter-clockwise: v = 0, u at its end, v at its end backwards, u = 0 backwards.
    pub(super) fn side(&self, side: usize) -> BSplineCurve {
        let column = |j: usize| self.points.iter().map(|row| row[j]).collect::<Vec<_>>();
        let (last, n) = (self.points.len() - 1, self.spans[1] + self.degree - 1);
        let mut points = match side {
            0 => column(0),
            1 => self.points[last].clone(),
            2 => column(n),
            _ => self.points[0].clone(),
        };
        if side > 1 {
            points.reverse();
        }
        BSplineCurve { degree: self.degree, knots: self.knots(side % 2), points }
    }

    /// Returns the length of the parameter range along a side.
    pub(super) fn length(&self, side: usize) -> f64 {
        real(self.spans[side % 2])
    }

    /// Returns the parameters of a point of a side.
    pub(super) fn on_side(&self, side: usize, t: f64) -> [f64; 2] {
        let [u, v] = [self.length(0), self.length(1)];
        match side {
            0 => [t, 0.0],
            1 => [u, t],
            2 => [u - t, v],
            _ => [0.0, v - t],
        }
    }

    /// Returns the point at some parameters, with the derivatives along u and v.
    pub(super) fn at(&self, [u, v]: [f64; 2]) -> [Vector; 3] {
        let ((i, bu), (j, bv)) = (self.basis(0, u), self.basis(1, v));
        let mut found = [[0.0; 3]; 3];
        for (a, row) in self.points[i..=i + self.degree].iter().enumerate() {
            for (b, &point) in row[j..=j + self.degree].iter().enumerate() {
                let weights = [bu[0][a] * bv[0][b], bu[1][a] * bv[0][b], bu[0][a] * bv[1][b]];
                for (sum, weight) in found.iter_mut().zip(weights) {
                    *sum = plus(*sum, times(weight, point));
                }
            }
        }
        found
    }

    /// Returns the first control point with an influence at a parameter, and the basis functions with their
    /// derivatives.
    fn basis(&self, direction: usize, t: f64) -> (usize, [[f64; MAX_SURFACE_DEGREE + 1]; 2]) {
        let (spans, d) = (self.spans[direction], self.degree);
        let span = (1..spans).take_while(|&knot| t >= real(knot)).count();
        // knots are whole numbers between 0 and the number of pieces
        let knot = |i: usize| real((span + i).saturating_sub(d).min(spans));
        let mut values = [0.0; MAX_SURFACE_DEGREE + 1];
        let mut lower = values;
        values[0] = 1.0;
        for degree in 1..=d {
            lower = values;
            values = [0.0; MAX_SURFACE_DEGREE + 1];
            for r in 0..degree {
                let (left, right) = (knot(d + 1 + r - degree), knot(d + 1 + r));
                let share = lower[r] / (right - left);
                values[r] += (right - t) * share;
                values[r + 1] += (t - left) * share;
            }
        }
        let mut slopes = [0.0; MAX_SURFACE_DEGREE + 1];
        for r in 0..d {
            let slope = real(d) * lower[r] / (knot(d + 1 + r - d) - knot(d + 1 + r)).abs();
            slopes[r] -= slope;
            slopes[r + 1] += slope;
        }
        (span, [values, slopes])
    }
}

/// Returns the control points of a uniform cubic B-spline with clamped ends.
fn clamped(points: &[Vector]) -> Vec<Vector> {
    let n = points.len();
    let end = |a: Vector, b: Vector, c: Vector| {
        [times(1.0 / 6.0, plus(plus(a, times(4.0, b)), c)), times(1.0 / 3.0, plus(times(2.0, b), c))]
    };
    let [first, second] = end(points[0], points[1], points[2]);
    let [last, before] = end(points[n - 1], points[n - 2], points[n - 3]);
    let inner = &points[2..n - 2];
    [first, second].into_iter().chain(inner.iter().copied()).chain([before, last]).collect()
}

/// Returns the Bezier surface of a cell.
pub(super) fn of_cell(net: &BicubicNet) -> BSplineSurface {
    BSplineSurface::bezier(&super::net::bezier(net))
}
