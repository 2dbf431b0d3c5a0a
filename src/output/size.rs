//! How long an artifact will be.

/// Length of an artifact in bytes, before it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// Exactly this many.
    Exact(u128),
    /// At most this many.
    AtMost(u128),
}

impl Size {
    /// The number, exact or bound.
    pub fn bytes(self) -> u128 {
        match self {
            Self::Exact(n) | Self::AtMost(n) => n,
        }
    }
}
