//! Ranges of masks: how an operator of some arity moves and counts the points of a polygon.

use super::extent::Extent;
use crate::math::mask::Mask;

/// The arity of an operator and the range of its mask: new point `j` depends on the old points `i` with
/// `first <= j - d i <= last`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MaskRange {
    /// Arity d.
    pub arity: u32,
    /// First index of the mask.
    pub first: i32,
    /// Last index of the mask.
    pub last: i32,
}

/// Converts an arity, or a part of one, to a signed number of steps.
#[expect(clippy::cast_possible_wrap, reason = "arities are at most 8")]
pub(crate) const fn steps(n: u32) -> isize {
    n as isize
}

/// A polygon after an operator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Landing {
    /// Number of stored points.
    pub n: u128,
    /// How the polygon is extended beyond them.
    pub extent: Extent,
    /// The index `j` of the first control point.
    pub start: i32,
}

impl MaskRange {
    /// Returns the range of a mask.
    pub(super) fn of(arity: u32, mask: &Mask) -> Self {
        Self { arity, first: mask.first, last: mask.last() }
    }

    /// Returns the range of the mask of U of arity d.
    pub const fn upsample(arity: u32) -> Self {
        let reach = arity.cast_signed() - 1;
        Self { arity, first: -reach, last: reach }
    }

    /// Returns the range of the mask of the mean of `width` neighbours; if that is even, the extra one follows or
    /// precedes the point.
    pub const fn mean(width: u32, before: bool) -> Self {
        let spare = width.cast_signed() - 1;
        let back = if before { spare - spare / 2 } else { spare / 2 };
        Self { arity: 1, first: back - spare, last: back }
    }

    /// Returns whether the operator moves points by half a step.
    pub fn shifts(&self) -> bool {
        self.arity == 1 && (self.first + self.last) % 2 != 0
    }

    /// Returns the polygon of `n` stored points after the operator. If the centre of reflection is at `c`, the new one
    /// lies at `d c + (first + last) / 2`: on a point, or half a step before one.
    pub fn land(&self, n: u128, extent: Extent) -> Landing {
        let d = u128::from(self.arity);
        let width = u128::from(self.last.abs_diff(self.first));
        let shift = self.first + self.last;
        let controls = match extent {
            Extent::Closed => return Landing { n: n.saturating_mul(d), extent, start: 0 },
            Extent::Natural => {
                let n = n.saturating_add(1).saturating_mul(d).saturating_sub(1 + width);
                return Landing { n, extent, start: self.last - self.arity.cast_signed() + 1 };
            }
            Extent::Whole => n.saturating_sub(1),
            Extent::Half => n.saturating_sub(2),
        };
        // twice the new centre
        let centre = shift - if extent == Extent::Half { self.arity.cast_signed() } else { 0 };
        let steps = controls.saturating_mul(d);
        if centre % 2 == 0 {
            Landing { n: steps.saturating_add(1), extent: Extent::Whole, start: centre / 2 }
        } else {
            Landing { n: steps.saturating_add(2), extent: Extent::Half, start: (centre + 1) / 2 }
        }
    }
}
