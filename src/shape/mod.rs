//! Shapes: polygons and meshes as they are given, and the flat topology that operators read.

pub mod attachments;
pub mod attributes;
pub mod check;
mod corner_cut;
pub mod creases;
pub mod directions;
pub mod frame;
pub mod grid;
mod indices;
pub mod labels;
mod line;
pub mod mesh;
pub mod numbering;
pub mod order;
pub mod pair;
pub mod polygon;
mod repair;
pub mod repairs;
pub mod root_three;
pub mod source;
mod split;
pub mod tile;
pub mod tiling;
pub mod topology;
pub mod triangle_grid;
pub mod uvs;
pub mod weld;
