//! The reported limit of a latitude line.

use crate::shape::directions::LatitudeLine;

/// The limit of a latitude line.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlook {
    /// The line.
    pub line: LatitudeLine,
    /// The circle that the line becomes, or the reason why it becomes none.
    pub circle: Result<LimitCircle, String>,
}

/// A circle in the limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitCircle {
    /// The radius of the circle, model units.
    pub radius: f64,
    /// By how much the rings that determine the circle deviate from regular polygons on one axis, model units. The
    /// limit line deviates from the circle by about as much.
    pub irregularity: f64,
}
