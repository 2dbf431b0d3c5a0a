//! The tokens of USD for the rules of subdivision surfaces.

use crate::scheme::tags::Boundary;
use crate::shape::seams::Interpolation;

/// Returns the token of `interpolateBoundary`.
pub(super) fn boundary(rule: Boundary) -> &'static str {
    match rule {
        Boundary::EdgeAndCorner => "edgeAndCorner",
        Boundary::EdgeOnly => "edgeOnly",
        Boundary::None => "none",
    }
}

/// Returns the token of `faceVaryingLinearInterpolation`.
pub(super) fn interpolation(word: Interpolation) -> &'static str {
    match word {
        Interpolation::None => "none",
        Interpolation::CornersOnly => "cornersOnly",
        Interpolation::CornersPlus1 => "cornersPlus1",
        Interpolation::CornersPlus2 => "cornersPlus2",
        Interpolation::Boundaries => "boundaries",
        Interpolation::All => "all",
    }
}
