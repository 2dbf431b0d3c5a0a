//! The extraordinary vertices and faces of a mesh under a scheme.

use std::collections::BTreeMap;

use super::sectors::Kind;
use crate::shape::topology::{Topology, index};

/// Most vertices, and faces, of one valence that are named.
/// They are for a look at a few; all are counted. Half of it names fewer; twice of it makes answers about fine meshes
/// of triangles under schemes for quads twice as long.
const MAX_NAMED: usize = 64;

/// Vertices and faces of a mesh that become extraordinary points of one valence.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Extraordinary {
    /// The first of the vertices inside that have so many edges.
    pub vertices: Vec<u32>,
    /// How many there are.
    pub n_vertices: usize,
    /// The first of the faces that have so many corners.
    pub faces: Vec<u32>,
    /// How many there are.
    pub n_faces: usize,
}

impl Extraordinary {
    fn add_vertex(&mut self, v: usize) {
        self.n_vertices += 1;
        if self.vertices.len() < MAX_NAMED {
            self.vertices.push(index(v));
        }
    }
}

/// The boundary vertices of a mesh by their number of faces.
pub(super) fn on_boundary(topology: &Topology) -> BTreeMap<usize, Extraordinary> {
    let mut found: BTreeMap<usize, Extraordinary> = BTreeMap::new();
    let outside = |v: &usize| !topology.is_isolated(*v) && topology.boundary_edges(*v).is_some();
    for v in (0..topology.n_vertices()).filter(outside) {
        found.entry(topology.ring(v).count()).or_default().add_vertex(v);
    }
    found
}

/// The extraordinary vertices inside a mesh, and its faces that are or become such, by valence.
pub(super) fn survey(kind: Kind, topology: &Topology) -> BTreeMap<usize, Extraordinary> {
    let mut found: BTreeMap<usize, Extraordinary> = BTreeMap::new();
    let inside = |v: usize| !topology.is_isolated(v) && topology.boundary_edges(v).is_none();
    for v in (0..topology.n_vertices()).filter(|&v| inside(v)) {
        let valence = topology.valence(v);
        if valence != kind.regular() {
            found.entry(valence).or_default().add_vertex(v);
        }
    }
    // triangles stay what they are
    let faces = if kind == Kind::Triangles { 0 } else { topology.n_faces() };
    for f in 0..faces {
        let corners = topology.face(f).len();
        if corners != kind.regular() {
            let of = found.entry(corners).or_default();
            of.n_faces += 1;
            if of.faces.len() < MAX_NAMED {
                of.faces.push(index(f));
            }
        }
    }
    found
}
