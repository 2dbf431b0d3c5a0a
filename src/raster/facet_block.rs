//! How normals and paint vary over triangles in a tile, found for several triangles at once.

#![expect(clippy::cast_possible_truncation, reason = "light needs no more than the precision of f32")]
#![expect(
    clippy::needless_bitwise_bool,
    clippy::needless_range_loop,
    reason = "loops without branches are vector code"
)]

use multiversion::multiversion;

use super::binned_model::BinnedModel;
use super::camera::Projection;
use super::paint::Tint;
use super::project::{STEPS_A_PIXEL, Vertex};
use crate::math::vector::Vector;

/// Interpolates the normals of a triangle over a tile. The last of four numbers is 1 if the back of the triangle is
/// seen, else 0; four fill a vector register.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Facet {
    /// Unnormalised normal at pixel (0, 0) of the tile, and its increments to the right and down.
    base: [f32; 4],
    right: [f32; 4],
    down: [f32; 4],
}

/// Triangles looked at together: eight 32-bit numbers fill a vector register of 256 bits. Half of it leaves half of
/// that empty; twice of it needs two registers for each number.
pub(super) const BLOCK_FACETS: usize = 8;

/// A number for each triangle.
type FacetRow<T> = [T; BLOCK_FACETS];

/// The corners of some triangles.
struct FacetCorners {
    x: [FacetRow<i32>; 3],
    y: [FacetRow<i32>; 3],
    depth: [FacetRow<f32>; 3],
    /// The normal at each corner, component by component.
    normals: [[FacetRow<f64>; 3]; 3],
}

/// How the numbers at the corners of some triangles vary over a tile: the value at pixel (0, 0), then its increments to
/// the right and down.
struct FacetSlopes {
    /// For each corner, how its weight varies.
    weights: [[FacetRow<f32>; 3]; 3],
    /// The value and the increments of the normal, component by component.
    normal: [[FacetRow<f32>; 3]; 3],
    /// 1 if the back of the triangle is seen, else 0.
    back: FacetRow<f32>,
}

/// How the normals and the paint of some triangles vary over a tile.
pub(super) struct FacetBlock<'a> {
    model: &'a BinnedModel<'a>,
    ids: &'a [u32],
    slopes: FacetSlopes,
}

impl Facet {
    /// Returns the normal at a place in the tile, in pixels, whose length is arbitrary, and whether the back is seen.
    #[inline]
    pub(super) fn normal(&self, [x, y]: [f32; 2]) -> [f32; 4] {
        std::array::from_fn(|k| self.base[k] + self.right[k] * x + self.down[k] * y)
    }
}

impl FacetCorners {
    /// Sets the corners of triangle `i` and the normals there.
    #[inline]
    fn set(&mut self, i: usize, corners: [&Vertex; 3], normals: [&Vector; 3]) {
        for k in 0..3 {
            let (corner, normal) = (corners[k], normals[k]);
            (self.x[k][i], self.y[k][i], self.depth[k][i]) = (corner.x, corner.y, corner.depth);
            for axis in 0..3 {
                self.normals[k][axis][i] = normal[axis];
            }
        }
    }
}

impl<'a> FacetBlock<'a> {
    /// Looks at up to [`BLOCK_FACETS`] triangles in the tile at `origin`. In perspective, weights are scaled by the
    /// stored depth, which is inverse to the distance.
    pub(super) fn of(model: &'a BinnedModel<'a>, ids: &'a [u32], origin: [i32; 2]) -> Self {
        let none = [[0; BLOCK_FACETS]; 3];
        // lanes without a triangle are of no account, but their normals are not undefined
        let one = [[1.0; BLOCK_FACETS]; 3];
        let mut rows = FacetCorners { x: none, y: none, depth: [[1.0; BLOCK_FACETS]; 3], normals: [one; 3] };
        for (i, &id) in ids.iter().enumerate().take(BLOCK_FACETS) {
            match model.shaded_corners(id) {
                Some((corners, normals)) => rows.set(i, corners, normals),
                None => rows.set(i, model.corners(id), model.normals(id).each_ref()),
            }
        }
        if has_undefined(&rows.normals) {
            for (i, &id) in ids.iter().enumerate().take(BLOCK_FACETS) {
                rows.set(i, model.corners(id), model.normals(id).each_ref());
            }
        }
        let slopes = slopes(&rows, origin, model.camera.projection == Projection::Perspective);
        Self { model, ids, slopes }
    }

    /// Returns how the normal of triangle `i` of these varies over the tile.
    #[inline]
    pub(super) fn facet(&self, i: usize) -> Facet {
        let FacetSlopes { normal, back, .. } = &self.slopes;
        let of = |along: &[FacetRow<f32>; 3], last: f32| [along[0][i], along[1][i], along[2][i], last];
        // the last numbers are exact, even where depths are so far apart that sums are no numbers
        Facet { base: of(&normal[0], back[i]), right: of(&normal[1], 0.0), down: of(&normal[2], 0.0) }
    }

    /// Returns how the paint of triangle `i` of these varies over the tile; `None` if it has none.
    #[inline]
    pub(super) fn tint(&self, i: usize) -> Option<Tint> {
        let paint = self.model.paint.as_ref()?;
        let weights = [0, 1, 2].map(|k| [0, 1, 2].map(|along| self.slopes.weights[k][along][i]));
        Some(Tint::new(&self.model.painted(paint, self.ids[i]), &weights))
    }
}

