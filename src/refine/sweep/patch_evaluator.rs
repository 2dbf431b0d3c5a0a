//! Evaluates stencils at the refined points of one patch.

use std::ops::Range;

use super::lattice::{CornerFrame, LATTICE_AXES, axis, last};
use super::program::Sweep;
use super::star::StarShape;
use super::stencils::{Stencil, Stencils};
use super::task::{PatchRun, SideValue};
use crate::math::vector::is_zero;
use crate::shape::topology::NONE;

/// Rows of a patch that are evaluated at a time, so that they stay with their neighbours in the cache of a core. With
/// half as many, a tenth of all rows are gathered twice; with twice as many, patches of 512 pieces and more leave the
/// cache.
pub(super) const ROWS_PER_BAND: usize = 32;

/// Number of rows after which the memory that is asked for is written. With half of it, rows of coarse levels arrive
/// too late; twice of it makes no measurable difference.
const ROWS_AHEAD: usize = 2;

/// How the functionals at a point are combined into its value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ValueRule<const W: usize> {
    /// The value of one sector, from its functionals.
    pub(crate) of: fn(&[[f64; W]]) -> [f64; W],
    /// Replaces the first functional of many points by their values, given the second one if there is one.
    pub(crate) of_all: fn(&mut [[f64; W]], &[[f64; W]]),
    /// The value of a point with several sectors, from the values of the sectors.
    pub(crate) join: fn(&[[f64; W]]) -> [f64; W],
    /// The value of a vertex without faces, from its position.
    pub(crate) alone: fn([f64; W]) -> [f64; W],
}

/// Evaluates one value of the points of patches.
pub(super) struct PatchEvaluator<'a, const W: usize> {
    pub(super) sweep: &'a Sweep,
    pub(super) stencils: &'a Stencils,
    pub(super) rule: ValueRule<W>,
    /// Number of pieces of a patch's side.
    pub(super) n: usize,
}

impl<'a, const W: usize> PatchEvaluator<'a, W> {
    pub(super) fn new(sweep: &'a Sweep, stencils: &'a Stencils, rule: ValueRule<W>) -> Self {
        Self { sweep, stencils, rule, n: sweep.patch_pieces() }
    }

    /// Returns the number of functionals at a point.
    pub(super) fn n_functionals(&self) -> usize {
        self.stencils.regular.sectors[0].len()
    }

    /// Returns the number of points of a band's buffer: so many rows, with the points within reach around them.
    pub(super) fn band_points(&self, rows: usize) -> usize {
        (rows + 2 * self.stencils.reach) * self.stride()
    }

    /// Returns the number of points in a row of a band's buffer.
    pub(super) fn stride(&self) -> usize {
        self.n + 1 + 2 * self.stencils.reach
    }

    /// Returns the index of a patch's place `[i, j]` in the buffers of a band whose first row is `first`.
    pub(super) fn at(&self, first: usize, [i, j]: [isize; 2]) -> usize {
        let reach = self.stencils.reach.cast_signed();
        (j - first.cast_signed() + reach).unsigned_abs() * self.stride() + (i + reach).unsigned_abs()
    }

    /// Returns the steps along a side, from the first to the last, for which the place lies in `rows`; `start` is the
    /// row of step 0.
    pub(super) fn steps(&self, along: [isize; 2], start: isize, rows: &Range<isize>) -> Range<isize> {
        let n = self.n.cast_signed();
        match along[1] {
            1 => (rows.start - start).max(0)..(rows.end - start).min(n + 1),
            -1 => (start - rows.end + 1).max(0)..(start - rows.start + 1).min(n + 1),
            _ => 0..if rows.contains(&start) { n + 1 } else { 0 },
        }
    }

