//! Which sizes of faces and which valences there are in a net: what decides how it may be split, and its largest faces.

use std::collections::BTreeSet;

use crate::shape::tile::Tile;
use crate::shape::topology::Topology;

/// The sizes of some faces and the valences of some interior vertices, each once.
#[derive(Debug, Clone, Default)]
pub(super) struct Sizes {
    /// Numbers of vertices of faces.
    pub(super) faces: BTreeSet<usize>,
    /// Numbers of faces around interior vertices.
    pub(super) valences: BTreeSet<usize>,
}

impl Sizes {
    /// Adds all faces and interior vertices of a topology, but for the vertices that `leave_out` names.
    pub(super) fn add(&mut self, topology: &Topology, leave_out: impl Fn(usize) -> bool) {
        self.faces.extend((0..topology.n_faces()).map(|f| topology.face(f).len()));
        let inside = (0..topology.n_vertices()).filter(|&v| is_interior(topology, v) && !leave_out(v));
        self.valences.extend(inside.map(|v| topology.ring(v).count()));
    }

    /// After a split of faces that have interior edges, or points inside them: new vertices are regular, but for those in
    /// the middle of faces.
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

    /// Vertices and faces change places.
    pub(super) fn dual(&mut self) {
        std::mem::swap(&mut self.faces, &mut self.valences);
    }

    /// Whether all faces have so many vertices.
    pub(super) fn are_all(&self, size: usize) -> bool {
        self.faces.iter().all(|&found| found == size)
    }

    /// Corners of the largest face.
    pub(super) fn largest_face(&self) -> u128 {
        self.faces.last().map_or(0, |&size| size as u128)
    }

    /// The largest valence.
    pub(super) fn largest_valence(&self) -> u128 {
        self.valences.last().map_or(0, |&valence| valence as u128)
    }
}

/// Whether faces lie all around vertex `v`.
pub(super) fn is_interior(topology: &Topology, v: usize) -> bool {
    !topology.is_isolated(v) && topology.boundary_edges(v).is_none()
}

/// Whether two faces lie all around vertex `v`, so that a dual has no face for it.
pub(super) fn is_between_two(topology: &Topology, v: usize) -> bool {
    is_interior(topology, v) && topology.ring(v).take(3).count() == 2
}
