//! The list of all readers.

use super::reader::Reader;
use super::{gltf, obj, off, ply, stl, threemf, usda};

/// All readers, in the order of the documentation.
pub const READERS: &[Reader] =
    &[obj::OBJ, ply::PLY, stl::STL, off::OFF, gltf::GLTF, gltf::GLB, threemf::THREE_MF, usda::USDA];
