//! Vertex normals of a refined net, weighted by the area of the faces around each vertex.

use std::ops::Range;

use rayon::prelude::*;

use crate::kept::Kept;
use crate::math::vector::{cross, minus, plus, times, unit};
use crate::output::bounds::CoordinateBounds;
use crate::output::grid_normals::{self, PIECES};
use crate::output::scene::{FaceChunk, MeshSource, OnDemandSource, ROWS_PER_CHUNK, in_chunks};
use crate::output::vertex_sums::sums;
use crate::watch::{Stopped, Watch};

/// Returns unit normals, one per vertex: the sum of the area vectors of the faces of each vertex, scaled to length one.
///
/// The area vector of a face `p_0 .. p_(n-1)` is Newell's, `1/2 sum (p_i - p_0) x (p_(i+1) - p_0)`: as long as the
/// projected area of the face, perpendicular to its mean plane. If the sum vanishes (isolated vertices, collapsed
/// faces) the normal is the zero vector. `positions` (model units) are those of all vertices. Each sum runs in face
/// order whatever the number of threads, so the bits are always the same.
///
/// Source: M. Newell, R. Newell, T. Sancha, Proc. ACM Annual Conference (1972), 443-450.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub fn area(mesh: &dyn MeshSource, positions: &[[f64; 3]], watch: &Watch) -> Result<Kept<[f64; 3]>, Stopped> {
    area_scaled(mesh, (positions, scale(positions)), watch)
}

/// Returns [`area`] normals of positions that are given with their [`scale`].
fn area_scaled(
    mesh: &dyn MeshSource,
    (positions, scale): (&[[f64; 3]], f64),
    watch: &Watch,
) -> Result<Kept<[f64; 3]>, Stopped> {
    if let Some(grid) = mesh.quad_grid().filter(|grid| PIECES.contains(&grid.pieces())) {
        return grid_normals::area(mesh, grid, (positions, scale), watch);
    }
    sums(mesh, |face| area_vector(face, positions, scale), unit, watch)
}

/// Returns the normals of the mesh itself (those of its limit), and [`area`] normals where it has none.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub fn of(mesh: &dyn MeshSource, positions: &[[f64; 3]], watch: &Watch) -> Result<Kept<[f64; 3]>, Stopped> {
    of_within(mesh, positions, None, watch)
}

/// Returns the same as [`of`]; `bounds` is the box around the positions, if it is known.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub(super) fn of_within(
    mesh: &dyn MeshSource,
    positions: &[[f64; 3]],
    bounds: Option<&CoordinateBounds<3>>,
    watch: &Watch,
) -> Result<Kept<[f64; 3]>, Stopped> {
    let area = || area_scaled(mesh, (positions, bounds.map_or_else(|| scale(positions), scale_of)), watch);
    let mut normals = Vec::new();
    let Some(source) = mesh.normals() else { return area() };
    source.of_vertices(0..mesh.n_vertices(), &mut normals);
    let is_missing = |normal: &[f64; 3]| normal.iter().all(|&x| x == 0.0);
    if normals.iter().any(is_missing) {
        let area = area()?;
        normals
            .iter_mut()
            .zip(&*area)
            .filter(|(normal, _)| is_missing(normal))
            .for_each(|(normal, area)| *normal = *area);
    }
    Ok(normals.into())
}

/// Returns the normals of `smooth` for the vertices of `split_vertices`, a mesh with the same faces in the same order
/// and with copies of some vertices of `smooth`. `positions` are those of `smooth`.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub fn split_vertices(
    split_vertices: &dyn MeshSource,
    smooth: &dyn MeshSource,
    positions: &[[f64; 3]],
    watch: &Watch,
) -> Result<Kept<[f64; 3]>, Stopped> {
    let normals = of(smooth, positions, watch)?;
    let mut found = vec![[0.0; 3]; split_vertices.n_vertices()];
    let (mut here, mut there) = (FaceChunk::default(), FaceChunk::default());
    in_chunks(split_vertices.n_faces(), |range| {
        watch.check()?;
        split_vertices.faces(range.clone(), &mut here);
        smooth.faces(range, &mut there);
        for (&v, &from) in here.vertices.iter().zip(&there.vertices) {
            found[v as usize] = normals[from as usize];
        }
        Ok(())
    })?;
    Ok(found.into())
}

/// Returns a normal, or +z for one that is undefined, for formats that require unit vectors.
#[inline]
pub fn or_up(normal: [f64; 3]) -> [f64; 3] {
    if normal.iter().all(|&x| x == 0.0) { [0.0, 0.0, 1.0] } else { normal }
}

/// Returns twice Newell's area vector of a face, with positions multiplied by `scale`.
#[inline]
pub fn area_vector(face: &[u32], positions: &[[f64; 3]], scale: f64) -> [f64; 3] {
    if let &[a, b, c, d] = face {
        // Most faces are quads, whose sum needs no loop and has the same bits. Spokes are written out, as functions
        // that map arrays take three times as long here.
        let [a, b, c, d] =
            [&positions[a as usize], &positions[b as usize], &positions[c as usize], &positions[d as usize]];
        let a = [a[0] * scale, a[1] * scale, a[2] * scale];
        let b = [b[0] * scale - a[0], b[1] * scale - a[1], b[2] * scale - a[2]];
        let c = [c[0] * scale - a[0], c[1] * scale - a[1], c[2] * scale - a[2]];
        let d = [d[0] * scale - a[0], d[1] * scale - a[1], d[2] * scale - a[2]];
        return plus(plus([0.0; 3], cross(b, c)), cross(c, d));
    }
    let at = |vertex: u32| times(scale, positions[vertex as usize]);
    let origin = at(face[0]);
    let spoke = |vertex: u32| minus(at(vertex), origin);
    let mut sum = [0.0; 3];
    let mut a = spoke(face[1]);
    for &vertex in &face[2..] {
        let b = spoke(vertex);
        sum = plus(sum, cross(a, b));
        a = b;
    }
    sum
}

