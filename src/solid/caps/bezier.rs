//! Tensor products of Bernstein polynomials: values, derivatives, degree elevation and restriction.

use crate::math::functions::{ratio, real, sqrt};
use crate::math::vector::{dot, minus, plus, times};

/// Coefficients of a patch of degree `K - 1` in both directions: `net.0[a][b]`, a along u and b along v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BezierNet<const D: usize, const K: usize>(pub(super) [[[f64; D]; K]; K]);

/// The binomial coefficient n choose k.
pub(super) fn choose(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |ways, i| ways * real(n - i) / real(i + 1))
}

/// Returns the Bernstein polynomials of degree `K - 1` at t.
pub(super) fn bernstein<const K: usize>(t: f64) -> [f64; K] {
    bernstein_of(K - 1, t)
}

/// Returns the Bernstein polynomials of a degree below `K` at t, by de Casteljau's scheme; the others are 0.
fn bernstein_of<const K: usize>(degree: usize, t: f64) -> [f64; K] {
    let mut values = [0.0; K];
    values[0] = 1.0;
    for degree in 1..=degree {
        for k in (0..=degree).rev() {
            let before = if k > 0 { t * values[k - 1] } else { 0.0 };
            values[k] = before + (1.0 - t) * values[k];
        }
    }
    values
}

/// Returns the weighted sum of points, in their order.
pub(super) fn weighted<const D: usize, const K: usize>(weights: &[f64; K], points: &[[f64; D]; K]) -> [f64; D] {
    let mut sum = [0.0; D];
    for (weight, point) in weights.iter().zip(points) {
        for (sum, x) in sum.iter_mut().zip(point) {
            *sum += weight * x;
        }
    }
    sum
}

/// Returns the curve elevated to a higher degree.
pub(super) fn raised<const D: usize, const K: usize, const M: usize>(curve: &[[f64; D]; K]) -> [[f64; D]; M] {
    let (degree, more) = (M - 1, M - K);
    std::array::from_fn(|i| {
        let mut sum = [0.0; D];
        for (j, point) in curve.iter().enumerate().take(i + 1).skip(i.saturating_sub(more)) {
            let weight = choose(K - 1, j) * choose(more, i - j) / choose(degree, i);
            sum = plus(sum, times(weight, *point));
        }
        sum
    })
}

impl<const D: usize, const K: usize> BezierNet<D, K> {
    /// Returns the patch with u and v exchanged.
    pub(super) fn transposed(&self) -> Self {
        Self(std::array::from_fn(|a| std::array::from_fn(|b| self.0[b][a])))
    }

    /// Returns the patch elevated to a higher degree in both directions.
    pub(super) fn raised<const M: usize>(&self) -> BezierNet<D, M> {
        let rows: [[[f64; D]; M]; K] = self.0.map(|row| raised(&row));
        let columns: [[[f64; D]; M]; M] =
            std::array::from_fn(|b| raised(&std::array::from_fn::<_, K, _>(|a| rows[a][b])));
        BezierNet(columns).transposed()
    }

    /// Returns the point with the given Bernstein values in both directions.
    pub(super) fn blend(&self, along: &[f64; K], across: &[f64; K]) -> [f64; D] {
        weighted(along, &self.0.each_ref().map(|row| weighted(across, row)))
    }

    /// Returns the point at (u, v).
    pub(super) fn at(&self, [u, v]: [f64; 2]) -> [f64; D] {
        self.blend(&bernstein(u), &bernstein(v))
    }

    /// Returns the derivatives along u and along v at (u, v).
    pub(super) fn slopes(&self, [u, v]: [f64; 2]) -> [[f64; D]; 2] {
        let (along, across) = (bernstein(u), bernstein(v));
        let steep = |t| steepness::<K>(t);
        [self.blend(&steep(u), &across), self.blend(&along, &steep(v))]
    }
}

/// Returns the derivatives of the Bernstein polynomials of degree `K - 1` at t.
fn steepness<const K: usize>(t: f64) -> [f64; K] {
    let lower: [f64; K] = bernstein_of(K - 2, t);
    std::array::from_fn(|k| {
        let before = if k > 0 { lower[k - 1] } else { 0.0 };
        real(K - 1) * (before - lower[k])
    })
}

/// The Bezier points of the middle span of a uniform cubic spline, as weights of its four control points.
const BEZIER_SPAN: [[f64; 4]; 4] = [
    [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0],
    [0.0, 4.0 / 6.0, 2.0 / 6.0, 0.0],
    [0.0, 2.0 / 6.0, 4.0 / 6.0, 0.0],
    [0.0, 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0],
];

impl<const D: usize> BezierNet<D, 4> {
    /// Returns the patch of the middle span of a uniform bicubic spline with these control points.
    pub(super) fn of_spline(control: &[[[f64; D]; 4]; 4]) -> Self {
        let rows: [[[f64; D]; 4]; 4] = control.map(|row| BEZIER_SPAN.map(|weights| weighted(&weights, &row)));
        let turned = BezierNet(rows).transposed();
        BezierNet(turned.0.map(|column| BEZIER_SPAN.map(|weights| weighted(&weights, &column)))).transposed()
    }
}

/// Returns the differences of consecutive control points of a curve.
pub(super) fn differences<const D: usize>(curve: &[[f64; D]; 5]) -> [[f64; D]; 4] {
    std::array::from_fn(|k| minus(curve[k + 1], curve[k]))
}

/// Returns n equally spaced numbers in the unit interval, including both ends.
pub(super) fn spaced(n: usize) -> Vec<f64> {
    (0..n).map(|k| ratio(k, n - 1)).collect()
}

/// Returns the restriction of polynomials to the interval from a to b, as weights of coefficients: `weights[i][k]`.
pub(super) fn restriction<const K: usize>([a, b]: [f64; 2]) -> [[f64; K]; K] {
    std::array::from_fn(|i| {
        std::array::from_fn(|k| {
            let mut values = [0.0; K];
            values[k] = 1.0;
            for step in 0..K - 1 {
                let t = if step < i { b } else { a };
                for left in 0..K - 1 - step {
                    values[left] = (1.0 - t) * values[left] + t * values[left + 1];
                }
            }
            values[0]
        })
    })
}

impl<const D: usize, const K: usize> BezierNet<D, K> {
    /// Returns the patch after linear maps of its coefficients in both directions, for example its restriction to a
    /// part.
    pub(super) fn mapped<const M: usize>(&self, along: &[[f64; K]; M], across: &[[f64; K]; M]) -> BezierNet<D, M> {
        let rows: [[[f64; D]; M]; K] = self.0.map(|row| std::array::from_fn(|j| weighted(&across[j], &row)));
        BezierNet(std::array::from_fn(|i| {
            std::array::from_fn(|j| weighted(&along[i], &std::array::from_fn(|k| rows[k][j]))) //
        }))
    }

    /// Returns the greatest length of a coefficient, which no point of the patch exceeds.
    pub(super) fn hull(&self) -> f64 {
        let longest = self.0.iter().flatten().map(|point| dot(*point, *point)).fold(0.0, f64::max);
        sqrt(longest)
    }
}
