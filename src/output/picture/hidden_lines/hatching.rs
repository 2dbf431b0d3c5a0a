//! Hatching: parallel lines over the picture, which are the denser the darker the surface is.
//!
//! Along a line of the picture the light on a triangle is linear between its corners, so the drawn part of the line is
//! an interval whose ends are quotients; the parts of it that nearer triangles hide are found as for any other line.
//! Pieces on neighbouring triangles lie on one line, and are joined to one stroke.

use rayon::prelude::*;

use super::parts::rest;
use crate::drawing::PolylinePoints;
use crate::math::functions::sqrt;
use crate::math::vector::{Vector, dot};
use crate::output::error::FormatError;
use crate::output::hard_edges::HardEdges;
use crate::output::normals;
use crate::output::positions::Positions;
use crate::output::scene::{MeshSource, Scene, each_face, triangles};
use crate::output::split_vertices::SplitVertices;
use crate::raster::{Camera, ProjectedPoint, Sight};
use crate::watch::Watch;

/// Distance between neighbouring lines, in units of line width. Half of it looks grey and doubles the file; twice of it
/// leaves a finger-wide surface without a line.
const STROKE_DISTANCE: f64 = 3.5;
/// The two directions of lines, across the picture and down it.
const STROKE_DIRECTIONS: [[f64; 2]; 2] = [[1.0, -1.0], [1.0, 1.0]];
/// The cosines of the angle between normal and lamp below which lines are drawn: every fourth line, the ones midway
/// between two of these, and all others; first in one direction, then across it. About even steps between full light
/// and the side turned away. Higher ones leave no paper, lower ones no ink.
const STROKE_COSINES: [[f64; 3]; 2] = [[0.82, 0.60, 0.36], [0.12, -0.10, -0.40]];
/// Minimum length of a stroke, in units of line width; shorter ones look like dust and are left out. Half of it leaves
/// dust; twice of it empties narrow shadows.
const LEAST_STROKE_LENGTH: f64 = 2.0;
/// Gaps between pieces of one line that are due to rounding, pixels. Half of it leaves gaps between triangles seen
/// nearly edge-on; twice of it still cannot be seen.
const GAP_PX: f64 = 0.2;
/// Maximum number of pieces, 56 bytes each; usual meshes have one or two per triangle. Half of it refuses meshes whose
/// lines can be drawn; twice of it takes 120 MB more in each of the two buffers of [`PIECES_BYTES`].
const MAX_STROKE_PIECES: usize = 1 << 21;
/// Bytes of memory for all pieces: as they are cut, and their visible parts.
const PIECES_BYTES: u128 = (MAX_STROKE_PIECES * 2 * size_of::<HatchSegment>()) as u128;
/// Maximum number of strokes. Pictures have some thousand; twice of it writes twice as long files of black areas.
const MAX_STROKES: usize = 1 << 17;
/// Maximum number of bytes of the strokes in a file.
pub(super) const STROKES_BYTES: u128 = (MAX_STROKES * 64) as u128;

/// Returns the memory in bytes for hatching: positions, normals, places and light of vertices that may be split,
/// triangles, and at most [`MAX_STROKE_PIECES`] pieces of lines.
pub(super) fn memory(triangles: u128, vertices: u128) -> u128 {
    let held = vertices.saturating_mul(3 * 24 + 8).saturating_add(triangles.saturating_mul(12));
    held.saturating_add(PIECES_BYTES)
}

/// The hatched surface: triangles, and at each vertex its place in the picture and the cosine between normal and lamp.
pub(super) struct HatchedSurface {
    triangles: Vec<[u32; 3]>,
    seen: Vec<ProjectedPoint>,
    light: Vec<f64>,
}

/// A piece of a line in a triangle.
#[derive(Debug, Clone, Copy)]
struct HatchSegment {
    /// The direction and number of the line.
    line: (usize, i64),
    triangle: u32,
    /// Positions of the start and the end along the line, pixels.
    from: f64,
    to: f64,
    /// Nearness of the two ends.
    near: [f64; 2],
}

impl HatchedSurface {
    /// Prepares the triangles of a mesh in the same order as [`SceneEdges`](super::edges::SceneEdges) has them, with
    /// normals that differ on the two sides of hard edges.
    pub(super) fn of(
        scene: &Scene<'_>,
        mesh: &dyn MeshSource,
        hard: &HardEdges,
        camera: &Camera,
        watch: &Watch,
    ) -> Result<Self, FormatError> {
        let split = SplitVertices::of(scene.shape, hard, watch)?;
        let sides = split.as_ref().map_or(mesh, |split| split);
        let positions = Positions::of_mesh(sides).held(watch)?;
        let positions = positions.rows();
        let normals = normals::of(sides, positions, watch)?;
        let mut found = Vec::new();
        each_face(sides, watch, |face| found.extend(triangles(face)))?;
        // triangles with two corners at one position are left out, as among the lines
        let at = |v: u32| positions[v as usize].map(|x| (x + 0.0).to_bits());
        found.retain(|&[a, b, c]| at(a) != at(b) && at(b) != at(c) && at(c) != at(a));
        let lamp = camera.lamp();
        let light = normals.par_iter().map(|normal| dot(*normal, lamp)).collect();
        // all points are in front of the camera, or the drawing would have been refused
        let seen = positions.par_iter().map(|point| camera.seen(*point).unwrap_or_default()).collect();
        Ok(Self { triangles: found, seen, light })
    }

