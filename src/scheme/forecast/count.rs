//! The counts of one net, and how operators change them.

use crate::scheme::mesh_net::MeshNet;
use crate::scheme::settings::LetterSettings;
use crate::shape::tile::Tile;
use crate::shape::topology::index;

/// The counts of one net.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Count {
    /// Number of points or vertices.
    pub vertices: u128,
    /// Number of edges (of a polygon: pairs of neighbouring points).
    pub edges: u128,
    /// Number of faces, hidden ones included; 0 for polygons.
    pub faces: u128,
    /// Sum of the sizes of all faces.
    pub corners: u128,
    /// Number of hidden faces.
    pub hidden_faces: u128,
    /// Sum of the sizes of the hidden faces.
    pub hidden_corners: u128,
    /// Upper bound of the number of vertices added where normals differ across sharp edges.
    pub split_vertices: u128,
    /// Number of places with texture coordinates; 0 without them.
    pub uvs: u128,
    /// Number of places of all channels with seams.
    pub seamed: u128,
    /// Number of vertices of the unfolded mesh, with one vertex per place of all seams together; 0 without seams.
    pub unfolded: u128,
    /// Size of the largest shown face; 0 without faces.
    pub largest_face: u128,
    /// Size of the largest face that D makes from a vertex: the number of its faces, plus two on the boundary.
    pub largest_fan: u128,
}

impl Count {
    /// Returns the sum of the counts of two nets.
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            vertices: self.vertices.saturating_add(other.vertices),
            edges: self.edges.saturating_add(other.edges),
            faces: self.faces.saturating_add(other.faces),
            corners: self.corners.saturating_add(other.corners),
            hidden_faces: self.hidden_faces.saturating_add(other.hidden_faces),
            hidden_corners: self.hidden_corners.saturating_add(other.hidden_corners),
            split_vertices: self.split_vertices.saturating_add(other.split_vertices),
            uvs: self.uvs.saturating_add(other.uvs),
            seamed: self.seamed.saturating_add(other.seamed),
            unfolded: self.unfolded.saturating_add(other.unfolded),
            largest_face: self.largest_face.max(other.largest_face),
            largest_fan: self.largest_fan.max(other.largest_fan),
        }
    }

    /// Returns the counts of a net.
    pub(super) fn of_mesh(net: &MeshNet) -> Self {
        let sizes = net.tags.holes.iter().map(|&f| net.mesh.base.face(f as usize).len() as u128);
        let hidden_faces = net.tags.holes.len() as u128;
        let count = Self { hidden_faces, hidden_corners: sizes.sum(), ..Self::of_base(net) };
        net.mesh.pieces.iter().fold(count, |count, &pieces| count.split(net.mesh.tile, pieces))
    }

    /// Returns the counts of a net before its splits, counting hidden faces as shown.
    pub(super) fn of_base(net: &MeshNet) -> Self {
        let topology = &net.mesh.base;
        let shown = (0..topology.n_faces()).filter(|&f| net.tags.holes.binary_search(&index(f)).is_err());
        let fan = |v: usize| topology.ring(v).count() + if topology.boundary_edges(v).is_some() { 2 } else { 0 };
        Self {
            vertices: topology.n_vertices() as u128,
            edges: topology.n_edges() as u128,
            faces: topology.n_faces() as u128,
            corners: topology.n_half_edges() as u128,
            largest_face: shown.map(|f| topology.face(f).len()).max().unwrap_or(0) as u128,
            largest_fan: (0..topology.n_vertices()).map(fan).max().unwrap_or(0) as u128,
            ..Self::default()
        }
    }

    /// Returns the counts after a split into `pieces` pieces per edge: of faces of any size into quads if that is 2,
    /// else of triangles or quads only.
    pub(super) fn split(self, tile: Tile, pieces: u32) -> Self {
        if tile == Tile::Quad && pieces == 2 {
            return self.halved();
        }
        let d = pieces as usize;
        let [points, edges] =
            [tile.inner_vertices(d), tile.inner_edges(d)].map(|n| self.faces.saturating_mul(n as u128));
        let cells = |n: u128| n.saturating_mul(u128::from(pieces) * u128::from(pieces));
        let regular = match tile {
            _ if self.faces == 0 => 0,
            Tile::Quad => 4,
            // without inner edges, all new vertices lie on the boundary
            Tile::Triangle if pieces == 2 && self.corners == self.edges => 5,
            Tile::Triangle => 6,
        };
        Self {
            vertices: self.vertices.saturating_add(self.edges.saturating_mul(d as u128 - 1)).saturating_add(points),
            edges: self.edges.saturating_mul(d as u128).saturating_add(edges),
            faces: cells(self.faces),
            corners: cells(self.corners),
            hidden_faces: cells(self.hidden_faces),
            hidden_corners: cells(self.hidden_corners),
            largest_face: if self.faces > 0 { tile.sides().into() } else { 0 },
            largest_fan: self.largest_fan.max(regular),
            ..self
        }
    }

    /// Returns the counts after a U of arity 2: V + E + F vertices, 2 E + (sum of face sizes) edges, one quad per
    /// corner.
    fn halved(self) -> Self {
        let four = |n: u128| n.saturating_mul(4);
        Self {
            vertices: self.vertices.saturating_add(self.edges).saturating_add(self.faces),
            edges: self.edges.saturating_mul(2).saturating_add(self.corners),
            faces: self.corners,
            corners: four(self.corners),
            hidden_faces: self.hidden_corners,
            hidden_corners: four(self.hidden_corners),
            largest_face: if self.faces > 0 { 4 } else { 0 },
            largest_fan: self.largest_fan.max(self.largest_face).max(4),
            ..self
        }
    }

    /// Returns the counts after a U on a mesh; `is_quads` tells whether all its faces are quads.
    pub(super) fn upsampled(self, settings: &LetterSettings, is_quads: bool) -> Self {
        let first = settings.pieces(is_quads) != settings.arity();
        let count = if first { self.halved() } else { self };
        count.split(settings.tile(), settings.arity())
    }
}
