//! The least height of a model above each cell of a map of the ground, and how dark it makes the ground.

#![expect(clippy::cast_precision_loss, reason = "cells are counted in hundreds")]
#![expect(clippy::cast_possible_truncation, reason = "there are some hundred cells, and places need no more than f32")]
#![expect(clippy::cast_sign_loss, reason = "lengths are not negative")]
#![expect(clippy::needless_bitwise_bool, reason = "loops without branches are vector code")]

use std::sync::atomic::{AtomicU64, Ordering};

use multiversion::multiversion;
use rayon::prelude::*;

use super::ground::{GroundFrame, GroundPlace, SHADOW_REACH};
use super::pixmap::rounded_down;
use crate::watch::{Stopped, Watch};

/// Height up to which parts darken the ground, as a fraction of half the longer side of the model. Half of it leaves
/// the shadows of feet only; twice of it makes a shadow of the whole model.
const DARKENING_HEIGHT: f32 = 0.4;

/// Height up to which parts touch the ground and cast the dark shadow of contact, as a fraction of half the longer
/// side. Half of it leaves thin lines below round parts; twice of it darkens the ground below parts that clearly hover.
const TOUCHING_HEIGHT: f32 = 0.1;

/// Fractions of the light removed below parts that touch the ground, and below parts just above it. They are a matter
/// of taste: halves are hardly visible, and twice of them is black.
const SHADOW_DARKNESS: [f32; 2] = [0.5, 0.36];

/// Number of triangles that are laid on a map between two questions whether to stop, and at least on each map. Half of
/// it allows twice as many maps, which are all merged; with twice of it, threads wait longer for each other at the end.
const LAID_TRIANGLES: usize = 4096;

/// A map of the ground: places times `scale` plus `shift` are counted in cells from its corner; heights are unchanged.
struct GroundMap {
    cells: u32,
    scale: GroundPlace,
    shift: GroundPlace,
    /// The last cell of a row or column.
    last: f32,
}

/// Sampled places that are looked at together: eight numbers of 32 bits fill a vector register of 256 bits. Half of it
/// leaves half of that empty; twice of it looks at more places beside small triangles in vain.
const PLACE_LANES: usize = 8;

/// Sampled places of triangles whose sides have up to this number of parts are tabled, 120 of them. Half of it leaves
/// triangles of some cells to the slower way, which takes one place after the other; twice of it is a table for few
/// triangles.
const TABLED_PARTS: usize = 14;

/// Returns the number of sampled places of a triangle whose sides have so many parts.
const fn n_places(parts: usize) -> usize {
    (parts + 1) * (parts + 2) / 2
}

/// Returns about that number for the limit of sampled places, without overflow.
fn n_counted(parts: u64) -> u64 {
    parts.saturating_add(1).saturating_pow(2) / 2
}

/// Numbers of parts to the second and to the third corner for each sampled place of a triangle, in the order of their
/// sum, so that the places of triangles with fewer parts come first.
static PLACE_STEPS: [[[f32; PLACE_LANES]; 2]; n_places(TABLED_PARTS).div_ceil(PLACE_LANES)] = {
    let mut steps = [[[0.0; PLACE_LANES]; 2]; n_places(TABLED_PARTS).div_ceil(PLACE_LANES)];
    let (mut sum, mut place) = (0, 0);
    while sum <= TABLED_PARTS {
        let mut down = 0;
        while down <= sum {
            let (block, lane) = (place / PLACE_LANES, place % PLACE_LANES);
            (steps[block][0][lane], steps[block][1][lane]) = ((sum - down) as f32, down as f32);
            (down, place) = (down + 1, place + 1);
        }
        sum += 1;
    }
    steps
};

impl GroundFrame<'_> {
    /// Returns the least height of the model above each cell; `None` if more than `most` places of triangles would have
    /// to be sampled.
    pub(super) fn heights(&self, cells: usize, most: u64, watch: &Watch) -> Result<Option<Vec<f32>>, Stopped> {
        let map = GroundMap::new(cells);
        let far = || vec![DARKENING_HEIGHT; cells * cells];
        let least = |mut a: Vec<f32>, b: Vec<f32>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a = a.min(b));
            a
        };
        let sampled = AtomicU64::new(0);
        let of = |mut heights: Vec<f32>, list: &[[u32; 3]]| {
            watch.check()?;
            if sampled.load(Ordering::Relaxed) <= most {
                sampled.fetch_add(lay(&map, (&self.places, list), &mut heights, most), Ordering::Relaxed);
            }
            Ok(heights)
        };
        let parts = self.triangles.par_chunks(LAID_TRIANGLES).try_fold(far, of);
        let heights = parts.try_reduce(far, |a, b| Ok::<_, Stopped>(least(a, b)))?;
        Ok((sampled.into_inner() <= most).then_some(heights))
    }
}

