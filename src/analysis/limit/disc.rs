//! Discs: the faces around a vertex, an edge or a face, numbered in an order that depends on their connectivity only.

use std::sync::Arc;

use super::disc_rules::DiscRules;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::sharpness::Sharpness;
use crate::scheme::surroundings::Surroundings;
use crate::scheme::tags::{Boundary, Tags};
use crate::shape::check::{FaceList, Winding};
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::directions::{Direction, Directions};
use crate::shape::topology::{NONE, Topology, index};

/// What a disc lies around.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::analysis) enum Centre {
    /// A vertex.
    Vertex(u32),
    /// The edge of a half-edge, as dual schemes have it where a boundary was.
    Edge(u32),
    /// A face, as dual schemes have it around their limit points.
    Face(u32),
}

/// How many rings of faces belong to a disc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rings {
    /// Rings whose vertices decide about the limit.
    pub(super) support: usize,
    /// Rings whose connectivity decides about it; at least as many.
    pub(super) disc: usize,
}

/// The connectivity of a disc and everything else that the weights of its limit depend on.
///
/// Vertices are numbered ring by ring around the centre; the centre is vertex 0, or the edge or the face of the first
/// vertices, which then begins the first face.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Disc {
    /// Number of vertices of the face or the edge at the centre; 0 where the centre is a vertex.
    pub(super) central: u32,
    /// Number of vertices within the rings that decide about the limit.
    pub(super) support: usize,
    pub(super) n_vertices: usize,
    pub(super) rounds: u32,
    pub(super) surroundings: Option<Surroundings>,
    pub(super) sizes: Vec<u32>,
    pub(super) vertices: Vec<u32>,
    /// Vertices that keep their place, ascending.
    pub(super) fixed: Vec<u32>,
    /// The bits of the sharpness of edges, each at its half-edges, and of vertices; ascending.
    pub(super) sharp_edges: Vec<(u32, u64)>,
    pub(super) sharp_vertices: Vec<(u32, u64)>,
    /// The direction of the edge of each half-edge, where edges have any.
    pub(super) directions: Vec<Direction>,
}

/// A disc and where it was found.
#[derive(Debug, Clone)]
pub(super) struct Located {
    /// The disc.
    pub(super) disc: Disc,
    /// For each of its vertices the number in the whole.
    pub(super) vertices: Vec<u32>,
    /// For each of its faces the half-edge in the whole net that is the first one here.
    pub(super) half_edges: Vec<u32>,
    /// Where the walk started: this many half-edges after the first in the ring of the centre.
    pub(super) rotation: usize,
}

impl Disc {
    /// The centre, in the numbers of the disc.
    pub(super) fn centre(&self) -> Centre {
        match self.central {
            0 => Centre::Vertex(0),
            2 => Centre::Edge(0),
            _ => Centre::Face(0),
        }
    }

    /// The centre as weights of vertices: itself, or the mean of the vertices of the edge or face.
    pub(super) fn middle(&self) -> Vec<f64> {
        let mut weights = vec![0.0; self.support];
        if self.central == 0 {
            weights[0] = 1.0;
        } else {
            weights[..self.central as usize].fill(1.0 / f64::from(self.central));
        }
        weights
    }

    /// The faces, one slice of vertices each, those at the centre first and each starting nearest to it.
    pub(super) fn faces(&self) -> impl Iterator<Item = &[u32]> {
        let mut rest = self.vertices.as_slice();
        self.sizes.iter().map(move |&size| {
            let (face, after) = rest.split_at(size as usize);
            rest = after;
            face
        })
    }

    /// The faces around the vertex at the centre, the one that is the centre, or the one that begins with its edge.
    pub(super) fn central_faces(&self) -> impl Iterator<Item = &[u32]> {
        let central = self.central as usize;
        let at_centre = move |(i, face): &(usize, &[u32])| if central == 0 { face[0] == 0 } else { *i == 0 };
        self.faces().enumerate().take_while(at_centre).map(|(_, face)| face)
    }

    /// Whether faces lie all around the vertex at the centre.
    pub(super) fn is_closed(&self) -> bool {
        let mut faces = self.central_faces();
        let first = faces.next().unwrap_or_default();
        first.get(1) == faces.last().unwrap_or(first).last()
    }

