//! A point of a surface with its derivatives.

use crate::math::functions::sqrt;
use crate::math::vector::{Vector, cross, direction, dot, plus, times};
use crate::solid::net::BicubicNet;

/// A point of the limit surface with its derivatives, as far as they exist.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jet {
    /// The position, in model units.
    pub at: Vector,
    /// The derivatives along u and v, in model units; `None` at vertices around which the surface is not bicubic.
    pub first: Option<[Vector; 2]>,
    /// The second derivatives (uu, uv, vv), in model units; `None` if there are no first derivatives.
    pub second: Option<[Vector; 3]>,
    /// The unit normal, on the side from which the face is counter-clockwise; `None` if no tangent plane is known.
    pub normal: Option<Vector>,
    /// The principal curvatures, in 1 / model units, the larger first: positive where the surface bends away from its
    /// normal, as for a sphere with outward normals. `None` if the surface has no second derivatives or no tangent
    /// plane.
    pub principal: Option<[f64; 2]>,
}

/// The values of the four cubic B-splines that count between two knots, and of their first and second derivatives.
/// Source: C. de Boor, A Practical Guide to Splines (1978), chapter 9, for uniform knots.
fn basis(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    let inner = |t: f64| (4.0 + t * t * (3.0 * t - 6.0)) / 6.0;
    [
        [s * s * s / 6.0, inner(t), inner(s), t * t * t / 6.0],
        [-0.5 * s * s, 0.5 * t * (3.0 * t - 4.0), 0.5 * s * (4.0 - 3.0 * s), 0.5 * t * t],
        [s, 3.0 * t - 2.0, 1.0 - 3.0 * t, t],
    ]
}

fn weighted(weights: [f64; 4], points: [Vector; 4]) -> Vector {
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| times(weights[i], points[i]));
    plus(plus(a, d), plus(b, c))
}

impl Jet {
    /// Returns the jet of a uniform bicubic B-spline whose parameters run `scale` times as fast as those of the face.
    pub(super) fn of(net: &BicubicNet, scale: f64, [u, v]: [f64; 2]) -> Self {
        let (along_u, along_v) = (basis(u), basis(v));
        // columns[k][i]: the k-th derivative along v of the curve i
        let columns = along_v.map(|weights| net.map(|row| weighted(weights, row)));
        let value = |i: usize, j: usize| weighted(along_u[i], columns[j]);
        let first = [value(1, 0), value(0, 1)].map(|d| times(scale, d));
        let second = [value(2, 0), value(1, 1), value(0, 2)].map(|d| times(scale * scale, d));
        let normal = normal(first[0], first[1]);
        let principal = normal.and_then(|normal| principal(first, second, normal));
        Self { at: value(0, 0), first: Some(first), second: Some(second), normal, principal }
    }

    /// Returns the jet in other coordinates: `at` maps points, and `direction`, its linear part, maps directions.
    pub(super) fn mapped(self, at: impl Fn(Vector) -> Vector, direction: impl Fn(Vector) -> Vector) -> Self {
        Self {
            at: at(self.at),
            first: self.first.map(|derivatives| derivatives.map(&direction)),
            second: self.second.map(|derivatives| derivatives.map(&direction)),
            normal: self.normal.map(&direction),
            principal: self.principal,
        }
    }
}

/// Returns the principal curvatures of a surface with these derivatives and this normal.
fn principal([du, dv]: [Vector; 2], [duu, duv, dvv]: [Vector; 3], normal: Vector) -> Option<[f64; 2]> {
    // scaling u and v separately keeps the products within range
    let [a, b] = [du, dv].map(|d| sqrt(dot(d, d)));
    let [du, dv] = [times(1.0 / a, du), times(1.0 / b, dv)];
    let f = dot(du, dv);
    let [l, m, n] = [(duu, a * a), (duv, a * b), (dvv, b * b)].map(|(second, by)| -dot(second, normal) / by);
    let area = 1.0 - f * f;
    let mean = 0.5 * (l + n - 2.0 * m * f) / area;
    let gaussian = (l * n - m * m) / area;
    let apart = sqrt((mean * mean - gaussian).max(0.0));
    let found = [mean + apart, mean - apart];
    found.iter().all(|k| k.is_finite()).then_some(found)
}

/// Returns the unit normal of two tangents.
pub(super) fn normal(along_u: Vector, along_v: Vector) -> Option<Vector> {
    direction(cross(direction(along_u)?, direction(along_v)?))
}
