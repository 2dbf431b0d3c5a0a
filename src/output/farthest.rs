//! The largest distance of points of one shape from another shape: one half of the Hausdorff distance, with its place
//! and an upper bound.
//!
//! The distance from a triangle `t` is a convex function, so over a triangle `T` it is largest at a corner of `T`. With
//! `d(x)` the distance of `x` from the other shape,
//!
//! `max over corners of d <= max over T of d <= min over t of (max over corners x of T of |x - t|)`,
//!
//! and on the right it is enough to take the few `t` that are nearest to the corners and to the centre of `T`.
//! Triangles whose lower and upper bounds are far apart are cut in four, until the bounds are close or the budget of
//! cuts is spent. Source: M. Tang, M. Lee, Y. Kim, ACM Transactions on Graphics 28 (2009), article 74; the convex bound
//! is the one of their section 4.

use rayon::prelude::*;

use super::nearest::{TREE_TRIANGLE_BYTES, Triangles};
use super::scene::{Shape, positions};
use crate::math::functions::sqrt;
use crate::math::vector::{Vector, square_from_triangle};
use crate::watch::{Stopped, Watch};

/// Maximum number of triangles that are cut in four, for each direction of a comparison. They take some seconds of one
/// core. Half of it leaves wider bounds where two surfaces lie close but are triangulated differently; twice of it
/// takes twice as long there.
const MAX_CUT: usize = 1 << 16;
/// Accepted gap between the bounds, relative to the distance found. Half of it cuts about twice as many triangles,
/// twice of it half as many.
const RELATIVE_GAP: f64 = 1e-3;
/// Accepted gap as a share of the diagonal of the box around the shape, for shapes that are nearly the same. It is
/// about the rounding of f32, in which most files hold their numbers: half of it searches below the precision of files;
/// twice of it lets more than their rounding pass.
const DIAGONAL_GAP: f64 = 1e-7;
/// Number of triangles that a thread measures before it checks the watch. Half or twice of it checks twice or half as
/// often; results are the same.
const TRIANGLES_PER_CHECK: usize = 4_096;

/// A shape as triangles, or as segments.
#[derive(Debug)]
pub struct Measured(Triangles);

/// The point of a shape that is farthest from another shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Farthest {
    /// The distance of the point, model units.
    pub distance: f64,
    /// A distance that no point of the shape exceeds, model units.
    pub at_most: f64,
    /// The point.
    pub at: Vector,
}

/// A triangle, the squared distance of its farthest known point with that point, and an upper bound of the squared
/// distances of its points.
#[derive(Debug, Clone, Copy)]
struct SearchTriangle {
    corners: [Vector; 3],
    least: f64,
    at: Vector,
    most: f64,
}

impl Measured {
    /// Bytes of memory per triangle in the tree.
    pub const NODE_BYTES: u128 = TREE_TRIANGLE_BYTES;
    /// Bytes of memory per triangle: in the tree, and as a piece with its number.
    pub const TRIANGLE_BYTES: u128 = Self::NODE_BYTES + size_of::<SearchTriangle>() as u128 + 8;
    /// Number of distances that are computed for a triangle. Half or twice of it predicts half or twice the time of a
    /// comparison.
    pub const QUERIES_A_TRIANGLE: u128 = 4;
    /// Maximum number of triangles that are measured beyond those of the shape.
    pub const MAX_PIECES: u128 = 4 * MAX_CUT as u128;

