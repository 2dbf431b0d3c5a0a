//! Readers of mesh files, each strict and bounded. The registry is the only place that lists them.

mod attach;
mod base64;
mod beside;
mod collect;
mod colors;
mod gltf;
mod kind;
mod obj;
mod off;
mod ply;
mod reader;
mod registry;
mod room;
mod sniff;
mod stl;
mod text;
mod threemf;
mod transform;
mod usda;

pub use crate::shape::attachments::ChannelInput;
pub use crate::shape::labels::FaceSet;
pub use crate::shape::looks::Look;
pub use base64::decode as from_base64;
pub use beside::{Alone, Beside, InputFile, WithLibrary};
pub use kind::{foreign, is_text, own};
pub use reader::{CornerUvs, ReadLimits, ReadMesh, Reader, Vertices};
pub use registry::READERS;
pub use room::weight;

/// Returns the reader with this name.
pub fn named(name: &str) -> Option<&'static Reader> {
    READERS.iter().find(|reader| reader.name == name)
}

/// Returns the reader of files with this extension, given without the dot, in any case.
pub fn of_extension(extension: &str) -> Option<&'static Reader> {
    READERS.iter().find(|reader| reader.name.eq_ignore_ascii_case(extension))
}

/// Detects the reader from the first bytes of a file; glTF as JSON and most text are not detected.
pub fn of_bytes(bytes: &[u8]) -> Option<&'static Reader> {
    sniff::kind(bytes).and_then(named)
}
