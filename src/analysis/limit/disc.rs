//! Discs: the faces around a vertex, an edge or a face, numbered in an order that depends only on their connectivity.

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

/// The vertex, edge or face that a disc lies around.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::analysis) enum Centre {
    /// A vertex.
    Vertex(u32),
    /// The edge of a half-edge. Under dual schemes it takes the place of a boundary vertex with an even number of
    /// faces, or of an inner vertex with two.
    Edge(u32),
    /// A face. Under dual schemes it takes the place of a vertex.
    Face(u32),
}

/// The number of rings of faces of a disc.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct RingCount {
    /// Number of rings whose vertices influence the limit.
    pub(super) support: usize,
    /// Number of rings whose connectivity influences the limit; at least `support`.
    pub(super) disc: usize,
}

/// The faces at a vertex, without further rings.
pub(super) const NEAREST: RingCount = RingCount { support: 1, disc: 1 };

/// The connectivity of a disc and all else that the weights of its limit depend on.
///
/// Vertices are numbered ring by ring around the centre. The centre is vertex 0, or the edge or face of the first
/// vertices, with which face 0 then begins.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Disc {
    /// Number of vertices of the face or the edge at the centre; 0 where the centre is a vertex.
    pub(super) central: u32,
    /// Number of vertices within the rings of the support; they have the lowest numbers.
    pub(super) support: usize,
    pub(super) n_vertices: usize,
    /// Number of steps of a scheme with its own connectivity that led to the net, as far as it matters.
    pub(super) rounds: u32,
    /// What rules need to know of the net beyond the disc, if anything.
    pub(super) surroundings: Option<Surroundings>,
    /// Number of vertices of each face.
    pub(super) sizes: Vec<u32>,
    /// The vertices of the faces, face after face.
    pub(super) vertices: Vec<u32>,
    /// Vertices that keep their place, ascending.
    pub(super) fixed: Vec<u32>,
    /// The half-edges of sharp edges with the bits of their sharpness, ascending.
    pub(super) sharp_edges: Vec<(u32, u64)>,
    /// The sharp vertices with the bits of their sharpness, ascending.
    pub(super) sharp_vertices: Vec<(u32, u64)>,
    /// The direction of the edge of each half-edge; empty if no edges have directions.
    pub(super) directions: Vec<Direction>,
}

/// A disc with its location in a net.
#[derive(Debug, Clone)]
pub(super) struct Located {
    /// The disc.
    pub(super) disc: Disc,
    /// For each vertex of the disc its number in the net.
    pub(super) vertices: Vec<u32>,
    /// For each face of the disc the half-edge of the net with which it begins here.
    pub(super) half_edges: Vec<u32>,
    /// The number of the start of the walk, counted from the first half-edge in the ring of the centre.
    pub(super) rotation: usize,
}

impl Disc {
    /// Returns the centre, in the numbers of the disc.
    pub(super) fn centre(&self) -> Centre {
        match self.central {
            0 => Centre::Vertex(0),
            2 => Centre::Edge(0),
            _ => Centre::Face(0),
        }
    }

    /// Returns the weights of the support's vertices in the centre: 1 for a central vertex, or the mean of the vertices
    /// of the central edge or face.
    pub(super) fn middle(&self) -> Vec<f64> {
        let mut weights = vec![0.0; self.support];
        if self.central == 0 {
            weights[0] = 1.0;
        } else {
            weights[..self.central as usize].fill(1.0 / f64::from(self.central));
        }
        weights
    }

    /// Returns the faces, one slice of vertices each; those at the centre come first, and each begins with its vertex
    /// nearest to the centre.
    pub(super) fn faces(&self) -> impl Iterator<Item = &[u32]> {
        let mut rest = self.vertices.as_slice();
        self.sizes.iter().map(move |&size| {
            let (face, after) = rest.split_at(size as usize);
            rest = after;
            face
        })
    }

    /// Returns the faces around the central vertex, or the central face, or the face that begins with the central edge.
    pub(super) fn central_faces(&self) -> impl Iterator<Item = &[u32]> {
        let central = self.central as usize;
        let at_centre = move |(i, face): &(usize, &[u32])| if central == 0 { face[0] == 0 } else { *i == 0 };
        self.faces().enumerate().take_while(at_centre).map(|(_, face)| face)
    }

    /// Returns whether faces lie all around the central vertex.
    pub(super) fn is_closed(&self) -> bool {
        let mut faces = self.central_faces();
        let first = faces.next().unwrap_or_default();
        first.get(1) == faces.last().unwrap_or(first).last()
    }

    /// Describes the centre in words, because its number would belong to a net that the client never sees.
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

    /// Returns whether the edge of a half-edge, numbered over all faces, is infinitely sharp.
    pub(super) fn is_sharp_for_ever(&self, half_edge: usize) -> bool {
        let found = self.sharp_edges.binary_search_by_key(&index(half_edge), |&(half_edge, _)| half_edge);
        found.is_ok_and(|at| f64::from_bits(self.sharp_edges[at].1) >= INFINITE_SHARPNESS)
    }

    /// Returns the disc as a net of its own, and for each vertex of the net the vertex of the disc; `None` if the faces
    /// are no valid mesh.
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
        // in a plan with a D, nothing is tagged that the D would lose
        let mut net = net.carrying(None, directions);
        net.tags = Tags { lost_by_dual: None, boundary, cut, ..net.tags };
        net.mesh.rounds = self.rounds;
        net.surroundings = self.surroundings;
        Some((net, origins))
    }
}

/// Returns the faces without those that have two or more edges on the boundary; `None` if there are none of these. A
/// scheme that cuts boundary edges in some steps only cuts at most one edge of a face, and a disc may have faces with
/// more where it ends at the boundary of its mesh.
fn without_ears(topology: &Topology) -> Option<FaceList> {
    let is_ear = |&f: &usize| topology.half_edges(f).filter(|&half_edge| topology.twin(half_edge) == NONE).count() > 1;
    (0..topology.n_faces()).find(is_ear)?;
    Some((0..topology.n_faces()).filter(|f| !is_ear(f)).map(|f| topology.face(f).iter().copied()).collect())
}

/// Returns whether there are faces and all of them are triangles.
pub(super) fn is_triangular(topology: &Topology) -> bool {
    topology.n_faces() > 0 && (0..topology.n_faces()).all(|f| topology.face(f).len() == 3)
}
