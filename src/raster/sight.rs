//! Determines exactly, not by pixels, which parts of lines triangles hide.
//!
//! Points are given as a camera sees them: two pixel coordinates, and a nearness that is linear over the picture and
//! larger for what is nearer ([`super::Camera::seen`]). There triangles are flat and lines straight, so that what a
//! triangle hides of a line is an interval whose ends are found by division.

use std::ops::RangeInclusive;

use crate::math::functions::{real, sqrt};

/// A point as a camera sees it: x and y, pixels, and its nearness.
pub type ProjectedPoint = [f64; 3];

/// How much nearer a triangle has to be to hide something, as a share of the range of nearness in the picture. Lines on
/// a surface are as near as the surface but for rounding, about 1e-13; a hundred times as much lets lines show that are
/// a hundred-thousandth of the depth of the picture behind a surface, a hundredth as much risks to hide lines on it.
const NEARNESS_SLACK: f64 = 1e-7;
/// Triangles of less area, square pixels, are seen from their edge and hide nothing. A thousand times as much drops
/// triangles that can be seen, a thousandth as much lets rounding decide how near such triangles are.
const LEAST_HIDING_AREA: f64 = 1e-6;
/// Cells along a side of the grid at most: half of it has four times as many triangles a cell, twice of it takes four
/// times as much memory.
const MAX_SIGHT_CELLS: usize = 512;

/// Triangles that hide what is behind them.
#[derive(Debug)]
pub struct Sight<'a> {
    points: &'a [ProjectedPoint],
    triangles: &'a [[u32; 3]],
    /// The least difference of nearness at which a triangle hides something.
    slack: f64,
    grid: SightGrid,
}

impl<'a> Sight<'a> {
    /// Prepares triangles, whose corners are indices of points.
    pub fn new(points: &'a [ProjectedPoint], triangles: &'a [[u32; 3]]) -> Self {
        let ends = |k: usize| {
            let none = (f64::INFINITY, f64::NEG_INFINITY);
            points.iter().fold(none, |(low, high), point| (low.min(point[k]), high.max(point[k])))
        };
        let (near, far) = ends(2);
        let boxes = triangles.iter().map(|triangle| bounds(triangle.map(|v| points[v as usize])));
        let grid = SightGrid::new([ends(0), ends(1)], &boxes.collect::<Vec<_>>());
        Self { points, triangles, slack: NEARNESS_SLACK * (far - near).max(0.0), grid }
    }

    /// Returns the number of triangles that are tested against a line.
    pub fn n_candidates(&self, ends: [ProjectedPoint; 2]) -> usize {
        self.grid.cells(bounds(ends)).map(|cell| self.grid.triangles(cell).len()).sum()
    }

    /// Returns the parts of a line that triangles hide, as shares of the way from its start to its end, ascending and
    /// disjoint. Triangles for which `beside` holds hide nothing of it: the line is an edge of them.
    pub fn hidden(&self, ends: [ProjectedPoint; 2], beside: impl Fn(u32) -> bool) -> Vec<[f64; 2]> {
        let seen = bounds(ends);
        let mut found: Vec<[f64; 2]> = Vec::new();
        for cell in self.grid.cells(seen) {
            for &triangle in self.grid.triangles(cell) {
                let corners = self.triangles[triangle as usize].map(|v| self.points[v as usize]);
                if !overlap(seen, bounds(corners)) || beside(triangle) {
                    continue;
                }
                found.extend(covered(ends, corners, self.slack));
            }
        }
        found.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let mut joined: Vec<[f64; 2]> = Vec::new();
        for [from, to] in found {
            match joined.last_mut().filter(|last| from <= last[1]) {
                Some(last) => last[1] = last[1].max(to),
                None => joined.push([from, to]),
            }
        }
        joined
    }
}

/// Left, top, right and bottom of a rectangle of the picture.
type ScreenRect = [f64; 4];

fn bounds<const N: usize>(points: [ProjectedPoint; N]) -> ScreenRect {
    points.iter().fold([f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY], |b, [x, y, _]| {
        [b[0].min(*x), b[1].min(*y), b[2].max(*x), b[3].max(*y)]
    })
}

fn overlap(a: ScreenRect, b: ScreenRect) -> bool {
    a[0] <= b[2] && b[0] <= a[2] && a[1] <= b[3] && b[1] <= a[3]
}

/// Returns the part of a line that a triangle hides.
///
/// With `f_k` the doubled area of a point of the line and side k of the triangle, which is linear along the line, the
/// line is inside where no `f_k` is below 0; there the triangle is as near as the mean of its corners with the weights
/// `f_k`, which keeps it between them whatever is rounded.
fn covered(ends: [ProjectedPoint; 2], corners: [ProjectedPoint; 3], slack: f64) -> Option<[f64; 2]> {
    let area = doubled(corners[0], corners[1], corners[2]);
    if area.abs() < 2.0 * LEAST_HIDING_AREA {
        return None;
    }
    let sign = area.signum();
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    let mut areas = [[0.0; 2]; 3];
    for k in 0..3 {
        let (a, b) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
        let [start, end] = ends.map(|point| sign * doubled(point, a, b));
        areas[k] = [start, end];
        if start < 0.0 && end < 0.0 {
            return None;
        }
        if start < 0.0 {
            from = from.max(start / (start - end));
        } else if end < 0.0 {
            to = to.min(start / (start - end));
        }
    }
    if from >= to {
        return None;
    }
    let ahead = |t: f64| {
        let weights = areas.map(|[start, end]| (start + t * (end - start)).max(0.0));
        let sum = weights[0] + weights[1] + weights[2];
        let near = weights[0] * corners[0][2] + weights[1] * corners[1][2] + weights[2] * corners[2][2];
        let line = ends[0][2] + t * (ends[1][2] - ends[0][2]);
        near / sum - line - slack
    };
    let [first, last] = [ahead(from), ahead(to)];
    // where both are as near, the line goes through the triangle
    let through = || from + first / (first - last) * (to - from);
    match (first > 0.0, last > 0.0) {
        (true, true) => Some([from, to]),
        (true, false) => Some([from, through()]),
        (false, true) => Some([through(), to]),
        (false, false) => None,
    }
}

