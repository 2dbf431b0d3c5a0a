//! Counts of a result, known before it is computed.

use std::sync::Arc;

use crate::shape::attachments::Attachments;
use crate::shape::coordinate_system::CoordinateSystem;
use crate::solid::CageCounts;

/// The kind of a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShapeKind {
    /// Polygons whose points have this many coordinates.
    Curves {
        /// Number of coordinates, 1 to 4.
        dimension: usize,
    },
    /// A polygon mesh in space.
    Mesh,
}

impl ShapeKind {
    /// Accepts meshes, and refuses curves with this message.
    pub(super) fn only_meshes(self, refusal: &str) -> Result<(), String> {
        if self == Self::Mesh { Ok(()) } else { Err(refusal.to_owned()) }
    }
}

/// Exact counts of a result, known before it is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Counts {
    /// Curves or a mesh.
    pub kind: ShapeKind,
    /// Number of polygons (1 for a mesh).
    pub polygons: u128,
    /// Number of points or vertices of the input.
    pub control: u128,
    /// Number of points or vertices of the result.
    pub vertices: u128,
    /// Number of shown faces (0 for curves).
    pub faces: u128,
    /// Number of half-edges of the shown faces: the sum of their sizes (0 for curves).
    pub half_edges: u128,
    /// Number of vertices of the largest shown face (0 for curves).
    pub largest_face: u128,
    /// Maximum number of vertices added because normals differ across sharp edges; 0 if no edge is sharp.
    pub split_vertices: u128,
    /// Number of places with texture coordinates, if there are any.
    pub uvs: u128,
    /// Number of places of all channels with seams.
    pub seamed: u128,
    /// Number of vertices with one for each place of attributes with seams; 0 if there are no seams.
    pub unfolded: u128,
    /// Number of shown frames of a mesh after the first (0 for curves).
    pub frames: usize,
    /// The unit and the up axis of coordinates.
    pub coordinate_system: CoordinateSystem,
    /// The attachments of a mesh.
    pub attachments: Arc<Attachments>,
    /// Number of faces of the input mesh, hidden ones included (0 for curves).
    pub input_faces: usize,
    /// Number of edges of the input mesh (0 for curves).
    pub input_edges: usize,
    /// The properties of the input mesh that determine its solid, if one is requested.
    pub cage: CageCounts,
    /// Upper bounds of the rows and entries of the weights that make points from those of the input; 0 if no output has
    /// them.
    pub weights: [u128; 2],
    /// Maximum number of sharp edges and vertices of a mesh that is written without refinement (0 for curves).
    pub tags: usize,
}

impl Counts {
    /// Returns the number of triangles: a face of n vertices gives n - 2. If counts have overflowed, returns an upper
    /// bound.
    pub fn triangles(&self) -> u128 {
        let less = self.faces.checked_mul(2).and_then(|twice| self.half_edges.checked_sub(twice));
        less.unwrap_or(self.half_edges)
    }
}
