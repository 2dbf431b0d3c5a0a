//! Norms of the powers of a scheme on a lattice.

use super::regular::Polynomial;
use super::sectors::LatticePoint;
use crate::math::functions::real;

/// Maximum number of entries of an iterated mask: those of six steps of a mask with 7 x 7 entries. Bounds of basic
/// limit functions get sharper with each step. Half of it leaves characteristic maps of interpolating schemes open;
/// twice of it takes twice as long for wide masks.
const MAX_ITERATED_ENTRIES: usize = 1 << 18;
/// Maximum number of products of entries of a mask and an iterated mask in one step, which [`MAX_ITERATED_ENTRIES`]
/// entries of usual masks take. Half of it has one step less for wide masks; twice of it takes twice as long.
const MAX_PRODUCTS: usize = 1 << 22;

/// Iterates over the norms of one step, two steps, ... of a scheme, as long as the masks are small enough.
pub(super) struct Iterated<'a> {
    mask: &'a Polynomial,
    d: i32,
    /// The mask of the steps so far; each of its steps multiplies indices by d, all of them by `step`.
    power: GridMask,
    step: i32,
}

/// Numbers at the points of a rectangle, row by row.
struct GridMask {
    first: LatticePoint,
    size: [usize; 2],
    values: Vec<f64>,
}

impl<'a> Iterated<'a> {
    /// Starts with the mask of a scheme of arity d.
    pub(super) fn new(mask: &'a Polynomial, d: i32) -> Self {
        let power = GridMask { first: [0, 0], size: [1, 1], values: vec![1.0] };
        Self { mask, d, power, step: 1 }
    }

    /// Returns the mask of one more step; `None` if it is too large.
    fn next_power(&self) -> Option<GridMask> {
        let end = |axis: usize, last: bool| {
            let all = self.mask.keys().map(|k| k[axis]);
            if last { all.max() } else { all.min() }
        };
        let first = [end(0, false)?, end(1, false)?];
        let mut size = [0; 2];
        for axis in 0..2 {
            let more = usize::try_from(self.step.checked_mul(end(axis, true)? - first[axis])?).ok()?;
            size[axis] = self.power.size[axis].checked_add(more)?;
        }
        let n = size[0].checked_mul(size[1]).filter(|n| *n <= MAX_ITERATED_ENTRIES)?;
        if self.power.values.len() * self.mask.len() > MAX_PRODUCTS {
            return None;
        }
        let mut values = vec![0.0; n];
        let width = self.power.size[0];
        for (k, a) in self.mask {
            let [x, y] = [0, 1].map(|axis| usize::try_from(self.step * (k[axis] - first[axis])).unwrap_or(0));
            for (row, old) in self.power.values.chunks_exact(width).enumerate() {
                let from = (y + row) * size[0] + x;
                values[from..from + width].iter_mut().zip(old).for_each(|(sum, b)| *sum += a * b);
            }
        }
        let first = [0, 1].map(|axis| self.power.first[axis] + self.step * first[axis]);
        Some(GridMask { first, size, values })
    }
}

impl Iterator for Iterated<'_> {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        self.power = self.next_power()?;
        self.step = self.step.checked_mul(self.d)?;
        let norm = self.power.norm(self.step);
        // each entry is a sum of at most so many products of rounded numbers
        Some(norm + 64.0 * real(self.mask.len()) * f64::EPSILON * (1.0 + norm))
    }
}

impl GridMask {
    /// Returns the greatest sum of absolute values of entries whose indices are congruent modulo `step`.
    fn norm(&self, step: i32) -> f64 {
        let n = usize::try_from(step).unwrap_or(1);
        let [x, y] = self.first.map(|x| usize::try_from(x.rem_euclid(step)).unwrap_or(0));
        let mut sums = vec![0.0; n * n];
        for (j, row) in self.values.chunks_exact(self.size[0]).enumerate() {
            for (i, a) in row.iter().enumerate() {
                sums[(y + j) % n * n + (x + i) % n] += a.abs();
            }
        }
        sums.into_iter().fold(0.0, f64::max)
    }
}
