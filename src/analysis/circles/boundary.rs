//! Finds where the rings that a latitude line depends on end: at boundaries, and at creases all around a tube.

use crate::math::distinct::distinct;
use crate::shape::mesh::Mesh;

/// How a ring of a tube relates to the rings beyond it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RingContinuation {
    /// A smooth ring; the rings beyond it have an influence.
    Smooth,
    /// A boundary or a crease all around the tube: only the curve rule applies on it, and rings beyond it have no
    /// influence.
    End,
}

/// Classifies a ring of a mesh. `on_line` says for each vertex whether it has exactly two latitude edges.
///
/// # Errors
/// A sentence if the ring is not the same all around.
pub(super) fn beyond(mesh: &Mesh, on_line: &[bool], ring: &[u32]) -> Result<RingContinuation, String> {
    if ring.iter().any(|v| mesh.corners.binary_search(v).is_ok()) {
        return Err("a vertex is a corner".into());
    }
    if ring.iter().any(|&v| !on_line[v as usize]) {
        return Err("a vertex has more than two latitude edges".into());
    }
    let n = ring.len();
    let kinds = (0..n).map(|i| {
        let neighbours = [ring[(i + n - 1) % n], ring[(i + 1) % n]];
        match distinct(sharp_neighbours(mesh, ring[i])).as_slice() {
            [] => Some(RingContinuation::Smooth),
            [a, b] if [[*a, *b], [*b, *a]].contains(&neighbours) => Some(RingContinuation::End),
            _ => None,
        }
    });
    let mut kinds = kinds.collect::<Vec<_>>().into_iter();
    let first = kinds.next().flatten();
    let common = first.filter(|_| kinds.all(|kind| kind == first));
    common.ok_or("an edge is sharp, or on the boundary, and not all around the tube".into())
}

/// Returns the other ends of the sharp edges and boundary edges of `v`, possibly with repetitions.
fn sharp_neighbours(mesh: &Mesh, v: u32) -> impl Iterator<Item = u32> {
    let topology = &mesh.topology;
    let sharp = topology.edges_at(v as usize).filter(|&e| {
        let tagged = mesh.creases.binary_search_by_key(&e, |&(edge, _)| edge).is_ok();
        tagged || topology.is_boundary_edge(e as usize)
    });
    sharp.map(move |e| topology.other_end(e as usize, v as usize))
}