    /// What the centre is, in words: its number would be one of a net that the client never sees.
    pub(super) fn describe(&self) -> String {
        let has_edge = |face: &&[u32]| face.contains(&0) && face.contains(&1);
        let (kind, n) = match self.central as usize {
            0 if self.fixed.first() == Some(&0) => ("a corner", self.central_faces().count()),
            0 if !self.is_closed() => ("a boundary vertex", self.central_faces().count()),
            0 => ("an interior vertex", self.central_faces().count()),
            2 if self.faces().filter(has_edge).count() < 2 => return "a boundary vertex".to_owned(),
            n => ("an interior vertex", n),
        };
        format!("{kind} with {n} {}", if n == 1 { "face" } else { "faces" })
    }

    /// Whether the edge of a half-edge, counted over all faces, stays sharp for ever.
    pub(super) fn is_sharp_for_ever(&self, half_edge: usize) -> bool {
        let found = self.sharp_edges.binary_search_by_key(&index(half_edge), |&(half_edge, _)| half_edge);
        found.is_ok_and(|at| f64::from_bits(self.sharp_edges[at].1) >= INFINITE_SHARPNESS)
    }

    /// The disc as a net of its own, with the origin of each of its vertices in the disc.
    pub(super) fn net(&self, disc_rules: DiscRules) -> Option<(MeshNet, Vec<u32>)> {
        let DiscRules { rules, boundary, cut, boundary_every } = disc_rules;
        let faces = self.faces().map(|face| face.iter().copied()).collect();
        let mut checked = Topology::of_faces(self.n_vertices, faces, Winding::Refuse).ok()?;
        if boundary_every > 1 && (self.rounds + 1).is_multiple_of(boundary_every) {
            while let Some(faces) = without_ears(&checked.topology) {
                checked = Topology::of_faces(self.n_vertices, faces, Winding::Refuse).ok()?;
            }
        }
        let origins = (0..index(self.n_vertices)).chain(checked.split_from).collect();
        let topology = Arc::new(checked.topology);
        let read = |&(at, bits): &(u32, u64)| (at, f64::from_bits(bits));
        let mut edges: Vec<(u32, f64)> = self.sharp_edges.iter().map(read).collect();
        edges.iter_mut().for_each(|(half_edge, _)| *half_edge = topology.edge(*half_edge));
        edges.sort_unstable_by_key(|&(e, _)| e);
        edges.dedup_by_key(|&mut (e, _)| e);
        let vertices = self.sharp_vertices.iter().map(read).collect();
        let net = MeshNet::new(topology, &self.fixed, &[], Boundary::EdgeOnly);
        let net = net.with_sharpness(Sharpness::of(&edges, &vertices), rules);
        let mut directions = vec![Direction::default(); net.mesh.base.n_edges()];
        for (half_edge, &direction) in self.directions.iter().enumerate() {
            directions[net.mesh.base.edge(index(half_edge)) as usize] = direction;
        }
        let directions = (!self.directions.is_empty()).then(|| Directions::of_edges(directions));
        // nothing that a D would lose was tagged where there is one
        let mut net = net.carrying(None, directions);
        net.tags = Tags { lost_by_dual: None, boundary, cut, ..net.tags };
        net.mesh.rounds = self.rounds;
        net.surroundings = self.surroundings;
        Some((net, origins))
    }
}

/// The faces without those that have two edges on the boundary, if there are any: a scheme that cuts boundary
/// edges in some steps only cuts one of a face at most, and where a disc ends at the boundary of its mesh it may have
/// such faces.
fn without_ears(topology: &Topology) -> Option<FaceList> {
    let is_ear = |&f: &usize| topology.half_edges(f).filter(|&half_edge| topology.twin(half_edge) == NONE).count() > 1;
    (0..topology.n_faces()).find(is_ear)?;
    Some((0..topology.n_faces()).filter(|f| !is_ear(f)).map(|f| topology.face(f).iter().copied()).collect())
}

/// Whether every face is a triangle.
pub(super) fn is_triangular(topology: &Topology) -> bool {
    topology.n_faces() > 0 && (0..topology.n_faces()).all(|f| topology.face(f).len() == 3)
}
