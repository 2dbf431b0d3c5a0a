//! A mesh as the operators see it: an explicit topology, or the quad split of one whose vertices carry the labels V, E, F.

use std::sync::Arc;

use super::sharpness::{Creasing, Sharpness};
use crate::shape::topology::{Topology, index};

/// Boundary rule of meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Boundary {
    /// Boundary curves by the curve rule; vertices with one face keep their place.
    #[default]
    EdgeAndCorner,
    /// Boundary curves by the curve rule.
    EdgeOnly,
    /// As `EdgeOnly`, and faces that touch the boundary are not shown.
    None,
}

/// What Catmull-Clark does at edges beside triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TriangleRule {
    /// What it does everywhere.
    #[default]
    Catmark,
    /// Face points count more, so that triangles in a mesh of quads dent it less.
    Smooth,
}

/// Rules that a preset chooses for meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rules {
    /// How sharpness becomes less.
    pub creasing: Creasing,
    /// What happens beside triangles.
    pub triangles: TriangleRule,
}

/// The state of a mesh under refinement.
#[derive(Debug, Clone)]
pub struct MeshNet {
    /// The mesh whose vertex and face order the result follows: the input, or the result of the last D.
    pub base: Arc<Topology>,
    /// Number of U since the base.
    pub splits: u32,
    /// The topology that entered the last of these U; the net is its split. `None` when `splits` is 0.
    pub parent: Option<Arc<Topology>>,
    /// Vertices that keep their place, ascending; they are vertices of the base.
    pub corners: Arc<[u32]>,
    /// Sharpness of its edges and of its other vertices; `None` when all are smooth.
    pub sharpness: Option<Arc<Sharpness>>,
    /// Rules of the scheme.
    pub rules: Rules,
    /// Base faces that are not shown, ascending.
    pub holes: Arc<[u32]>,
    /// Boundary rule.
    pub boundary: Boundary,
    /// Whether D would lose something the client tagged.
    pub tagged: Option<&'static str>,
    /// Number of D since the last U.
    pub duals: u32,
    /// Number of steps of a scheme with a connectivity of its own, such as Doo-Sabin.
    pub rounds: u32,
    /// What entered the last U.
    pub anchor: Option<Anchor>,
}

/// The mesh that entered the last U.
#[derive(Debug, Clone)]
pub struct Anchor {
    /// Its topology; the net's vertices are its vertices, edges and faces, in this order or in that of `order`.
    pub topology: Arc<Topology>,
    /// Its vertices that keep their place.
    pub corners: Arc<[u32]>,
    /// Sharpness of its edges and of its other vertices; `None` when all were smooth.
    pub sharpness: Option<Arc<Sharpness>>,
    /// Where the net was put into another order since: for each vertex its number in (vertices, edges, faces).
    pub order: Option<Arc<[u32]>>,
    /// Whether vertices were lost since.
    pub lost: bool,
}

impl MeshNet {
    /// The net of a control mesh with tagged corners and holes.
    pub fn new(topology: Arc<Topology>, corners: &[u32], holes: &[u32], boundary: Boundary) -> Self {
        let holes = shown_holes(&topology, holes, boundary);
        let tagged = if !corners.is_empty() {
            Some("corners")
        } else if !holes.is_empty() {
            Some("holes (boundary \"none\" makes some)")
        } else {
            None
        };
        let corners = fixed(&topology, corners, boundary);
        Self {
            base: topology,
            splits: 0,
            parent: None,
            corners,
            sharpness: None,
            rules: Rules::default(),
            holes,
            boundary,
            tagged,
            duals: 0,
            rounds: 0,
            anchor: None,
        }
    }

    /// The same net with sharp edges and vertices, and the rules of a scheme.
    #[must_use]
    pub fn with_sharpness(self, sharpness: Option<Sharpness>, rules: Rules) -> Self {
        let tagged = self.tagged.or(sharpness.is_some().then_some("creases"));
        Self { sharpness: sharpness.map(Arc::new), rules, tagged, ..self }
    }

    /// The net of an explicit topology that came of a D.
    pub(super) fn after_dual(&self, topology: Topology, anchor: Option<Anchor>) -> Self {
        let corners = fixed(&topology, &[], self.boundary);
        Self {
            base: Arc::new(topology),
            splits: 0,
            parent: None,
            corners,
            sharpness: None,
            rules: self.rules,
            holes: Arc::default(),
            boundary: self.boundary,
            tagged: None,
            duals: self.duals + 1,
            rounds: 0,
            anchor,
        }
    }

    /// The net of an explicit topology that a scheme of its own connectivity made, with the vertices that keep their
    /// place, ascending.
    pub(super) fn after_own(&self, topology: Topology, corners: Vec<u32>) -> Self {
        let corners = corners.into();
        let rounds = self.rounds + 1;
        Self { base: Arc::new(topology), splits: 0, parent: None, corners, rounds, anchor: None, ..self.clone() }
    }

    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.parent.as_ref().map_or(self.base.n_vertices(), |p| p.n_vertices() + p.n_edges() + p.n_faces())
    }

    /// Number of faces, hidden ones included.
    pub fn n_faces(&self) -> usize {
        self.parent.as_ref().map_or(self.base.n_faces(), |p| p.n_corners())
    }

    /// The net's topology made explicit, in the order of its construction (see [`Topology::split`]).
    pub fn topology(&self) -> Arc<Topology> {
        self.parent.as_ref().map_or_else(|| self.base.clone(), |parent| Arc::new(parent.split()))
    }

    /// Whether vertex `v` keeps its place.
    #[inline]
    pub fn is_corner(&self, v: usize) -> bool {
        !self.corners.is_empty() && self.corners.binary_search(&index(v)).is_ok()
    }
}

/// Tagged corners and, where the boundary rule says so, boundary vertices with one face.
fn fixed(topology: &Topology, corners: &[u32], boundary: Boundary) -> Arc<[u32]> {
    let mut fixed = corners.to_vec();
    if boundary == Boundary::EdgeAndCorner {
        let lone = (0..topology.n_vertices())
            .filter(|&v| topology.boundary_edges(v).is_some() && topology.ring(v).count() == 1);
        fixed.extend(lone.map(index));
        fixed.sort_unstable();
        fixed.dedup();
    }
    fixed.into()
}

/// Tagged holes and, where the boundary is not interpolated, faces that touch it.
fn shown_holes(topology: &Topology, holes: &[u32], boundary: Boundary) -> Arc<[u32]> {
    let mut hidden = holes.to_vec();
    if boundary == Boundary::None {
        let touches = |f: &usize| topology.face(*f).iter().any(|&v| topology.boundary_edges(v as usize).is_some());
        hidden.extend((0..topology.n_faces()).filter(touches).map(index));
        hidden.sort_unstable();
        hidden.dedup();
    }
    hidden.into()
}
