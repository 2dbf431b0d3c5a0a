//! Refines points by a sweep: each patch through all rounds, straight into the documented order.

use std::ops::{Range, RangeInclusive};
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::grid::{GridLine, GridSize, Planes, at_least};
use super::lattice::{CornerFrame, axis, cell, corner, sector};
use super::program::{Flat, Sweep};
use super::star::StarWork;
use super::task::PatchRun;
use super::weave::{GridRow, weave};
use crate::kept::Numbers;
use crate::shape::tile::Tile;
use crate::shape::topology::{NONE, index};
use crate::watch::{Stopped, Watch};

/// Number of faces after which a thread reports to the watch, which all threads share. Half of it makes them wait for
/// each other twice as often; with twice of it, a job goes on for twice as long after it was cancelled.
const FACES_PER_REPORT: u64 = 4_096;

/// Number of patches that are refined as a stack while they are small, at most.
const STACK: usize = 8;

/// Number of values in a plane up to which patches are refined as a stack.
const STACKED: usize = 4_096;

/// Refined points in the documented order.
#[derive(Debug)]
pub(crate) struct Swept {
    /// The coordinates, point after point.
    pub(crate) points: Numbers,
    /// Whether all coordinates are finite.
    pub(crate) finite: bool,
}

impl Sweep {
    /// Refines points of `width` values, 1 to 4. Both the given and the returned points are in the documented order, of
    /// the nets where the sweep begins and where it ends.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    ///
    /// # Panics
    /// If the number of points differs from that of the net where the sweep begins.
    pub(crate) fn refine(&self, start: &[f64], width: usize, watch: &Watch) -> Result<Swept, Stopped> {
        assert_eq!(start.len(), self.orders[0].n_vertices() * width, "the points belong to another net");
        match width {
            1 => self.refine_points::<1>(start, watch),
            2 => self.refine_points::<2>(start, watch),
            3 => self.refine_points::<3>(start, watch),
            _ => self.refine_points::<4>(start, watch),
        }
    }

    fn refine_points<const W: usize>(&self, start: &[f64], watch: &Watch) -> Result<Swept, Stopped> {
        let bounded = self.is_bounded(start);
        let start = start.as_chunks::<W>().0;
        let mut all = Numbers::to_overwrite(self.n_points() * W);
        let finite = AtomicBool::new(true);
        let base = &self.surface.base;
        let run = SweepRun { sweep: self, flat: &self.flat(W), start, watch };
        let (vertices, rest) = all.as_chunks_mut::<W>().0.split_at_mut(base.n_vertices());
        let tasks = self.tasks(rest);
        let made = tasks.into_par_iter().map_init(Worker::<W>::default, |worker, mut task| {
            worker.begin(self);
            run.patches(task.patches.clone(), worker, &mut task)?;
            run.report(worker)?;
            let vertices = || task.vertices.iter().all(|(_, point)| all_finite(point));
            let others = || all_finite(task.edges.as_flattened()) && all_finite(task.inner.as_flattened());
            if !(bounded || vertices() && others()) {
                finite.store(false, Ordering::Relaxed);
            }
            Ok(task.vertices)
        });
        let owned = made.collect::<Result<Vec<_>, Stopped>>()?;
        for (v, point) in owned.into_iter().flatten() {
            vertices[v as usize] = point;
        }
        for v in (0..base.n_vertices()).filter(|&v| base.is_isolated(v)) {
            vertices[v] = start[v];
        }
        Ok(Swept { points: all, finite: finite.into_inner() })
    }
}

/// Returns whether all values are finite: a sum of products with zero is NaN as soon as one value is not.
fn all_finite(numbers: &[f64]) -> bool {
    let (lines, rest) = numbers.as_chunks::<16>();
    let mut sums = [0.0; 16];
    for line in lines {
        sums.iter_mut().zip(line).for_each(|(sum, x)| *sum += 0.0 * x);
    }
    sums.iter().all(|&sum| sum == 0.0) && rest.iter().all(|x| x.is_finite())
}

