//! glTF 2.0 and GLB: the triangles of a scene, each node where its transforms put it.
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

use self::buffers::Document;
use super::beside::File;
use super::reader::{ReadLimits, ReadMesh, Reader, Vertices};
use super::room::Room;

/// glTF as text. Buffers are data URIs, or files beside it, where whoever hands it over has them.
///
/// Read are the triangles, strips and fans of the default scene; vertices stay apart where the file has them apart
/// (weld with 0 to merge equal places). Groups are those that primitives name (`"extras": {"group": "top"}`), else
/// nodes; materials are materials, one without a name is none. `COLOR_0` is the channel `color`, `TEXCOORD_0` the
/// texture coordinates, turned to count v upwards; attributes of applications (`_HEAT`) are channels (`heat`). Normals
/// are ignored; points, lines, skins and morph targets are left out with a note.
pub(super) const GLTF: Reader = Reader {
    name: "gltf",
    media_type: "model/gltf+json",
    doc: "glTF 2.0 in JSON with data URIs, on the command line with files beside it: the triangles of its scene",
    vertices: Vertices::Doubled,
    read: |file, limits| {
        if file.bytes.starts_with(b"glTF") {
            return Err(vec!["the file is binary; read it as glb".to_owned()]);
        }
        read(file, limits, |room| Document::of_json(file.bytes, None, file.beside, room))
    },
};

/// GLB: glTF in one binary file.
pub(super) const GLB: Reader = Reader {
    name: "glb",
    media_type: "model/gltf-binary",
    doc: "Binary glTF 2.0: the triangles of its scene",
    vertices: Vertices::Doubled,
    read: |file, limits| read(file, limits, |room| Document::of_glb(file, room)),
};

fn read<'a>(
    file: &File<'a>,
    limits: &ReadLimits,
    document: impl FnOnce(&mut Room) -> Result<Document<'a>, String>,
) -> Result<ReadMesh, Vec<String>> {
    let mut room = Room::new(file.bytes.len()).with_spare(file.beside.spare());
    let mesh = document(&mut room).and_then(|document| scene::read(&document, file.bytes.len(), room, limits));
    mesh.map_err(|detail| vec![detail])
}
