//! Sides of patches that are not smooth, and how sharpness becomes less from round to round.

use crate::shape::creases::INFINITE_SHARPNESS;

/// What a side of a patch is, where it is not smooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Line {
    /// An edge with one face.
    Boundary,
    /// An edge between two faces of this sharpness.
    Crease(f64),
}

impl Line {
    /// What it is after so many rounds; none where it is smooth by then.
    pub(super) fn after(self, rounds: usize) -> Option<Self> {
        match self {
            Self::Crease(sharpness) => softened(sharpness, rounds).map(Self::Crease),
            Self::Boundary => Some(self),
        }
    }
}

/// What is left of a sharpness after so many rounds, if anything.
pub(super) fn softened(sharpness: f64, rounds: usize) -> Option<f64> {
    let less = |sharpness: f64| if sharpness >= INFINITE_SHARPNESS { sharpness } else { sharpness - 1.0 };
    Some((0..rounds).fold(sharpness, |sharpness, _| less(sharpness))).filter(|&sharpness| sharpness > 0.0)
}
