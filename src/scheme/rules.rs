//! Rules for meshes that presets and plans choose.

use super::sharpness::Creasing;

/// The rule of Catmull-Clark at edges of triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TriangleRule {
    /// The usual rule.
    #[default]
    Catmark,
    /// Face points of triangles have greater weight, so that triangles in a mesh of quads dent it less.
    Smooth,
}

impl TriangleRule {
    /// Returns the name of the rule in requests.
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
    /// How sharpness decays.
    pub creasing: Creasing,
    /// The rule at edges of triangles.
    pub triangles: TriangleRule,
}

/// The rule for odd points of latitude lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LatitudeRule {
    /// Odd points follow the displacements of their even neighbours.
    #[default]
    Difference,
    /// Odd points follow the positions of their even neighbours.
    Position,
    /// The tags are ignored.
    Isotropic,
}

impl LatitudeRule {
    /// Returns the name of the rule in requests.
    pub fn name(self) -> &'static str {
        match self {
            Self::Difference => "difference",
            Self::Position => "position",
            Self::Isotropic => "isotropic",
        }
    }
}
