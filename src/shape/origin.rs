//! Where vertices of refined meshes come from.

/// The input cell in which a vertex arose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Origin {
    /// 0 for a vertex, 1 for an edge, 2 for a face.
    pub dimension: u8,
    /// The index of the cell; edges are numbered by first appearance when faces are scanned in order, half-edge by
    /// half-edge.
    pub cell: u32,
}
