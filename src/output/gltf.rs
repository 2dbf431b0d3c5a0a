//! glTF 2.0 as one text file, the buffer inside as base64.

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;

use crate::fault::Fault;
use crate::math::parameter::{Parameter, Values};
use crate::output::counts::{Counts, ShapeKind};
use crate::output::description::DescriptionPlace;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Details, Format, FormatFacts, Requirements};
use crate::output::gltf_amounts::{self, Amounts, GltfContents};
use crate::output::gltf_bin::GltfBin;
use crate::output::gltf_buffer::buffered;
use crate::output::gltf_document::{GLTF_OPTIONS, document};
use crate::output::gltf_levels::{self, LOD};
use crate::output::gltf_pack::Packed;
use crate::output::gltf_packing::{self, Packing};
use crate::output::numbers::total;
use crate::output::options::joined;
use crate::output::scene::Scene;
use crate::output::size::Size;
use crate::output::stream::{Stream, holds_space};
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;

const URI: &str = "data:application/octet-stream;base64,";

/// Self-contained glTF 2.0: the same content as GLB, with the buffer in a data URI.
#[derive(Debug)]
pub(super) struct Gltf;

/// The options of both containers, and the one for levels of detail in several files.
const ALL_PARAMETERS: [Parameter; GLTF_OPTIONS.len() + 1] = joined(GLTF_OPTIONS, &[LOD]);

const FACTS: &FormatFacts = &FormatFacts {
    name: "gltf",
    extension: "gltf",
    media_type: "model/gltf+json",
    content: Content::Json,
    doc: "Self-contained glTF 2.0 in JSON: as glb, with the numbers as base64",
    parameters: &ALL_PARAMETERS,
    description: Some(DescriptionPlace::Gltf),
    holds_frames: true,
    holds: |kind, _| holds_space("gltf", kind),
    has_no_tags: true,
    ..FormatFacts::USUAL
};

impl Format for Gltf {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn details(&self, options: &Values) -> Option<Details> {
        let levels = gltf_levels::of(options)?;
        Some(Details { format: &GltfBin, option: LOD.name, levels })
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let watch = stream.watch;
        if !scene.details.is_empty() {
            return gltf_levels::write(scene, stream);
        }
        buffered(scene, options, watch, |buffer| match Packing::of(options) {
            Some(packing) => {
                let packed = Packed::of(buffer, packing, watch)?;
                write(&packed.document(Some(URI))?, stream, |stream| stream.bytes(&packed.bytes))
            }
            None => write(&document(buffer, Some(URI))?, stream, |stream| buffer.write(stream)),
        })
    }
}

impl Requirements for Gltf {
    fn suits(&self, kind: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        gltf_levels::suits(kind, options)?;
        gltf_packing::suits(kind, options)
    }

    fn fits(&self, counts: &Counts, options: &Values) -> Result<(), Fault> {
        gltf_amounts::fits(counts, options)?;
        gltf_levels::fits(counts, options)?;
        gltf_packing::fits(counts, options)
    }
}

impl Costs for Gltf {
    fn memory(&self, counts: &Counts, options: &Values) -> u128 {
        gltf_amounts::memory(counts, options)
    }

    fn work(&self, _: Option<&Mesh>, counts: &Counts, options: &Values) -> u128 {
        gltf_amounts::packing_work(counts, options)
    }

    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let (amounts, contents) = (Amounts::of(counts, options), GltfContents::of(counts, options));
        if let Some(size) = gltf_levels::size(contents, options) {
            return size;
        }
        let (json, binary) = match Packing::of(options) {
            Some(packing) => (contents.packed_room(), amounts.packed_bytes(packing)),
            None => (contents.room(), amounts.bytes()),
        };
        Size::AtMost(total(&[(json, 1), (URI.len() as u128, 1), (binary.div_ceil(3), 4)]))
    }
}

/// Writes a document, and inserts the bytes of its buffer after the start of its data URI.
fn write(
    json: &[u8],
    stream: &mut Stream<'_>,
    write_bytes: impl FnOnce(&mut Stream<'_>) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    let Some(start) = json.windows(URI.len()).position(|text| text == URI.as_bytes()) else {
        return stream.bytes(json);
    };
    let (before, after) = json.split_at(start + URI.len());
    stream.bytes(before)?;
    let mut base64 = EncoderWriter::new(&mut *stream.out, &STANDARD);
    write_bytes(&mut Stream::new(&mut base64, stream.watch))?;
    Ok(base64.finish()?.write_all(after)?)
}
