//! The extraordinary vertices and faces of a mesh under a scheme.

use std::collections::BTreeMap;

use super::sectors::NetKind;
use crate::shape::topology::{Topology, index};

/// Maximum number of vertices, and of faces, of one valence that are listed. Lists are for a look at a few; all are
/// counted. Half of it lists fewer; twice of it makes answers about fine meshes of triangles under schemes for quads
/// twice as long.
const MAX_LISTED_OF_VALENCE: usize = 64;

/// The vertices and faces of a mesh with one valence; a survey keeps those that are or become extraordinary.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Extraordinary {
    /// The first of the vertices, by index.
    pub vertices: Vec<u32>,
    /// The number of vertices.
    pub n_vertices: usize,
    /// The first of the faces, by index.
    pub faces: Vec<u32>,
    /// The number of faces.
    pub n_faces: usize,
}

impl Extraordinary {
    fn add_vertex(&mut self, v: usize) {
        self.n_vertices += 1;
        if self.vertices.len() < MAX_LISTED_OF_VALENCE {
            self.vertices.push(index(v));
        }
    }
}

/// Returns the boundary vertices of a mesh by their number of faces.
pub(super) fn on_boundary(topology: &Topology) -> BTreeMap<usize, Extraordinary> {
    let mut found: BTreeMap<usize, Extraordinary> = BTreeMap::new();
    let outside = |v: &usize| !topology.is_isolated(*v) && topology.boundary_edges(*v).is_some();
    for v in (0..topology.n_vertices()).filter(outside) {
        found.entry(topology.ring(v).count()).or_default().add_vertex(v);
    }
    found
}

/// Returns the extraordinary vertices inside a mesh, and the faces that are or become extraordinary, by valence.
pub(super) fn survey(kind: NetKind, topology: &Topology) -> BTreeMap<usize, Extraordinary> {
    let mut found: BTreeMap<usize, Extraordinary> = BTreeMap::new();
    let inside = |v: usize| !topology.is_isolated(v) && topology.boundary_edges(v).is_none();
    for v in (0..topology.n_vertices()).filter(|&v| inside(v)) {
        let valence = topology.valence(v);
        if valence != kind.regular() {
            found.entry(valence).or_default().add_vertex(v);
        }
    }
    // schemes on triangles refine triangles only, which never become extraordinary points
    let faces = if kind == NetKind::Triangles { 0 } else { topology.n_faces() };
    for f in 0..faces {
        let corners = topology.face(f).len();
        if corners != kind.regular() {
            let of = found.entry(corners).or_default();
            of.n_faces += 1;
            if of.faces.len() < MAX_LISTED_OF_VALENCE {
                of.faces.push(index(f));
            }
        }
    }
    found
}
