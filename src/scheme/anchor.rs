//! The anchor, that is, the mesh that entered the last upsampling, and how the points made by the upsampling depend on
//! it.

use std::sync::Arc;

use super::sharpness::{Creasing, Sharpness};
use crate::math::functions::ratio;
use crate::shape::directions::Directions;
use crate::shape::tile::Tile;
use crate::shape::tiling::{Ancestor, Tiling};
use crate::shape::topology::{Topology, index};

/// The mesh that entered the last upsampling, towards which a push-back pushes.
#[derive(Debug, Clone)]
pub struct Anchor {
    /// The topology of the mesh.
    pub topology: Arc<Topology>,
    /// The mesh split into quads, if it had other faces and the arity was above 2: such faces are split into quads
    /// first.
    pub quads: Option<Arc<Topology>>,
    /// The tile into which its faces were split.
    pub tile: Tile,
    /// Number of pieces of each edge, of the mesh or of `quads`.
    pub pieces: u32,
    /// Its corners, which keep their position.
    pub corners: Arc<[u32]>,
    /// Sharpness of its edges and semi-sharp vertices; `None` if all are smooth.
    pub sharpness: Option<Arc<Sharpness>>,
    /// Directions of its edges along latitude and longitude lines.
    pub directions: Option<Arc<Directions>>,
    /// For each vertex its index just after the upsampling; `None` if the net was not reordered since.
    pub order: Option<Arc<[u32]>>,
    /// Whether vertices were lost since the upsampling.
    pub lost: bool,
}

/// The kind of cell from which the last upsampling made a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellKind {
    /// A vertex, labelled V.
    Vertex,
    /// An edge, labelled E.
    Edge,
    /// A face, labelled F.
    Face,
}

impl Anchor {
    /// Returns the topology that the upsampling split last.
    pub fn parent(&self) -> &Arc<Topology> {
        self.quads.as_ref().unwrap_or(&self.topology)
    }

    /// Returns the number of pieces that each edge of the mesh became.
    pub fn pieces_of_an_edge(&self) -> usize {
        if self.quads.is_some() { 2 * self.pieces as usize } else { self.pieces as usize }
    }

    /// Returns the sharpness of the net after the upsampling.
    pub(super) fn sharpness_after(&self, creasing: Creasing) -> Option<Arc<Sharpness>> {
        let before = self.sharpness.as_ref()?;
        let after = if self.pieces_of_an_edge() == 2 {
            before.split(&self.topology, creasing)
        } else {
            before.pieces(self.pieces_of_an_edge())
        };
        after.map(Arc::new)
    }

    /// Returns whether each edge got a midpoint and each face a centre.
    fn is_halving(&self) -> bool {
        self.tile == Tile::Quad && self.pieces == 2
    }

    /// Returns the label of the vertex with index `v` just after the upsampling.
    pub fn label(&self, v: usize) -> CellKind {
        let parent = self.parent();
        let (n_v, n_e) = (self.topology.n_vertices(), self.topology.n_edges());
        let label = |edges: usize| match v {
            v if v < n_v => CellKind::Vertex,
            v if v < n_v + edges => CellKind::Edge,
            _ => CellKind::Face,
        };
        if self.is_halving() {
            return label(n_e);
        }
        if self.quads.is_none() || v < parent.n_vertices() {
            let inner = if self.quads.is_none() { self.pieces as usize - 1 } else { 1 };
            return label(n_e * inner);
        }
        // the midpoints of the mesh's own edges come first among the edge points of the quads
        match self.tiling().ancestor(v) {
            Ancestor::Edge(edge, _) if edge < 2 * n_e => CellKind::Edge,
            _ => CellKind::Face,
        }
    }

    /// Returns the weight of a vertex in the first average after the upsampling: `f^2` for V, `f` for E, 1 for F; on
    /// triangles `f` for V, else 1. `v` is the index just after the upsampling.
    pub fn weight(&self, v: usize, f: f64) -> f64 {
        match (self.tile, self.label(v)) {
            (Tile::Quad, CellKind::Vertex) => f * f,
            (Tile::Quad, CellKind::Edge) | (Tile::Triangle, CellKind::Vertex) => f,
            _ => 1.0,
        }
    }

    fn tiling(&self) -> Tiling<'_> {
        Tiling::new(self.parent(), self.tile, self.pieces as usize)
    }

    /// Calls `add(vertex, share)` for the anchor vertices from which the upsampling made vertex `v`: linear along
    /// edges, bilinear in quads, barycentric in triangles, equal at face centres. All shares are multiplied by the
    /// first, second or third scale if `v` is a V, E or F.
    pub fn shares(&self, v: usize, scales: [f64; 3], mut add: impl FnMut(u32, f64)) {
        let scale = match self.label(v) {
            CellKind::Vertex => scales[0],
            CellKind::Edge => scales[1],
            CellKind::Face => scales[2],
        };
        if self.is_halving() {
            halved(&self.topology, v, scale, &mut add);
            return;
        }
        let mut add = |u: u32, weight: f64| match self.quads {
            None => add(u, scale * weight),
            Some(_) => halved(&self.topology, u as usize, scale * weight, &mut add),
        };
        let (parent, d) = (self.parent(), self.pieces as usize);
        match self.tiling().ancestor(v) {
            Ancestor::Vertex(v) => add(index(v), 1.0),
            Ancestor::Edge(edge, at) => {
                let [a, b] = parent.ends(edge);
                add(a, ratio(d - at, d));
                add(b, ratio(at, d));
            }
            Ancestor::Face(face, [i, j]) => match (self.tile, parent.face(face)) {
                (Tile::Triangle, &[a, b, c]) => {
                    add(a, ratio(d - i - j, d));
                    add(b, ratio(i, d));
                    add(c, ratio(j, d));
                }
                (_, face) => {
                    let weights = [(d - i) * (d - j), i * (d - j), i * j, (d - i) * j];
                    face.iter().zip(weights).for_each(|(&v, weight)| add(v, ratio(weight, d * d)));
                }
            },
        }
    }
}

/// Adds the shares of a vertex of the quads: a vertex of the mesh, an edge midpoint or a face centre.
fn halved(topology: &Topology, v: usize, weight: f64, add: &mut impl FnMut(u32, f64)) {
    let (n_v, n_e) = (topology.n_vertices(), topology.n_edges());
    if v < n_v {
        add(index(v), weight);
    } else if v < n_v + n_e {
        topology.ends(v - n_v).iter().for_each(|&end| add(end, weight / 2.0));
    } else {
        let face = topology.face(v - n_v - n_e);
        let share = weight / ratio(face.len(), 1);
        face.iter().for_each(|&v| add(v, share));
    }
}