/// Returns whether some normal of a block is undefined, which is 0.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn has_undefined(normals: &[[FacetRow<f64>; 3]; 3]) -> bool {
    let mut n = 0_u64;
    for corner in normals {
        for i in 0..BLOCK_FACETS {
            n += u64::from((corner[0][i] == 0.0) & (corner[1][i] == 0.0) & (corner[2][i] == 0.0));
        }
    }
    n > 0
}

/// Returns how the normals of triangles vary over a tile. There are no branches, so that it is vector code; wider
/// vectors give the same bits.
#[multiversion(targets("x86_64+avx2"))]
fn slopes(corners: &FacetCorners, origin: [i32; 2], is_perspective: bool) -> FacetSlopes {
    let (row, zero) = ([0.0; BLOCK_FACETS], [[0.0; BLOCK_FACETS]; 3]);
    let mut slopes = FacetSlopes { weights: [zero; 3], normal: [zero; 3], back: row };
    let wide = [[0.0_f64; BLOCK_FACETS]; 3];
    let (mut side, mut local, mut weight) = (wide[0], [wide; 2], wide);
    for i in 0..BLOCK_FACETS {
        let way = |u: &[FacetRow<i32>; 3], k: usize| f64::from(u[k][i] - u[0][i]);
        // coordinates have 23 bits, so that this is exact
        let is_back = way(&corners.x, 1) * way(&corners.y, 2) > way(&corners.x, 2) * way(&corners.y, 1);
        side[i] = if is_back { 1.0 } else { -1.0 };
        slopes.back[i] = if is_back { 1.0 } else { 0.0 };
    }
    for k in 0..3 {
        for i in 0..BLOCK_FACETS {
            local[0][k][i] = f64::from(corners.x[k][i]) / f64::from(STEPS_A_PIXEL) - f64::from(origin[0]);
            local[1][k][i] = f64::from(corners.y[k][i]) / f64::from(STEPS_A_PIXEL) - f64::from(origin[1]);
            let nearness = side[i] / f64::from(corners.depth[0][i]);
            weight[k][i] = if is_perspective { f64::from(corners.depth[k][i]) * nearness } else { side[i] };
        }
    }
    for k in 0..3 {
        let (a, b) = ((k + 1) % 3, (k + 2) % 3);
        for i in 0..BLOCK_FACETS {
            let ([ax, ay], [bx, by]) = ([local[0][a][i], local[1][a][i]], [local[0][b][i], local[1][b][i]]);
            slopes.weights[k][0][i] = ((ax * by - ay * bx) * weight[k][i]) as f32;
            slopes.weights[k][1][i] = ((ay - by) * weight[k][i]) as f32;
            slopes.weights[k][2][i] = ((bx - ax) * weight[k][i]) as f32;
        }
    }
    let mut normals = [zero; 3];
    for k in 0..3 {
        for axis in 0..3 {
            for i in 0..BLOCK_FACETS {
                normals[k][axis][i] = corners.normals[k][axis][i] as f32;
            }
        }
    }
    for along in 0..3 {
        for axis in 0..3 {
            for i in 0..BLOCK_FACETS {
                let at = |k: usize| slopes.weights[k][along][i] * normals[k][axis][i];
                slopes.normal[along][axis][i] = 0.0 + at(0) + at(1) + at(2);
            }
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::bins::TileGrid;
    use crate::raster::camera::{Camera, View};
    use crate::raster::model::{Model, ShadingNormals, TriangleAppearance};
    use crate::watch::Watch;

    #[test]
    fn facets_of_a_block_are_those_of_each_triangle_alone() {
        let turn = |k: u32| f64::from(k) * 0.61;
        let (cos, sin) = (crate::math::functions::cos, crate::math::functions::sin);
        let positions: Vec<Vector> = (0..10).map(|k| [cos(turn(k)), 0.3 * sin(3.0 * turn(k)), sin(turn(k))]).collect();
        let triangles: Vec<[u32; 3]> = (0..8).map(|k| [k, k + 1, if k % 2 == 0 { k + 2 } else { 0 }]).collect();
        // the normal of vertex 4 is undefined: its triangles have those of their planes there
        let normals: Vec<Vector> =
            (0..10).map(|k| if k == 4 { [0.0; 3] } else { [0.1 * f64::from(k), 1.0, -0.5] }).collect();
        let normals = ShadingNormals::Vertices(&normals);
        let surface = TriangleAppearance::Lit([200; 4]);
        let model = Model { positions: &positions, triangles: &triangles, normals, surface, strokes: &[] };
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = Camera::framing(&View { projection, ..View::default() }, &[&positions], 96, 64);
            let grid = TileGrid::of(96, 64);
            let model = BinnedModel::new(&model, &camera, grid, &Watch::new()).expect("nobody says stop");
            let ids: Vec<u32> = (0..8).collect();
            let bits = |facet: Facet| [facet.base, facet.right, facet.down].map(|u| u.map(f32::to_bits));
            for n in [8, 5] {
                let block = FacetBlock::of(&model, &ids[..n], [32, 0]);
                for i in 0..n {
                    let alone = FacetBlock::of(&model, &ids[i..=i], [32, 0]).facet(0);
                    assert_eq!(bits(block.facet(i)), bits(alone), "triangle {i} of {n}");
                }
            }
            let plain = FacetBlock::of(&model, &[4], [0, 0]).facet(0).normal([40.0, 20.0]);
            assert!(plain[..3].iter().all(|u| u.is_finite()) && plain[..3].iter().any(|u| u.abs() > 0.0), "{plain:?}");
        }
    }
}
