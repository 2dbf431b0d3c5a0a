//! Bounding boxes of points with `D` coordinates.

/// Smallest and largest coordinates, in model units; empty when `min > max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CoordinateBounds<const D: usize> {
    /// Smallest coordinates.
    pub(super) min: [f64; D],
    /// Largest coordinates.
    pub(super) max: [f64; D],
}

impl<const D: usize> CoordinateBounds<D> {
    /// The box of no points.
    pub(super) const EMPTY: Self = Self { min: [f64::INFINITY; D], max: [f64::NEG_INFINITY; D] };

    /// Grows the box so that it contains these points. Zeros lose their sign.
    pub(super) fn add(&mut self, points: &[[f64; D]]) {
        for point in points {
            for ((low, high), &x) in self.min.iter_mut().zip(&mut self.max).zip(point) {
                *low = low.min(x) + 0.0;
                *high = high.max(x) + 0.0;
            }
        }
    }

    /// Returns the smallest box that contains both.
    pub(super) fn joined(mut self, other: &Self) -> Self {
        if !other.is_empty() {
            self.add(&[other.min, other.max]);
        }
        self
    }

    /// Returns whether the box contains no point.
    pub(super) fn is_empty(&self) -> bool {
        self.min.iter().zip(&self.max).any(|(low, high)| low > high)
    }

    /// Returns the centre; the origin for the empty box.
    pub(super) fn center(&self) -> [f64; D] {
        if self.is_empty() { [0.0; D] } else { std::array::from_fn(|k| self.min[k] / 2.0 + self.max[k] / 2.0) }
    }

    /// Returns half the longest side; 0 for the empty box.
    pub(super) fn half_side(&self) -> f64 {
        (0..D).fold(0.0, |most: f64, k| most.max(self.max[k] / 2.0 - self.min[k] / 2.0))
    }
}
