//! The face sizes and valences that occur in a net, which decide how it may be split and how large its faces are.

use std::collections::BTreeSet;

use crate::shape::tile::Tile;
use crate::shape::topology::Topology;

/// The set of face sizes and the set of valences of interior vertices.
#[derive(Debug, Clone, Default)]
pub(super) struct Sizes {
    /// The sizes of faces.
    pub(super) faces: BTreeSet<usize>,
    /// The valences of interior vertices.
    pub(super) valences: BTreeSet<usize>,
}

impl Sizes {
    /// Adds all faces and interior vertices of a topology, except the vertices for which `leave_out` is true.
    pub(super) fn add(&mut self, topology: &Topology, leave_out: impl Fn(usize) -> bool) {
        self.faces.extend((0..topology.n_faces()).map(|f| topology.face(f).len()));
        let inside = (0..topology.n_vertices()).filter(|&v| is_interior(topology, v) && !leave_out(v));
        self.valences.extend(inside.map(|v| topology.ring(v).count()));
    }

    /// Splits faces that have interior edges or points inside them: new vertices are regular, except those in the
    /// middle of faces.
    pub(super) fn split(&mut self, tile: Tile, pieces: u32) {
        if self.faces.is_empty() {
            return;
        }
        if tile == Tile::Quad && pieces == 2 {
            self.valences.extend(&self.faces);
        }
        self.valences.insert(tile.regular_valence());
        self.faces = [tile.sides() as usize].into();
    }

    /// Exchanges faces and vertices.
    pub(super) fn dual(&mut self) {
        std::mem::swap(&mut self.faces, &mut self.valences);
    }

    /// Returns whether all faces have `size` vertices.
    pub(super) fn are_all(&self, size: usize) -> bool {
        self.faces.iter().all(|&found| found == size)
    }

    /// Returns the size of the largest face, or 0.
    pub(super) fn largest_face(&self) -> u128 {
        self.faces.last().map_or(0, |&size| size as u128)
    }

    /// Returns the largest valence, or 0.
    pub(super) fn largest_valence(&self) -> u128 {
        self.valences.last().map_or(0, |&valence| valence as u128)
    }
}

/// Returns whether vertex `v` is an interior vertex.
pub(super) fn is_interior(topology: &Topology, v: usize) -> bool {
    !topology.is_isolated(v) && topology.boundary_edges(v).is_none()
}

/// Returns whether vertex `v` is interior with only two faces, so that a dual has no face for it.
pub(super) fn is_between_two(topology: &Topology, v: usize) -> bool {
    is_interior(topology, v) && topology.ring(v).take(3).count() == 2
}
