//! Formats: each writes a scene; the registry is the only place that lists them.

pub mod normals;
pub mod scene;
pub mod surface;

mod bounds;
mod colors;
mod curvature;
mod glb;
mod gltf;
mod gltf_amounts;
mod gltf_buffer;
mod gltf_document;
mod gltf_views;
mod json;
mod numbers;
mod obj;
mod parted;
mod picture;
mod ply;
mod png;
mod sections;
mod sides;
mod stats;
mod stl;
mod stream;
mod svg;

use std::io::{self, Write};
use std::sync::Arc;

use crate::fault::Fault;
use crate::math::parameter::{Default, Kind, Parameter, Values};
use crate::output::scene::Scene;
use crate::shape::attachments::Attachments;
use crate::shape::frame::Frame;
use crate::shape::mesh::Mesh;
use crate::watch::{Stopped, Watch};

/// Every format, in the order of the documentation.
pub const FORMATS: &[&dyn Format] =
    &[&json::Json, &stats::Stats, &obj::Obj, &glb::Glb, &gltf::Gltf, &ply::Ply, &stl::Stl, &png::Png, &svg::Svg];

/// The option of mesh formats that tells of what in the input everything came.
const IDS: Parameter = Parameter {
    name: "ids",
    kind: Kind::Flag,
    unit: "",
    default: Default::Flag(false),
    doc: "For each face of a mesh the input face it came of, for each vertex the input vertex, edge or face",
};

/// The edges of the input on a refined mesh: an option of formats that write them, and what pictures show.
const ISOLINES: &str = "isolines";

/// The format of a name.
pub fn named(name: &str) -> Option<&'static dyn Format> {
    FORMATS.iter().copied().find(|format| format.name() == name)
}

/// Name of the choice that moves points to the limit.
pub const LIMIT: &str = "limit";

/// The option where the points of the last level stand.
pub const POSITIONS: Parameter = Parameter {
    name: "positions",
    kind: Kind::Choice(&["refined", LIMIT]),
    unit: "",
    default: Default::Text("refined"),
    doc: "Whether the points of the last level stay where refinement put them, or move to their limit.",
};

/// The option of unit tangents.
pub const TANGENTS: Parameter = Parameter {
    name: "tangents",
    kind: Kind::Flag,
    unit: "",
    default: Default::Flag(false),
    doc: "Whether the unit tangents of the limit curve at the points are written; null where there is none. Curves only.",
};

/// A way to write a scene as bytes.
pub trait Format: std::fmt::Debug + Send + Sync {
    /// Name in requests.
    fn name(&self) -> &'static str;
    /// File extension without the dot.
    fn extension(&self) -> &'static str {
        self.name()
    }
    /// Media type of the bytes.
    fn media_type(&self) -> &'static str;
    /// One sentence for the catalogue.
    fn doc(&self) -> &'static str;
    /// Options that this format knows.
    fn parameters(&self) -> &'static [Parameter];
    /// Whether the format can hold a shape of this kind.
    ///
    /// # Errors
    /// A sentence that says why not, and which formats can.
    fn holds(&self, kind: ShapeKind) -> Result<(), String>;
    /// Whether the format can hold what these options make of a shape of this kind.
    ///
    /// # Errors
    /// As [`Format::holds`].
    fn takes(&self, kind: ShapeKind, _options: &Values) -> Result<(), String> {
        self.holds(kind)
    }
    /// Whether the options make sense for a shape of this kind that carries this.
    ///
    /// # Errors
    /// The fault, with a pointer below the output.
    fn suits(&self, _kind: ShapeKind, _carried: &Attachments, _options: &Values) -> Result<(), Fault> {
        Ok(())
    }
    /// Whether the format can count what there will be; what coordinates it can hold shows only when they are there.
    ///
    /// # Errors
    /// The fault, with a pointer below the output.
    fn fits(&self, _counts: &Counts, _options: &Values) -> Result<(), Fault> {
        Ok(())
    }
    /// Bytes that `counts` will take.
    fn size(&self, counts: &Counts, options: &Values) -> Size;
    /// What the options tell of single faces, edges or vertices of the input, if anything: schemes that make faces of
    /// their own cannot.
    fn refers(&self, options: &Values) -> Option<&'static str> {
        options.flag(IDS.name).then_some(IDS.name)
    }
    /// Bytes of memory that the options cost while the scene is written, besides those that every picture of such a mesh
    /// and its bytes need.
    fn memory(&self, _counts: &Counts, _options: &Values) -> u128 {
        0
    }
    /// Work that the scene takes besides refining it and making its bytes, in rows of a table, 100 ns each; `mesh` is the
    /// input, where that is one.
    fn work(&self, _mesh: Option<&Mesh>, _counts: &Counts, _options: &Values) -> u128 {
        0
    }
    /// Writes the scene.
    ///
    /// # Errors
    /// When the scene cannot be held after all, the writer fails, or the watch says stop.
    fn write(&self, scene: &Scene<'_>, options: &Values, out: &mut dyn Write, watch: &Watch)
    -> Result<(), FormatError>;
}

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
    /// Sum of the sizes of the shown faces.
    pub corners: u128,
    /// Corners of the largest shown face (0 for curves).
    pub largest_face: u128,
    /// Vertices that are added, at most, where normals differ across sharp edges; 0 where no edge is sharp.
    pub parted: u128,
    /// Places with texture coordinates, where there are some.
    pub uvs: u128,
    /// What the coordinates mean.
    pub frame: Frame,
    /// What a mesh carries besides its shape.
    pub attachments: Arc<Attachments>,
    /// Faces of the input mesh, hidden ones included (0 for curves).
    pub input_faces: usize,
    /// Edges of the input mesh (0 for curves).
    pub input_edges: usize,
    /// Sharp edges and vertices of a mesh that is written as it was given, at most (0 for curves).
    pub tags: usize,
}

impl Counts {
    /// Triangles after triangulation: a face of n vertices gives n - 2. Where counts are too large to be true, a bound.
    pub fn triangles(&self) -> u128 {
        let less = self.faces.checked_mul(2).and_then(|twice| self.corners.checked_sub(twice));
        less.unwrap_or(self.corners)
    }
}

/// Length of an artifact in bytes, before it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// Exactly this many.
    Exact(u128),
    /// At most this many.
    AtMost(u128),
}

impl Size {
    /// The number, exact or bound.
    pub fn bytes(self) -> u128 {
        match self {
            Self::Exact(n) | Self::AtMost(n) => n,
        }
    }
}

/// Why a scene was not written.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The job was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The bytes could not be taken.
    #[error("writing the result failed: {0}")]
    Io(#[from] io::Error),
    /// The scene holds something the format cannot express.
    #[error("{0}")]
    Unfit(String),
}
