//! Second differences of a net where it is regular, and the joining of vertex values over rings of faces.

use rayon::prelude::*;

use crate::math::vector::{Vector, dot, length, minus, plus};
use crate::scheme::mesh_net::MeshNet;
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::tile::Tile;
use crate::shape::topology::{NONE, Topology};

/// The size of the second differences at a vertex, in model units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bend {
    /// The greatest length.
    pub(super) most: f64,
    /// The greatest component along the normal of the vertex, or the greatest length if it has no normal.
    pub(super) rise: f64,
}

impl Bend {
    const NONE: Self = Self { most: 0.0, rise: 0.0 };
    const UNBOUNDED: Self = Self { most: f64::INFINITY, rise: f64::INFINITY };

    /// Returns the maximum of each size.
    pub(super) fn or(self, other: Self) -> Self {
        Self { most: self.most.max(other.most), rise: self.rise.max(other.rise) }
    }
}

/// Returns for each vertex the size of its second differences: `a - 2 v + b` over the straight lines of edges through
/// the vertex v, from a to b, and on triangles also `c + d - a - b` over its edges (a, b) between the triangles with c
/// and d. Infinite where the net is not regular, because second differences need not shrink there; zero at vertices
/// without faces. `normals` are the unit normals of the vertices, zero where there is none.
pub(super) fn bends(
    net: &MeshNet,
    topology: &Topology,
    tile: Tile,
    points: &[Vector],
    normals: &[Vector],
) -> Vec<Bend> {
    let net = Bending { net, topology, tile, points, normals };
    (0..topology.n_vertices()).into_par_iter().with_min_len(1024).map(|v| net.at(v)).collect()
}

struct Bending<'a> {
    net: &'a MeshNet,
    topology: &'a Topology,
    tile: Tile,
    points: &'a [Vector],
    normals: &'a [Vector],
}

impl Bending<'_> {
    fn at(&self, v: usize) -> Bend {
        let topology = self.topology;
        if topology.is_isolated(v) {
            return Bend::NONE;
        }
        let sides = if self.tile == Tile::Quad { 4 } else { 3 };
        // number of faces on one side of a straight line through a regular vertex
        let half = if self.tile == Tile::Quad { 2 } else { 3 };
        let ring: Vec<u32> = topology.ring(v).take(2 * half + 1).collect();
        if ring.len() > 2 * half || ring.iter().any(|&c| topology.face(topology.face_of(c)).len() != sides) {
            return Bend::UNBOUNDED;
        }
        let open = topology.boundary_edges(v).is_some();
        let Some(sharp) = self.sharp(v, &ring) else { return Bend::UNBOUNDED };
        let end = |half_edge: u32| topology.vertex(topology.next(half_edge)) as usize;
        let lines: Vec<[usize; 2]> = match (open, ring.len(), sharp.as_slice()) {
            // a fixed corner of one quad, where two boundary lines end
            (true, 1, []) if self.net.tags.is_corner(v) && sides == 4 => return Bend::NONE,
            _ if self.net.tags.is_corner(v) => return Bend::UNBOUNDED,
            (true, n, []) if n == half => {
                vec![[end(ring[0]), topology.vertex(topology.previous(ring[n - 1])) as usize]]
            }
            (false, n, []) if n == 2 * half => (0..half).map(|i| [end(ring[i]), end(ring[i + half])]).collect(),
            (false, n, &[i, j]) if n == 2 * half && j - i == half => vec![[end(ring[i]), end(ring[j])]],
            _ => return Bend::UNBOUNDED,
        };
        let p = self.points;
        let twice = plus(p[v], p[v]);
        let bend = |x: Vector| {
            let most = length(x);
            let rise = if length(self.normals[v]) > 0.0 { dot(self.normals[v], x).abs() } else { most };
            Bend { most, rise }
        };
        let along = lines.iter().map(|&[a, b]| bend(minus(plus(p[a], p[b]), twice))).fold(Bend::NONE, Bend::or);
        if self.tile == Tile::Quad {
            return along;
        }
        let inner = ring.iter().enumerate().filter(|(i, _)| !sharp.contains(i));
        inner.filter_map(|(_, &half_edge)| self.rhombus(half_edge).map(bend)).fold(along, Bend::or)
    }

    /// Returns the positions in the ring of the infinitely sharp edges, ascending; `None` if the vertex is sharp or an
    /// edge has finite sharpness.
    fn sharp(&self, v: usize, ring: &[u32]) -> Option<Vec<usize>> {
        let Some(sharpness) = &self.net.sharpness else { return Some(Vec::new()) };
        let all = ring.iter().map(|&half_edge| sharpness.edge(self.topology.edge(half_edge) as usize));
        let last = ring.last().map(|&half_edge| self.topology.edge(self.topology.previous(half_edge)));
        let last = last.map_or(0.0, |e| sharpness.edge(e as usize));
        let fading = |s: f64| s > 0.0 && s < INFINITE_SHARPNESS;
        if sharpness.vertex(v) > 0.0 || all.clone().any(fading) || fading(last) {
            return None;
        }
        Some(all.enumerate().filter(|&(_, s)| s > 0.0).map(|(i, _)| i).collect())
    }

    /// Returns `c + d - a - b` for the edge (a, b) of a half-edge between the triangles with c and d; `None` on the
    /// boundary.
    fn rhombus(&self, half_edge: u32) -> Option<Vector> {
        let topology = self.topology;
        let twin = topology.twin(half_edge);
        if twin == NONE {
            return None;
        }
        let point = |half_edge: u32| self.points[topology.vertex(half_edge) as usize];
        let edge = plus(point(half_edge), point(twin));
        let across = plus(point(topology.previous(half_edge)), point(topology.previous(twin)));
        Some(minus(across, edge))
    }
}

/// Returns for each vertex the values of all vertices within `rings` rings of faces around it, joined into one. `join`
/// must be commutative, associative and idempotent.
pub(super) fn spread<T: Copy + Send + Sync>(
    topology: &Topology,
    mut values: Vec<T>,
    rings: usize,
    join: impl Fn(T, T) -> T + Sync,
) -> Vec<T> {
    for _ in 0..rings {
        let of_face = |f: usize| topology.face(f).iter().map(|&v| values[v as usize]).reduce(&join);
        let faces: Vec<Option<T>> = (0..topology.n_faces()).into_par_iter().with_min_len(1024).map(of_face).collect();
        let around = |v: usize| topology.ring(v).filter_map(|c| faces[topology.face_of(c)]).fold(values[v], &join);
        values = (0..values.len()).into_par_iter().with_min_len(1024).map(around).collect();
    }
    values
}

/// An axis-aligned box: its least and its greatest corner.
pub(super) type Box3 = [Vector; 2];

/// Returns the smallest box around two boxes.
pub(super) fn around(a: Box3, b: Box3) -> Box3 {
    let each = |k: usize| [a[0][k].min(b[0][k]), a[1][k].max(b[1][k])];
    let [x, y, z] = [each(0), each(1), each(2)];
    [[x[0], y[0], z[0]], [x[1], y[1], z[1]]]
}
