//! How far points reach: their bounding box, and how far they are along the axes of a camera.

use multiversion::multiversion;

use super::axes::{AxisRows, along};
use crate::math::vector::Vector;

/// The least and the largest coordinates of no points.
pub(super) const NO_BOX: [Vector; 2] = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// Returns the least and the largest coordinates of those points that are finite. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn bounding_box(points: &[Vector]) -> [Vector; 2] {
    /// Points side by side, whose twelve coordinates fill three vector registers. Half of it fills one and a half;
    /// twice of it needs six for each corner.
    const LANES: usize = 4;
    let (lines, rest) = points.as_chunks::<LANES>();
    let [mut low, mut high] = NO_BOX.map(|corner| [corner; LANES]);
    for line in lines {
        let mut are_finite = true;
        for x in line.as_flattened() {
            are_finite &= x.abs() < f64::INFINITY;
        }
        if are_finite {
            for i in 0..LANES {
                for k in 0..3 {
                    low[i][k] = if line[i][k] < low[i][k] { line[i][k] } else { low[i][k] };
                    high[i][k] = if line[i][k] > high[i][k] { line[i][k] } else { high[i][k] };
                }
            }
        } else {
            include_finite(line, (&mut low[0], &mut high[0]));
        }
    }
    include_finite(rest, (&mut low[0], &mut high[0]));
    let least = |i: usize| low.iter().fold(f64::INFINITY, |least, corner| least.min(corner[i]));
    let largest = |i: usize| high.iter().fold(f64::NEG_INFINITY, |largest, corner| largest.max(corner[i]));
    [[0, 1, 2].map(least), [0, 1, 2].map(largest)]
}

/// Grows a box so that it contains those points that are finite.
fn include_finite(points: &[Vector], (low, high): (&mut Vector, &mut Vector)) {
    for point in points.iter().filter(|point| point.iter().all(|x| x.is_finite())) {
        (*low, *high) = ([0, 1, 2].map(|k| low[k].min(point[k])), [0, 1, 2].map(|k| high[k].max(point[k])));
    }
}

/// Returns how far points reach along the axes from `centre`, and against them; then both again, reduced for each axis
/// by its tangent times the distance along the third axis. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn farthest(rows: &AxisRows, centre: Vector, tangents: &[f64; 4], points: &[Vector]) -> [[f64; 4]; 4] {
    let mut far = [[f64::NEG_INFINITY; 4]; 4];
    for point in points {
        let p = along(rows, [point[0] - centre[0], point[1] - centre[1], point[2] - centre[2]]);
        for k in 0..4 {
            let reduced = tangents[k] * p[2];
            let found = [p[k], -p[k], p[k] - reduced, -p[k] - reduced];
            for i in 0..4 {
                far[i][k] = if found[i] > far[i][k] { found[i] } else { far[i][k] };
            }
        }
    }
    far
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::math::vector::{dot, minus};
    use crate::raster::axes::axis_rows;

    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![8 => -9.0..9.0, 1 => prop::sample::select(vec![0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY])]
    }

    fn finite_vector() -> impl Strategy<Value = Vector> {
        prop::array::uniform3(-9.0..9.0)
    }

    proptest! {
        #[test]
        fn the_box_of_points_is_that_of_the_finite_ones(
            points in prop::collection::vec(prop::array::uniform3(number()), 0..40),
        ) {
            let mut expected = NO_BOX;
            for point in points.iter().filter(|point| point.iter().all(|x| x.is_finite())) {
                for k in 0..3 {
                    expected[0][k] = expected[0][k].min(point[k]);
                    expected[1][k] = expected[1][k].max(point[k]);
                }
            }
            prop_assert_eq!(bounding_box(&points), expected);
        }

        #[test]
        fn points_reach_as_far_as_the_farthest_of_them(
            points in prop::collection::vec(finite_vector(), 0..20),
            axes in prop::array::uniform3(finite_vector()),
            centre in finite_vector(),
            tangents in prop::array::uniform3(0.0..2.0),
        ) {
            let [x, y, z] = tangents;
            let found = farthest(&axis_rows(axes), centre, &[x, y, z, 0.0], &points);
            let of_axis = |k: usize| {
                let of = |point: &Vector| {
                    let r = minus(*point, centre);
                    let (along, reduced) = (dot(r, axes[k]), tangents[k] * dot(r, axes[2]));
                    [along, -along, along - reduced, -along - reduced]
                };
                let farther = |far: [f64; 4], found: [f64; 4]| [0, 1, 2, 3].map(|i| far[i].max(found[i]));
                points.iter().map(of).fold([f64::NEG_INFINITY; 4], farther)
            };
            prop_assert_eq!([0, 1, 2].map(|k| found.map(|far| far[k])), [0, 1, 2].map(of_axis));
        }
    }
}
