//! Places of regular nets at which a cycle shows how far it reaches: inside, and where D takes rings away, on the boundary.

use std::sync::Arc;

use super::cycle::Cycle;
use super::patch::Centre;
use super::probe::Regular;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::tags::Boundary;
use crate::shape::check::{FaceList, Winding};
use crate::shape::topology::{Topology, index};

/// Boundary vertices with so many faces and fewer are looked at: a path of points has its middle at a vertex or an edge,
/// beside its ends or not.
const MOST_SECTORS: usize = 4;

/// Where limits are looked for besides the vertices of a closed mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Starts {
    /// Whether vertices lie on a boundary.
    pub(super) is_open: bool,
    /// Whether edges and faces stand for vertices.
    pub(super) others: bool,
}

impl Starts {
    /// Rings by which patches are wider where D takes some away on the boundary, half a ring each.
    pub(super) fn wider(self, cycle: &Cycle<'_>) -> usize {
        if self.is_open { cycle.n_duals().div_ceil(2) } else { 0 }
    }
}

impl Regular {
    /// Regular nets with a place at their middle from which it is `reach` rings to anywhere else, besides an inner vertex
    /// of a net without tags.
    pub(super) fn places(self, starts: Starts, n_duals: usize, reach: usize) -> Vec<(MeshNet, Centre)> {
        let mut places = Vec::new();
        let side = 2 * (reach + 2);
        let boundaries = starts.is_open && n_duals > 0;
        if boundaries {
            places.extend((1..=MOST_SECTORS).map(|n| (self.fan(n, reach + 2), Centre::Vertex(0))));
            places.push((self.net(side, false), Centre::Vertex(index(side / 2))));
        }
        if starts.others {
            let per_square = if self == Self::Quads { 1 } else { 2 };
            let net = self.net(side, false);
            let face = (side / 2 * side + side / 2) * per_square;
            if boundaries {
                let rim = net.mesh.base.half_edges(side / 2 * per_square).start;
                places.push((net.clone(), Centre::Edge(rim)));
            }
            places.push((net, Centre::Face(index(face))));
        }
        places
    }

    /// `n` sectors of `side x side` squares around a boundary vertex, number 0, each square cut where it is made of triangles.
    fn fan(self, n: usize, side: usize) -> MeshNet {
        let inner = 1 + (n + 1) * side;
        let at = |sector: usize, i: usize, j: usize| match (i, j) {
            (0, 0) => 0,
            (i, 0) => sector * side + i,
            (0, j) => (sector + 1) * side + j,
            (i, j) => inner + (sector * side + i - 1) * side + j - 1,
        };
        let squares = (0..n).flat_map(|s| (0..side).flat_map(move |i| (0..side).map(move |j| (s, i, j))));
        let corners = |(s, i, j)| [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| index(at(s, i, j)));
        self.of_squares(inner + n * side * side, squares.map(corners))
    }

    /// The net of squares, each cut into two triangles where it is made of these.
    pub(super) fn of_squares(self, n_vertices: usize, squares: impl Iterator<Item = [u32; 4]>) -> MeshNet {
        let mut faces = FaceList::default();
        for [a, b, c, d] in squares {
            match self {
                Self::Quads => faces.push([a, b, c, d]),
                Self::Triangles => {
                    faces.push([a, b, c]);
                    faces.push([a, c, d]);
                }
            }
        }
        let checked =
            Topology::of_faces(n_vertices, faces, Winding::Refuse).expect("squares side by side are a manifold");
        MeshNet::new(Arc::new(checked.topology), &[], &[], Boundary::EdgeOnly)
    }
}