    /// Prepares a shape, whose faces are cut into triangles as for every picture. Points have at most three
    /// coordinates.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub fn of(shape: &Shape<'_>, watch: &Watch) -> Result<Self, Stopped> {
        match shape {
            Shape::Mesh(mesh) => {
                let positions = positions(*mesh, watch)?;
                Triangles::of(*mesh, &positions, watch).map(Self)
            }
            Shape::Curves(curves) => Triangles::of_curves(curves, watch).map(Self),
        }
    }

    /// Returns the point that is farthest from another shape; `None` if one of the shapes has no faces.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub fn farthest_from(&self, other: &Self, watch: &Watch) -> Result<Option<Farthest>, Stopped> {
        if other.0.corners().is_empty() {
            return Ok(None);
        }
        let mut pieces = other.measured(self.0.corners(), watch)?;
        let Some(first) = pieces.first() else { return Ok(None) };
        let (mut best, mut settled, mut left) = (*first, 0.0_f64, MAX_CUT);
        loop {
            best = pieces.iter().fold(best, |best, piece| if piece.least > best.least { *piece } else { best });
            let distance = sqrt(best.least);
            let enough = distance + (RELATIVE_GAP * distance).max(DIAGONAL_GAP * self.0.diagonal());
            let (open, closed): (Vec<SearchTriangle>, Vec<SearchTriangle>) =
                pieces.into_iter().partition(|piece| sqrt(piece.most) > enough);
            settled = closed.iter().fold(settled, |most, piece| most.max(piece.most));
            pieces = open;
            // the triangles with the largest bounds are cut, as far as the budget allows
            pieces.sort_by(|a, b| b.most.total_cmp(&a.most));
            let cut = pieces.len().min(left);
            if cut == 0 {
                break;
            }
            left -= cut;
            let whole = pieces.split_off(cut);
            let quarters: Vec<[Vector; 3]> = pieces.iter().flat_map(|piece| quarters(piece.corners)).collect();
            pieces = other.measured(&quarters, watch)?;
            pieces.extend(whole);
        }
        let most = pieces.iter().fold(settled.max(best.least), |most, piece| most.max(piece.most));
        Ok(Some(Farthest { distance: sqrt(best.least), at_most: sqrt(most), at: best.at }))
    }

    /// Measures triangles against this shape, which has at least one triangle.
    fn measured(&self, triangles: &[[Vector; 3]], watch: &Watch) -> Result<Vec<SearchTriangle>, Stopped> {
        let part = |part: &[[Vector; 3]]| {
            watch.check()?;
            let (mut near, mut waiting) = (0, Vec::new());
            let measured = part.iter().map(|&corners| self.piece(corners, &mut near, &mut waiting)).collect();
            watch.advance(part.len() as u64);
            Ok(measured)
        };
        let parts: Result<Vec<Vec<SearchTriangle>>, Stopped> =
            triangles.par_chunks(TRIANGLES_PER_CHECK).map(part).collect();
        Ok(parts?.concat())
    }

    fn piece(&self, corners: [Vector; 3], near: &mut usize, waiting: &mut Vec<(f64, u32)>) -> SearchTriangle {
        let [a, b, c] = corners;
        let centre = [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0);
        let (mut least, mut at, mut most) = (-1.0, a, f64::INFINITY);
        for point in [a, b, c, centre] {
            let square = self.0.nearest(point, near, waiting);
            if square > least {
                (least, at) = (square, point);
            }
            let other = self.0.corners()[*near];
            let from = corners.map(|corner| square_from_triangle(corner, other));
            most = most.min(from[0].max(from[1]).max(from[2]));
        }
        // rounding may swap the two bounds where they are equal
        SearchTriangle { corners, least, at, most: most.max(least) }
    }
}

/// Returns the four triangles between the corners and the midpoints of the sides.
fn quarters([a, b, c]: [Vector; 3]) -> [[Vector; 3]; 4] {
    let middle = |p: Vector, q: Vector| [0, 1, 2].map(|k| p[k].midpoint(q[k]));
    let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::scene::Curve;

    fn polygon(points: &[[f64; 2]], closed: bool) -> Curve {
        Curve { points: points.concat(), dimension: 2, closed, tangents: None }
    }

    fn both_ways(a: Curve, b: Curve) -> [Farthest; 2] {
        let watch = Watch::new();
        let [a, b] = [a, b].map(|curve| Measured::of(&Shape::Curves(&[curve]), &watch).expect("nobody stops it"));
        [(&a, &b), (&b, &a)].map(|(a, b)| a.farthest_from(b, &watch).expect("nobody stops it").expect("segments"))
    }

    #[test]
    fn a_point_between_two_vertices_may_be_the_farthest() {
        // the middle of the segment below is farthest from the two posts, and none of its vertices is far from them
        let below = polygon(&[[0.0, 0.0], [8.0, 0.0]], false);
        let posts = polygon(&[[8.0, 0.0], [8.0, 6.0], [0.0, 6.0], [0.0, 0.0]], false);
        let [there, back] = both_ways(below, posts);
        assert!((there.distance - 4.0).abs() < 4e-3 && (there.at[0] - 4.0).abs() < 1e-2, "{there:?}");
        assert!(there.distance <= 4.0 && 4.0 <= there.at_most && there.at_most < 4.01, "{there:?}");
        assert_eq!((back.distance, back.at_most), (6.0, 6.0));
    }

    #[test]
    fn the_same_shape_is_at_no_distance_but_for_rounding() {
        let star = polygon(&[[0.0, 0.1], [2.0, 0.3], [1.7, 1.9], [0.4, 0.9]], true);
        for way in both_ways(star.clone(), star) {
            assert!(way.distance <= way.at_most && way.at_most <= 4.0 * f64::EPSILON, "{way:?}");
        }
    }
}
