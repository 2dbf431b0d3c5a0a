//! Interleaves the planes of a refined grid into rows of points.

use super::aligned::AlignedBuffer;
use super::grid::{GridSize, Planes};

/// A row of the refined grids of a stack, which take their points from two planes alternately.
pub(super) struct GridRow<'a, const W: usize> {
    even: &'a [[f64; W]],
    odd: &'a [[f64; W]],
    /// Number of grids in the stack.
    grids: usize,
}

impl<'a, const W: usize> GridRow<'a, W> {
    pub(super) fn new(planes: &'a Planes, size: GridSize, row: usize) -> Self {
        let start = size.at([0, (row / 2).cast_signed()]);
        let range = start..start + (size.cells + 1) * size.step();
        let plane = |odd: usize| planes.now[odd + 2 * (row % 2)][range.clone()].as_chunks().0;
        Self { even: plane(0), odd: plane(1), grids: size.grids }
    }

    /// Copies the points of the grid at a place of the stack, from column `start` on, to `out`.
    #[inline]
    pub(super) fn copy(&self, place: usize, start: usize, out: &mut [[f64; W]]) {
        let [even, odd] = [self.even, self.odd].map(|plane| &plane[start / 2 * self.grids + place..]);
        interleave(even, odd, self.grids, start % 2 == 1, out);
    }
}

/// Fills `out` with the points of one grid of a stack: `even[0], odd[0], even[grids], odd[grids], ...`, without the
/// first one if `skips` is set.
#[inline]
fn interleave<const W: usize>(even: &[[f64; W]], odd: &[[f64; W]], grids: usize, skips: bool, out: &mut [[f64; W]]) {
    let (even, odd, out) = match out.split_first_mut() {
        Some((first, rest)) if skips => {
            *first = odd[0];
            (&even[grids..], &odd[grids..], rest)
        }
        _ => (even, odd, out),
    };
    let (pairs, last) = out.as_chunks_mut::<2>();
    if let [last] = last {
        *last = even[pairs.len() * grids];
    }
    if grids == 1 {
        pair_up(pairs, even.iter().zip(odd));
    } else {
        pair_up(pairs, even.iter().step_by(grids).zip(odd.iter().step_by(grids)));
    }
}

#[inline]
fn pair_up<'a, const W: usize>(
    pairs: &mut [[[f64; W]; 2]],
    points: impl Iterator<Item = (&'a [f64; W], &'a [f64; W])>,
) {
    for (pair, (even, odd)) in pairs.iter_mut().zip(points) {
        pair[0] = *even;
        pair[1] = *odd;
    }
}

/// Interleaves the planes of a stack of grids into the grids that are refined in the next round. These are divided into
/// stacks of the size `fine`, each in a buffer of its own.
pub(super) fn weave<const W: usize>(planes: &Planes, size: GridSize, fine: GridSize, out: &mut Vec<AlignedBuffer>) {
    let stacks = size.grids / fine.grids;
    if out.len() < stacks {
        out.resize_with(stacks, AlignedBuffer::default);
    }
    let halo = size.halo.cast_signed();
    let length = fine.stride() * fine.step();
    // row by row, as all stacks share the lines of memory of a row
    for (row, first) in (-halo..).zip((0..fine.len()).step_by(length)) {
        for (stack, out) in out[..stacks].iter_mut().enumerate() {
            let out = &mut out.first(fine.len())[first..][..length];
            let size = size.stacked(stack * fine.grids);
            let start = size.at([(-halo).div_euclid(2), row.div_euclid(2)]);
            let plane = |odd: usize| &planes.now[odd + 2 * row.rem_euclid(2).unsigned_abs()][start..];
            if fine.grids == 1 {
                let [even, odd] = [plane(0), plane(1)].map(|plane| plane.as_chunks::<W>().0);
                interleave(even, odd, size.grids, halo % 2 == 1, out.as_chunks_mut().0);
            } else {
                let [even, odd] = [plane(0), plane(1)].map(|plane| plane.chunks(size.step()));
                let points = even.zip(odd).flat_map(|(even, odd)| [even, odd]).skip(size.halo % 2);
                let out = out.chunks_exact_mut(fine.step());
                out.zip(points).for_each(|(out, points)| out.copy_from_slice(&points[..fine.step()]));
            }
        }
    }
}
