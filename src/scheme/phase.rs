//! Which points of a polygon were vertices before the last upsampling.

use super::window::steps;

/// Which control points are children of vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Phase {
    /// Arity of the last U.
    pub arity: u32,
    /// Offset of the first control point.
    pub offset: u32,
}

impl Phase {
    /// The index `j` of control point 0, counted so that vertices stand at the multiples of the arity.
    pub(super) fn start(self) -> isize {
        let (d, offset) = (steps(self.arity), steps(self.offset));
        -((d - offset) % d)
    }

    /// The phase when the first control point moves by so many steps.
    pub(super) fn moved(self, by: i32) -> Self {
        let by = by.rem_euclid(self.arity.cast_signed()).unsigned_abs();
        Self { offset: (self.offset + by) % self.arity, ..self }
    }
}
