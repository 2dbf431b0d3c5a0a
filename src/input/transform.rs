//! Affine maps, in f64.

use crate::math::vector::{cross, dot};

/// An affine map: `x -> A x + t`, the columns of `A`, then `t`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform(pub(super) [[f64; 3]; 4]);

impl Transform {
    /// The map that changes nothing.
    pub(super) const IDENTITY: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]]);

    /// First `inner`, then this one.
    pub(super) fn after(&self, inner: &Self) -> Self {
        let linear = Self([self.0[0], self.0[1], self.0[2], [0.0; 3]]);
        let [a, b, c, t] = inner.0;
        Self([linear.point(a), linear.point(b), linear.point(c), self.point(t)])
    }

    /// Where a point comes to.
    pub(super) fn point(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c, t] = self.0;
        std::array::from_fn(|k| a[k] * x + b[k] * y + c[k] * z + t[k])
    }

    /// Whether it turns the orientation round: the determinant is negative.
    pub(super) fn is_mirror(&self) -> bool {
        let [a, b, c, _] = self.0;
        dot(a, cross(b, c)) < 0.0
    }
}
