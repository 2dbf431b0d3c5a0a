//! The positions of an output's vertices.

/// The positions of an output's vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Placed {
    /// Where the levels put them.
    Refined,
    /// At their limits.
    Limit,
}
