//! Gaussian and mean curvature of meshes.

use rayon::prelude::*;

use super::normals;
use super::scene::{MeshSource, each_face};
use super::vertex_sums::sums;
use crate::kept::Kept;
use crate::math::vector::{cross, dot, minus, plus, times, unit};
use crate::watch::{Stopped, Watch};

/// Curvatures of each vertex; 0 where they are undefined.
#[derive(Debug)]
pub(super) struct Curvatures {
    /// Gaussian curvature, 1 / model units squared: positive on domes and bowls, negative on saddles.
    pub(super) gaussian: Vec<f64>,
    /// Mean curvature, half the sum of the principal curvatures, 1 / model units: positive where the surface bends away
    /// from its normal, as on a sphere whose normals point outwards.
    pub(super) mean: Vec<f64>,
    /// Area of the faces around each vertex, projected along its normal, in units of a power of two near half the
    /// longest side of the mesh squared; 0 where curvature is undefined.
    pub(super) areas: Vec<f64>,
}

/// Minimum of twice the area of the faces around a vertex that define a curvature, in units of half the longest side of
/// the mesh squared. Coordinates are rounded to 16 digits; faces a billionth of the mesh long (this area) have about
/// seven left. Half or twice of it makes a difference only for meshes of 10^17 faces.
const LEAST_CURVED_AREA: f64 = 1e-18;

/// Returns the curvatures of a mesh with these positions (model units), one of each kind per vertex.
///
/// When each vertex p moves along its normal n by t, the area vector of a face, Newell's
/// `1/2 sum (p_i - p_0) x (p_(i+1) - p_0)`, becomes `A + 2 t M + t^2 N`: A belongs to the face, N to the polygon of its
/// normals, and M is the mixed area vector of both. On a smooth surface area grows by the factor `1 + 2 t H + t^2 K`
/// (Steiner's formula). So with sums over the faces around a vertex, projected along its normal,
/// `H = (M . n) / (A . n)` and `K = (N . n) / (A . n)`: the means of the curvatures over these faces.
///
/// The normals are the limit normals of the mesh, if it has them, or [`fitted_normals`]. With the normals of the
/// surface the curvatures are exact on spheres; on other surfaces they converge as h^2 if the edges of length h around
/// a vertex are symmetric up to h^2, as in the regular parts of refined meshes, otherwise as h.
///
/// At the boundary of the mesh or of its smooth parts half of this neighbourhood is missing: vertices there get the
/// mean over the inner vertices of the same faces, if there are any. So do their neighbours, whose curvature would
/// depend on the normals there, unless the mesh has normals of its own.
///
/// Sources: J. Steiner, Monatsbericht der Akademie der Wissenschaften Berlin (1840), 114-118; A. Bobenko, H. Pottmann,
/// J. Wallner, Mathematische Annalen 348 (2010), 1-24, sections 2 and 3.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub(super) fn curvatures(mesh: &dyn MeshSource, positions: &[[f64; 3]], watch: &Watch) -> Result<Curvatures, Stopped> {
    let are_given = mesh.normals().is_some();
    let unit_normals =
        if are_given { normals::of(mesh, positions, watch)? } else { fitted_normals(mesh, positions, watch)? };
    let scale = normals::scale(positions);
    let area = sums(mesh, |face| normals::area_vector(face, positions, scale), |sum| sum, watch)?;
    let mut areas: Vec<f64> = area.par_iter().zip(&*unit_normals).map(|(area, n)| dot(*area, *n)).collect();
    areas.par_iter_mut().for_each(|area| *area = if *area > LEAST_CURVED_AREA { *area } else { 0.0 });
    drop(area);
    // NaN marks vertices without an area
    let over_area = |sums: &[[f64; 3]], unit: f64| -> Vec<f64> {
        let rows = sums.par_iter().zip(&*unit_normals).zip(&areas);
        rows.map(|((sum, n), area)| if *area > 0.0 { unit * (dot(*sum, *n) / area) } else { f64::NAN }).collect()
    };
    let mixed = sums(mesh, |face| mixed_area(face, positions, &unit_normals, scale), |sum| sum, watch)?;
    let mut mean = over_area(&mixed, scale);
    drop(mixed);
    let image = sums(mesh, |face| normals::area_vector(face, &unit_normals, 1.0), |sum| sum, watch)?;
    let mut gaussian = over_area(&image, scale * scale);
    drop(image);
    let mut is_unknown = ends(mesh, watch)?;
    if !are_given && is_unknown.contains(&true) {
        widen(mesh, &mut is_unknown, watch)?;
    }
    for values in [&mut gaussian, &mut mean] {
        fill(mesh, &is_unknown, if are_given { 1 } else { 2 }, values, watch)?;
    }
    Ok(Curvatures { gaussian, mean, areas })
}

/// Returns twice the mixed area vector of a face and the polygon of its normals, with positions multiplied by `scale`.
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

