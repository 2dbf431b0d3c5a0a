//! What is known of a result before it is computed.

use std::sync::Arc;

use crate::shape::attachments::Attachments;
use crate::shape::frame::Frame;
use crate::solid::Cage;

/// What kind of shape is to be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShapeKind {
    /// Polygons whose points have this many coordinates.
    Curves {
        /// 1 to 4.
        dimension: usize,
    },
    /// A polygon mesh in space.
    Mesh,
}

/// Exact counts of a result, known before it is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Counts {
    /// Curves or a mesh.
    pub kind: ShapeKind,
    /// Number of polygons (1 for a mesh).
    pub polygons: u128,
    /// Points or vertices of the input.
    pub control: u128,
    /// Points or vertices.
    pub vertices: u128,
    /// Shown faces (0 for curves).
    pub faces: u128,
    /// Half-edges of the shown faces: the sum of their sizes (0 for curves).
    pub half_edges: u128,
    /// Vertices of the largest shown face (0 for curves).
    pub largest_face: u128,
    /// Vertices that are added, at most, where normals differ across sharp edges; 0 where no edge is sharp.
    pub split_vertices: u128,
    /// Places with texture coordinates, where there are some.
    pub uvs: u128,
    /// Places of all channels with seams.
    pub seamed: u128,
    /// Vertices where there is one for each place of all that has seams; 0 where nothing has.
    pub unfolded: u128,
    /// Frames of a mesh beside the first that are shown (0 for curves).
    pub frames: usize,
    /// What the coordinates mean.
    pub frame: Frame,
    /// What a mesh carries besides its shape.
    pub attachments: Arc<Attachments>,
    /// Faces of the input mesh, hidden ones included (0 for curves).
    pub input_faces: usize,
    /// Edges of the input mesh (0 for curves).
    pub input_edges: usize,
    /// What decides about the solid of the input mesh, where one is asked for.
    pub cage: Cage,
    /// Rows and entries of the weights that make the points of those of the input, at most; 0 where no output has them.
    pub weights: [u128; 2],
    /// Sharp edges and vertices of a mesh that is written as it was given, at most (0 for curves).
    pub tags: usize,
}

impl Counts {
    /// Triangles after triangulation: a face of n vertices gives n - 2. Where counts are too large to be true, a bound.
    pub fn triangles(&self) -> u128 {
        let less = self.faces.checked_mul(2).and_then(|twice| self.half_edges.checked_sub(twice));
        less.unwrap_or(self.half_edges)
    }
}
