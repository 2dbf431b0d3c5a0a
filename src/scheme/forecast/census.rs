//! Counts of a mesh for the forecast of schemes that rebuild the connectivity.

use super::count::Count;
use crate::scheme::mesh_net::MeshNet;

/// The counts of one mesh; sums saturate, and nothing is allocated for the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Census {
    /// Numbers of vertices, edges and faces, and the sum of the sizes of the faces.
    pub count: Count,
    /// Number of boundary edges, which is also that of boundary vertices.
    pub boundary: u128,
    /// Number of corners, which keep their position.
    pub corners: u128,
    /// Number of vertices without faces.
    pub isolated: u128,
    /// Number of steps of such a scheme since the input.
    pub rounds: u32,
}

impl Census {
    /// Returns the counts of a net that is not split.
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

    /// Returns the size of the topology while it is built, in bytes: four numbers per corner (one of them temporary),
    /// six per edge, and one per vertex and face.
    pub fn bytes(&self) -> u128 {
        let Count { vertices, edges, faces, corners, .. } = self.count;
        sum(&[(16, corners), (24, edges), (4, vertices), (4, faces)])
    }

    /// Returns the counts after a step with these numbers of vertices, faces and corners and this largest face; the
    /// number of edges follows from the corners and the boundary.
    #[must_use]
    pub fn after(&self, [vertices, faces, corners, largest_face]: [u128; 4], boundary: u128) -> Self {
        let edges = corners.saturating_add(boundary) / 2;
        let count = Count { vertices, edges, faces, corners, largest_face, ..Count::default() };
        Self { count, boundary, rounds: self.rounds.saturating_add(1), ..*self }
    }
}

/// Returns the sum of products of counts with small factors.
pub(in crate::scheme) fn sum(terms: &[(u128, u128)]) -> u128 {
    terms.iter().fold(0, |sum: u128, (factor, n)| sum.saturating_add(factor.saturating_mul(*n)))
}
