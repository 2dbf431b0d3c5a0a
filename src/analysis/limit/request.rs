//! The parts of a limit surface that are requested.

/// The parts of the limit surface that are requested.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LimitRequest {
    /// Limit positions instead of the refined ones.
    pub positions: bool,
    /// Limit normals.
    pub normals: bool,
}

impl LimitRequest {
    /// Returns whether anything is requested.
    pub fn anything(self) -> bool {
        self.positions || self.normals
    }
}
