//! Properties of a whole mesh that are needed to refine a part of it.

use crate::shape::topology::Topology;

/// Properties of the whole mesh on which the split of a part depends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Surroundings {
    /// Whether all faces are quads.
    pub quads: bool,
    /// Whether each interior vertex has valence 4, apart from those between two faces.
    pub regular: bool,
}

impl Surroundings {
    /// Returns the properties of a whole mesh.
    pub fn of(topology: &Topology) -> Self {
        let regular = |v: usize| {
            let n = topology.ring(v).take(5).count();
            topology.boundary_edges(v).is_some() || n <= 2 || n == 4
        };
        Self { quads: topology.is_quads(), regular: (0..topology.n_vertices()).all(regular) }
    }

    /// Returns the properties after an upsampling into quads, which puts a vertex into the middle of every other face.
    pub(super) fn after_split(self) -> Self {
        Self { quads: true, regular: self.regular && self.quads }
    }

    /// Returns the properties after a D, which exchanges vertices and faces.
    pub(super) fn after_dual(self) -> Self {
        Self { quads: self.regular, regular: self.quads }
    }
}