/// Lowers the cells below triangles to their heights there, and returns the number of sampled places. As soon as that
/// would be above `most`, the rest is left out. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn lay(map: &GroundMap, (places, triangles): (&[GroundPlace], &[[u32; 3]]), heights: &mut [f32], most: u64) -> u64 {
    let mut n_places = 0;
    for &[a, b, c] in triangles {
        let (a, b, c) = (&places[a as usize], &places[b as usize], &places[c as usize]);
        if !((a[2] < DARKENING_HEIGHT) | (b[2] < DARKENING_HEIGHT) | (c[2] < DARKENING_HEIGHT)) {
            continue;
        }
        let (a, b, c) = (map.place(a), map.place(b), map.place(c));
        let mut is_small = [false; 4];
        for k in 0..4 {
            let sides = [(a[k] - b[k]).abs(), (b[k] - c[k]).abs(), (c[k] - a[k]).abs()];
            is_small[k] = (sides[0] <= SMALL[k]) & (sides[1] <= SMALL[k]) & (sides[2] <= SMALL[k]);
        }
        if is_small[0] & is_small[1] & is_small[2] & is_small[3] {
            n_places += n_counted(1);
            map.lower(heights, a);
        } else {
            n_places += map.lay_parts(&[a, b, c], heights, most);
        }
        if n_places > most {
            break;
        }
    }
    n_places
}

/// The largest sides of a triangle that counts as a single place, in cells; all heights will do that are numbers.
const SMALL: GroundPlace = [1.0, 1.0, f32::MAX, f32::MAX];

impl GroundMap {
    fn new(cells: usize) -> Self {
        let half = 0.5 * cells as f32;
        let scale = half / (1.0 + SHADOW_REACH as f32);
        let (scale, shift) = ([scale, scale, 1.0, 1.0], [half, half, 0.0, 0.0]);
        Self { cells: cells as u32, scale, shift, last: (cells - 1) as f32 }
    }

    #[expect(clippy::inline_always, reason = "only code inside of `lay` uses its wider vectors")]
    #[inline(always)]
    fn place(&self, place: &GroundPlace) -> GroundPlace {
        let mut on_map = [0.0; 4];
        for k in 0..4 {
            on_map[k] = place[k] * self.scale[k] + self.shift[k];
        }
        on_map
    }

    /// Returns the number of the cell at a place.
    #[expect(clippy::inline_always, reason = "only code inside of `lay` uses its wider vectors")]
    #[inline(always)]
    fn cell(&self, x: f32, y: f32) -> u32 {
        let (x, y) = (if x > 0.0 { x } else { 0.0 }, if y > 0.0 { y } else { 0.0 });
        let (x, y) = (if x < self.last { x } else { self.last }, if y < self.last { y } else { self.last });
        rounded_down(y) * self.cells + rounded_down(x)
    }

    /// Lowers the cell at a place to its height.
    #[expect(clippy::inline_always, reason = "only code inside of `lay` uses its wider vectors")]
    #[inline(always)]
    fn lower(&self, heights: &mut [f32], [x, y, height, _]: GroundPlace) {
        let least = &mut heights[self.cell(x, y) as usize];
        *least = if height < *least { height } else { *least };
    }

    /// Lowers the cells below a triangle that is larger than a cell; returns the number of sampled places. If it is
    /// above `most`, none are.
    #[expect(clippy::inline_always, reason = "only code inside of `lay` uses its wider vectors")]
    #[inline(always)]
    fn lay_parts(&self, corners: &[GroundPlace; 3], heights: &mut [f32], most: u64) -> u64 {
        if !corners.as_flattened().iter().all(|u| u.is_finite()) {
            return 0;
        }
        let [a, b, c] = corners;
        let parts = parts(corners);
        let n_sampled = n_counted(parts as u64);
        if n_sampled > most {
            return n_sampled;
        }
        // only a difference of heights that overflows leads here
        if parts == 1 {
            self.lower(heights, *a);
            return n_sampled;
        }
        let step = 1.0 / parts as f32;
        let [mut right, mut down] = [[0.0; 4]; 2];
        for k in 0..4 {
            (right[k], down[k]) = (step * (b[k] - a[k]), step * (c[k] - a[k]));
        }
        if parts > TABLED_PARTS {
            for j in 0..=parts {
                for i in 0..=parts - j {
                    let at = |k: usize| a[k] + i as f32 * right[k] + j as f32 * down[k];
                    self.lower(heights, [at(0), at(1), at(2), 0.0]);
                }
            }
            return n_sampled;
        }
        let mut rest = n_places(parts);
        for steps in PLACE_STEPS.iter().take(rest.div_ceil(PLACE_LANES)) {
            let (mut cell, mut height) = ([0; PLACE_LANES], [0.0; PLACE_LANES]);
            for lane in 0..PLACE_LANES {
                let at = |k: usize| a[k] + steps[0][lane] * right[k] + steps[1][lane] * down[k];
                (cell[lane], height[lane]) = (self.cell(at(0), at(1)), at(2));
            }
            for (cell, height) in cell.into_iter().zip(height).take(rest) {
                let least = &mut heights[cell as usize];
                *least = if height < *least { height } else { *least };
            }
            rest = rest.saturating_sub(PLACE_LANES);
        }
        n_sampled
    }
}