    /// Returns the visible strokes, line by line. `size` is the size of the picture and `unit` the unit of line width,
    /// pixels.
    pub(super) fn strokes(
        &self,
        sight: &Sight<'_>,
        size: [u32; 2],
        unit: f32,
        most_pairs: usize,
        watch: &Watch,
    ) -> Result<Vec<PolylinePoints>, FormatError> {
        let lines = HatchLines { apart: STROKE_DISTANCE * f64::from(unit), size: size.map(f64::from) };
        let count = |triangle: &[u32; 3]| -> u64 {
            let numbers = (0..2).map(|direction| lines.numbers(direction, self.corners(*triangle)));
            numbers.map(|(from, to)| u64::try_from(to - from).unwrap_or(0)).sum()
        };
        let too_many = |what: &str| {
            FormatError::Unfit(format!("{what}; ask for fewer levels, or leave \"hatching\" out of \"show\""))
        };
        if self.triangles.par_iter().map(count).sum::<u64>() > MAX_STROKE_PIECES as u64 {
            return Err(too_many("hatching has too many lines on faces that lie behind each other"));
        }
        let of_triangle = |(number, triangle): (usize, &[u32; 3])| {
            let number = u32::try_from(number).expect("fewer than 2^32 triangles");
            self.pieces(&lines, number, *triangle)
        };
        let pieces: Vec<HatchSegment> = self.triangles.par_iter().enumerate().flat_map_iter(of_triangle).collect();
        let pairs: usize = pieces.par_iter().map(|piece| sight.n_candidates(lines.ends(piece))).sum();
        if pairs > most_pairs {
            return Err(too_many("too many faces lie behind each other to find what each hides of the hatching"));
        }
        let shown = |piece: &HatchSegment| {
            watch.check()?;
            let hidden = sight.hidden(lines.ends(piece), |triangle| triangle == piece.triangle);
            let length = piece.to - piece.from;
            let part = |[from, to]: [f64; 2]| (piece.line, piece.from + from * length, piece.from + to * length);
            Ok(rest(&hidden).into_iter().map(part).collect::<Vec<_>>())
        };
        let seen: Vec<Vec<_>> = pieces.par_iter().with_min_len(256).map(shown).collect::<Result<_, FormatError>>()?;
        let mut seen = seen.concat();
        seen.par_sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.total_cmp(&b.2)));
        let mut strokes: Vec<((usize, i64), f64, f64)> = Vec::new();
        for (line, from, to) in seen {
            match strokes.last_mut().filter(|last| last.0 == line && from <= last.2 + GAP_PX) {
                Some(last) => last.2 = last.2.max(to),
                None => strokes.push((line, from, to)),
            }
        }
        strokes.retain(|(_, from, to)| to - from >= LEAST_STROKE_LENGTH * f64::from(unit));
        if strokes.len() > MAX_STROKES {
            return Err(too_many("hatching has too many strokes"));
        }
        Ok(strokes.into_iter().map(|(line, from, to)| [from, to].map(|at| lines.place(line, at)).to_vec()).collect())
    }

    fn corners(&self, triangle: [u32; 3]) -> [ProjectedPoint; 3] {
        triangle.map(|v| self.seen[v as usize])
    }

    /// Returns the pieces of lines in a triangle where it is dark enough for them.
    fn pieces(&self, lines: &HatchLines, number: u32, triangle: [u32; 3]) -> Vec<HatchSegment> {
        let corners = self.corners(triangle);
        let [a, b, c] = corners;
        // y points downwards: clockwise triangles show their inside, which is lit from the other side
        let inside = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0;
        let light = triangle.map(|v| if inside { -self.light[v as usize] } else { self.light[v as usize] });
        let mut found = Vec::new();
        for direction in 0..2 {
            let (from, to) = lines.numbers(direction, corners);
            for line in from..to {
                found.extend(lines.cut((direction, line), corners, light, number));
            }
        }
        found
    }
}

/// All lines of a picture.
struct HatchLines {
    /// Distance between neighbouring lines, pixels.
    apart: f64,
    size: [f64; 2],
}

