//! The requested properties of a solid.

/// The continuity across the edges of caps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Continuity {
    /// Common tangent planes: caps of bidegree 5.
    Tangent,
    /// Bicubic caps; the certificate states the angle between their tangent planes.
    Bicubic,
}

/// Which bicubic faces are merged into one B-spline face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pack {
    /// No faces are merged.
    Nothing,
    /// The faces that belong to the same input face are merged.
    Face,
    /// All faces that form a rectangle are merged.
    Patch,
}

/// The requested properties of a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolidRequest {
    /// Largest distance from the limit surface, as a fraction of the largest side of the control mesh's bounding box.
    pub tolerance: f64,
    /// The continuity across the edges of caps.
    pub continuity: Continuity,
    /// Which bicubic faces are merged.
    pub pack: Pack,
    /// Maximum number of faces of the result.
    pub max_faces: usize,
    /// Maximum number of levels of isolation.
    pub max_level: u32,
    /// Length of the shortest edge that can be distinguished from a point, in model units.
    pub shortest: f64,
    /// Whether all components must be closed.
    pub closed: bool,
}
