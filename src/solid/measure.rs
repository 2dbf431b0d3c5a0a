//! Area and volume of faces, by Gauss quadrature on each of their polynomial pieces.

use super::spline::BSplineSurface;
use crate::math::functions::real;
use crate::math::vector::{Vector, cross, dot, length, minus};

/// Nodes in (-1, 1) and weights: five points, exact to degree 9, which the volume below a bicubic piece has. Source: M.
/// Abramowitz, I. Stegun, Handbook of Mathematical Functions (1964), table 25.4.
const FIVE_NODES: &[[f64; 2]] = &[
    [-0.906_179_845_938_664, 0.236_926_885_056_189_1],
    [-0.538_469_310_105_683_1, 0.478_628_670_499_366_47],
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_47],
    [0.906_179_845_938_664, 0.236_926_885_056_189_1],
];
/// Eight points, exact to degree 15: that below a piece of bidegree 5 has degree 14.
const EIGHT_NODES: &[[f64; 2]] = &[
    [-0.960_289_856_497_536_2, 0.101_228_536_290_376_26],
    [-0.796_666_477_413_626_7, 0.222_381_034_453_374_47],
    [-0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [-0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_47],
    [0.960_289_856_497_536_2, 0.101_228_536_290_376_26],
];

/// The measures of a face.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct FaceMeasure {
    /// Its area, in square model units.
    pub(super) area: f64,
    /// The signed volume of the cone over it from a point, in cubic model units.
    pub(super) volume: f64,
}

impl FaceMeasure {
    /// Measures a surface; the apex of the cone is `origin`.
    pub(super) fn of(surface: &BSplineSurface, origin: Vector) -> Self {
        let rule = if surface.degree > 3 { EIGHT_NODES } else { FIVE_NODES };
        let mut sum = Self::default();
        for (i, j) in (0..surface.spans[0]).flat_map(|i| (0..surface.spans[1]).map(move |j| (i, j))) {
            for [x, a] in rule {
                for [y, b] in rule {
                    let at = [real(i) + 0.5 * (1.0 + x), real(j) + 0.5 * (1.0 + y)];
                    let [point, along_u, along_v] = surface.at(at);
                    let normal = cross(along_u, along_v);
                    sum.area += 0.25 * a * b * length(normal);
                    sum.volume += 0.25 * a * b * dot(minus(point, origin), normal) / 3.0;
                }
            }
        }
        sum
    }
}
