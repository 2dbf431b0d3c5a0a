//! Ambient occlusion: hollows receive less light, estimated from the depths of the picture.
//!
//! On a coarser grid of at most 256 cells a side, so that the time is bounded, each cell asks some cells around it how
//! high they stand over its tangent plane: the mean of the sines of those angles is what is hidden of the sky. It is
//! smoothed over cells of like distance. Source: M. `McGuire` et al., High Performance Graphics 2011, 25-32.

#![expect(clippy::cast_precision_loss, reason = "pixel numbers are small")]
#![expect(clippy::cast_possible_truncation, reason = "light needs no more than the precision of f32")]
#![expect(clippy::cast_sign_loss, reason = "places are checked to lie in the grid before the cast")]

use std::f64::consts::TAU;
use std::sync::LazyLock;

use multiversion::multiversion;
use rayon::prelude::*;

use super::bins::{TILE, TileGrid};
use super::camera::{Camera, Projection};
use super::pixmap::rounded_down;
use super::shade::{Vec3f, dot, positive};
use super::tile_scratch::DrawnTiles;
use crate::math::functions::{cos, sin};
use crate::watch::{Stopped, Watch};

/// Most cells along a side.
/// Half of it blurs small hollows, twice of it takes four times as long; in the largest picture a cell is a tile.
const MAX_HOLLOW_CELLS: usize = 256;
/// Distance up to which a sample counts as an occluder, as a fraction of the radius of the model. Half of it darkens
/// creases only; twice of it darkens whole limbs.
const OCCLUDER_REACH: f32 = 0.3;
/// Least and largest radius, in cells, of the circle in which a cell takes its samples of ambient occlusion. With less
/// than the least nearly all samples would fall on the cell itself; beyond the largest they would stand too far apart.
/// Half of the largest loses the occlusion of models seen from close by; twice of it leaves grain.
const REACH_CELLS: [f32; 2] = [1.5, 64.0];
/// Number of samples of ambient occlusion that each cell takes around itself. Half of it leaves grain; twice of it
/// takes twice as long.
const PLACES_A_CELL: usize = 8;
/// Number of rotations of the circle of samples, one for each cell of a square of 4 x 4 cells. The occlusion is then
/// smoothed by the mean over such a square, which so joins samples in all rotations.
const CIRCLE_KINDS: usize = 16;
/// Sine of the elevation above the tangent plane from which a sample counts as an occluder. The faces of a mesh that
/// approximates a round surface rise above the tangent planes of their neighbours by less and must not darken them.
/// Half of it darkens the edges of coarse meshes; twice of it leaves flat hollows light.
const LEAST_OCCLUDER_SINE: f32 = 0.12;
/// Factor from the mean over the samples, of the sine of the elevation of occluders weighted by their nearness, to the
/// fraction of the ambient light that a cell loses, which [`LEAST_OPEN`] bounds. It is a matter of taste: with half of
/// it hollows hardly show; with twice of it all but the flattest are as dark as they may be.
const OCCLUSION_STRENGTH: f32 = 2.2;
/// Least fraction of the ambient light that occlusion leaves a cell. It is a matter of taste: with half of it deep
/// hollows are nearly black and lose their colour; with twice of it deep hollows look like flat ones.
const LEAST_OPEN: f32 = 0.3;

/// Places around a cell, right and down, within a circle of radius one.
type SampleCircle = [[f32; PLACES_A_CELL]; 2];

/// The places for each turn.
static CIRCLES: LazyLock<[SampleCircle; CIRCLE_KINDS]> = LazyLock::new(|| {
    std::array::from_fn(|turn| {
        // the golden angle leads round, equal areas lead out
        let angle = |tap: usize| TAU * (turn as f64 / CIRCLE_KINDS as f64 + 0.381_966 * tap as f64);
        let radius = |tap: usize| ((tap as f64 + 0.5) / PLACES_A_CELL as f64).sqrt();
        let right = std::array::from_fn(|tap| (radius(tap) * cos(angle(tap))) as f32);
        [right, std::array::from_fn(|tap| (radius(tap) * sin(angle(tap))) as f32)]
    })
});

