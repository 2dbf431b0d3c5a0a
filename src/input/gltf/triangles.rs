//! Triangles of primitives of any mode.

use gltf::json::mesh::Mode;

/// Returns triangle `t` of a primitive, counter-clockwise. Source: glTF 2.0, section 3.7.2.1.
pub(super) fn triangle(mode: Mode, order: &[u32], t: usize) -> [u32; 3] {
    match mode {
        Mode::TriangleStrip if t.is_multiple_of(2) => [order[t], order[t + 1], order[t + 2]],
        Mode::TriangleStrip => [order[t], order[t + 2], order[t + 1]],
        Mode::TriangleFan => [order[t + 1], order[t + 2], order[0]],
        _ => [order[3 * t], order[3 * t + 1], order[3 * t + 2]],
    }
}
