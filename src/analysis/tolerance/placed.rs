//! Where an output has its vertices.

/// Where the vertices of an output are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Placed {
    /// Where the levels put them.
    Refined,
    /// At their limits.
    Limit,
}