/// Fills `out` with the [`area`] normals of the vertices in `range` of a mesh that makes its positions on demand;
/// `scale` is the [`scale`] of the mesh.
pub(super) fn on_demand(source: &dyn OnDemandSource, range: Range<usize>, scale: f64, out: &mut Vec<[f64; 3]>) {
    source.sums(range, &|corners| area_vector(&[0, 1, 2, 3], &corners, scale), out);
    out.iter_mut().for_each(|sum| *sum = unit(*sum));
}

/// Returns the unit normal of a triangle, zero where it is undefined; `scale` is the [`scale`] of the mesh.
#[inline]
pub(super) fn of_triangle(corners: [[f64; 3]; 3], scale: f64) -> [f64; 3] {
    unit(area_vector(&[0, 1, 2], &corners, scale))
}

/// Returns the unit normals of the triangles `a, b, c` and `a, c, d` of a quad, as [`of_triangle`] does.
#[inline]
pub(super) fn of_halves(quad: [[f64; 3]; 4], scale: f64) -> [[f64; 3]; 2] {
    let [a, b, c, d] = quad.map(|corner| times(scale, corner));
    let [b, c, d] = [b, c, d].map(|corner| minus(corner, a));
    // the sum starts from zero, as in `area_vector`
    [[b, c], [c, d]].map(|[b, c]| unit(plus([0.0; 3], cross(b, c))))
}

/// Returns the power of two that brings half the longest side of the bounding box between 1 and 2, so that products of
/// lengths neither overflow nor vanish. A power of two changes no digit.
pub fn scale(positions: &[[f64; 3]]) -> f64 {
    let block = |rows: &[[f64; 3]]| {
        let mut bounds = CoordinateBounds::EMPTY;
        bounds.add(rows);
        bounds
    };
    let bounds =
        positions.par_chunks(ROWS_PER_CHUNK).map(block).reduce(|| CoordinateBounds::EMPTY, |a, b| a.joined(&b));
    scale_of(&bounds)
}

/// Returns the [`scale`] of positions in this box.
pub(super) fn scale_of(bounds: &CoordinateBounds<3>) -> f64 {
    let half_side = bounds.half_side();
    if half_side > 0.0 && half_side.is_finite() { inverse_power_of_two(half_side) } else { 1.0 }
}

/// Returns `2^-e` for `x` in `[2^e, 2^(e+1))`, within the range of normal numbers.
fn inverse_power_of_two(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52) & 0x7ff;
    f64::from_bits((2046 - exponent).clamp(1, 2046) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::source::{CarriedSource, OriginSource};

    #[derive(Debug)]
    struct FanMesh(usize);

    /// A fan of triangles in the plane `z = 0` around vertex 0; the last vertex is isolated.
    impl MeshSource for FanMesh {
        fn n_vertices(&self) -> usize {
            self.0 + 3
        }

        fn n_faces(&self) -> usize {
            self.0
        }

        fn n_half_edges(&self) -> usize {
            3 * self.0
        }

        fn positions(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
            out.clear();
            out.extend(range.map(|i| match i {
                0 => [0.0; 3],
                _ if i % 2 == 0 => [1.0, 0.0, 0.0],
                _ => [0.0, 1.0, 0.0],
            }));
        }

        fn faces(&self, range: Range<usize>, out: &mut FaceChunk) {
            out.clear();
            for f in range {
                let f = u32::try_from(f).expect("a small mesh");
                let [a, b] = if f % 2 == 0 { [f + 1, f + 2] } else { [f + 2, f + 1] };
                out.push(&[0, b, a]);
            }
        }
    }

    impl CarriedSource for FanMesh {}

    impl OriginSource for FanMesh {
        fn input_cells(&self) -> [usize; 3] {
            [self.0 + 3, 0, self.0]
        }
    }

    fn normals_at(size: f64) -> Vec<[f64; 3]> {
        let mesh = FanMesh(6);
        let mut positions = Vec::new();
        mesh.positions(0..9, &mut positions);
        positions.iter_mut().flatten().for_each(|x| *x *= size);
        area(&mesh, &positions, &Watch::new()).expect("nobody stops it").to_vec()
    }

    #[test]
    fn normals_point_up_and_vanish_at_isolated_vertices_at_any_size() {
        let mut expected = vec![[0.0, 0.0, 1.0]; 8];
        expected.push([0.0; 3]);
        for size in [1.0, 1e-300, 1e300] {
            assert_eq!(normals_at(size), expected, "size {size}");
        }
    }

    #[test]
    fn a_stopped_watch_ends_the_sum() {
        let watch = Watch::new();
        watch.stop();
        assert_eq!(area(&FanMesh(1), &[[0.0; 3]; 4], &watch), Err(Stopped));
    }
}
