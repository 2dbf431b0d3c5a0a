//! Presets: one file each family; the registry is the only place that lists them.

mod b_splines;
mod circles;
mod incenter;
mod interpolating;
mod masks;
mod meshes;
mod push_back;
mod quads;
mod registry;
mod ternary;
mod triangles;

pub(super) use push_back::with_functions;
pub use registry::PRESETS;
