//! Masks of mesh schemes: weights by role, and the walks that assign them to the points around a vertex, edge or face.
//!
//! A scheme is a function of valence, face size and kind that returns such masks; the walks know no scheme, and the
//! weights can be read without a walk.

mod four_point;
mod quads;
mod ring;
mod triangles;

pub use four_point::FourPoint;
pub use quads::{EdgeMask, FaceMask, VertexMask};
pub use ring::RingMask;
pub use triangles::TriangleEdgeMask;