/// Returns unit normals of vertices that are exact if all vertices lie on a sphere, and otherwise are those of a fitted
/// sphere: at each vertex the sum over its faces of `a x b / (|a|^2 |b|^2)`, with a and b the edges to the next and the
/// previous vertex of the face. Around vertices whose neighbourhood is not symmetric, normals weighted by area are off
/// by the edge length h, and curvature computed from them by a constant; these normals are not.
///
/// Source: N. Max, Journal of Graphics Tools 4 (1999) 2, 1-6.
fn fitted_normals(mesh: &dyn MeshSource, positions: &[[f64; 3]], watch: &Watch) -> Result<Kept<[f64; 3]>, Stopped> {
    let scale = normals::scale(positions);
    let mut sums = vec![[0.0; 3]; positions.len()];
    each_face(mesh, watch, |face| {
        let n = face.len();
        let at = |j: usize| times(scale, positions[face[j % n] as usize]);
        for (j, &v) in face.iter().enumerate() {
            let (a, b) = (minus(at(j + 1), at(j)), minus(at(j + n - 1), at(j)));
            let weight = dot(a, a) * dot(b, b);
            if weight > 0.0 {
                sums[v as usize] = plus(sums[v as usize], times(1.0 / weight, cross(a, b)));
            }
        }
    })?;
    sums.par_iter_mut().for_each(|sum| *sum = if sum.iter().all(|x| x.is_finite()) { unit(*sum) } else { [0.0; 3] });
    Ok(sums.into())
}

/// Returns for each vertex whether the faces around it do not close.
///
/// Around a closed vertex each neighbour follows the vertex in one face and precedes it in another, so that the sum of
/// the following minus the preceding neighbours is 0.
fn ends(mesh: &dyn MeshSource, watch: &Watch) -> Result<Vec<bool>, Stopped> {
    let mut balance = vec![0_u32; mesh.n_vertices()];
    each_face(mesh, watch, |face| {
        let n = face.len();
        for (j, &v) in face.iter().enumerate() {
            let (next, before) = (face[(j + 1) % n], face[(j + n - 1) % n]);
            let sum = &mut balance[v as usize];
            *sum = sum.wrapping_add(next).wrapping_sub(before);
        }
    })?;
    Ok(balance.iter().map(|&sum| sum != 0).collect())
}

/// Marks all vertices of the faces that have a marked vertex, in addition to those marked before.
fn widen(mesh: &dyn MeshSource, marked: &mut [bool], watch: &Watch) -> Result<(), Stopped> {
    let before = marked.to_vec();
    each_face(mesh, watch, |face| {
        if face.iter().any(|&v| before[v as usize]) {
            face.iter().for_each(|&v| marked[v as usize] = true);
        }
    })
}

/// Gives vertices without a value the mean of the known values in the faces around them, in `rounds` rounds, one for
/// each layer of marked vertices; vertices that are still without a value keep their own, or 0.
fn fill(
    mesh: &dyn MeshSource,
    is_unknown: &[bool],
    rounds: usize,
    values: &mut [f64],
    watch: &Watch,
) -> Result<(), Stopped> {
    let mut missing: Vec<u32> =
        (0..).zip(values.iter().zip(is_unknown)).filter(|(_, (x, e))| **e || x.is_nan()).map(|(v, _)| v).collect();
    let mut places = vec![u32::MAX; values.len()];
    for _ in 0..rounds {
        if missing.is_empty() {
            return Ok(());
        }
        (0..).zip(&missing).for_each(|(place, &v)| places[v as usize] = place);
        let mut sums = vec![(0.0, 0_u32); missing.len()];
        each_face(mesh, watch, |face| {
            let known = face.iter().filter(|&&v| places[v as usize] == u32::MAX);
            let (sum, n) = known.fold((0.0, 0), |(sum, n), &v| (sum + values[v as usize], n + 1));
            for &v in face.iter().filter(|&&v| places[v as usize] != u32::MAX) {
                let all = &mut sums[places[v as usize] as usize];
                *all = (all.0 + sum, all.1 + n);
            }
        })?;
        let mut rest = Vec::new();
        for (v, (sum, n)) in missing.into_iter().zip(sums) {
            if n > 0 {
                places[v as usize] = u32::MAX;
                values[v as usize] = sum / f64::from(n);
            } else {
                rest.push(v);
            }
        }
        missing = rest;
    }
    for v in missing {
        let value = &mut values[v as usize];
        if value.is_nan() {
            *value = 0.0;
        }
    }
    Ok(())
}

/// Bytes of memory per vertex: normals, a sum while it is computed, both curvatures and areas, the marks before and
/// after they are widened, and the values that are filled in.
pub(super) const CURVATURE_VERTEX_BYTES: u128 = 2 * 24 + 3 * 8 + 2 + 4 + 4 + 16;
