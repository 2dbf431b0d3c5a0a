//! How polygons go on beyond their ends.

/// End rule of open polygons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Ends {
    /// The polygon goes on by point reflection about its end points, which stay where they are.
    #[default]
    Clamped,
    /// Only points whose whole stencil exists.
    Natural,
}

impl Ends {
    /// Its name in requests.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clamped => "clamped",
            Self::Natural => "natural",
        }
    }
}

/// How a polygon goes on beyond its stored points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// Cyclically.
    Closed,
    /// By reflection about the first and the last point, which are points of the polygon: `P[-j] = 2 P[0] - P[j]`.
    Whole,
    /// By reflection about the first and the last stored point, which are no points of the polygon but lie half a step
    /// before and after it: `q[-1-j] = 2 e - q[j]`.
    Half,
    /// Not at all.
    Natural,
}
