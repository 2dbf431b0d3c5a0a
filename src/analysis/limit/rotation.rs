//! Rotations of what is around a vertex from level to level.
//!
//! A step that puts the middles of faces around a vertex, between its neighbours, rotates what is there: two such steps
//! lead from the place of a neighbour to that of the next one. Where neighbours stand at the corners of a regular
//! n-gon, as the complex numbers `exp(2 pi i j/n)`, a matrix that rotates by k faces multiplies them by
//! `a exp(2 pi i k/n)`, with a positive a.
//!
//! Source: L. Kobbelt, SIGGRAPH 2000, 103-112, section 4, where the matrix of two steps is turned back.

use super::cycle::Cycle;
use super::patch::{Centre, Patch, Rings};
use super::walk::WholeNet;
use crate::math::functions::{cos, real, sin};
use crate::shape::topology::index;

/// By how many faces `forth`, a matrix that maps the support of a patch to itself, turns the neighbours of the vertex
/// inside at its centre; `None` for other patches.
pub(super) fn by(patch: &Patch, forth: impl Fn(&[f64]) -> Vec<f64>) -> Option<usize> {
    let faces: Vec<&[u32]> = patch.central_faces().collect();
    if patch.centre() != Centre::Vertex(0) || !patch.is_closed() {
        return None;
    }
    let n = faces.len();
    let angle = |j: usize| std::f64::consts::TAU * real(j % n) / real(n);
    let mut corners = [0, 1].map(|_| vec![0.0; patch.support]);
    for (j, face) in faces.iter().enumerate() {
        let place = *face.get(1)? as usize;
        *corners[0].get_mut(place)? = cos(angle(j));
        *corners[1].get_mut(place)? = sin(angle(j));
    }
    let [x, y] = corners.map(|column| forth(&column));
    // the sum of the new corners times the conjugates of the old ones
    let sum = faces.iter().enumerate().fold([0.0, 0.0], |[real, imaginary], (j, face)| {
        let (x, y) = (x[face[1] as usize], y[face[1] as usize]);
        let (cos, sin) = (cos(angle(j)), sin(angle(j)));
        [real + x * cos + y * sin, imaginary + y * cos - x * sin]
    });
    let along: Vec<f64> = (0..n).map(|k| sum[0] * cos(angle(k)) + sum[1] * sin(angle(k))).collect();
    (0..n).reduce(|best, k| if along[k] > along[best] { k } else { best })
}

/// For each vertex of the support of a patch the one in whose place it comes when the patch is turned by so many faces;
/// `None` where it does not look the same then.
pub(super) fn places(patch: &Patch, cycle: &Cycle<'_>, rings: Rings, faces: usize) -> Option<Vec<u32>> {
    let (net, origins) = patch.net(cycle.patch_rules)?;
    let (centre, whole) = (patch.centre(), WholeNet::of(&net, &net.mesh.base));
    let [here, there] = [0, faces].map(|start| whole.walk(centre, whole.starts(centre).nth(start)?, rings));
    let (here, there) = (here?, there?);
    let place = |i: usize| {
        let [from, to] = [&here, &there].map(|found| found.vertices.get(i).map(|&v| origins[v as usize]));
        Some((from?, to?))
    };
    let mut places = (0..patch.support).map(place).collect::<Option<Vec<_>>>()?;
    places.sort_unstable();
    let complete = places.iter().map(|&(from, _)| from).eq(0..index(patch.support));
    let inside = places.iter().all(|&(_, to)| (to as usize) < patch.support);
    (here.patch == there.patch && complete && inside).then(|| places.into_iter().map(|(_, to)| to).collect())
}
