//! Where the vertices of an output are.

/// Where the vertices of an output are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VertexPlacement {
    /// At the positions of the refined net.
    Refined,
    /// At their limit positions.
    Limit,
}
