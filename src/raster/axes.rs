//! Coordinates along three axes, four numbers at once.

use crate::math::vector::Vector;

/// The components of three axes and of a fourth one, which is 0, to the first, the second and the third direction. Four
/// numbers fill a vector register.
pub(super) type AxisRows = [[f64; 4]; 3];

/// Returns the components of these axes.
pub(super) fn axis_rows(axes: [Vector; 3]) -> AxisRows {
    [0, 1, 2].map(|k| [axes[0][k], axes[1][k], axes[2][k], 0.0])
}

/// Returns the dot products of a vector and the axes.
#[expect(clippy::inline_always, reason = "callers that are compiled for wider vectors need it to be, too")]
#[inline(always)]
pub(super) fn along(rows: &AxisRows, [x, y, z]: Vector) -> [f64; 4] {
    let mut along = [0.0; 4];
    for k in 0..4 {
        along[k] = rows[0][k] * x + rows[1][k] * y + rows[2][k] * z;
    }
    along
}
