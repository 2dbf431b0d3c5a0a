//! Length, area, volume, centroid and second moments, summed over simplices.

use crate::math::vector::{cross, dot, length, minus};

/// Integrals of 1, `x` and `x x^T` over segments, triangles or tetrahedra of dimension d, in model units to the powers
/// d, d + 1 and d + 2.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moments<const D: usize> {
    /// Length, area or signed volume.
    pub(super) measure: f64,
    first: [f64; D],
    second: [[f64; D]; D],
}

impl<const D: usize> Moments<D> {
    /// The integrals over nothing.
    pub(super) const ZERO: Self = Self { measure: 0.0, first: [0.0; D], second: [[0.0; D]; D] };

    /// Adds a simplex of this measure with `n` corners: `corners`, and the origin if they are one fewer than `n`.
    ///
    /// With `s` the sum of the corners: `int x = m s / n`, `int x x^T = m / (n (n + 1)) (sum v v^T + s s^T)`, exactly.
    fn add(&mut self, measure: f64, n: f64, corners: &[[f64; D]]) {
        let sum: [f64; D] = std::array::from_fn(|k| corners.iter().map(|v| v[k]).sum());
        self.measure += measure;
        for i in 0..D {
            self.first[i] += measure * sum[i] / n;
            for j in 0..D {
                let squares: f64 = corners.iter().map(|v| v[i] * v[j]).sum();
                self.second[i][j] += measure * (squares + sum[i] * sum[j]) / (n * (n + 1.0));
            }
        }
    }

    /// Adds the segment from `a` to `b`.
    pub(super) fn add_segment(&mut self, a: [f64; D], b: [f64; D]) {
        self.add(length(minus(b, a)), 2.0, &[a, b]);
    }

    /// Returns the sum of both.
    pub(super) fn plus(mut self, other: &Self) -> Self {
        self.measure += other.measure;
        for i in 0..D {
            self.first[i] += other.first[i];
            for j in 0..D {
                self.second[i][j] += other.second[i][j];
            }
        }
        self
    }

    /// Returns the centroid and the second moments about it; `None` if the measure is 0.
    pub(super) fn centered(&self) -> Option<Centered<D>> {
        if self.measure == 0.0 {
            return None;
        }
        let centroid = self.first.map(|x| x / self.measure);
        let about = |i: usize, j: usize| self.second[i][j] - self.measure * centroid[i] * centroid[j];
        let second = std::array::from_fn(|i| std::array::from_fn(|j| about(i, j)));
        Some(Centered { centroid, second })
    }
}

impl Moments<3> {
    /// Adds the triangle `a b c`.
    pub(super) fn add_triangle(&mut self, corners: &[[f64; 3]; 3]) {
        let [a, b, c] = *corners;
        let normal = cross(minus(b, a), minus(c, a));
        self.add(length(normal) / 2.0, 3.0, corners);
    }

    /// Adds the tetrahedron of the triangle `a b c` and the origin; its volume is positive if the triangle is
    /// counter-clockwise seen from the far side.
    pub(super) fn add_cone(&mut self, corners: &[[f64; 3]; 3]) {
        let [a, b, c] = *corners;
        self.add(dot(a, cross(b, c)) / 6.0, 4.0, corners);
    }
}

/// The centroid and the second moments about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Centered<const D: usize> {
    /// The centroid, in the coordinates of the corners.
    pub(super) centroid: [f64; D],
    /// `int (x - centroid) (x - centroid)^T`, symmetric.
    pub(super) second: [[f64; D]; D],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_segment_has_the_textbook_moments() {
        let mut moments = Moments::ZERO;
        moments.add_segment([0.0], [1.0]);
        let centered = moments.centered().expect("it has a length");
        assert_eq!((moments.measure, centered.centroid), (1.0, [0.5]));
        assert!((centered.second[0][0] - 1.0 / 12.0).abs() < 1e-16);
    }

    #[test]
    fn the_corner_tetrahedron_has_the_textbook_moments() {
        let mut moments = Moments::ZERO;
        moments.add_cone(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let centered = moments.centered().expect("it has a volume");
        assert_eq!((moments.measure, centered.centroid), (1.0 / 6.0, [0.25; 3]));
        assert!((moments.second[0][0] - 1.0 / 60.0).abs() < 1e-16);
        assert!((moments.second[0][1] - 1.0 / 120.0).abs() < 1e-16);
    }
}