/// The fraction of ambient light that reaches each cell.
#[derive(Debug)]
pub(super) struct Occlusion {
    lens: Lens,
    /// Side of a cell, in pixels.
    cell_px: usize,
    /// Its inverse; both are powers of two.
    cells_a_px: f32,
    size: [usize; 2],
    /// Distance along the view in radii of the model; infinite where there is nothing, and
    /// once more after the last cell, for places outside.
    distance: Vec<f32>,
    /// The remaining fraction of the light.
    open: Vec<f32>,
}

/// Converts depths to positions, in radii of the model.
#[derive(Debug, Clone, Copy)]
struct Lens {
    perspective: bool,
    /// The distance is the first over the depth (perspective), or the first less the second times the depth.
    depth: [f32; 2],
    /// Pixels per radius of the model, in perspective at distance one, and its inverse.
    focal: [f32; 2],
    centre_px: [f32; 2],
}

impl Lens {
    fn of(camera: &Camera) -> Self {
        let perspective = camera.projection == Projection::Perspective;
        let [start, fall] = camera.fall;
        let depth = if perspective {
            [camera.near / camera.radius, 0.0]
        } else {
            [start / (fall * camera.radius), 1.0 / (fall * camera.radius)]
        };
        let focal = if perspective { camera.focal_px } else { camera.focal_px * camera.radius };
        Self {
            perspective,
            depth: depth.map(|x| x as f32),
            focal: [focal as f32, (1.0 / focal) as f32],
            centre_px: camera.size_px.map(|side| (0.5 * side) as f32),
        }
    }

    /// Returns the distance of a depth; infinite where there is nothing.
    #[expect(clippy::inline_always, reason = "only code inside of `blended` uses its wider vectors")]
    #[inline(always)]
    fn distance(&self, depth: f32) -> f32 {
        if depth <= 0.0 {
            f32::INFINITY
        } else if self.perspective {
            self.depth[0] / depth
        } else {
            self.depth[0] - self.depth[1] * depth
        }
    }

    /// Returns the position at pixel coordinates and a distance: right, down, forward.
    #[expect(clippy::inline_always, reason = "only code inside of `hidden` uses its wider vectors")]
    #[inline(always)]
    fn point(&self, [x, y]: [f32; 2], distance: f32) -> Vec3f {
        let scale = if self.perspective { distance * self.focal[1] } else { self.focal[1] };
        [(x - self.centre_px[0]) * scale, (y - self.centre_px[1]) * scale, distance]
    }

    /// Returns the size in pixels of a radius at this distance.
    fn pixels(&self, distance: f32) -> f32 {
        if self.perspective { self.focal[0] / distance } else { self.focal[0] }
    }
}

impl Occlusion {
    /// Computes the occlusion of a picture whose tiles are drawn.
    pub(super) fn of(tiles: &DrawnTiles<'_>, grid: TileGrid, camera: &Camera, watch: &Watch) -> Result<Self, Stopped> {
        let [width, height] = camera.size_px.map(|side| side as usize);
        let mut cell_px = 1;
        while width.max(height).div_ceil(cell_px) > MAX_HOLLOW_CELLS {
            cell_px *= 2;
        }
        let lens = Lens::of(camera);
        let size = [width.div_ceil(cell_px), height.div_ceil(cell_px)];
        let cells_a_px = 1.0 / cell_px as f32;
        let mut occlusion = Self { lens, cell_px, cells_a_px, size, distance: Vec::new(), open: Vec::new() };
        occlusion.distance = occlusion.by_row(watch, |row, distance| {
            let y = row * cell_px + cell_px / 2;
            let tiles = &tiles[y / TILE * usize::from(grid.columns)..];
            for (column, distance) in distance.iter_mut().enumerate() {
                let x = column * cell_px + cell_px / 2;
                let tile = tiles.get(x / TILE).and_then(Option::as_ref);
                let depth = tile.and_then(|tile| tile.depth.get(y % TILE * TILE + x % TILE));
                *distance = lens.distance(depth.copied().unwrap_or(0.0));
            }
        })?;
        occlusion.distance.push(f32::INFINITY);
        let circles = &*CIRCLES;
        occlusion.open = occlusion.by_row(watch, |y, open| {
            open.iter_mut().enumerate().for_each(|(x, open)| *open = occlusion.found(circles, x, y));
        })?;
        occlusion.open = occlusion.by_row(watch, |y, open| occlusion.smooth(y, open))?;
        Ok(occlusion)
    }