/// Returns the number of parts into which each side of a triangle is divided, so that no cell below it is missed.
#[expect(clippy::inline_always, reason = "only code inside of `lay` uses its wider vectors")]
#[inline(always)]
fn parts(corners: &[GroundPlace; 3]) -> usize {
    let side = |a: &GroundPlace, b: &GroundPlace| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
    let longest =
        side(&corners[0], &corners[1]).max(side(&corners[1], &corners[2])).max(side(&corners[2], &corners[0]));
    if longest <= 1.0 { 1 } else { longest.ceil() as usize }
}

/// Returns the fraction of its light that each cell loses.
pub(super) fn darkness(heights: &[f32], cells: usize) -> Vec<f32> {
    let side = cells as f32;
    let soft = |high: f32, share: f32| {
        let weight = |height: &f32| {
            let rest = (1.0 - height / high).max(0.0);
            rest * rest
        };
        smoothed(heights.iter().map(weight).collect(), cells, ((share * side) as usize).max(1))
    };
    let (near, wide) = rayon::join(|| soft(TOUCHING_HEIGHT, 0.011), || soft(DARKENING_HEIGHT, 0.05));
    let mixed = near
        .iter()
        .zip(&wide)
        .map(|(near, wide)| 1.0 - (1.0 - SHADOW_DARKNESS[0] * near) * (1.0 - SHADOW_DARKNESS[1] * wide));
    mixed.collect()
}

/// Returns the map after three box filters of `2 reach + 1` cells, which approximate a Gaussian. Cells outside of it
/// are zero.
fn smoothed(mut map: Vec<f32>, cells: usize, reach: usize) -> Vec<f32> {
    let share = 1.0 / (2 * reach + 1) as f32;
    let reach = reach.min(cells);
    let mut means = vec![0.0; map.len()];
    let mut wide = vec![0.0; cells + 2 * reach];
    for _ in 0..3 {
        for (row, means) in map.chunks(cells).zip(means.chunks_mut(cells)) {
            wide[reach..][..cells].copy_from_slice(row);
            find_means(&wide, (2 * reach + 1, 1), share, means);
        }
        for (y, row) in map.chunks_mut(cells).enumerate() {
            let (first, last) = (y.saturating_sub(reach), (y + reach).min(cells - 1));
            find_means(&means[first * cells..], (last + 1 - first, cells), share, row);
        }
    }
    map
}

/// Cells whose means are found together: as many numbers of 32 bits as the widest registers hold. Half of it leaves
/// half of such a register empty; twice of it leaves a larger rest of a row, which is summed one cell after the other.
const MEAN_LANES: usize = 16;

/// Finds for each cell of a row the sum of `n` numbers, the first at the cell's own place in `from` and the others each
/// `step` farther, times `share`. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx512f", "x86_64+avx2"))]
fn find_means(from: &[f32], (n, step): (usize, usize), share: f32, row: &mut [f32]) {
    let (blocks, rest) = row.as_chunks_mut::<MEAN_LANES>();
    let in_blocks = MEAN_LANES * blocks.len();
    for (first, means) in (0..).step_by(MEAN_LANES).zip(blocks) {
        let mut sums = [0.0; MEAN_LANES];
        for k in 0..n {
            let from = &from[first + k * step..][..MEAN_LANES];
            for lane in 0..MEAN_LANES {
                sums[lane] += from[lane];
            }
        }
        for lane in 0..MEAN_LANES {
            means[lane] = share * sums[lane];
        }
    }
    for (first, mean) in (in_blocks..).zip(rest) {
        *mean = share * (0..n).fold(0.0, |sum, k| sum + from[first + k * step]);
    }
}

#[cfg(test)]
mod tests {
    use proptest::collection;
    use proptest::prelude::*;

    use super::*;

    const CELLS: usize = 24;

