//! What every reader does, and what it hands over.

use super::beside::File;
use crate::scheme::tags::Boundary;
use crate::shape::attachments::ChannelInput;
use crate::shape::check::FaceList;
use crate::shape::frame::{Unit, Up};
use crate::shape::labels::FaceSet;
use crate::shape::looks::Look;
use crate::shape::seams::Interpolation;

/// A way to read a mesh from the bytes of a file.
#[derive(Debug)]
pub struct Reader {
    /// Name in requests, and file extension without the dot.
    pub name: &'static str,
    /// Media type of the bytes.
    pub media_type: &'static str,
    /// One sentence for the catalogue.
    pub doc: &'static str,
    /// Which corners of faces share a vertex.
    pub vertices: Vertices,
    /// Reads a file. No more memory is taken than the [`weight`](super::room::weight) of the length of the bytes and of
    /// those of the files beside it, whatever counts they claim. Refusals are sentences that name what is wrong by line
    /// or byte.
    pub read: fn(&File<'_>, &ReadLimits) -> Result<ReadMesh, Vec<String>>,
}

/// Which corners of faces share a vertex in files of a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Vertices {
    /// Those that the file lets share one.
    Shared,
    /// Those with the same of all that vertices carry, so that vertices at one place are there several times.
    Doubled,
    /// None in the file; those at the same place are joined as it is read.
    Joined,
}

/// Bounds on one file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadLimits {
    /// Vertices.
    pub max_vertices: u64,
    /// Faces.
    pub max_faces: u64,
}

impl Default for ReadLimits {
    fn default() -> Self {
        Self { max_vertices: 40_000_000, max_faces: 20_000_000 }
    }
}

/// What a file holds.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadMesh {
    /// Positions of the vertices, `n x 3`, model units.
    pub positions: Vec<[f64; 3]>,
    /// Faces, each of 3 or more vertices that exist.
    pub faces: FaceList,
    /// The line of each face in the file, where it has one; else empty.
    pub lines: Vec<u32>,
    /// Edges with a sharpness.
    pub creases: Vec<([u64; 2], f64)>,
    /// Vertices with a sharpness.
    pub corners: Vec<(u64, f64)>,
    /// Faces that are refined but not shown.
    pub holes: Vec<u64>,
    /// The unit of its coordinates, where the file says it.
    pub unit: Option<Unit>,
    /// The axis that points up, where the file says it.
    pub up: Option<Up>,
    /// The boundary rule that the file asks for.
    pub boundary: Option<Boundary>,
    /// Which corners of faces share a vertex, where the file knows it better than its format.
    pub vertices: Option<Vertices>,
    /// Texture coordinates.
    pub uvs: Option<Uvs>,
    /// Named sets of faces, which may overlap: a face is in the first.
    pub groups: Vec<FaceSet>,
    /// Materials with their faces.
    pub materials: Vec<FaceSet>,
    /// How the first of these materials look.
    pub looks: Vec<Look>,
    /// Numbers that vertices carry.
    pub channels: Vec<ChannelInput>,
    /// What was left out or changed, in sentences.
    pub notes: Vec<String>,
}

/// Texture coordinates that belong to the corners of faces.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Uvs {
    /// Coordinates, `n x 2`.
    pub values: Vec<[f64; 2]>,
    /// For each corner (face after face) its row of `values`.
    pub corners: Vec<u32>,
    /// Where they are interpolated linearly, which most formats do not know of.
    pub interpolation: Interpolation,
}

impl Uvs {
    /// Those of corners by their rows, interpolated linearly everywhere.
    pub(super) fn new(values: Vec<[f64; 2]>, corners: Vec<u32>) -> Self {
        Self { values, corners, interpolation: Interpolation::All }
    }
}