/// A consumer of the points of blocks.
pub(super) trait Target<const W: usize> {
    /// Returns whether any point of a block with `cells` cells per side is needed.
    fn wants(&self, block: Block, cells: usize) -> bool;

    /// Receives the points of a block; `size` is that of the block's grid before the last round.
    fn take(&mut self, sweep: &Sweep, size: GridSize, block: Block, planes: &Planes);
}

/// The data that all patches of a sweep share.
pub(super) struct SweepRun<'a, const W: usize> {
    pub(super) sweep: &'a Sweep,
    pub(super) flat: &'a Flat,
    pub(super) start: &'a [[f64; W]],
    pub(super) watch: &'a Watch,
}

/// The buffers of one thread.
#[derive(Debug, Default)]
pub(super) struct Worker<const W: usize> {
    planes: Planes,
    /// Refined grids of patches that are refined further block by block; one grid per round.
    woven: Vec<Vec<f64>>,
    /// For each vertex of the patches the index of the first point of its star; [`NONE`] if the star is not refined
    /// yet.
    star_of: Vec<u32>,
    /// The vertices whose stars are refined.
    starred: Vec<u32>,
    /// Points of stars, round after round.
    stars: Vec<[f64; W]>,
    work: StarWork<W>,
    lines: Vec<GridLine>,
    /// Number of faces that the watch does not know of yet.
    unreported: u64,
}

/// A part of a patch in some round: a grid whose first cell is at `at`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    patch: usize,
    pub(super) at: [usize; 2],
    /// Number of pieces of the patch's side.
    pub(super) pieces: usize,
}

impl Block {
    /// Returns the range of vertices on a side of the patch that lie in the block, which has `cells` cells per side.
    fn on_side(self, tile: Tile, side: usize, cells: usize) -> Option<RangeInclusive<usize>> {
        if cells == self.pieces {
            return Some(0..=cells);
        }
        let frame = CornerFrame::new(tile, self.pieces, side, 0);
        let (start, along) = (frame.corner(), frame.along());
        let (mut least, mut most) = (0, self.pieces.cast_signed());
        for axis in 0..2 {
            let low = self.at[axis].cast_signed() - start[axis];
            let high = low + cells.cast_signed();
            match along[axis] {
                1 => (least, most) = (least.max(low), most.min(high)),
                -1 => (least, most) = (least.max(-high), most.min(-low)),
                _ if low > 0 || high < 0 => return None,
                _ => {}
            }
        }
        (least <= most).then(|| least.unsigned_abs()..=most.unsigned_abs())
    }

    /// Converts a place of the patch into one relative to the block.
    fn inside(self, place: [isize; 2]) -> [isize; 2] {
        [0, 1].map(|axis| place[axis] - self.at[axis].cast_signed())
    }

    /// Returns the same part of the patch at a place in a stack of which this is the first.
    fn at_place(self, place: usize) -> Self {
        Self { patch: self.patch + place, ..self }
    }

    /// Returns the block after a split, at the same part of the patch.
    fn refined(self) -> Self {
        Self { at: self.at.map(|at| 2 * at), pieces: 2 * self.pieces, ..self }
    }
}

impl<const W: usize> Worker<W> {
    /// Discards the stars of the previous task.
    pub(super) fn begin(&mut self, sweep: &Sweep) {
        self.star_of.resize(sweep.surface.patches.n_vertices(), NONE);
        for v in self.starred.drain(..) {
            self.star_of[v as usize] = NONE;
        }
        self.stars.clear();
    }
}

