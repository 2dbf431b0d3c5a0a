//! What is asked of a solid.

/// What happens across the edges of caps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Continuity {
    /// Tangent planes agree: caps of bidegree 5.
    Tangent,
    /// Caps are bicubic; the angle between their tangent planes is told.
    Bicubic,
}

/// Which bicubic faces become one B-spline face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pack {
    /// None.
    Nothing,
    /// Those of one input face.
    Face,
    /// All that form a rectangle.
    Patch,
}

/// What is asked of a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Largest distance from the limit surface, in shares of the largest side of the bounding box of the cage.
    pub tolerance: f64,
    /// What happens across the edges of caps.
    pub continuity: Continuity,
    /// Which bicubic faces become one.
    pub pack: Pack,
    /// Most faces of the result.
    pub max_faces: usize,
    /// Most levels of isolation.
    pub max_level: u32,
    /// Shortest edge that can be told from a point, model units.
    pub shortest: f64,
    /// Whether all components have to be closed.
    pub closed: bool,
}
