//! What has to be known of a whole mesh to refine a part of it.

use crate::shape::topology::Topology;

/// Into how many pieces the faces of a part are split depends on all faces of the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Surroundings {
    /// Whether all faces are quads.
    pub quads: bool,
    /// Whether four faces are around each inner vertex, but for those between two faces.
    pub regular: bool,
}

impl Surroundings {
    /// Returns what a whole mesh has.
    pub fn of(topology: &Topology) -> Self {
        let regular = |v: usize| {
            let n = topology.ring(v).take(5).count();
            topology.boundary_edges(v).is_some() || n <= 2 || n == 4
        };
        Self { quads: topology.is_quads(), regular: (0..topology.n_vertices()).all(regular) }
    }

    /// After an upsampling into quads, which puts vertices in the middle of faces that are none.
    pub(super) fn after_split(self) -> Self {
        Self { quads: true, regular: self.regular && self.quads }
    }

    /// After a D, under which vertices and faces change places.
    pub(super) fn after_dual(self) -> Self {
        Self { quads: self.regular, regular: self.quads }
    }
}
