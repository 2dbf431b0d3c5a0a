//! Where the rings that a line depends on end: at boundaries and creases all around a tube.

use super::Tube;

/// What a ring of a tube is to the rings beyond it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wall {
    /// Smooth: they count, too.
    Smooth,
    /// A boundary or a crease all around: the curve rule alone holds on it, and nothing beyond it counts.
    End,
}

impl Tube<'_> {
    /// Whether a ring is smooth or ends the tube; an error where it is disturbed.
    pub(super) fn wall(&self, ring: &[u32]) -> Result<Wall, String> {
        if ring.iter().any(|v| self.mesh.corners.binary_search(v).is_ok()) {
            return Err("a vertex is a corner".into());
        }
        if ring.iter().any(|&v| !self.on_line[v as usize]) {
            return Err("a vertex has more than two latitude edges".into());
        }
        let n = ring.len();
        let walls = (0..n).map(|i| {
            let neighbours = [ring[(i + n - 1) % n], ring[(i + 1) % n]];
            let mut sharp = self.sharp_neighbours(ring[i]);
            sharp.sort_unstable();
            sharp.dedup();
            match sharp.as_slice() {
                [] => Some(Wall::Smooth),
                [a, b] if [[*a, *b], [*b, *a]].contains(&neighbours) => Some(Wall::End),
                _ => None,
            }
        });
        let mut walls = walls.collect::<Vec<_>>().into_iter();
        let first = walls.next().flatten();
        let wall = first.filter(|_| walls.all(|wall| wall == first));
        wall.ok_or("an edge is sharp, or on the boundary, and not all around the tube".into())
    }

    /// The vertices at the other ends of the sharp edges and boundary edges of `v`, perhaps several times.
    fn sharp_neighbours(&self, v: u32) -> Vec<u32> {
        let topology = &self.mesh.topology;
        let edges = topology.ring(v as usize).flat_map(|c| [topology.edge(c), topology.edge(topology.previous(c))]);
        let sharp = edges.filter(|&e| {
            let tagged = self.mesh.creases.binary_search_by_key(&e, |&(edge, _)| edge).is_ok();
            tagged || topology.is_boundary_edge(e as usize)
        });
        let ends = sharp.map(|e| topology.ends(e as usize));
        ends.map(|[a, b]| if a == v { b } else { a }).collect()
    }
}
