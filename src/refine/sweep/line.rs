//! Sides of patches that are boundaries or creases, and the decay of sharpness from round to round.

use crate::shape::creases::INFINITE_SHARPNESS;

/// The kind of a side of a patch that is not smooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SharpSide {
    /// An edge with one face.
    Boundary,
    /// An edge with two faces and this sharpness.
    Crease(f64),
}

impl SharpSide {
    /// Returns the line after so many rounds, or `None` if it is smooth by then.
    pub(super) fn after(self, rounds: usize) -> Option<Self> {
        match self {
            Self::Crease(sharpness) => softened(sharpness, rounds).map(Self::Crease),
            Self::Boundary => Some(self),
        }
    }
}

/// Returns the sharpness left after so many rounds, or `None` if nothing is left.
pub(super) fn softened(sharpness: f64, rounds: usize) -> Option<f64> {
    let less = |sharpness: f64| if sharpness >= INFINITE_SHARPNESS { sharpness } else { sharpness - 1.0 };
    Some((0..rounds).fold(sharpness, |sharpness, _| less(sharpness))).filter(|&sharpness| sharpness > 0.0)
}