impl<const W: usize> SweepRun<'_, W> {
    /// Refines consecutive patches and hands their points to `target`.
    ///
    /// In their first rounds patches are so small that each loop ends before it has begun: several are refined as a
    /// stack until their grids are large enough.
    pub(super) fn patches(
        &self,
        patches: Range<usize>,
        worker: &mut Worker<W>,
        target: &mut impl Target<W>,
    ) -> Result<(), Stopped> {
        let surface = &self.sweep.surface;
        let mut rest = patches;
        while !rest.is_empty() {
            let first = rest.start;
            let turned = surface.is_turned(first);
            let alike = rest.clone().take(STACK).take_while(|&patch| surface.is_turned(patch) == turned).count();
            self.stack(first..first + alike, worker, target)?;
            rest.start += alike;
        }
        Ok(())
    }

    /// Refines a stack of patches, all turned alike.
    fn stack(&self, patches: Range<usize>, worker: &mut Worker<W>, target: &mut impl Target<W>) -> Result<(), Stopped> {
        let sweep = self.sweep;
        let size = sweep.size(0, W);
        let len = patches.len() * size.len();
        at_least(&mut worker.planes.now[0], len);
        worker.planes.now[0][..len].fill(0.0);
        for (place, patch) in patches.clone().enumerate() {
            let corners =
                sweep.surface.patches.half_edges(patch).map(|half| sweep.surface.patches.vertex(half) as usize);
            corners.for_each(|v| self.star(v, worker));
            let (coarse, size) = (&mut worker.planes.now[0], size.stacked(place));
            sweep.surface.gather(&sweep.orders[0], patch, [size.cells, sweep.halo], |place, v| {
                let at = size.at(place);
                coarse[at..at + W].copy_from_slice(&self.start[v as usize]);
            });
        }
        let block = Block { patch: patches.start, at: [0, 0], pieces: size.cells };
        self.descend(0, (block, patches.len()), worker, target)
    }

    /// Counts the faces since the last report as done.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub(super) fn report(&self, worker: &mut Worker<W>) -> Result<(), Stopped> {
        self.watch.advance(std::mem::take(&mut worker.unreported));
        self.watch.check()
    }

    /// Refines the star around a vertex through all rounds, if the vertex has one and it was not refined yet.
    fn star(&self, v: usize, worker: &mut Worker<W>) {
        let sweep = self.sweep;
        let Some(kind) = sweep.surface.kind_of(v) else { return };
        if worker.star_of[v] != NONE {
            return;
        }
        worker.star_of[v] = index(worker.stars.len());
        worker.starred.push(index(v));
        let shape = sweep.shape(kind);
        let mut star = Vec::with_capacity(shape.len());
        let put = |point: u32| star.push(self.start[point as usize]);
        sweep.surface.gather_star(&sweep.orders[0], v, shape, sweep.first_pieces, put);
        for round in &sweep.rounds {
            round.stars[kind].apply(&star, &mut worker.work);
            star.clone_from(&worker.work.now);
            worker.stars.extend_from_slice(&star);
        }
    }

    /// Refines blocks of consecutive patches, whose coarse grids are stacked in the first plane, through the rounds from
    /// `round` on. `block` is the first of them, `grids` their number.
    fn descend(
        &self,
        round: usize,
        (block, grids): (Block, usize),
        worker: &mut Worker<W>,
        target: &mut impl Target<W>,
    ) -> Result<(), Stopped> {
        let sweep = self.sweep;
        let size = sweep.size(round, W);
        worker.lines.clear();
        (0..grids).for_each(|place| self.lines((size.cells, place), block.at_place(place), &mut worker.lines));
        let passes = &self.flat.of(sweep.surface.is_turned(block.patch))[round];
        worker.planes.refine(passes, size, grids, &worker.lines);
        for place in 0..grids {
            self.overlay_corners(round, size.stacked(place), block.at_place(place), worker);
        }
        if round + 1 == sweep.rounds.len() {
            worker.unreported += 4 * (grids * size.cells * size.cells) as u64;
            if worker.unreported >= FACES_PER_REPORT {
                self.report(worker)?;
            }
            for place in 0..grids {
                target.take(sweep, size.stacked(place), block.at_place(place), &worker.planes);
            }
            return Ok(());
        }
        if worker.woven.len() <= round {
            worker.woven.resize_with(round + 1, Vec::new);
        }
        let mut woven = std::mem::take(&mut worker.woven[round]);
        let next = sweep.size(round + 1, W);
        let fine = GridSize { cells: 2 * size.cells, ..size };
        weave::<W>(&worker.planes, size, fine, grids, &mut woven);
        let refined = block.refined();
        if fine.cells == next.cells && (grids == 1 || grids * next.len() <= STACKED) {
            std::mem::swap(&mut woven, &mut worker.planes.now[0]);
            worker.woven[round] = woven;
            return self.descend(round + 1, (refined, grids), worker, target);
        }
        for place in 0..grids {
            let grid = &woven[place * fine.len()..][..fine.len()];
            self.divide(round, (grid, fine), refined.at_place(place), worker, target)?;
        }
        worker.woven[round] = woven;
        Ok(())
    }

    /// Refines a block further, whose grid was refined in `round`: whole, or part by part if it has become too large.
    fn divide(
        &self,
        round: usize,
        (woven, fine): (&[f64], GridSize),
        refined: Block,
        worker: &mut Worker<W>,
        target: &mut impl Target<W>,
    ) -> Result<(), Stopped> {
        let next = self.sweep.size(round + 1, W);
        let parts = if fine.cells == next.cells { 1 } else { 2 };
        for corner in [[0, 0], [1, 0], [0, 1], [1, 1]].into_iter().filter(|corner| corner.iter().all(|&x| x < parts)) {
            let offset = corner.map(|x| x * next.cells);
            let at: [usize; 2] = std::array::from_fn(|axis| refined.at[axis] + offset[axis]);
            let part = Block { at, ..refined };
            let is_beyond = self.sweep.tile() == Tile::Triangle && at[0] + at[1] >= refined.pieces;
            if is_beyond || !target.wants(part, next.cells) {
                continue;
            }
            let coarse = &mut worker.planes.now[0];
            at_least(coarse, next.len());
            let rows = coarse[..next.len()].chunks_exact_mut(next.stride() * W);
            for (j, row) in rows.enumerate() {
                let from = ((offset[1] + j) * fine.stride() + offset[0]) * W;
                row.copy_from_slice(&woven[from..from + row.len()]);
            }
            self.descend(round + 1, (part, 1), worker, target)?;
        }
        Ok(())
    }

    /// Collects the lines that cross the grid of a block, which has a place in a stack.
    fn lines(&self, (cells, grid): (usize, usize), block: Block, lines: &mut Vec<GridLine>) {
        let surface = &self.sweep.surface;
        for (side, half_edge) in surface.patches.half_edges(block.patch).enumerate() {
            let Some(line) = surface.line(half_edge) else { continue };
            if let Some(range) = block.on_side(surface.tile, side, cells) {
                let steps = [range.start().cast_signed(), 0];
                let from = block.inside(CornerFrame::new(surface.tile, block.pieces, side, 0).place(steps));
                lines.push(GridLine { grid, line, axis: axis(surface.tile, side), from });
            }
        }
    }

    /// Overwrites the points around the corners of the patch that lie in a block; `size` is that of the block's grid
    /// before the round.
    fn overlay_corners(&self, round: usize, size: GridSize, block: Block, worker: &mut Worker<W>) {
        let surface = &self.sweep.surface;
        for (side, half_edge) in surface.patches.half_edges(block.patch).enumerate() {
            let v = surface.patches.vertex(half_edge) as usize;
            if worker.star_of[v] == NONE {
                continue;
            }
            let here = block.inside(corner(surface.tile, block.pieces, side));
            if here.iter().all(|x| (0..=size.cells.cast_signed()).contains(x)) {
                self.overlay((round, size), block.refined(), half_edge, worker);
            }
        }
    }

    /// Overwrites the points around a corner of the patch, which the loops computed as if the grid were regular, by the
    /// points of its star; `block` is the block after the round.
    fn overlay(&self, (round, size): (usize, GridSize), block: Block, half_edge: u32, worker: &mut Worker<W>) {
        let sweep = self.sweep;
        let surface = &sweep.surface;
        let v = surface.patches.vertex(half_edge) as usize;
        let Some(kind) = surface.kind_of(v) else { return };
        let shape = sweep.shape(kind);
        let Worker { planes, star_of, stars, .. } = worker;
        let star = &stars[star_of[v] as usize + round * shape.len()..][..shape.len()];
        let (_, side) = surface.side(half_edge);
        let mut put = |frame: &CornerFrame, place: [usize; 2], point: usize| {
            let (plane, place) = cell(block.inside(frame.place(place.map(usize::cast_signed))));
            let at = size.at(place);
            planes.now[plane][at..at + W].copy_from_slice(&star[point]);
        };
        let own = surface.patches.ring(v).position(|ring| ring == half_edge).unwrap_or(0);
        let sectors = [(0, Some(own)), (-1, shape.neighbour(own, false)), (1, shape.neighbour(own, true))];
        for (turn, face) in sectors.into_iter().filter_map(|(turn, face)| Some((turn, face?))) {
            let frame = CornerFrame::new(surface.tile, block.pieces, side, turn);
            put(&frame, [0, 0], 0);
            sector(surface.tile, shape.reach).for_each(|place| put(&frame, place, shape.point(face, place)));
            // the points on the edge towards the next face
            (1..=shape.reach).for_each(|b| put(&frame, [0, b], shape.point(face, [0, b])));
        }
    }
}

