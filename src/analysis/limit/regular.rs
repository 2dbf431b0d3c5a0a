//! Regular nets, and the places on them at which the reach of a cycle is examined: inside and, if D removes rings
//! there, on the boundary.

use std::sync::Arc;

use super::disc::{Centre, RingCount};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::tags::Boundary;
use crate::shape::check::{FaceList, Winding};
use crate::shape::directions::{Direction, Directions};
use crate::shape::topology::{Topology, index};

/// Maximum number of faces around the boundary vertices that are examined. Under D a boundary vertex with m faces
/// becomes the middle of a path of m points: a vertex if m is odd, an edge if it is even. For 1 and 2 faces the middle
/// contains an end of the path, for 3 and 4 it does not. Half of it would leave out 3 and 4; twice of it repeats them.
const MAX_SECTORS: usize = 4;

/// The kind of net on which a scheme is regular.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Regular {
    /// Quads, four around a vertex.
    Quads,
    /// Triangles, six around a vertex.
    Triangles,
}

/// The places besides the vertices of a closed mesh whose limits are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Starts {
    /// Whether the mesh has a boundary.
    pub(super) is_open: bool,
    /// Whether edges or faces have taken the place of vertices.
    pub(super) others: bool,
}

impl Starts {
    /// Returns the number of rings by which discs must be wider, as each D removes half a ring at a boundary.
    pub(super) fn wider(self, n_duals: usize) -> usize {
        if self.is_open { n_duals.div_ceil(2) } else { 0 }
    }
}

impl Regular {
    /// Returns a regular net of `side x side` squares, each cut into two if the net consists of triangles. If it is
    /// tagged, the edges along its rows are on latitude lines and all others on longitude lines.
    pub(super) fn net(self, side: usize, tagged: bool) -> MeshNet {
        let at = |i: usize, j: usize| index(j * (side + 1) + i);
        let squares = (0..side).flat_map(|j| (0..side).map(move |i| (i, j)));
        let squares = squares.map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        let net = self.of_squares((side + 1) * (side + 1), squares);
        let topology = &net.mesh.base;
        let direction = |e: usize| {
            let [a, b] = topology.ends(e).map(|v| v as usize / (side + 1));
            if a == b { Direction::Latitude } else { Direction::Longitude }
        };
        let directions = tagged.then(|| Directions::of_edges((0..topology.n_edges()).map(direction).collect()));
        net.carrying(None, directions)
    }

    /// Returns a regular net and its middle vertex, which is so far from the boundary that no disc reaches it.
    pub(super) fn grid(self, rings: RingCount, tagged: bool) -> (MeshNet, usize) {
        let side = 2 * (rings.disc + 2);
        (self.net(side, tagged), (side / 2) * (side + 1) + side / 2)
    }

    /// Returns the places other than inner vertices at which a cycle has to be examined, each with a regular net that
    /// continues for more than `reach` rings around it: boundary vertices if the mesh is open and the cycle contains
    /// duals, then a face and, on such boundaries, an edge if these have taken the place of vertices.
    pub(super) fn places(self, starts: Starts, n_duals: usize, reach: usize) -> Vec<(MeshNet, Centre)> {
        let mut places = Vec::new();
        let side = 2 * (reach + 2);
        let boundaries = starts.is_open && n_duals > 0;
        if boundaries {
            places.extend((1..=MAX_SECTORS).map(|n| (self.fan(n, reach + 2), Centre::Vertex(0))));
            places.push((self.net(side, false), Centre::Vertex(index(side / 2))));
        }
        if starts.others {
            let per_square = if self == Self::Quads { 1 } else { 2 };
            let net = self.net(side, false);
            let face = (side / 2 * side + side / 2) * per_square;
            if boundaries {
                let half_edge = net.mesh.base.half_edges(side / 2 * per_square).start;
                places.push((net.clone(), Centre::Edge(half_edge)));
            }
            places.push((net, Centre::Face(index(face))));
        }
        places
    }

    /// Returns a net of `n` blocks of `side x side` squares around vertex 0, which lies on the boundary. Each square is
    /// cut into two if the net consists of triangles.
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

    /// Returns the net of some squares, each cut into two if the net consists of triangles.
    fn of_squares(self, n_vertices: usize, squares: impl Iterator<Item = [u32; 4]>) -> MeshNet {
        let faces: FaceList = match self {
            Self::Quads => squares.collect(),
            Self::Triangles => squares.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        };
        let checked =
            Topology::of_faces(n_vertices, faces, Winding::Refuse).expect("squares side by side are a manifold");
        MeshNet::new(Arc::new(checked.topology), &[], &[], Boundary::EdgeOnly)
    }
}