    /// Computes a number for each cell, given a function that fills a row.
    fn by_row(&self, watch: &Watch, fill: impl Fn(usize, &mut [f32]) + Sync) -> Result<Vec<f32>, Stopped> {
        let [columns, rows] = self.size;
        let mut all = Vec::with_capacity(columns * rows + 1);
        all.resize(columns * rows, 1.0);
        all.par_chunks_mut(columns).enumerate().try_for_each(|(y, row)| {
            watch.check()?;
            fill(y, row);
            Ok(())
        })?;
        Ok(all)
    }

    /// Returns the distance in a cell; infinite outside the picture.
    fn distance(&self, x: isize, y: isize) -> f32 {
        let [columns, rows] = self.size;
        if x < 0 || y < 0 || x as usize >= columns || y as usize >= rows {
            return f32::INFINITY;
        }
        self.distance[y as usize * columns + x as usize]
    }

    /// Returns the position of the surface in a cell.
    fn point(&self, x: isize, y: isize) -> Vec3f {
        self.lens.point(self.middle(x, y), self.distance(x, y))
    }

    /// Returns the remaining fraction of the light of a cell, with the grain of eight places.
    fn found(&self, circles: &[SampleCircle; CIRCLE_KINDS], x: usize, y: usize) -> f32 {
        let here @ [x, y] = [x, y].map(usize::cast_signed);
        if self.distance(x, y).is_infinite() {
            return 1.0;
        }
        let at = self.point(x, y);
        let Some(normal) = self.normal(here, at) else { return 1.0 };
        let reach =
            (OCCLUDER_REACH * self.lens.pixels(at[2]) / self.cell_px as f32).clamp(REACH_CELLS[0], REACH_CELLS[1]);
        let turn = ((x & 3) * 4 + (y & 3)) as usize;
        let hidden = hidden(self, here.map(|cell| cell as i32), &circles[turn], (at, normal, reach));
        let hidden = hidden.into_iter().fold(0.0, |sum, share| sum + share);
        (1.0 - OCCLUSION_STRENGTH * hidden / PLACES_A_CELL as f32).max(LEAST_OPEN)
    }

    /// Returns the pixel coordinates of the middle of a cell.
    fn middle(&self, x: isize, y: isize) -> [f32; 2] {
        [x, y].map(|cell| (cell as f32 + 0.5) * self.cell_px as f32)
    }

    /// Returns the normal toward the viewer, from the neighbours with the most similar distances.
    fn normal(&self, [x, y]: [isize; 2], at: Vec3f) -> Option<Vec3f> {
        let toward = |[i, j]: [isize; 2]| {
            let [before, after] = [self.distance(x - i, y - j), self.distance(x + i, y + j)];
            let sign = if (after - at[2]).abs() <= (before - at[2]).abs() { 1 } else { -1 };
            let other = self.point(x + sign * i, y + sign * j);
            other[2].is_finite().then(|| -> Vec3f { std::array::from_fn(|k| (other[k] - at[k]) * sign as f32) })
        };
        let (a, b) = (toward([1, 0])?, toward([0, 1])?);
        let normal = [b[1] * a[2] - b[2] * a[1], b[2] * a[0] - b[0] * a[2], b[0] * a[1] - b[1] * a[0]];
        let length = dot(normal, normal).sqrt();
        (length > 0.0).then(|| normal.map(|c| c / length))
    }

    /// Fills a row with the mean over the 16 cells around each cell, of those at similar distances.
    fn smooth(&self, y: usize, mean: &mut [f32]) {
        let [columns, rows] = self.size;
        let row = |y: usize| y * columns..(y + 1) * columns;
        let here = &self.distance[row(y)];
        let mut weights = vec![0.0; columns];
        mean.fill(0.0);
        for y in (y.saturating_sub(2)..y + 2).filter(|y| *y < rows) {
            let (distance, open) = (&self.distance[row(y)], &self.open[row(y)]);
            let shifts = [(2, 0), (1, 0), (0, 0), (0, 1)].into_iter().filter(|(left, right)| left + right < columns);
            for (to, from) in shifts.map(|(left, right)| (left..columns - right, right..columns - left)) {
                let sums = [&mut mean[to.clone()], &mut weights[to.clone()]];
                add_similar(sums, &here[to], [&distance[from.clone()], &open[from]]);
            }
        }
        for ((mean, weight), here) in mean.iter_mut().zip(weights).zip(here) {
            *mean = if here.is_infinite() { 1.0 } else { *mean / weight };
        }
    }

