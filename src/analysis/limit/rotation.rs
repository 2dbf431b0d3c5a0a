//! Rotations of the neighbourhood of a vertex from level to level.
//!
//! A step that makes the middles of the faces around a vertex its new neighbours rotates the neighbourhood by half a
//! face: after two such steps each neighbour stands in the direction of the next one. If the neighbours are at the
//! corners of a regular n-gon, the complex numbers `exp(2 pi i j/n)`, a matrix that rotates by k faces multiplies them
//! by `a exp(2 pi i k/n)` with a positive a.
//!
//! Source: L. Kobbelt, SIGGRAPH 2000, 103-112, section 4, which rotates the matrix of two steps back.

use super::cycle::Cycle;
use super::disc::{Centre, Disc, RingCount};
use super::walk::WholeNet;
use crate::math::functions::{cos, real, sin};
use crate::shape::topology::index;

/// Returns the number of faces by which `forth` rotates the neighbours of an inner vertex at the centre of a disc;
/// `None` for other discs. `forth` multiplies a column by a matrix that maps the support of the disc to itself.
pub(super) fn by(disc: &Disc, forth: impl Fn(&[f64]) -> Vec<f64>) -> Option<usize> {
    let faces: Vec<&[u32]> = disc.central_faces().collect();
    if disc.centre() != Centre::Vertex(0) || !disc.is_closed() {
        return None;
    }
    let n = faces.len();
    let angle = |j: usize| std::f64::consts::TAU * real(j % n) / real(n);
    let mut corners = [0, 1].map(|_| vec![0.0; disc.support]);
    for (j, face) in faces.iter().enumerate() {
        let place = *face.get(1)? as usize;
        *corners[0].get_mut(place)? = cos(angle(j));
        *corners[1].get_mut(place)? = sin(angle(j));
    }
    let [x, y] = corners.map(|column| forth(&column));
    // the sum of the new corners, each times the conjugate of the old one
    let sum = faces.iter().enumerate().fold([0.0, 0.0], |[real, imaginary], (j, face)| {
        let (x, y) = (x[face[1] as usize], y[face[1] as usize]);
        let (cos, sin) = (cos(angle(j)), sin(angle(j)));
        [real + x * cos + y * sin, imaginary + y * cos - x * sin]
    });
    let along: Vec<f64> = (0..n).map(|k| sum[0] * cos(angle(k)) + sum[1] * sin(angle(k))).collect();
    (0..n).reduce(|best, k| if along[k] > along[best] { k } else { best })
}

/// Returns for each vertex of the support of a disc the vertex to which a rotation of the disc by `faces` faces takes
/// it; `None` if the rotation does not map the disc to itself.
pub(super) fn places(disc: &Disc, cycle: &Cycle<'_>, rings: RingCount, faces: usize) -> Option<Vec<u32>> {
    let (net, origins) = disc.net(cycle.disc_rules)?;
    let (centre, whole) = (disc.centre(), WholeNet::of(&net, &net.mesh.base));
    let [here, there] = [0, faces].map(|start| whole.walk(centre, whole.starts(centre).nth(start)?, rings));
    let (here, there) = (here?, there?);
    let place = |i: usize| {
        let [from, to] = [&here, &there].map(|found| found.vertices.get(i).map(|&v| origins[v as usize]));
        Some((from?, to?))
    };
    let mut places = (0..disc.support).map(place).collect::<Option<Vec<_>>>()?;
    places.sort_unstable();
    let complete = places.iter().map(|&(from, _)| from).eq(0..index(disc.support));
    let inside = places.iter().all(|&(_, to)| (to as usize) < disc.support);
    (here.disc == there.disc && complete && inside).then(|| places.into_iter().map(|(_, to)| to).collect())
}
