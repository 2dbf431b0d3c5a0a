//! The options that make glTF smaller.

use crate::fault::Fault;
use crate::math::parameter::{Parameter, Values};
use crate::output::counts::{Counts, ShapeKind};

/// The option of both containers that makes numbers smaller.
pub(super) const COMPRESSION: Parameter = Parameter::choice(
    "compression",
    &["none", "quantize", "meshopt"],
    "How a mesh is made smaller: not at all; positions, texture coordinates and colours in 16 bits and normals in \
     8 (KHR_mesh_quantization); or these encoded (EXT_meshopt_compression), with vertex_order cache. The extras \
     of each mesh tell the error of positions in model units",
);

/// The option of both containers that orders vertices and triangles.
pub(super) const VERTEX_ORDER: Parameter = Parameter::choice(
    "vertex_order",
    &["documented", "cache"],
    "Whether vertices and triangles of a mesh have the order that all formats have, or one in which graphics \
     processors meet vertices again soon",
);

/// The steps of packing a model in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Packing {
    /// Whether numbers are rounded to 16 bits and fewer.
    pub(super) quantizes: bool,
    /// Whether views are encoded.
    pub(super) encodes: bool,
    /// Whether triangles and vertices are ordered.
    pub(super) orders: bool,
}

impl Packing {
    /// Returns the steps that the options request; `None` if a model is not packed.
    pub(super) fn of(options: &Values) -> Option<Self> {
        let compression = options.choice(COMPRESSION.name);
        let encodes = compression == Some("meshopt");
        let quantizes = encodes || compression == Some("quantize");
        let orders = encodes || options.choice(VERTEX_ORDER.name) == Some("cache");
        (quantizes || orders).then_some(Self { quantizes, encodes, orders })
    }

    /// Returns a pointer to the option that requests packing.
    fn option(self) -> String {
        let option = if self.quantizes { COMPRESSION } else { VERTEX_ORDER };
        format!("/{}", option.name)
    }
}

/// Refuses packing of curves.
pub(super) fn suits(kind: ShapeKind, options: &Values) -> Result<(), Fault> {
    match (Packing::of(options), kind) {
        (Some(packing), ShapeKind::Curves { .. }) => {
            Err(Fault::new(packing.option(), "it is for meshes, and these are curves; leave it out"))
        }
        _ => Ok(()),
    }
}

/// Refuses packing of meshes with frames.
pub(super) fn fits(counts: &Counts, options: &Values) -> Result<(), Fault> {
    match Packing::of(options) {
        Some(packing) if counts.frames > 0 => {
            let detail = "the frames of a mesh are written as they are; leave it out, or name one with \"frame\"";
            Err(Fault::new(packing.option(), detail))
        }
        _ => Ok(()),
    }
}
