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
use super::shade::{Vec3f, dot, positive};
use super::tile_scratch::Drawn;
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

/// Places around a cell for each turn, within a circle of radius one.
static CIRCLE_PLACES: LazyLock<[[[f32; 2]; PLACES_A_CELL]; CIRCLE_KINDS]> = LazyLock::new(|| {
    std::array::from_fn(|turn| {
        std::array::from_fn(|tap| {
            // the golden angle leads round, equal areas lead out
            let angle = TAU * (turn as f64 / CIRCLE_KINDS as f64 + 0.381_966 * tap as f64);
            let radius = ((tap as f64 + 0.5) / PLACES_A_CELL as f64).sqrt();
            [(radius * cos(angle)) as f32, (radius * sin(angle)) as f32]
        })
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
    /// Distance along the view in radii of the model; infinite where there is nothing.
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
    pub(super) fn of(tiles: &[Option<Drawn>], grid: TileGrid, camera: &Camera, watch: &Watch) -> Result<Self, Stopped> {
        let [width, height] = camera.size_px.map(|side| side as usize);
        let mut cell_px = 1;
        while width.max(height).div_ceil(cell_px) > MAX_HOLLOW_CELLS {
            cell_px *= 2;
        }
        let lens = Lens::of(camera);
        let size @ [columns, _] = [width.div_ceil(cell_px), height.div_ceil(cell_px)];
        let distance = |i: usize| {
            let [x, y] = [i % columns, i / columns].map(|cell| cell * cell_px + cell_px / 2);
            let tile = tiles.get(y / TILE * usize::from(grid.columns) + x / TILE).and_then(Option::as_ref);
            let depth = tile.and_then(|tile| tile.depth.get(y % TILE * TILE + x % TILE));
            lens.distance(depth.copied().unwrap_or(0.0))
        };
        let distance = (0..size[0] * size[1]).into_par_iter().with_min_len(4096).map(distance).collect();
        let mut occlusion = Self { lens, cell_px, cells_a_px: 1.0 / cell_px as f32, size, distance, open: Vec::new() };
        occlusion.open = occlusion.by_row(watch, |x, y| occlusion.found(x, y))?;
        occlusion.open = occlusion.by_row(watch, |x, y| occlusion.smoothed(x, y))?;
        Ok(occlusion)
    }

    fn by_row(&self, watch: &Watch, at: impl Fn(usize, usize) -> f32 + Sync) -> Result<Vec<f32>, Stopped> {
        let mut all = vec![1.0; self.distance.len()];
        all.par_chunks_mut(self.size[0]).enumerate().try_for_each(|(y, row)| {
            watch.check()?;
            row.iter_mut().enumerate().for_each(|(x, cell)| *cell = at(x, y));
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

    fn found(&self, x: usize, y: usize) -> f32 {
        let here @ [x, y] = [x, y].map(usize::cast_signed);
        if self.distance(x, y).is_infinite() {
            return 1.0;
        }
        let at = self.point(x, y);
        let Some(normal) = self.normal(here, at) else { return 1.0 };
        let reach =
            (OCCLUDER_REACH * self.lens.pixels(at[2]) / self.cell_px as f32).clamp(REACH_CELLS[0], REACH_CELLS[1]);
        let turn = ((x & 3) * 4 + (y & 3)) as usize;
        let mut around = [[0.0; PLACES_A_CELL]; 3];
        for (tap, [right, down]) in CIRCLE_PLACES[turn].into_iter().enumerate() {
            // to the nearest, moved up so that the cast rounds down
            let [i, j] = [right, down].map(|share| (reach * share + 128.5) as isize - 128);
            let distance = if (i, j) == (0, 0) { f32::INFINITY } else { self.distance(x + i, y + j) };
            [around[0][tap], around[1][tap]] = self.middle(x + i, y + j);
            around[2][tap] = distance;
        }
        let hidden = hidden(&self.lens, &around, at, normal).into_iter().fold(0.0, |sum, share| sum + share);
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

    /// Returns the mean over the 16 cells around a cell, restricted to similar distances.
    fn smoothed(&self, x: usize, y: usize) -> f32 {
        let [x, y] = [x, y].map(usize::cast_signed);
        let distance = self.distance(x, y);
        if distance.is_infinite() {
            return 1.0;
        }
        let (mut sum, mut weight) = (0.0, 0.0);
        for (i, j) in (-2..2).flat_map(|j| (-2..2).map(move |i| (i, j))) {
            if (self.distance(x + i, y + j) - distance).abs() < 0.25 * OCCLUDER_REACH {
                sum += self.open[((y + j) * self.size[0].cast_signed() + x + i) as usize];
                weight += 1.0;
            }
        }
        sum / weight
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

/// Returns how much each of some places, given by pixel coordinates and distances, hides of the sky above the point
/// `at`. Wider vectors give the same bits.
#[multiversion(targets("x86_64+avx2"))]
fn hidden(lens: &Lens, around: &[[f32; PLACES_A_CELL]; 3], at: Vec3f, normal: Vec3f) -> [f32; PLACES_A_CELL] {
    let mut hidden = [0.0; PLACES_A_CELL];
    for tap in 0..PLACES_A_CELL {
        let distance = around[2][tap];
        let other = lens.point([around[0][tap], around[1][tap]], distance);
        let to = [other[0] - at[0], other[1] - at[1], other[2] - at[2]];
        let square = dot(to, to);
        let sine = dot(to, normal) / square.sqrt() - LEAST_OCCLUDER_SINE;
        let near = 1.0 - square * (1.0 / (OCCLUDER_REACH * OCCLUDER_REACH));
        // what is infinitely far away is not near
        hidden[tap] = positive(sine) * positive(near);
    }
    hidden
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
