//! The state of a mesh as operators see it, without coordinates.

use std::sync::Arc;

use super::anchor::Anchor;
use super::annotations::Annotations;
use super::local_mesh::MeshLocal;
use super::rules::Rules;
use super::sharpness::Sharpness;
use super::split_mesh::SplitMesh;
use super::surroundings::Surroundings;
use super::tags::{Boundary, Tags};
use crate::shape::attributes::Attributes;
use crate::shape::directions::Directions;
use crate::shape::tile::Tile;
use crate::shape::topology::Topology;

/// The state of a mesh under refinement.
#[derive(Debug, Clone)]
pub struct MeshNet {
    /// The connectivity.
    pub mesh: SplitMesh,
    /// Corners, holes and the boundary rule.
    pub tags: Tags,
    /// Sharpness of edges and of semi-sharp vertices; `None` if all are smooth.
    pub sharpness: Option<Arc<Sharpness>>,
    /// The rules of the scheme.
    pub rules: Rules,
    /// Vertex parameters, edge directions and indices in a whole net.
    pub annotations: Annotations,
    /// The state since the last upsampling.
    pub since: SinceUpsampling,
    /// Properties of the whole net, if this net is a part of it and its split depends on the other faces.
    pub surroundings: Option<Surroundings>,
}

/// The state of a mesh since its last upsampling.
#[derive(Debug, Clone, Default)]
pub struct SinceUpsampling {
    /// The mesh that entered the upsampling.
    pub anchor: Option<Anchor>,
    /// Values of single vertices at the upsampling.
    pub local: Option<Arc<MeshLocal>>,
    /// Number of D since the upsampling.
    pub duals: u32,
}

impl MeshNet {
    /// Creates the net of a control mesh with tagged corners and holes.
    pub fn new(topology: Arc<Topology>, corners: &[u32], holes: &[u32], boundary: Boundary) -> Self {
        Self {
            tags: Tags::new(&topology, corners, holes, boundary),
            mesh: SplitMesh::new(topology, 0),
            sharpness: None,
            rules: Rules::default(),
            annotations: Annotations::default(),
            since: SinceUpsampling::default(),
            surroundings: None,
        }
    }

    /// Returns the net with vertex parameters and edge directions.
    #[must_use]
    pub fn carrying(self, attributes: Option<Attributes>, directions: Option<Directions>) -> Self {
        let tags = self.tags.and(attributes.is_some(), "parameters of vertices");
        let tags = tags.and(directions.is_some(), "latitude and longitude tags");
        let (attributes, directions) = (attributes.map(Arc::new), directions.map(Arc::new));
        Self { tags, annotations: Annotations { attributes, directions, ..self.annotations }, ..self }
    }

    /// Returns the net with sharp edges and vertices, and the rules of a scheme.
    #[must_use]
    pub fn with_sharpness(self, sharpness: Option<Sharpness>, rules: Rules) -> Self {
        let tags = self.tags.and(sharpness.is_some(), "creases");
        Self { tags, sharpness: sharpness.map(Arc::new), rules, ..self }
    }

    /// Returns the net after an upsampling of the anchor's topology, with the values of its vertices.
    pub(super) fn after_split(&self, anchor: Anchor, local: Option<Arc<MeshLocal>>) -> Self {
        Self {
            mesh: self.mesh.after_split(&anchor),
            tags: self.tags.clone(),
            sharpness: anchor.sharpness_after(self.rules.creasing),
            rules: self.rules,
            annotations: self.annotations.after_split(&anchor.topology),
            since: SinceUpsampling { anchor: Some(anchor), local, duals: 0 },
            surroundings: self.surroundings.map(Surroundings::after_split),
        }
    }

    /// Returns the net after `splits` more splits of its faces that halve all edges. Only the base, the number of
    /// splits, the tags and the sharp edges are tracked; the sharpness of an edge decays equally along the whole edge.
    #[must_use]
    pub fn after_splits(&self, tile: Tile, splits: usize) -> Self {
        let halves = |sharpness: Option<Sharpness>, _| sharpness.and_then(|sharpness| sharpness.pieces(2));
        let sharpness = (0..splits).fold(self.sharpness.as_deref().cloned(), halves).map(Arc::new);
        let mesh = self.mesh.after_splits(tile, splits);
        let (annotations, since) = (Annotations::default(), SinceUpsampling::default());
        Self { mesh, tags: self.tags.clone(), sharpness, rules: self.rules, annotations, since, surroundings: None }
    }

    /// Returns the net of a topology that D made, with the anchor of the last upsampling.
    pub(super) fn after_dual(&self, topology: Topology, anchor: Option<Anchor>) -> Self {
        Self {
            tags: self.tags.after_dual(&topology),
            mesh: SplitMesh::new(Arc::new(topology), 0),
            sharpness: None,
            rules: self.rules,
            annotations: Annotations::default(),
            since: SinceUpsampling { anchor, local: None, duals: self.since.duals + 1 },
            surroundings: self.surroundings.map(Surroundings::after_dual),
        }
    }

    /// Returns the net of a topology that a step with a connectivity of its own made; `corners` are its corners,
    /// ascending.
    pub(super) fn after_rebuild(&self, topology: Topology, corners: Vec<u32>) -> Self {
        let mesh = SplitMesh::new(Arc::new(topology), self.mesh.rounds + 1);
        let since = SinceUpsampling { anchor: None, ..self.since.clone() };
        Self { mesh, tags: self.tags.after_rebuild(corners), since, ..self.clone() }
    }
}
