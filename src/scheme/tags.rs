//! The corners, holes and boundary rule of a mesh.

use std::sync::Arc;

use crate::math::distinct::distinct;
use crate::shape::topology::{Topology, index};

/// The boundary rule of meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Boundary {
    /// Boundaries follow the curve rule; boundary vertices with one face keep their position.
    #[default]
    EdgeAndCorner,
    /// Boundaries follow the curve rule.
    EdgeOnly,
    /// As `EdgeOnly`, and faces that touch the boundary are not shown.
    None,
}

impl Boundary {
    /// Returns the name of the rule in requests.
    pub fn name(self) -> &'static str {
        match self {
            Self::EdgeAndCorner => "edge-and-corner",
            Self::EdgeOnly => "edge-only",
            Self::None => "none",
        }
    }
}

/// The tags of a net.
#[derive(Debug, Clone)]
pub struct Tags {
    /// Corners, which keep their position, ascending; indices of vertices of the base.
    pub corners: Arc<[u32]>,
    /// Base faces that are not shown, ascending.
    pub holes: Arc<[u32]>,
    /// The boundary rule.
    pub boundary: Boundary,
    /// Whether the boundary is where the net was cut out of a closed mesh, so that D loses no vertices there.
    pub cut: bool,
    /// The kind of tags that D would lose, if there are any.
    pub lost_by_dual: Option<&'static str>,
}

impl Tags {
    /// Creates the tags of a control mesh.
    pub(super) fn new(topology: &Topology, corners: &[u32], holes: &[u32], boundary: Boundary) -> Self {
        let holes = hidden(topology, holes, boundary);
        let lost_by_dual = if !corners.is_empty() {
            Some("corners")
        } else if !holes.is_empty() {
            Some("holes (boundary \"none\" makes some)")
        } else {
            None
        };
        Self { corners: fixed(topology, corners, boundary), holes, boundary, cut: false, lost_by_dual }
    }

    /// Records that another kind of tags that D would lose is present, if `any`.
    pub(super) fn and(self, any: bool, what: &'static str) -> Self {
        Self { lost_by_dual: self.lost_by_dual.or(any.then_some(what)), ..self }
    }

    /// Returns the tags after a D that made this topology.
    pub(super) fn after_dual(&self, topology: &Topology) -> Self {
        let corners = fixed(topology, &[], self.boundary);
        Self { corners, holes: Arc::default(), boundary: self.boundary, cut: self.cut, lost_by_dual: None }
    }

    /// Returns the tags after a step with a connectivity of its own; `corners` are its corners, ascending.
    pub(super) fn after_rebuild(&self, corners: Vec<u32>) -> Self {
        Self { corners: corners.into(), ..self.clone() }
    }

    /// Returns whether vertex `v` is a corner, which keeps its position.
    #[inline]
    pub fn is_corner(&self, v: usize) -> bool {
        !self.corners.is_empty() && self.corners.binary_search(&index(v)).is_ok()
    }
}

/// Returns the tagged corners and, if the boundary rule demands it, boundary vertices with one face.
fn fixed(topology: &Topology, corners: &[u32], boundary: Boundary) -> Arc<[u32]> {
    if boundary != Boundary::EdgeAndCorner || topology.n_boundary() == 0 {
        return corners.into();
    }
    let is_lone = |&v: &usize| topology.boundary_edges(v).is_some() && topology.ring(v).count() == 1;
    let lone = (0..topology.n_vertices()).filter(is_lone).map(index);
    distinct(corners.iter().copied().chain(lone)).into()
}

/// Returns the tagged holes and, if the boundary rule is `None`, faces that touch the boundary.
fn hidden(topology: &Topology, holes: &[u32], boundary: Boundary) -> Arc<[u32]> {
    if boundary != Boundary::None {
        return holes.into();
    }
    let touches = |f: &usize| topology.face(*f).iter().any(|&v| topology.boundary_edges(v as usize).is_some());
    distinct(holes.iter().copied().chain((0..topology.n_faces()).filter(touches).map(index))).into()
}
