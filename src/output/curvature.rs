//! Discrete curvature of polygons.

use crate::math::vector::{cross, length};
use crate::output::scene::Curve;

/// Returns the discrete curvature at point `i`: that of the circle through the point and its two neighbours,
/// `4 A / (|a| |b| |a + b|)` with the area A of their triangle and the edges a, b before and after the point, in 1 /
/// model units. In the plane it has a sign, positive where the polygon turns left. Returns `None` at the ends of open
/// polygons and if two of the three points coincide.
///
/// Source: Menger, Mathematische Annalen 103 (1930), 466-501.
pub(super) fn discrete(curve: &Curve, i: usize) -> Option<f64> {
    let n = curve.len();
    let at = |i: usize| &curve.points[i * curve.dimension..(i + 1) * curve.dimension];
    let (before, after) = match (curve.closed, i) {
        (true, _) => ((i + n - 1) % n, (i + 1) % n),
        (false, 0) => return None,
        (false, _) if i + 1 == n => return None,
        (false, _) => (i - 1, i + 1),
    };
    let edge = |from: usize, to: usize| -> [f64; 3] {
        std::array::from_fn(|k| if k < curve.dimension { at(to)[k] - at(from)[k] } else { 0.0 })
    };
    let (a, b, c) = (edge(before, i), edge(i, after), edge(before, after));
    let normal = cross(a, b);
    let twice_area = if curve.dimension == 2 { normal[2] } else { length(normal) };
    let curvature = 2.0 * twice_area / length(a) / length(b) / length(c);
    curvature.is_finite().then_some(curvature)
}
