//! Readers of mesh files, each strict and bounded. Only the registry lists them.

mod attach;
mod base64;
mod beside;
mod collect;
mod colors;
mod find;
mod gltf;
mod kind;
mod likeness;
mod obj;
mod off;
mod ply;
mod reader;
mod registry;
mod room;
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
pub use find::{mistaken, named, of_bytes, of_extension, own};
pub use kind::{foreign, is_text};
pub use likeness::{FileStart, Likeness};
pub use reader::{CornerUvs, ReadLimits, ReadMesh, Reader, Vertices};
pub use registry::READERS;
pub use room::reading_memory;