impl HatchLines {
    /// Returns the unit vectors along and across the lines of a direction.
    fn axes(direction: usize) -> [[f64; 2]; 2] {
        let along = STROKE_DIRECTIONS[direction].map(|x| x / sqrt(2.0));
        [along, [-along[1], along[0]]]
    }

    /// Returns the coordinate of a place across a direction, in distances between lines.
    fn across(&self, direction: usize, [x, y]: [f64; 2]) -> f64 {
        let [_, across] = Self::axes(direction);
        (across[0] * x + across[1] * y) / self.apart
    }

    /// Returns the first line that reaches into both a triangle and the picture, and the end of the range.
    fn numbers(&self, direction: usize, corners: [ProjectedPoint; 3]) -> (i64, i64) {
        let range = |places: &[[f64; 2]]| {
            let of = |place: &[f64; 2]| self.across(direction, *place);
            let least = places.iter().map(of).fold(f64::INFINITY, f64::min);
            (least, places.iter().map(of).fold(f64::NEG_INFINITY, f64::max))
        };
        let [width, height] = self.size;
        let picture = range(&[[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]]);
        let triangle = range(&corners.map(|[x, y, _]| [x, y]));
        #[expect(clippy::cast_possible_truncation, reason = "some thousand lines")]
        let number = |x: f64| x.ceil() as i64;
        let from = number(triangle.0.max(picture.0));
        (from, number(triangle.1.min(picture.1)).max(from))
    }

    /// Returns the place at a distance `at` along a line.
    fn place(&self, (direction, number): (usize, i64), at: f64) -> [f32; 2] {
        #[expect(clippy::cast_possible_truncation, reason = "pixel coordinates need no more than the precision of f32")]
        let place = self.place_exactly((direction, number), at).map(|x| x as f32);
        place
    }

    fn place_exactly(&self, (direction, number): (usize, i64), at: f64) -> [f64; 2] {
        let [along, across] = Self::axes(direction);
        #[expect(clippy::cast_precision_loss, reason = "some thousand lines")]
        let off = number as f64 * self.apart;
        [0, 1].map(|k| at * along[k] + off * across[k])
    }

    /// Returns the ends of a piece.
    fn ends(&self, piece: &HatchSegment) -> [ProjectedPoint; 2] {
        let [start, end] = [piece.from, piece.to].map(|at| self.place_exactly(piece.line, at));
        [[start[0], start[1], piece.near[0]], [end[0], end[1], piece.near[1]]]
    }

    /// Returns the part of a line in a triangle on which the light is below the threshold of the line.
    fn cut(
        &self,
        line: (usize, i64),
        corners: [ProjectedPoint; 3],
        light: [f64; 3],
        triangle: u32,
    ) -> Option<HatchSegment> {
        let (direction, number) = line;
        let [along, _] = Self::axes(direction);
        #[expect(clippy::cast_precision_loss, reason = "some thousand lines")]
        let off = corners.map(|[x, y, _]| self.across(direction, [x, y]) - number as f64);
        let mut met: Vec<Vector> = Vec::with_capacity(2);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            if (off[i] < 0.0) != (off[j] < 0.0) {
                let t = off[i] / (off[i] - off[j]);
                let at = |of: fn(ProjectedPoint, [f64; 2]) -> f64| {
                    let [start, end] = [i, j].map(|k| of(corners[k], along));
                    start + t * (end - start)
                };
                let place = at(|[x, y, _], along| x * along[0] + y * along[1]);
                met.push([place, at(|corner, _| corner[2]), light[i] + t * (light[j] - light[i])]);
            }
        }
        let [a, b] = met[..] else { return None };
        let [start, end] = if a[0] <= b[0] { [a, b] } else { [b, a] };
        let [from, to] = darker(start[2], end[2], below(direction, number))?;
        let at = |t: f64, k: usize| start[k] + t * (end[k] - start[k]);
        let piece = HatchSegment { line, triangle, from: at(from, 0), to: at(to, 0), near: [at(from, 1), at(to, 1)] };
        (piece.to > piece.from).then_some(piece)
    }
}

/// Returns the cosine below which a line is drawn.
fn below(direction: usize, number: i64) -> f64 {
    let [fourth, second, other] = STROKE_COSINES[direction];
    match number.rem_euclid(4) {
        0 => fourth,
        2 => second,
        _ => other,
    }
}

/// Returns the part of a way on which a number that changes linearly from `start` to `end` is below a bound.
fn darker(start: f64, end: f64, bound: f64) -> Option<[f64; 2]> {
    let through = || (bound - start) / (end - start);
    match (start < bound, end < bound) {
        (true, true) => Some([0.0, 1.0]),
        (true, false) => Some([0.0, through()]),
        (false, true) => Some([through(), 1.0]),
        (false, false) => None,
    }
}