    /// What [`lay`] does, one place of a triangle after the other.
    fn laid(places: &[GroundPlace], triangles: &[[u32; 3]]) -> (Vec<f32>, u64) {
        let mut heights = vec![DARKENING_HEIGHT; CELLS * CELLS];
        let half = 0.5 * CELLS as f32;
        let scale = half / (1.0 + SHADOW_REACH as f32);
        let mut n_places = 0;
        for triangle in triangles {
            let corners = triangle.map(|v| places[v as usize]);
            if corners.iter().all(|corner| corner[2] >= DARKENING_HEIGHT)
                || corners.as_flattened().iter().any(|u| !u.is_finite())
            {
                continue;
            }
            let [a, b, c] = corners.map(|[x, y, height, _]| [x * scale + half, y * scale + half, height]);
            let side = |a: [f32; 3], b: [f32; 3]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
            let n = side(a, b).max(side(b, c)).max(side(c, a)).ceil().max(1.0) as usize;
            n_places += (n as u64 + 1).pow(2) / 2;
            let step = 1.0 / n as f32;
            for j in 0..=n {
                // of a triangle smaller than a cell only the first corner counts
                for i in (0..=n - j).filter(|i| n > 1 || (*i, j) == (0, 0)) {
                    let at = |k: usize| a[k] + i as f32 * (step * (b[k] - a[k])) + j as f32 * (step * (c[k] - a[k]));
                    let [x, y] = [at(0), at(1)].map(|u| (u.max(0.0) as usize).min(CELLS - 1));
                    let least = &mut heights[y * CELLS + x];
                    *least = least.min(at(2));
                }
            }
        }
        (heights, n_places)
    }

    /// What [`smoothed`] does, one number after the other.
    fn smoothed_singly(mut map: Vec<f32>, cells: usize, reach: usize) -> Vec<f32> {
        let share = 1.0 / (2 * reach + 1) as f32;
        let around = |at: usize| at.saturating_sub(reach)..(at + reach + 1).min(cells);
        for _ in 0..3 {
            let across = |y: usize, x: usize| share * around(x).fold(0.0, |sum, x| sum + map[y * cells + x]);
            let means: Vec<f32> = (0..cells * cells).map(|at| across(at / cells, at % cells)).collect();
            let down = |y: usize, x: usize| share * around(y).fold(0.0, |sum, y| sum + means[y * cells + x]);
            map = (0..cells * cells).map(|at| down(at / cells, at % cells)).collect();
        }
        map
    }

    proptest! {
        #[test]
        fn means_are_those_of_one_number_after_the_other(
            (cells, reach) in (1..40_usize, 1..12_usize),
            numbers in collection::vec(0.0..1.0_f32, 1600),
        ) {
            let map = numbers[..cells * cells].to_vec();
            let bits = |map: Vec<f32>| map.into_iter().map(f32::to_bits).collect::<Vec<_>>();
            let expected = smoothed_singly(map.clone(), cells, reach);
            prop_assert_eq!(bits(smoothed(map, cells, reach)), bits(expected));
        }

        #[test]
        fn cells_are_lowered_as_by_one_place_after_the_other(
            numbers in collection::vec((-1.5_f32..1.5, -1.5_f32..1.5, -0.1_f32..0.6), 3..40),
            corners in collection::vec((0..40_u32, 0..40_u32, 0..40_u32), 1..40),
            strange in collection::vec((0..40_usize, 0..3_usize, prop::num::f32::ANY), 0..3),
            size in prop::sample::select(vec![0.02_f32, 0.3, 1.0]),
        ) {
            let mut places: Vec<GroundPlace> =
                numbers.iter().map(|(x, y, height)| [size * x, size * y, *height, 0.0]).collect();
            let n = places.len();
            for (i, k, number) in strange {
                // usual places are within the map, others no numbers
                places[i % n][k] = if number.is_finite() { number % 2.0 } else { number };
            }
            let vertex = |v: u32| v % u32::try_from(n).expect("some dozens");
            let triangles: Vec<[u32; 3]> = corners.iter().map(|(a, b, c)| [*a, *b, *c].map(vertex)).collect();
            let mut heights = vec![DARKENING_HEIGHT; CELLS * CELLS];
            let n_places = lay(&GroundMap::new(CELLS), (&places, &triangles), &mut heights, u64::MAX);
            prop_assert_eq!((heights, n_places), laid(&places, &triangles));
            let mut few = vec![DARKENING_HEIGHT; CELLS * CELLS];
            let told = lay(&GroundMap::new(CELLS), (&places, &triangles), &mut few, n_places / 2);
            prop_assert!(n_places < 2 || told > n_places / 2, "{told} of {n_places}");
        }
    }
}
