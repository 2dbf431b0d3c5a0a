//! Interleaves the planes of a refined grid into rows of points.

use super::grid::{GridSize, Planes, at_least};

/// A row of a refined grid, which takes its points from two planes alternately.
pub(super) struct GridRow<'a, const W: usize> {
    even: &'a [[f64; W]],
    odd: &'a [[f64; W]],
}

impl<'a, const W: usize> GridRow<'a, W> {
    pub(super) fn new(planes: &'a Planes, size: GridSize, row: usize) -> Self {
        let start = size.at([0, (row / 2).cast_signed()]);
        let range = start..start + (size.cells + 1) * W;
        let plane = |odd: usize| planes.now[odd + 2 * (row % 2)][range.clone()].as_chunks().0;
        Self { even: plane(0), odd: plane(1) }
    }

    /// Copies the points from column `start` on to `out`.
    pub(super) fn copy(&self, start: usize, out: &mut [[f64; W]]) {
        interleave(&self.even[start / 2..], &self.odd[start / 2..], start % 2 == 1, out);
    }
}

/// Fills `out` with `even[0], odd[0], even[1], ...`, without the first one if `skips` is set.
fn interleave<const W: usize>(even: &[[f64; W]], odd: &[[f64; W]], skips: bool, out: &mut [[f64; W]]) {
    let (even, odd, out) = match out.split_first_mut() {
        Some((first, rest)) if skips => {
            *first = odd[0];
            (&even[1..], &odd[1..], rest)
        }
        _ => (even, odd, out),
    };
    let (pairs, last) = out.as_chunks_mut::<2>();
    let n = pairs.len();
    for ((pair, even), odd) in pairs.iter_mut().zip(even).zip(odd) {
        pair[0] = *even;
        pair[1] = *odd;
    }
    if let [last] = last {
        *last = even[n];
    }
}

/// Interleaves the planes of a stack of `grids` grids into the grids that are refined in the next round.
pub(super) fn weave<const W: usize>(planes: &Planes, size: GridSize, fine: GridSize, grids: usize, out: &mut Vec<f64>) {
    at_least(out, grids * fine.len());
    for (place, out) in out[..grids * fine.len()].chunks_exact_mut(fine.len()).enumerate() {
        weave_grid::<W>(planes, size.stacked(place), fine, out);
    }
}

fn weave_grid<const W: usize>(planes: &Planes, size: GridSize, fine: GridSize, out: &mut [f64]) {
    let halo = size.halo.cast_signed();
    let stride = fine.stride() * W;
    for (row, out) in out.chunks_exact_mut(stride).enumerate() {
        let row = row.cast_signed() - halo;
        let start = size.at([(-halo).div_euclid(2), row.div_euclid(2)]);
        let plane = |odd: usize| {
            let plane = &planes.now[odd + 2 * row.rem_euclid(2).unsigned_abs()];
            plane[start..].as_chunks::<W>().0
        };
        interleave(plane(0), plane(1), halo % 2 == 1, out.as_chunks_mut().0);
    }
}
