//! Affine maps in f64.

use crate::math::vector::{cross, dot};

/// How far the length of a quaternion may be from 1, because writers round to a few digits: 1e-3 admits three decimals
/// of each of its four numbers, whose rounding changes the length by 1e-3 at most. Half of it may refuse these; twice
/// of it would still refuse most with two decimals, which change it by up to 1e-2.
const UNIT_LENGTH_TOLERANCE: f64 = 1e-3;
/// How far the last row of a matrix, or column where vectors are rows, may be from 0, 0, 0, 1: some ten roundings of
/// f32, as products of matrices of files have. Half of it is five roundings, which long products may exceed; twice of
/// it takes projections for affine whose divisor changes by 2e-6 over a unit.
pub(super) const AFFINE: f64 = 1e-6;

/// An affine map `x -> A x + t`, stored as the columns of `A`, then `t`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform(pub(super) [[f64; 3]; 4]);

impl Transform {
    /// The identity map.
    pub(super) const IDENTITY: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]]);

    /// Returns the rotation of a quaternion, with its real part last, after normalisation; `None` if its length is not
    /// near 1.
    pub(super) fn rotation([x, y, z, w]: [f64; 4]) -> Option<Self> {
        let square = x * x + y * y + z * z + w * w;
        let s = 2.0 / square;
        let columns = [
            [1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)],
            [s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w)],
            [s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y)],
            [0.0; 3],
        ];
        ((square.sqrt() - 1.0).abs() <= UNIT_LENGTH_TOLERANCE).then_some(Self(columns))
    }

    /// Returns the composition that applies `inner` first, then `self`.
    pub(super) fn after(&self, inner: &Self) -> Self {
        let linear = Self([self.0[0], self.0[1], self.0[2], [0.0; 3]]);
        let [a, b, c, t] = inner.0;
        Self([linear.point(a), linear.point(b), linear.point(c), self.point(t)])
    }

    /// Applies the map to a point.
    pub(super) fn point(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c, t] = self.0;
        std::array::from_fn(|k| a[k] * x + b[k] * y + c[k] * z + t[k])
    }

    /// Whether the map reverses orientation, which is when its determinant is negative.
    pub(super) fn is_mirror(&self) -> bool {
        let [a, b, c, _] = self.0;
        dot(a, cross(b, c)) < 0.0
    }
}