    /// Gathers entries for the points in `rows` and within reach around them; `fill` fills a slice with those of
    /// consecutive points from its first argument on.
    pub(super) fn gather<T>(&self, patch: usize, rows: &Range<usize>, fill: impl Fn(u32, &mut [T]), buffer: &mut [T]) {
        let (order, surface, n) = (&self.sweep.orders[1], &self.sweep.surface, self.n);
        let (tile, reach) = (surface.tile, self.stencils.reach);
        for j in rows.start.saturating_sub(reach).max(1)..(rows.end + reach).min(n) {
            let len = last(tile, n, j).saturating_sub(1);
            if len > 0 {
                let place = [1, j.cast_signed()];
                let (first, at) = (order.vertex(patch, place), self.at(rows.start, place));
                fill(first, &mut buffer[at..at + len]);
            }
        }
        let reach = reach.cast_signed();
        let wanted = rows.start.cast_signed() - reach..rows.end.cast_signed() + reach;
        let mut put = |place: [isize; 2], v: u32| {
            if wanted.contains(&place[1]) {
                fill(v, std::slice::from_mut(&mut buffer[self.at(rows.start, place)]));
            }
        };
        for (side, half_edge) in surface.patches.half_edges(patch).enumerate() {
            let frame = CornerFrame::new(tile, n, side, 0);
            for steps in self.steps(frame.along(), frame.corner()[1], &wanted) {
                let place = frame.place([steps, 0]);
                put(place, order.vertex(patch, place));
            }
            let twin = surface.patches.twin(half_edge);
            if twin != NONE {
                let (neighbour, its) = surface.side(twin);
                let there = CornerFrame::new(tile, n, its, 0);
                for depth in 1..=reach {
                    let shorter = n - last(tile, n, depth.unsigned_abs());
                    for steps in self.steps(frame.along(), frame.place([0, -depth])[1], &wanted) {
                        if steps.unsigned_abs() >= shorter {
                            let across = there.place([n.cast_signed() - steps, depth]);
                            put(frame.place([steps, -depth]), order.vertex(neighbour, across));
                        }
                    }
                }
            }
            if surface.kind_of(surface.patches.vertex(half_edge) as usize).is_none() {
                surface.gather_across(order, half_edge, [n, self.stencils.reach], &mut put);
            }
        }
    }

    /// Returns the value of one sector; `point` gives the points.
    fn value<P: Copy>(&self, sector: &[Vec<(P, f64)>], point: impl Fn(P) -> [f64; W]) -> [f64; W] {
        let sum = |weights: &Vec<(P, f64)>| {
            let add = |sum: [f64; W], &(p, weight): &(P, f64)| {
                let p = point(p);
                std::array::from_fn(|c| sum[c] + weight * p[c])
            };
            weights.iter().fold([-0.0; W], add)
        };
        (self.rule.of)(&sector.iter().map(sum).collect::<Vec<_>>())
    }

    /// Returns the value of a point, and the values of its sectors if it has several.
    fn values<P: Copy>(&self, stencil: &Stencil<P>, point: impl Fn(P) -> [f64; W]) -> ([f64; W], Vec<[f64; W]>) {
        if let [sector] = stencil.sectors.as_slice() {
            return (self.value(sector, point), Vec::new());
        }
        let all: Vec<[f64; W]> = stencil.sectors.iter().map(|sector| self.value(sector, &point)).collect();
        ((self.rule.join)(&all), all)
    }

    /// Evaluates the points on lines; the patch in which an edge appears first also records their values by side.
    pub(super) fn lines(
        &self,
        patch: usize,
        rows: &Range<usize>,
        grid: &[[f64; W]],
        (values, sides): (&mut [[f64; W]], &mut Vec<SideValue<W>>),
    ) {
        let (order, surface, n) = (&self.sweep.orders[1], &self.sweep.surface, self.n);
        let wanted = rows.start.cast_signed()..rows.end.cast_signed();
        for (side, half_edge) in surface.patches.half_edges(patch).enumerate() {
            let Some(line) = surface.line(half_edge) else { continue };
            let Some(along) = &self.stencils.lines[line] else { continue };
            let stencil = &along[axis(surface.tile, side)];
            let frame = CornerFrame::new(surface.tile, n, side, 0);
            // stencils of boundaries have the faces on the left, so they are rotated by a half turn on sides that run
            // backwards
            let turn = if frame.along() == LATTICE_AXES[axis(surface.tile, side)] { 1 } else { -1 };
            let owned = surface.patches.halves(surface.patches.edge(half_edge) as usize)[0] == half_edge;
            for steps in self.steps(frame.along(), frame.corner()[1], &wanted) {
                let place = frame.place([steps, 0]);
                let near = |[i, j]: [isize; 2]| [place[0] + turn * i, place[1] + turn * j];
                let (value, sectors) = self.values(stencil, |offset| grid[self.at(rows.start, near(offset))]);
                values[self.at(rows.start, place)] = value;
                if owned && (1..n.cast_signed()).contains(&steps) && !sectors.is_empty() {
                    let v = order.vertex(patch, place);
                    let beside = |&(offset, sector): &([isize; 2], usize)| {
                        ([v, surface.vertex_near(order, half_edge, n, frame.seen(near(offset)))], sectors[sector])
                    };
                    sides.extend(stencil.sides.iter().map(beside));
                }
            }
        }
    }

