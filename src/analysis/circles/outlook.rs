//! The limit of a latitude line, as it is reported.

use crate::shape::directions::Line;

/// The limit of a latitude line.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlook {
    /// The line.
    pub line: Line,
    /// The circle that it becomes, or why it becomes none.
    pub circle: Result<Circle, String>,
}

/// A circle in the limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circle {
    /// The radius of the circle, model units.
    pub radius: f64,
    /// By how much the rings that it comes from miss regular polygons on one axis, model units: the line is a circle to
    /// about that.
    pub irregularity: f64,
}