/// Returns twice the area of a triangle in the picture.
fn doubled(a: ProjectedPoint, b: ProjectedPoint, c: ProjectedPoint) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Squares of the picture with the triangles whose bounds reach into them.
#[derive(Debug)]
struct SightGrid {
    origin: [f64; 2],
    /// Cells a pixel, along x and y.
    scale: [f64; 2],
    side: usize,
    /// Where the triangles of each cell start.
    starts: Vec<usize>,
    triangles: Vec<u32>,
}

impl SightGrid {
    /// Creates a grid over the triangles in the picture, as fine as triangles that reach into many cells allow.
    fn new(ends: [(f64, f64); 2], boxes: &[ScreenRect]) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the root of a count")]
        let root = sqrt(real(boxes.len())) as usize;
        let mut grid = Self {
            origin: [ends[0].0, ends[1].0],
            scale: [0.0; 2],
            side: (2 * root).clamp(1, 2 * MAX_SIGHT_CELLS),
            starts: Vec::new(),
            triangles: Vec::new(),
        };
        loop {
            grid.side = (grid.side / 2).max(1);
            #[expect(clippy::cast_precision_loss, reason = "some hundred cells")]
            let side = grid.side as f64;
            grid.scale = ends.map(|(low, high)| if high > low { side / (high - low) } else { 0.0 });
            let entries: usize = boxes.iter().map(|bounds| grid.n_cells(*bounds)).sum();
            if grid.side == 1 || entries <= 8 * boxes.len() {
                break;
            }
        }
        grid.fill(boxes);
        grid
    }

    fn fill(&mut self, boxes: &[ScreenRect]) {
        let mut counts = vec![0; self.side * self.side + 1];
        for bounds in boxes {
            self.cells(*bounds).for_each(|cell| counts[cell + 1] += 1);
        }
        for cell in 1..counts.len() {
            counts[cell] += counts[cell - 1];
        }
        self.triangles = vec![0; counts[self.side * self.side]];
        let mut next = counts.clone();
        for (number, bounds) in (0..).zip(boxes) {
            for cell in self.cells(*bounds) {
                self.triangles[next[cell]] = number;
                next[cell] += 1;
            }
        }
        self.starts = counts;
    }

    fn triangles(&self, cell: usize) -> &[u32] {
        &self.triangles[self.starts[cell]..self.starts[cell + 1]]
    }

    /// Rows and columns of the cells that something reaches into.
    fn reach(&self, [left, top, right, bottom]: ScreenRect) -> [RangeInclusive<usize>; 2] {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "numbers of cells, clamped")]
        let cell = |k: usize, at: f64| (((at - self.origin[k]) * self.scale[k]).max(0.0) as usize).min(self.side - 1);
        [cell(1, top)..=cell(1, bottom), cell(0, left)..=cell(0, right)]
    }

    fn n_cells(&self, bounds: ScreenRect) -> usize {
        let [rows, columns] = self.reach(bounds);
        (rows.end() - rows.start() + 1) * (columns.end() - columns.start() + 1)
    }

    fn cells(&self, bounds: ScreenRect) -> impl Iterator<Item = usize> + use<> {
        let ([rows, columns], side) = (self.reach(bounds), self.side);
        rows.flat_map(move |row| columns.clone().map(move |column| row * side + column))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACING_TRIANGLE: [ProjectedPoint; 3] = [[0.0, 0.0, 1.0], [8.0, 0.0, 1.0], [0.0, 8.0, 1.0]];

    fn hidden(ends: [ProjectedPoint; 2]) -> Vec<[f64; 2]> {
        Sight::new(&FACING_TRIANGLE, &[[0, 1, 2]]).hidden(ends, |_| false)
    }

    #[test]
    fn what_is_behind_a_triangle_is_hidden_from_side_to_side() {
        assert_eq!(hidden([[-2.0, 2.0, 0.0], [14.0, 2.0, 0.0]]), [[0.125, 0.5]]);
        assert_eq!(hidden([[1.0, 1.0, 0.0], [2.0, 2.0, 0.0]]), [[0.0, 1.0]]);
        assert_eq!(hidden([[-2.0, 2.0, 2.0], [14.0, 2.0, 2.0]]), [[0.0; 2]; 0]);
        assert_eq!(hidden([[9.0, 9.0, 0.0], [10.0, 9.0, 0.0]]), [[0.0; 2]; 0]);
    }

    #[test]
    #[expect(clippy::float_cmp, reason = "where a line ends is not computed")]
    fn a_line_through_a_triangle_is_hidden_from_where_it_enters() {
        let [[from, to]] = hidden([[1.0, 1.0, 2.0], [3.0, 1.0, 0.0]])[..] else { panic!("one part is hidden") };
        assert!((from - 0.5).abs() < 1e-12 && to == 1.0, "{from} {to}");
    }

    #[test]
    fn triangles_and_lines_in_one_plane_hide_nothing_of_each_other() {
        let tilted = FACING_TRIANGLE.map(|[x, y, _]| [x, y, 0.3 * x - 0.7 * y]);
        let line = [[1.0, 1.0], [3.0, 2.0]].map(|[x, y]: [f64; 2]| [x, y, 0.3 * x - 0.7 * y]);
        assert!(Sight::new(&tilted, &[[0, 1, 2]]).hidden(line, |_| false).is_empty());
    }
}