    /// Calls `visit` for the points in some rows that are too near to a corner around which the grid is not regular,
    /// with the half-edge that starts at the corner, the place of the point, its stencil, and the points of the star
    /// around the corner.
    pub(super) fn near_stars(
        &self,
        patch: usize,
        rows: &Range<usize>,
        mut visit: impl FnMut(u32, [isize; 2], &Stencil<usize>, &[u32]),
    ) {
        let (surface, n, Stencils { reach, near, .. }) = (&self.sweep.surface, self.n, self.stencils);
        let tile = surface.tile;
        for (side, half_edge) in surface.patches.half_edges(patch).enumerate() {
            let v = surface.patches.vertex(half_edge) as usize;
            let Some(kind) = surface.kind_of(v) else { continue };
            let frame = CornerFrame::new(tile, n, side, 0);
            let shape = &surface.kinds[kind];
            let shape = |reach: usize| StarShape { tile, faces: shape.faces, closed: shape.closed, reach };
            let own = surface.patches.ring(v).position(|ring| ring == half_edge).unwrap_or(0);
            let mut star = Vec::new();
            for place in (0..=*near).flat_map(|a| (0..=last(tile, *near, a)).map(move |b| [a, b])) {
                let here = frame.place(place.map(usize::cast_signed));
                if rows.contains(&here[1].unsigned_abs()) {
                    if star.is_empty() {
                        surface.gather_star(&self.sweep.orders[1], v, shape(near + reach), n, |point| star.push(point));
                    }
                    visit(half_edge, here, &self.stencils.stars[kind][shape(*near).point(own, place)], &star);
                }
            }
        }
    }

    /// Evaluates the points near corners around which the grid is not regular; returns their places and values.
    pub(super) fn stars(
        &self,
        patch: usize,
        rows: &Range<usize>,
        points: &[[f64; W]],
        sides: &mut Vec<SideValue<W>>,
    ) -> Vec<([isize; 2], [f64; W])> {
        let mut found = Vec::new();
        self.near_stars(patch, rows, |half_edge, place, stencil, star| {
            let (value, sectors) = self.values(stencil, |point| points[star[point] as usize]);
            found.push((place, value));
            let patches = &self.sweep.surface.patches;
            if !sectors.is_empty() && patches.ring_start(patches.vertex(half_edge) as usize) == half_edge {
                let beside = |&(point, sector): &(usize, usize)| ([star[0], star[point]], sectors[sector]);
                sides.extend(stencil.sides.iter().map(beside));
            }
        });
        found
    }

    /// Writes the values of a row inside the patch to their places in the documented order.
    pub(super) fn emit_row(&self, patch: usize, j: usize, row: &[[f64; W]], task: &mut PatchRun<'_, W>) {
        let len = row.len().saturating_sub(2);
        if (1..self.n).contains(&j) && len > 0 {
            let first = self.sweep.orders[1].vertex(patch, [1, j.cast_signed()]);
            task.expect_inside(first as usize + ROWS_AHEAD * len, len);
            task.has_zero |= row[1..=len].iter().any(is_zero);
            task.inside(first, len).copy_from_slice(&row[1..=len]);
        }
    }

    /// Writes the values on the sides of the patch to their places in the documented order.
    pub(super) fn emit_sides(
        &self,
        patch: usize,
        rows: &Range<usize>,
        values: &[[f64; W]],
        task: &mut PatchRun<'_, W>,
    ) {
        let (order, surface, n) = (&self.sweep.orders[1], &self.sweep.surface, self.n);
        let wanted = rows.start.cast_signed()..rows.end.cast_signed();
        for (side, half_edge) in surface.patches.half_edges(patch).enumerate() {
            let frame = CornerFrame::new(surface.tile, n, side, 0);
            let owned = surface.patches.halves(surface.patches.edge(half_edge) as usize)[0] == half_edge;
            let corner = surface.patches.vertex(half_edge) as usize;
            for steps in self.steps(frame.along(), frame.corner()[1], &wanted) {
                let place = frame.place([steps, 0]);
                let value = values[self.at(rows.start, place)];
                let is_inner = (1..n.cast_signed()).contains(&steps);
                if !(is_inner && owned || steps == 0) {
                    continue;
                }
                let v = order.vertex(patch, place);
                let is_kept = if is_inner || v as usize >= surface.base.n_vertices() {
                    task.places(v as usize, 1).map(|place| place.fill(value)).is_some()
                } else if surface.patches.ring_start(corner) == half_edge {
                    task.vertices.push((v, value));
                    true
                } else {
                    false
                };
                task.has_zero |= is_kept && is_zero(&value);
            }
        }
    }
}
