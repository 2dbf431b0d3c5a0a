//! Tells which points of a polygon are children of vertices of the last upsampling.

use super::mask_range::steps;

/// The position of the children of vertices among the control points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChildPhase {
    /// Arity of the last U.
    pub arity: u32,
    /// Offset of the first control point.
    pub offset: u32,
}

impl ChildPhase {
    /// Returns the index `j` of control point 0, counted so that children of vertices lie at the multiples of the
    /// arity.
    pub(super) fn start(self) -> isize {
        let (d, offset) = (steps(self.arity), steps(self.offset));
        -((d - offset) % d)
    }

    /// Returns the phase after the first control point moved by `by` steps.
    pub(super) fn moved(self, by: i32) -> Self {
        let by = by.rem_euclid(self.arity.cast_signed()).unsigned_abs();
        Self { offset: (self.offset + by) % self.arity, ..self }
    }
}
