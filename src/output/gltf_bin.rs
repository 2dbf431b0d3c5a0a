//! The buffer of a glTF model alone, to which a document elsewhere refers.

use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Requirements};
use crate::output::gltf_amounts::{self, Amounts, split_vertices, with_normals};
use crate::output::gltf_buffer::buffered;
use crate::output::gltf_document::GLTF_OPTIONS;
use crate::output::gltf_pack::Packed;
use crate::output::gltf_packing::{self, Packing};
use crate::output::hard_edges;
use crate::output::scene::Scene;
use crate::output::size::Size;
use crate::output::stream::Stream;
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;

/// The bytes of a glTF buffer: the binary chunk of `glb` with the same options.
#[derive(Debug)]
pub(super) struct GltfBin;

const FACTS: &FormatFacts = &FormatFacts {
    name: "gltf-bin",
    extension: "bin",
    media_type: "application/gltf-buffer",
    content: Content::Binary,
    doc: "The buffer of a glTF model: what the documents of gltf with lod refer to",
    parameters: GLTF_OPTIONS,
    holds: |kind, _| kind.only_meshes("gltf-bin holds the buffers of meshes; ask for gltf"),
    ..FormatFacts::USUAL
};

/// Returns the kinds of faces of meshes whose buffer can be written while they are refined.
pub(super) fn streams(mesh: &Mesh, options: &Values) -> &'static [Tile] {
    match with_normals(options) {
        _ if Packing::of(options).is_some() => &[],
        false => &[Tile::Quad, Tile::Triangle],
        // vertices on sharp edges have copies with normals of their own
        true if mesh.creases.is_empty() && hard_edges::angle(options).is_none() => &[Tile::Quad],
        true => &[],
    }
}

impl Format for GltfBin {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn streams(&self, mesh: &Mesh, options: &Values) -> &'static [Tile] {
        streams(mesh, options)
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let watch = stream.watch;
        buffered(scene, options, watch, |buffer| match Packing::of(options) {
            Some(packing) => stream.bytes(&Packed::of(buffer, packing, watch)?.bytes),
            None => buffer.write(stream),
        })
    }
}

impl Requirements for GltfBin {
    fn suits(&self, kind: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        gltf_packing::suits(kind, options)
    }

    fn fits(&self, counts: &Counts, options: &Values) -> Result<(), Fault> {
        gltf_amounts::fits(counts, options)
    }
}

impl Costs for GltfBin {
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let amounts = Amounts::of(counts, options);
        match Packing::of(options) {
            Some(packing) => Size::AtMost(amounts.packed_bytes(packing)),
            // the number of split vertices depends on which edges stay sharp
            None if split_vertices(counts, options) > 0 => Size::AtMost(amounts.bytes()),
            None => Size::Exact(amounts.bytes()),
        }
    }

    fn memory(&self, counts: &Counts, options: &Values) -> u128 {
        gltf_amounts::memory(counts, options)
    }

    fn work(&self, _: Option<&Mesh>, counts: &Counts, options: &Values) -> u128 {
        gltf_amounts::packing_work(counts, options)
    }
}