    /// Returns the column of the cell whose middle is left of a column of pixels, and how far to the right of it they
    /// are, in cells; the same for rows.
    fn cell_of(&self, pixel: usize) -> (usize, f32) {
        let place = ((pixel as f32 + 0.5) * self.cells_a_px - 0.5).max(0.0);
        let cell = place as usize;
        (cell, place - cell as f32)
    }

    /// Returns the remaining fraction of light for the depths of a row of pixels of a tile, the first at `[left, y]`,
    /// interpolated from the surrounding cells at similar distances.
    pub(super) fn open(&self, [left, y]: [usize; 2], depths: &[f32; TILE]) -> [f32; TILE] {
        let [columns, rows] = self.size;
        if self.cell_px == 1 {
            return std::array::from_fn(|i| self.open[y * columns + (left + i).min(columns - 1)]);
        }
        let (upper, down) = self.cell_of(y);
        let lines = [upper, (upper + 1).min(rows - 1)].map(|row| row * columns..row * columns + columns);
        let open = lines.clone().map(|line| &self.open[line]);
        let distance = lines.map(|line| &self.distance[line]);
        let mut around = CellsAround { open: [[1.0; TILE]; 4], distance: [[0.0; TILE]; 4], right: [0.0; TILE], down };
        let (first, end) = (self.cell_of(left).0, (self.cell_of(left + TILE).0 + 2).min(columns));
        if open.iter().all(|line| line[first..end].iter().all(|open| *open >= 1.0)) {
            return [1.0; TILE];
        }
        for i in 0..TILE {
            let (column, right) = self.cell_of(left + i);
            let sides = [column.min(columns - 1), (column + 1).min(columns - 1)];
            around.right[i] = right;
            for k in 0..4 {
                around.open[k][i] = open[k / 2][sides[k % 2]];
                around.distance[k][i] = distance[k / 2][sides[k % 2]];
            }
        }
        blended(&self.lens, &around, depths)
    }
}

/// Returns how much each place of a circle about the cell `[x, y]` hides of the sky above the point `at` with this
/// normal; `reach` is the radius of the circle in cells. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx2"))]
fn hidden(
    cells: &Occlusion,
    [x, y]: [i32; 2],
    circle: &SampleCircle,
    (at, normal, reach): (Vec3f, Vec3f, f32),
) -> [f32; PLACES_A_CELL] {
    let [columns, rows] = cells.size.map(|side| side as u32);
    let outside = columns * rows;
    let (mut places, mut middles) = ([0; PLACES_A_CELL], [[0.0; PLACES_A_CELL]; 2]);
    for tap in 0..PLACES_A_CELL {
        // to the nearest, moved up so that it is not negative
        let right = rounded_down(reach * circle[0][tap] + 128.5).cast_signed() - 128;
        let down = rounded_down(reach * circle[1][tap] + 128.5).cast_signed() - 128;
        let (column, row) = (x + right, y + down);
        // what is negative becomes large
        let (across, along) = (column.cast_unsigned(), row.cast_unsigned());
        let is_other = (right | down) != 0;
        let is_place = is_other && across < columns && along < rows;
        places[tap] = if is_place { along * columns + across } else { outside };
        middles[0][tap] = (column as f32 + 0.5) * cells.cell_px as f32;
        middles[1][tap] = (row as f32 + 0.5) * cells.cell_px as f32;
    }
    let mut distances = [f32::INFINITY; PLACES_A_CELL];
    for (distance, place) in distances.iter_mut().zip(places) {
        *distance = cells.distance[place as usize];
    }
    let mut hidden = [0.0; PLACES_A_CELL];
    for tap in 0..PLACES_A_CELL {
        let other = cells.lens.point([middles[0][tap], middles[1][tap]], distances[tap]);
        let to = [other[0] - at[0], other[1] - at[1], other[2] - at[2]];
        let square = dot(to, to);
        let sine = dot(to, normal) / square.sqrt() - LEAST_OCCLUDER_SINE;
        let near = 1.0 - square * (1.0 / (OCCLUDER_REACH * OCCLUDER_REACH));
        // what is infinitely far away is not near
        hidden[tap] = positive(sine) * positive(near);
    }
    hidden
}

