//! Gaussian and mean curvature of meshes.

use rayon::prelude::*;

use super::normals;
use super::scene::{FaceChunk, MeshSource, in_chunks};
use super::vertex_sums::sums;
use crate::math::vector::{cross, dot, minus, plus, times};
use crate::watch::{Stopped, Watch};

/// Curvatures of each vertex: 0 where nothing defines them.
#[derive(Debug)]
pub(super) struct Curvatures {
    /// Gaussian curvature, 1 / model units squared: positive on domes and bowls, negative on saddles.
    pub(super) gaussian: Vec<f64>,
    /// Mean curvature, half the sum of the principal ones, 1 / model units: positive where the surface bends away from
    /// its normal, as a sphere does whose normals point outwards.
    pub(super) mean: Vec<f64>,
    /// Area of the faces around each vertex as it is seen along its normal, in units of a power of two that is near
    /// half the longest side of the mesh squared; 0 where nothing defines a curvature.
    pub(super) areas: Vec<f64>,
}

/// Twice the area, in units of half the longest side of the mesh squared, from which the faces around a vertex define a
/// curvature.
/// Coordinates are rounded to 16 digits; of faces a billionth of the mesh long (this area) about seven are left. Half
/// of it and twice of it differ for meshes of 10^17 faces only.
const LEAST_AREA: f64 = 1e-18;

/// The curvatures of a mesh with these positions (model units) and unit normals, one each a vertex.
///
/// When each vertex p moves along its normal n by t, the area vector of a face, Newell's `1/2 sum (p_i - p_0) x
/// (p_(i+1) - p_0)`, becomes `A + 2 t M + t^2 N`: A is that of the face, N that of the polygon of its normals, and M
/// what both mix to. On a smooth surface area grows by the factor `1 + 2 t H + t^2 K` (Steiner's formula). So with
/// sums over the faces around a vertex, as they are seen along its normal, `H = (M . n) / (A . n)` and
/// `K = (N . n) / (A . n)`: the means of the curvatures over these faces. With the exact positions and normals of a
/// surface they are exact on spheres and cylinders whose edges are parallel to the axis, and tend to the curvatures of
/// others as h^2 where edges of length h around a vertex are symmetric up to h^2, as in the regular parts of refined
/// meshes, else as h.
///
/// Where the mesh or its smoothness ends, half of this neighbourhood is missing: there stands the mean over the
/// vertices inside of the same faces, where there are some.
///
/// Sources: J. Steiner, Monatsbericht der Akademie der Wissenschaften Berlin (1840), 114-118; A. Bobenko, H. Pottmann,
/// J. Wallner, Mathematische Annalen 348 (2010), 1-24, sections 2 and 3.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub(super) fn curvatures(
    mesh: &dyn MeshSource,
    positions: &[[f64; 3]],
    unit_normals: &[[f64; 3]],
    watch: &Watch,
) -> Result<Curvatures, Stopped> {
    let scale = normals::scale(positions);
    let area = sums(mesh, |face| normals::area_vector(face, positions, scale), watch)?;
    let mixed = sums(mesh, |face| mixed_area(face, positions, unit_normals, scale), watch)?;
    let image = sums(mesh, |face| normals::area_vector(face, unit_normals, 1.0), watch)?;
    let over_area = |v: usize, sum: &[f64; 3], unit: f64| {
        let below = dot(area[v], unit_normals[v]);
        if below > LEAST_AREA { unit * (dot(*sum, unit_normals[v]) / below) } else { f64::NAN }
    };
    let of_all = |sums: &[[f64; 3]], unit: f64| -> Vec<f64> {
        sums.par_iter().enumerate().map(|(v, sum)| over_area(v, sum, unit)).collect()
    };
    let areas = area.par_iter().zip(unit_normals).map(|(area, n)| dot(*area, *n));
    let areas = areas.map(|area| if area > LEAST_AREA { area } else { 0.0 }).collect();
    let mut found = Curvatures { gaussian: of_all(&image, scale * scale), mean: of_all(&mixed, scale), areas };
    drop((area, mixed, image));
    let ends = Ends::of(mesh, watch)?;
    for values in [&mut found.gaussian, &mut found.mean] {
        ends.fill(mesh, values, watch)?;
    }
    Ok(found)
}

