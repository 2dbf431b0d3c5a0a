//! Numbers of glTF as whole numbers of 8 or 16 bits, as in `KHR_mesh_quantization`.
//!
//! Source: Khronos Group, `KHR_mesh_quantization` (2019).

use crate::output::error::FormatError;
use crate::output::numbers::{as_written, rounded};

/// Number of steps of a grid along the longest side of a model: the largest 16-bit number.
const GRID_STEPS: f64 = 65_535.0;

/// Half a unit in the last place of an f32, as a share of the number.
const HALF_ULP: f64 = 1.0 / 16_777_216.0;

/// Maximum error of a number from 0 to 1 in 16 bits: half a step, and its rounding to f32.
pub(super) const UNIT_ERROR: f64 = 0.5 / GRID_STEPS + HALF_ULP;

/// A cubic grid over all positions of a model: `x = corner + step k`, `k` from 0 to 65,535 along each axis.
///
/// Corner and step mean the decimals in the document, which may differ slightly from the f32.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PositionGrid {
    /// The position of `k = 0`, model units.
    pub(super) corner: [f32; 3],
    /// The distance between neighbours, model units.
    pub(super) step: f32,
    /// Maximum distance of a coordinate from the requested one, model units.
    pub(super) error: f32,
}

impl PositionGrid {
    /// Returns the finest grid over these positions, each of which was rounded to f32 after `center` was subtracted.
    ///
    /// The error is half a step, which is the longest side of the bounding box / 65,535, plus the rounding to f32 that
    /// the positions of every glTF have.
    ///
    /// # Errors
    /// A model with sides longer than f32 can hold.
    pub(super) fn over(positions: &[[f32; 3]], center: [f64; 3]) -> Result<Self, FormatError> {
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for position in positions {
            for (k, &x) in position.iter().enumerate() {
                (min[k], max[k]) = (min[k].min(x), max[k].max(x));
            }
        }
        if positions.is_empty() {
            (min, max) = ([0.0; 3], [0.0; 3]);
        }
        let corner = min.map(|x| least_below(x + 0.0));
        let side = (0..3).fold(0.0, |most: f64, k| most.max(f64::from(max[k]) - as_written(corner[k])));
        if rounded(side).is_infinite() {
            let most = f32::MAX;
            let detail = format!("a side of the model is {side:e} long, glTF compresses at most {most:e}; ask for obj");
            return Err(FormatError::Unfit(detail));
        }
        let step = most_above(rounded(side / GRID_STEPS).max(f32::MIN_POSITIVE), side);
        let largest = min.iter().chain(&max).fold(0.0, |most: f64, &x| most.max(f64::from(x).abs()));
        let far = center.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let error = as_written(step) / 2.0 + largest * HALF_ULP + far * f64::EPSILON;
        // two steps up, as the shortest decimal may be less than the f32
        Ok(Self { corner, step, error: rounded(error).next_up().next_up() })
    }

    /// Returns the place of the grid next to a position.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 65,535, whatever it was")]
    pub(super) fn place(&self, position: [f32; 3]) -> [u16; 3] {
        let step = as_written(self.step);
        [0, 1, 2].map(|k| {
            ((f64::from(position[k]) - as_written(self.corner[k])) / step).round().clamp(0.0, GRID_STEPS) as u16
        })
    }
}

/// Returns the largest f32 up to `x` whose decimal does not exceed `x`.
fn least_below(mut x: f32) -> f32 {
    let most = f64::from(x);
    while as_written(x) > most {
        x = x.next_down();
    }
    x
}

/// Returns the smallest f32 from `step` on with which [`GRID_STEPS`] steps, in decimals, cover a side.
fn most_above(mut step: f32, side: f64) -> f32 {
    while as_written(step) * GRID_STEPS < side {
        step = step.next_up();
    }
    step
}

/// Returns a number from 0 to 1 in 16 bits.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 65,535, whatever it was")]
pub(super) fn quantized_fraction(x: f32) -> u16 {
    (f64::from(x) * GRID_STEPS).round().clamp(0.0, GRID_STEPS) as u16
}

/// Returns a coordinate of a unit vector in 8 bits.
#[expect(clippy::cast_possible_truncation, reason = "from -127 to 127, whatever it was")]
pub(super) fn quantized_direction(x: f32) -> i8 {
    (f64::from(x) * 127.0).round().clamp(-127.0, 127.0) as i8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the position of a place of a grid as a reader of the document computes it.
    fn found(grid: &PositionGrid, place: [u16; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| as_written(grid.corner[k]) + as_written(grid.step) * f64::from(place[k]))
    }

    #[test]
    fn no_coordinate_is_farther_from_its_place_than_stated() {
        let lengths = [0.0_f32, 1e-40, 1e-12, 0.1, 1.0 / 3.0, 1.0, 7.3, 65_535.0, 1e9, 1e37];
        for length in lengths {
            for start in [0.0_f32, -0.3, 1e-20, 0.1, -123.456, 1e6, -3e30] {
                let at = |i: u8| start + length * (f32::from(i) / 255.0);
                let positions: Vec<[f32; 3]> = (0..=255).map(|i| [at(i), at(255 - i), start]).collect();
                let grid = PositionGrid::over(&positions, [0.0; 3]).expect("it fits");
                for &position in &positions {
                    for (x, y) in found(&grid, grid.place(position)).iter().zip(position) {
                        let error = as_written(grid.error);
                        assert!((x - f64::from(y)).abs() <= error, "{x} for {y} from {start} on, within {error}");
                    }
                }
            }
        }
    }

    #[test]
    fn sides_longer_than_f32_holds_are_refused() {
        let error = PositionGrid::over(&[[-3e38; 3], [3e38; 3]], [0.0; 3]).expect_err("too long");
        assert!(error.to_string().contains("long"), "{error}");
    }
}
