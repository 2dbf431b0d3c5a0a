//! Shapes: polygons and meshes as they are given, and the flat topology that operators read.

pub mod attributes;
pub mod check;
pub mod creases;
pub mod grid;
pub mod mesh;
pub mod polygon;
pub mod source;
mod split;
pub mod topology;
