//! Finds coincident boundary edges, which files with duplicated vertices leave in a closed surface.

use super::mesh::Mesh;
use super::repairs::{AffectedEdges, Repair};
use super::topology::index;

/// The positions of the two ends of an edge as bits, the lower first.
type EdgePositions = [[u64; 3]; 2];

impl Mesh {
    /// Returns the boundary edges that coincide with others, if any; refinement opens gaps along them. Edges that were
    /// cut apart on reading do not count, as their ends were given as the same vertices.
    pub fn doubled_boundary(&self) -> Option<Repair> {
        let topology = &self.topology;
        let place = |v: u32| self.positions.as_chunks::<3>().0[v as usize].map(|x| (x + 0.0).to_bits());
        let given = topology.n_vertices() - self.split_from.len();
        let original = |v: u32| (v as usize).checked_sub(given).map_or(v, |part| self.split_from[part]);
        let open = (0..topology.n_edges()).filter(|&e| topology.is_boundary_edge(e));
        let mut edges: Vec<(EdgePositions, u32)> = open
            .map(|e| {
                let mut ends = topology.ends(e).map(place);
                ends.sort_unstable();
                (ends, index(e))
            })
            .collect();
        edges.sort_unstable();
        let ends = |e: u32| {
            let [a, b] = topology.ends(e as usize).map(original);
            [a.min(b), a.max(b)]
        };
        let groups = edges.chunk_by(|a, b| a.0 == b.0);
        let apart = groups.filter(|group| group.iter().any(|&(_, e)| ends(e) != ends(group[0].1)));
        let mut doubled: Vec<u32> = apart.flatten().map(|&(_, e)| e).collect();
        doubled.sort_unstable();
        AffectedEdges::some(doubled.into_iter().map(|e| topology.ends(e as usize))).map(Repair::Doubled)
    }
}
