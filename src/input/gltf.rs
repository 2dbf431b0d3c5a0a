//! glTF 2.0 and GLB: the triangles of a scene, each node where its transforms put it.
//!
//! Source: Khronos Group, glTF 2.0 Specification (2021).

mod accessor;
mod buffers;
mod carried;
mod census;
mod scene;
mod transform;

use self::buffers::Document;
use super::reader::{ReadLimits, ReadMesh, Reader};
use super::room::Room;
use crate::fault::Fault;

/// glTF in one text file. Buffers have to be data URIs.
///
/// Read are the triangles, strips and fans of the default scene; vertices stay apart where the file has them apart
/// (weld with 0 to merge equal places). Groups are those that primitives name (`"extras": {"group": "top"}`), else
/// nodes; materials are materials, one without a name is none. `COLOR_0` is the channel `color`, `TEXCOORD_0` the
/// texture coordinates, turned to count v upwards; attributes of applications (`_HEAT`) are channels (`heat`). Normals
/// are ignored; points, lines, skins and morph targets are left out with a note.
#[derive(Debug)]
pub(super) struct Gltf;

/// GLB: glTF in one binary file.
#[derive(Debug)]
pub(super) struct Glb;

impl Reader for Gltf {
    fn name(&self) -> &'static str {
        "gltf"
    }

    fn media_type(&self) -> &'static str {
        "model/gltf+json"
    }

    fn doc(&self) -> &'static str {
        "glTF 2.0 in JSON with data URIs: the triangles of its scene"
    }

    fn read(&self, bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, Vec<Fault>> {
        let mut room = Room::new(bytes.len());
        let document = if bytes.starts_with(b"glTF") {
            Err("the file is binary; read it as glb".to_owned())
        } else {
            Document::of_json(bytes, None, &mut room)
        };
        read(document, bytes.len(), room, limits)
    }
}

impl Reader for Glb {
    fn name(&self) -> &'static str {
        "glb"
    }

    fn media_type(&self) -> &'static str {
        "model/gltf-binary"
    }

    fn doc(&self) -> &'static str {
        "Binary glTF 2.0: the triangles of its scene"
    }

    fn read(&self, bytes: &[u8], limits: &ReadLimits) -> Result<ReadMesh, Vec<Fault>> {
        let mut room = Room::new(bytes.len());
        let document = Document::of_glb(bytes, &mut room);
        read(document, bytes.len(), room, limits)
    }
}

fn read(
    document: Result<Document<'_>, String>,
    length: usize,
    room: Room,
    limits: &ReadLimits,
) -> Result<ReadMesh, Vec<Fault>> {
    let mesh = document.and_then(|document| scene::read(&document, length, room, limits));
    mesh.map_err(|detail| vec![Fault::new("", detail)])
}
