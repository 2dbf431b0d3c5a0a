//! The interface of mesh file readers, and the mesh that they return.

use super::beside::InputFile;
use super::likeness::{FileStart, Likeness};
use crate::scheme::tags::Boundary;
use crate::shape::attachments::ChannelInput;
use crate::shape::check::FaceList;
use crate::shape::coordinate_system::{Unit, Up};
use crate::shape::labels::FaceSet;
use crate::shape::looks::Look;
use crate::shape::seams::Interpolation;

/// A reader of one mesh file format.
#[derive(Debug)]
pub struct Reader {
    /// Name in requests, and file extension without the dot.
    pub name: &'static str,
    /// Media type of the format.
    pub media_type: &'static str,
    /// Description in one sentence, for the catalogue.
    pub doc: &'static str,
    /// Which face corners share a vertex.
    pub vertices: Vertices,
    /// Tells how far a file resembles those of the format, where requests do not name it.
    pub likeness: fn(&FileStart<'_>) -> Likeness,
    /// Reads a file. The memory that it takes is bounded by the [`reading_memory`](super::room::reading_memory) of
    /// the length of the bytes and of the files beside it, whatever counts they claim. Errors are sentences that name
    /// the fault by line or byte.
    pub read: fn(&InputFile<'_>, &ReadLimits) -> Result<ReadMesh, Vec<String>>,
}

/// Which face corners share a vertex in files of a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Vertices {
    /// Corners share a vertex if the file says so.
    Shared,
    /// Corners share a vertex only if all vertex data are equal, so that vertices at one position may be repeated.
    Doubled,
    /// Corners share no vertex in the file; vertices at equal positions are joined on reading.
    Joined,
}

/// Limits on one file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadLimits {
    /// Maximum number of vertices.
    pub max_vertices: u64,
    /// Maximum number of faces.
    pub max_faces: u64,
}

impl Default for ReadLimits {
    fn default() -> Self {
        Self { max_vertices: 40_000_000, max_faces: 20_000_000 }
    }
}

/// The contents of a mesh file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadMesh {
    /// Positions of the vertices, `n x 3`, model units.
    pub positions: Vec<[f64; 3]>,
    /// Faces, each with at least 3 valid vertices.
    pub faces: FaceList,
    /// The line of each face in the file; empty if the format has no lines.
    pub lines: Vec<u32>,
    /// Edges with their sharpness.
    pub creases: Vec<([u64; 2], f64)>,
    /// Vertices with their sharpness.
    pub corners: Vec<(u64, f64)>,
    /// Faces that are refined but not shown.
    pub holes: Vec<u64>,
    /// The unit of the coordinates, if the file gives it.
    pub unit: Option<Unit>,
    /// The up axis, if the file gives it.
    pub up: Option<Up>,
    /// The boundary rule, if the file gives it.
    pub boundary: Option<Boundary>,
    /// Which face corners share a vertex, if this file differs from its format.
    pub vertices: Option<Vertices>,
    /// Texture coordinates.
    pub uvs: Option<CornerUvs>,
    /// Named sets of faces, which may overlap; a face belongs to the first set that contains it.
    pub groups: Vec<FaceSet>,
    /// Materials with their faces.
    pub materials: Vec<FaceSet>,
    /// The looks of the first of these materials.
    pub looks: Vec<Look>,
    /// Channels of vertices or corners.
    pub channels: Vec<ChannelInput>,
    /// Sentences about data that were left out or changed.
    pub notes: Vec<String>,
}

/// Texture coordinates of face corners.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CornerUvs {
    /// Coordinates, `n x 2`.
    pub values: Vec<[f64; 2]>,
    /// The row in `values` of each corner, face after face.
    pub corners: Vec<u32>,
    /// Where the coordinates are interpolated linearly, which most formats cannot express.
    pub interpolation: Interpolation,
}

impl CornerUvs {
    /// Creates texture coordinates from the rows of the corners, with linear interpolation everywhere.
    pub(super) fn new(values: Vec<[f64; 2]>, corners: Vec<u32>) -> Self {
        Self { values, corners, interpolation: Interpolation::All }
    }
}
