//! Bounding boxes of points with `D` coordinates.

/// Number of boxes that grow side by side: enough for two vectors of each coordinate, few enough for registers. Half of
/// it waits for each comparison; twice of it leaves the registers.
const BOX_LANES: usize = 4;

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
        // several boxes side by side, for vectorisation
        let mut boxes = [*self; BOX_LANES];
        let (lines, rest) = points.as_chunks::<BOX_LANES>();
        for line in lines {
            boxes.iter_mut().zip(line).for_each(|(own, point)| own.reach(point, point));
        }
        rest.iter().for_each(|point| boxes[0].reach(point, point));
        boxes.iter().for_each(|own| self.reach(&own.min, &own.max));
        self.min.iter_mut().chain(&mut self.max).for_each(|x| *x += 0.0);
    }

    /// Grows the box as far as these coordinates. A coordinate that is NaN changes nothing.
    #[inline]
    fn reach(&mut self, min: &[f64; D], max: &[f64; D]) {
        for k in 0..D {
            self.min[k] = if min[k] < self.min[k] { min[k] } else { self.min[k] };
            self.max[k] = if max[k] > self.max[k] { max[k] } else { self.max[k] };
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
