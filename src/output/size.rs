//! The length of an artifact.

/// Length of an artifact in bytes, before it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// The exact number.
    Exact(u128),
    /// An upper bound.
    AtMost(u128),
}

impl Size {
    /// Returns the number, exact or bound.
    pub fn bytes(self) -> u128 {
        match self {
            Self::Exact(n) | Self::AtMost(n) => n,
        }
    }
}