impl<const W: usize> Target<W> for PatchRun<'_, W> {
    fn wants(&self, _block: Block, _cells: usize) -> bool {
        true
    }

    fn take(&mut self, sweep: &Sweep, size: GridSize, block: Block, planes: &Planes) {
        let (order, surface) = (&sweep.orders[1], &sweep.surface);
        let tile = surface.tile;
        let (cells, block) = (2 * size.cells, block.refined());
        let (n, at) = (block.pieces, block.at);
        let start = at.map(|at| at.max(1));
        let rows = start[1]..(at[1] + cells + 1).min(n);
        for (row, first) in rows.clone().zip(order.rows(block.patch, start, rows.len())) {
            let end = if tile == Tile::Quad { n } else { n - row };
            let columns = start[0]..(at[0] + cells + 1).min(end);
            if !columns.is_empty() {
                let row = GridRow::new(planes, size, row - at[1]);
                row.copy(columns.start - at[0], self.inside(first, columns.len()));
            }
        }
        for (side, half_edge) in surface.patches.half_edges(block.patch).enumerate() {
            let Some(range) = block.on_side(tile, side, cells) else { continue };
            let frame = CornerFrame::new(tile, n, side, 0);
            let place = |steps: usize| frame.place([steps.cast_signed(), 0]);
            let vertex = |steps: usize| order.vertex(block.patch, place(steps));
            let point = |steps: usize| planes.point(size, block.inside(place(steps)));
            let within = (*range.start()).max(1)..(*range.end() + 1).min(n);
            // the patch in which an edge appears first writes its points
            if !within.is_empty() && surface.patches.halves(surface.patches.edge(half_edge) as usize)[0] == half_edge {
                let ends = [within.start, within.end - 1].map(|steps| vertex(steps) as usize);
                // on a column inside a base face, consecutive points are as far apart as a row of the face is long
                let stride = (ends[0].abs_diff(ends[1]) / (within.len() - 1).max(1)).max(1);
                let places = self.places(ends[0].min(ends[1]), stride * (within.len() - 1) + 1);
                let places = places.into_iter().flatten().step_by(stride);
                if ends[0] <= ends[1] {
                    places.zip(within).for_each(|(place, steps)| *place = point(steps));
                } else {
                    places.zip(within.rev()).for_each(|(place, steps)| *place = point(steps));
                }
            }
            if *range.start() == 0 {
                let (v, corner) = (vertex(0), surface.patches.vertex(half_edge) as usize);
                if (v as usize) >= surface.base.n_vertices() {
                    self.places(v as usize, 1).into_iter().flatten().for_each(|place| *place = point(0));
                } else if surface.patches.ring(corner).next() == Some(half_edge) {
                    self.vertices.push((v, point(0)));
                }
            }
        }
    }
}