/// Twice the mixed area vector of a face and the polygon of its normals, of positions multiplied by `scale`.
fn mixed_area(face: &[u32], positions: &[[f64; 3]], unit_normals: &[[f64; 3]], scale: f64) -> [f64; 3] {
    let first = face[0] as usize;
    let both = |v: u32| {
        let v = v as usize;
        // scaled first, so that no difference overflows
        let spoke = minus(times(scale, positions[v]), times(scale, positions[first]));
        [spoke, minus(unit_normals[v], unit_normals[first])]
    };
    let mut sum = [0.0; 3];
    let [mut p, mut n] = both(face[1]);
    for &v in &face[2..] {
        let [q, m] = both(v);
        sum = plus(sum, plus(cross(p, m), cross(n, q)));
        (p, n) = (q, m);
    }
    times(0.5, sum)
}

/// The vertices around which faces do not close.
struct Ends(Vec<bool>);

impl Ends {
    /// Around a closed vertex each neighbour follows it in one face and comes before it in another, so that the sum of
    /// those that follow less those that come before is 0.
    fn of(mesh: &dyn MeshSource, watch: &Watch) -> Result<Self, Stopped> {
        let mut balance = vec![0_u32; mesh.n_vertices()];
        each_face(mesh, watch, |face| {
            let n = face.len();
            for (j, &v) in face.iter().enumerate() {
                let (next, before) = (face[(j + 1) % n], face[(j + n - 1) % n]);
                let sum = &mut balance[v as usize];
                *sum = sum.wrapping_add(next).wrapping_sub(before);
            }
        })?;
        Ok(Self(balance.iter().map(|&sum| sum != 0).collect()))
    }

    /// Gives vertices at an end the mean of what those inside have in the faces around them; what nothing defines is 0.
    fn fill(&self, mesh: &dyn MeshSource, values: &mut [f64], watch: &Watch) -> Result<(), Stopped> {
        let is_missing = |v: usize, values: &[f64]| self.0[v] || values[v].is_nan();
        let mut numbers = vec![u32::MAX; values.len()];
        let missing: Vec<usize> = (0..values.len()).filter(|&v| is_missing(v, values)).collect();
        (0..).zip(&missing).for_each(|(number, &v)| numbers[v] = number);
        let mut means = vec![(0.0, 0_u32); missing.len()];
        each_face(mesh, watch, |face| {
            let inside = face.iter().filter(|&&v| numbers[v as usize] == u32::MAX);
            let (sum, n) = inside.fold((0.0, 0), |(sum, n), &v| (sum + values[v as usize], n + 1));
            for &v in face.iter().filter(|&&v| numbers[v as usize] != u32::MAX) {
                let mean = &mut means[numbers[v as usize] as usize];
                *mean = (mean.0 + sum, mean.1 + n);
            }
        })?;
        for (v, (sum, n)) in missing.into_iter().zip(means) {
            let own = if values[v].is_nan() { 0.0 } else { values[v] };
            values[v] = if n > 0 { sum / f64::from(n) } else { own };
        }
        Ok(())
    }
}

fn each_face(mesh: &dyn MeshSource, watch: &Watch, mut each: impl FnMut(&[u32])) -> Result<(), Stopped> {
    let mut chunk = FaceChunk::default();
    in_chunks(mesh.n_faces(), |range| {
        watch.check()?;
        mesh.faces(range, &mut chunk);
        chunk.iter().for_each(&mut each);
        Ok(())
    })
}

/// Bytes of memory a vertex: three sums while they are made, then both curvatures, areas, what ends, and what is put there.
pub(super) const VERTEX_BYTES: u128 = 3 * 24 + 3 * 8 + 4 + 1 + 4 + 8 + 16;
