//! Transforms of nodes, in f64.

use gltf::json::Node;

/// An affine map: `x -> A x + t`, the columns of `A`, then `t`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform([[f64; 3]; 4]);

impl Transform {
    /// The map that changes nothing.
    pub(super) const IDENTITY: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]]);

    /// The map of a node: its matrix, or its scale, then rotation, then translation.
    pub(super) fn of(node: &Node) -> Self {
        if let Some(matrix) = node.matrix {
            let column = |j: usize| std::array::from_fn(|i| f64::from(matrix[4 * j + i]));
            return Self([column(0), column(1), column(2), column(3)]);
        }
        let [x, y, z, w] = node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |rotation| rotation.0.map(f64::from));
        let scale = node.scale.map_or([1.0; 3], |scale| scale.map(f64::from));
        let rotation = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
            [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
            [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        let column = |j: usize| rotation[j].map(|entry| entry * scale[j]);
        Self([column(0), column(1), column(2), node.translation.map_or([0.0; 3], |t| t.map(f64::from))])
    }

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
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2] < 0.0
    }
}