/// Adds to sums and weights what is open of the cells whose distance is like that `here`. Wider vectors give the same
/// bits.
#[multiversion(targets("x86_64+avx2"))]
fn add_similar([sums, weights]: [&mut [f32]; 2], here: &[f32], [distance, open]: [&[f32]; 2]) {
    for ((((sum, weight), here), distance), open) in sums.iter_mut().zip(weights).zip(here).zip(distance).zip(open) {
        let is_similar = (distance - here).abs() < 0.25 * OCCLUDER_REACH;
        *sum += if is_similar { *open } else { 0.0 };
        *weight += if is_similar { 1.0 } else { 0.0 };
    }
}

/// The four cells around each pixel of a row.
struct CellsAround {
    open: [[f32; TILE]; 4],
    distance: [[f32; TILE]; 4],
    /// How far to the right of the left cells each pixel is, and how far below the upper cells, in cells.
    right: [f32; TILE],
    down: f32,
}

/// Returns the mean of four cells for each pixel, weighted by how near they are in the picture and in distance. Wider
/// vectors give the same bits.
#[multiversion(targets("x86_64+avx2"))]
fn blended(lens: &Lens, around: &CellsAround, depths: &[f32; TILE]) -> [f32; TILE] {
    let mut open = [0.0; TILE];
    for i in 0..TILE {
        let distance = lens.distance(depths[i]);
        let (u, v) = (around.right[i], around.down);
        let shares = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
        let (mut sum, mut weights) = (0.0, 0.0);
        for ((share, cells), open) in shares.iter().zip(&around.distance).zip(&around.open) {
            let near = 1.0 - (cells[i] - distance).abs() * (4.0 / OCCLUDER_REACH);
            let weight = if near > 0.0 { share * near + 1e-6 } else { 1e-6 };
            sum += weight * open[i];
            weights += weight;
        }
        open[i] = sum / weights;
    }
    open
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::View;

    #[test]
    fn a_cell_is_smoothed_over_the_cells_of_like_distance_around_it() {
        let camera = Camera::framing(&View::default(), &[&[[0.0; 3], [1.0; 3]]], 8, 8);
        for size @ [columns, rows] in [[1, 1], [1, 5], [2, 2], [2, 7], [3, 1], [9, 6]] {
            let random = |i: usize| (i as u32).wrapping_mul(2_654_435_761) as f32 / (1_u64 << 32) as f32;
            let distances = (1..=columns * rows).map(random).map(|x| if x < 0.2 { f32::INFINITY } else { x });
            let distance: Vec<f32> = distances.chain([f32::INFINITY]).collect();
            let (lens, open) = (Lens::of(&camera), (100..100 + columns * rows).map(random).collect());
            let occlusion = Occlusion { lens, cell_px: 1, cells_a_px: 1.0, size, distance, open };
            let found = occlusion.by_row(&Watch::new(), |y, open| occlusion.smooth(y, open)).expect("nobody stops it");
            for (i, found) in found.into_iter().enumerate() {
                let [x, y] = [i % columns, i / columns].map(usize::cast_signed);
                let here = occlusion.distance(x, y);
                let around = (-2..2).flat_map(|down| (-2..2).map(move |right| (x + right, y + down)));
                let like = around.filter(|&(x, y)| (occlusion.distance(x, y) - here).abs() < 0.25 * OCCLUDER_REACH);
                let like = like.map(|(x, y)| occlusion.open[y.cast_unsigned() * columns + x.cast_unsigned()]);
                let (sum, n) = like.fold((0.0, 0.0), |(sum, n), open| (sum + open, n + 1.0));
                let expected = if here.is_infinite() { 1.0 } else { sum / n };
                assert_eq!(found.to_bits(), expected.to_bits(), "cell {x}, {y} of {size:?}");
            }
        }
    }
}
