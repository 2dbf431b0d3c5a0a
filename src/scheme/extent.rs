//! How polygons are extended beyond their ends.

/// The end rule of open polygons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ends {
    /// The polygon is extended by point reflection about its end points, which keep their position.
    #[default]
    Clamped,
    /// Only points whose whole stencil exists are computed.
    Natural,
}

impl Ends {
    /// Returns the name of the rule in requests.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clamped => "clamped",
            Self::Natural => "natural",
        }
    }
}

/// How a polygon is extended beyond its stored points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// The polygon is extended cyclically.
    Closed,
    /// By reflection about the first and the last point, which belong to the polygon: `P[-j] = 2 P[0] - P[j]`.
    Whole,
    /// By reflection about the first and the last stored point, which do not belong to the polygon but lie half a step
    /// before and after it: `q[-1-j] = 2 e - q[j]`.
    Half,
    /// The polygon is not extended.
    Natural,
}
