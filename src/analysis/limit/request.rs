//! What of a limit surface is asked for.

/// What of the limit surface is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LimitRequest {
    /// Limit positions instead of the refined ones.
    pub positions: bool,
    /// Limit normals.
    pub normals: bool,
}

impl LimitRequest {
    /// Whether anything is asked for.
    pub fn anything(self) -> bool {
        self.positions || self.normals
    }
}
