//! Counts of a mesh and of what decides how they grow, for schemes that make a connectivity of their own.

use super::count::Count;
use crate::scheme::mesh_net::MeshNet;

/// Counts of one mesh. Numbers saturate; nothing is allocated for them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Census {
    /// Vertices, edges, faces and the sum of the sizes of the faces.
    pub count: Count,
    /// Boundary edges, which are as many as boundary vertices.
    pub boundary: u128,
    /// Vertices that keep their place.
    pub corners: u128,
    /// Vertices without a face.
    pub isolated: u128,
    /// Steps of such a scheme since the mesh was given.
    pub rounds: u32,
}

impl Census {
    /// The counts of a net that is not split.
    pub fn of(net: &MeshNet) -> Self {
        let topology = &net.mesh.base;
        Self {
            count: Count::of_base(net),
            boundary: topology.n_boundary() as u128,
            corners: net.tags.corners.len() as u128,
            isolated: (0..topology.n_vertices()).filter(|&v| topology.is_isolated(v)).count() as u128,
            rounds: net.mesh.rounds,
        }
    }

    /// Bytes of the topology while it is made: four numbers a corner, one of them on the way only, six an edge, and one
    /// a vertex and a face.
    pub fn bytes(&self) -> u128 {
        let Count { vertices, edges, faces, corners, .. } = self.count;
        sum(&[(16, corners), (24, edges), (4, vertices), (4, faces)])
    }

    /// The counts after a step with these vertices, faces, corners and largest face: the edges follow from the sizes of
    /// the faces and the boundary.
    #[must_use]
    pub fn after(&self, [vertices, faces, corners, largest_face]: [u128; 4], boundary: u128) -> Self {
        let edges = corners.saturating_add(boundary) / 2;
        let count = Count { vertices, edges, faces, corners, largest_face, ..Count::default() };
        Self { count, boundary, rounds: self.rounds.saturating_add(1), ..*self }
    }
}

/// A sum of products of counts with small factors.
pub(in crate::scheme) fn sum(terms: &[(u128, u128)]) -> u128 {
    terms.iter().fold(0, |sum: u128, (factor, n)| sum.saturating_add(factor.saturating_mul(*n)))
}
