//! Formats: each writes a scene; the registry is the only place that lists them.

pub mod description;
pub mod figure;
pub mod film;
pub mod hard_edges;
pub mod left_out;
pub mod mtl;
pub mod normals;
pub mod scene;
pub mod surface;

mod apng;
mod bounds;
mod bytes;
mod certificate;
mod color_maps;
mod colors;
mod control_source;
mod counts;
mod curvature;
mod error;
mod farthest;
mod format;
mod glb;
mod gltf;
mod gltf_amounts;
mod gltf_animation;
mod gltf_bin;
mod gltf_buffer;
mod gltf_codec;
mod gltf_document;
mod gltf_grid;
mod gltf_levels;
mod gltf_looks;
mod gltf_order;
mod gltf_pack;
mod gltf_packing;
mod gltf_targets;
mod gltf_views;
mod json;
mod mesh_curvature;
mod nearest;
mod numbers;
mod obj;
mod options;
mod picture;
mod ply;
mod png;
mod positions;
mod registry;
mod sections;
mod size;
mod solid_options;
mod split_vertices;
mod stats;
mod stencils;
mod step;
mod stl;
mod stream;
mod text;
mod threemf;
mod usda;
mod vector;
mod vertex_sides;
mod vertex_sums;

pub use counts::{Counts, ShapeKind};
pub use error::FormatError;
pub use farthest::{Farthest, Measured};
pub use format::{Content, Costs, Details, Format, FormatFacts, MadeOf, Paper, ParameterRange, Requirements};
pub use obj::WITHOUT_LIBRARY;
pub use options::{CAGE, DIRECTION_ITEMS, LIMIT, POSITIONS, TANGENTS};
pub use picture::hidden_lines::MAX_LINE_TRIANGLES;
pub use picture::outline::Outline;
pub use picture::shading::shows_distances;
pub use registry::FORMATS;
pub use size::Size;

/// Returns the format with this name.
pub fn named(name: &str) -> Option<&'static dyn Format> {
    FORMATS.iter().copied().find(|format| format.name() == name)
}
