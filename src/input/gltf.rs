//! glTF 2.0 and GLB: reads the triangles of a scene with the transforms of its nodes applied.
//!
//! Source: Khronos Group, glTF 2.0 Specification (2021).

mod accessor;
mod buffers;
mod carried;
mod census;
mod looks;
mod packed;
mod scene;
mod transform;
mod triangles;

use self::buffers::GltfDocument;
use super::beside::InputFile;
use super::likeness::Likeness;
use super::reader::{ReadLimits, ReadMesh, Reader, Vertices};
use super::room::MemoryBudget;

/// The reader of glTF in JSON. Buffers are data URIs, or files beside the document if they are available.
///
/// It reads the triangles, strips and fans of the default scene; vertices that are separate in the file stay separate
/// (weld with 0 to merge equal positions). Groups are those that primitives name (`"extras": {"group": "top"}`),
/// otherwise nodes; materials become materials, except for a single one without a name and with a plain look. `COLOR_0`
/// becomes the channel `color`, and `TEXCOORD_0` the texture coordinates, with v flipped to point upwards;
/// application-specific attributes (`_HEAT`) become channels (`heat`). Normals are ignored; points, lines, skins and
/// morph targets are left out with a note.
pub(super) const GLTF: Reader = Reader {
    name: "gltf",
    media_type: "model/gltf+json",
    doc: "glTF 2.0 in JSON with data URIs, on the command line with files beside it: the triangles of its scene",
    vertices: Vertices::Doubled,
    likeness: |_| Likeness::Unlike,
    read: |file, limits| {
        if file.bytes.starts_with(b"glTF") {
            return Err(vec!["the file is binary; read it as glb".to_owned()]);
        }
        read(file, limits, |room| GltfDocument::of_json(file.bytes, None, file.beside, room))
    },
};

/// The reader of GLB, which is glTF in one binary file.
pub(super) const GLB: Reader = Reader {
    name: "glb",
    media_type: "model/gltf-binary",
    doc: "Binary glTF 2.0: the triangles of its scene",
    vertices: Vertices::Doubled,
    likeness: |file| file.bytes.starts_with(b"glTF").into(),
    read: |file, limits| read(file, limits, |room| GltfDocument::of_glb(file, room)),
};

fn read<'a>(
    file: &InputFile<'a>,
    limits: &ReadLimits,
    document: impl FnOnce(&mut MemoryBudget) -> Result<GltfDocument<'a>, String>,
) -> Result<ReadMesh, Vec<String>> {
    let mut room = MemoryBudget::new(file.bytes.len()).with_spare(file.beside.spare());
    let mesh = document(&mut room).and_then(|document| scene::read(&document, file.bytes.len(), room, limits));
    mesh.map_err(|detail| vec![detail])
}
