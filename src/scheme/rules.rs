//! Rules that presets and plans choose for meshes.

use super::sharpness::Creasing;

/// What Catmull-Clark does at edges beside triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TriangleRule {
    /// What it does everywhere.
    #[default]
    Catmark,
    /// Face points count more, so that triangles in a mesh of quads dent it less.
    Smooth,
}

impl TriangleRule {
    /// Its name in requests.
    pub fn name(self) -> &'static str {
        match self {
            Self::Catmark => "catmark",
            Self::Smooth => "smooth",
        }
    }
}

/// Rules that a preset chooses for meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rules {
    /// How sharpness becomes less.
    pub creasing: Creasing,
    /// What happens beside triangles.
    pub triangles: TriangleRule,
}

/// What odd points of latitude lines follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LatitudeRule {
    /// Differences of their even neighbours.
    #[default]
    Difference,
    /// Places of their even neighbours.
    Position,
    /// Nothing: the tags are not looked at.
    Isotropic,
}

impl LatitudeRule {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Difference => "difference",
            Self::Position => "position",
            Self::Isotropic => "isotropic",
        }
    }
}
