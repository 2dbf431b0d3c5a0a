//! Counts of one net, and how operators change them.

use crate::scheme::mesh_net::MeshNet;
use crate::scheme::settings::Settings;
use crate::shape::tile::Tile;
use crate::shape::topology::index;

/// Counts of one net.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Count {
    /// Points or vertices.
    pub vertices: u128,
    /// Edges (of a polygon: pairs of neighbouring points).
    pub edges: u128,
    /// Faces, hidden ones included; 0 for polygons.
    pub faces: u128,
    /// Sum of the sizes of all faces.
    pub corners: u128,
    /// Hidden faces.
    pub hidden_faces: u128,
    /// Sum of the sizes of the hidden faces.
    pub hidden_corners: u128,
    /// Vertices that are added, at most, where normals differ across sharp edges.
    pub split_vertices: u128,
    /// Places with texture coordinates, where there are some.
    pub uvs: u128,
    /// Places of all channels with seams.
    pub seamed: u128,
    /// Vertices where there is one for each place of all that has seams; 0 where nothing has.
    pub unfolded: u128,
    /// Corners of the largest face that is shown; 0 without faces.
    pub largest_face: u128,
    /// Corners of the largest face that a dual makes of a vertex: as many as it has faces, and two more at the
    /// boundary.
    pub largest_fan: u128,
}

impl Count {
    /// The counts of two nets together.
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

    /// The counts of a net.
    pub(super) fn of_mesh(net: &MeshNet) -> Self {
        let sizes = net.tags.holes.iter().map(|&f| net.mesh.base.face(f as usize).len() as u128);
        let hidden_faces = net.tags.holes.len() as u128;
        let count = Self { hidden_faces, hidden_corners: sizes.sum(), ..Self::of_base(net) };
        net.mesh.pieces.iter().fold(count, |count, &pieces| count.split(net.mesh.tile, pieces))
    }

    /// The counts of a net before its splits, hidden faces counted as if they were shown.
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

    /// After a split with so many pieces an edge: of faces of any size into quads when it is 2, else of triangles or
    /// quads alone.
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
            // where no edge is an inner one, new vertices lie on the boundary
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

    /// After a U of arity 2: V + E + F vertices, 2 E + (sum of sizes) edges, as many quads as there were corners.
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

    /// After a U on a mesh whose faces are all quads, or not.
    pub(super) fn upsampled(self, settings: &Settings, is_quads: bool) -> Self {
        let first = settings.pieces(is_quads) != settings.arity();
        let count = if first { self.halved() } else { self };
        count.split(settings.tile(), settings.arity())
    }
}
