//! GLB: glTF 2.0 in one binary file.

use std::io;

use crate::fault::Fault;
use crate::math::amounts::in_bytes;
use crate::math::parameter::Values;
use crate::output::counts::{Counts, ShapeKind};
use crate::output::description::DescriptionPlace;
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, Requirements};
use crate::output::gltf_amounts::{self, Amounts, GltfContents, split_vertices};
use crate::output::gltf_bin;
use crate::output::gltf_buffer::{Buffer, buffered};
use crate::output::gltf_document::{GLTF_OPTIONS, document};
use crate::output::gltf_pack::Packed;
use crate::output::gltf_packing::{self, Packing};
use crate::output::numbers::total;
use crate::output::scene::Scene;
use crate::output::size::Size;
use crate::output::stream::{Stream, holds_space};
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;
use crate::shape::tile::Tile;

/// Bytes before the first chunk, and before the content of each chunk.
const CONTAINER_HEADER_BYTES: u128 = 12;
const CHUNK_HEADER: u128 = 8;

/// Binary glTF 2.0: triangles or line strips in f32.
///
/// The JSON chunk is padded with spaces to a length that depends only on the kind of the shape, the number of polygons
/// and the attachments of the mesh, so that the length of the file is known beforehand. Models far from the origin are
/// moved there, and the node's translation moves them back.
///
/// Source: Khronos Group, glTF 2.0 Specification, section 4.4.
#[derive(Debug)]
pub(super) struct Glb;

const FACTS: &FormatFacts = &FormatFacts {
    name: "glb",
    extension: "glb",
    media_type: "model/gltf-binary",
    content: Content::Binary,
    doc: "Binary glTF 2.0: triangles with normals, or line strips, in f32",
    parameters: GLTF_OPTIONS,
    description: Some(DescriptionPlace::Glb),
    holds_frames: true,
    holds: |kind, _| holds_space("glb", kind),
    has_no_tags: true,
    ..FormatFacts::USUAL
};

impl Format for Glb {
    fn facts(&self) -> &'static FormatFacts {
        FACTS
    }

    fn streams(&self, mesh: &Mesh, options: &Values) -> &'static [Tile] {
        gltf_bin::streams(mesh, options)
    }

    fn encode(&self, scene: &Scene<'_>, options: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let watch = stream.watch;
        buffered(scene, options, watch, |buffer| match Packing::of(options) {
            Some(packing) => write_packed(&Packed::of(buffer, packing, watch)?, stream),
            None => write(buffer, stream),
        })
    }
}

impl Requirements for Glb {
    fn suits(&self, kind: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        gltf_packing::suits(kind, options)
    }

    fn fits(&self, counts: &Counts, options: &Values) -> Result<(), Fault> {
        gltf_amounts::fits(counts, options)?;
        gltf_packing::fits(counts, options)?;
        let length = check_length(self.size(counts, options).bytes());
        length.map(drop).map_err(|detail| Fault::new("/format", detail))
    }
}

impl Costs for Glb {
    fn size(&self, counts: &Counts, options: &Values) -> Size {
        let (amounts, contents) = (Amounts::of(counts, options), GltfContents::of(counts, options));
        if let Some(packing) = Packing::of(options) {
            return Size::AtMost(file(contents.packed_room(), amounts.packed_bytes(packing)));
        }
        let bytes = file(contents.room(), amounts.bytes());
        // the number of split vertices depends on which edges stay sharp
        if split_vertices(counts, options) > 0 { Size::AtMost(bytes) } else { Size::Exact(bytes) }
    }

    fn memory(&self, counts: &Counts, options: &Values) -> u128 {
        gltf_amounts::memory(counts, options)
    }

    fn work(&self, _: Option<&Mesh>, counts: &Counts, options: &Values) -> u128 {
        gltf_amounts::packing_work(counts, options)
    }
}

fn write(buffer: &Buffer<'_>, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let json = padded(document(buffer, None)?, buffer.contents().room())?;
    let binary = buffer.amounts.bytes();
    container(&json, binary, stream)?;
    if binary > 0 { buffer.write(stream) } else { Ok(()) }
}

/// Writes everything before `binary` bytes of the binary chunk; there is no such chunk if it is empty.
fn container(json: &[u8], binary: u128, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let room = json.len() as u128;
    let file = check_length(file(room, binary)).map_err(FormatError::Unfit)?;
    let [room, binary] = [room, binary].map(|part| u32::try_from(part).expect("the parts are shorter than the file"));
    stream.bytes(b"glTF")?;
    stream.bytes([2, file].map(u32::to_le_bytes).as_flattened())?;
    chunk(*b"JSON", room, stream)?;
    stream.bytes(json)?;
    if binary > 0 { chunk(*b"BIN\0", binary, stream) } else { Ok(()) }
}

fn write_packed(packed: &Packed, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let document = packed.document(None)?;
    let room = document.len().next_multiple_of(4) as u128;
    container(&padded(document, room)?, packed.bytes.len() as u128, stream)?;
    stream.bytes(&packed.bytes)
}

/// Pads the document with spaces to its forecast length.
fn padded(mut json: Vec<u8>, room: u128) -> Result<Vec<u8>, FormatError> {
    let length = json.len();
    if length as u128 > room {
        // a document cut short would not be JSON, and the length of the file was announced
        let detail = format!("the glTF document takes {length} bytes, {room} were forecast");
        return Err(FormatError::Io(io::Error::other(detail)));
    }
    // a length beyond `usize` fails in the container, whose lengths have 32 bits
    json.resize(usize::try_from(room).unwrap_or(length), b' ');
    Ok(json)
}

/// Converts the length of a file to the 32 bits of glb.
fn check_length(bytes: u128) -> Result<u32, String> {
    u32::try_from(bytes).map_err(|_| {
        let [bytes, most] = [bytes, u32::MAX.into()].map(in_bytes);
        format!("the file would take {bytes}, glb counts at most {most}; ask for fewer levels or for ply")
    })
}

/// Returns the length of a file with chunks of these lengths; an empty binary chunk is left out.
fn file(json: u128, binary: u128) -> u128 {
    let chunks = if binary > 0 { 2 } else { 1 };
    total(&[(CONTAINER_HEADER_BYTES, 1), (CHUNK_HEADER, chunks), (json, 1), (binary, 1)])
}

fn chunk(kind: [u8; 4], length: u32, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.bytes(&length.to_le_bytes())?;
    stream.bytes(&kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_longer_than_forecast_is_an_error_and_never_cut() {
        assert_eq!(padded(b"{}".to_vec(), 4).expect("it fits"), b"{}  ");
        assert_eq!(padded(b"{}".to_vec(), 2).expect("it fits"), b"{}");
        let error = padded(b"{\"a\": 1}".to_vec(), 4).expect_err("it does not fit");
        assert!(matches!(error, FormatError::Io(_)), "{error}");
    }
}
