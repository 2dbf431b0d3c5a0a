//! Regular nets, and the places there at which a cycle shows how far it reaches: inside, and where D takes rings away,
//! on the boundary.

use std::sync::Arc;

use super::disc::{Centre, Rings};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::tags::Boundary;
use crate::shape::check::{FaceList, Winding};
use crate::shape::directions::{Direction, Directions};
use crate::shape::topology::{Topology, index};

/// Boundary vertices with so many faces and fewer are looked at: a path of points has its middle at a vertex or an
/// edge, beside its ends or not.
/// Fans of one and two faces are the ends, those of three and four the two kinds of middle. Half of it would leave out
/// the middles; twice of it repeats what is known.
const MOST_SECTORS: usize = 4;

/// How many sides the faces have around which a scheme is regular.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Regular {
    /// Quads, four around a vertex.
    Quads,
    /// Triangles, six around a vertex.
    Triangles,
}

/// Where limits are looked for besides the vertices of a closed mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Starts {
    /// Whether vertices lie on a boundary.
    pub(super) is_open: bool,
    /// Whether edges and faces stand for vertices.
    pub(super) others: bool,
}

impl Starts {
    /// Rings by which discs are wider where D takes some away on the boundary, half a ring each.
    pub(super) fn wider(self, n_duals: usize) -> usize {
        if self.is_open { n_duals.div_ceil(2) } else { 0 }
    }
}

impl Regular {
    /// A regular net of `side x side` squares, each cut into two triangles where it is made of these; its rows are
    /// latitude lines where it is tagged.
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

    /// A regular net and the vertex in its middle, which is so far from the boundary that no disc reaches it.
    pub(super) fn grid(self, rings: Rings, tagged: bool) -> (MeshNet, usize) {
        let side = 2 * (rings.disc + 2);
        (self.net(side, tagged), (side / 2) * (side + 1) + side / 2)
    }

    /// Regular nets with a place at their middle from which it is `reach` rings to anywhere else, besides an inner
    /// vertex of a net without tags.
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
                let half_edge = net.mesh.base.half_edges(side / 2 * per_square).start;
                places.push((net.clone(), Centre::Edge(half_edge)));
            }
            places.push((net, Centre::Face(index(face))));
        }
        places
    }

    /// `n` sectors of `side x side` squares around a boundary vertex, number 0, each square cut where it is made of
    /// triangles.
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
