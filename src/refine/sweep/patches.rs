//! Refines points by a sweep: each patch through all rounds, straight into the documented order.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::aligned::AlignedBuffer;
use super::block::{Block, BlockReceiver, BlockStack};
use super::grid::{GridLine, GridSize, Planes};
use super::lattice::{CornerFrame, axis, corner};
use super::overlay::SpecialSides;
use super::program::{Flat, Sweep};
use super::star::StarWork;
use super::upcoming::Upcoming;
use super::weave::weave;
use crate::kept::Numbers;
use crate::shape::tile::Tile;
use crate::shape::topology::{NONE, index};
use crate::watch::{Stopped, Watch};

/// Number of faces after which a thread reports to the watch, which all threads share. Half of it makes them wait for
/// each other twice as often; with twice of it, a job goes on for twice as long after it was cancelled.
const FACES_PER_REPORT: u64 = 4_096;

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
        let (vertices, rest) = all.as_chunks_mut::<W>().0.split_at_mut(base.n_vertices());
        let tasks = self.tasks(rest);
        let most = tasks.iter().map(|task| task.patches.len()).max().unwrap_or(1);
        let run = SweepRun { sweep: self, flat: &self.flat(W, most), start, watch };
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
    /// For each round but the last the refined grids, as the stacks of the next round.
    woven: Vec<Vec<AlignedBuffer>>,
    /// For each vertex of the patches the index of the first point of its star; [`NONE`] if the star is not refined
    /// yet.
    star_of: Vec<u32>,
    /// The vertices whose stars are refined.
    starred: Vec<u32>,
    /// Points of stars, round after round.
    stars: Vec<[f64; W]>,
    work: StarWork<W>,
    lines: Vec<GridLine>,
    /// The sides of the patches that are being refined, unless these are plain.
    sides: SpecialSides,
    /// Whether the patches that are being refined have neither stars nor lines.
    is_plain: bool,
    /// Number of faces that the watch does not know of yet.
    unreported: u64,
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
    /// In their first rounds patches are so small that each loop ends before it has begun, and that most points of
    /// their rows lie in halos: many are refined as a stack until their grids are large enough.
    pub(super) fn patches(
        &self,
        patches: Range<usize>,
        worker: &mut Worker<W>,
        target: &mut impl BlockReceiver<W>,
    ) -> Result<(), Stopped> {
        let surface = &self.sweep.surface;
        let mut rest = patches;
        while !rest.is_empty() {
            let first = rest.start;
            let turned = surface.is_turned(first);
            let most = self.flat.grids(0);
            let alike = rest.clone().take(most).take_while(|&patch| surface.is_turned(patch) == turned).count();
            // empty places of a stack cost as much as others, and a single grid costs a fifth more than a place
            let (n, grids) = if 4 * alike >= 3 * most { (alike, most) } else { (1, 1) };
            self.stack(first..first + n, grids, worker, target)?;
            rest.start += n;
        }
        Ok(())
    }

    /// Refines patches, all turned alike, as a stack of so many grids.
    fn stack(
        &self,
        patches: Range<usize>,
        grids: usize,
        worker: &mut Worker<W>,
        target: &mut impl BlockReceiver<W>,
    ) -> Result<(), Stopped> {
        let sweep = self.sweep;
        let size = sweep.size(0, W, grids);
        let len = size.len();
        worker.is_plain = patches.clone().all(|patch| sweep.surface.is_plain(patch));
        worker.planes.now[0].first(len).fill(0.0);
        for (place, patch) in patches.clone().enumerate() {
            let corners =
                sweep.surface.patches.half_edges(patch).map(|half| sweep.surface.patches.vertex(half) as usize);
            corners.for_each(|v| self.star(v, worker));
            let (coarse, size) = (&mut worker.planes.now[0][..], size.stacked(place));
            sweep.surface.gather(&sweep.orders[0], patch, [size.cells, sweep.halo], |place, v| {
                let at = size.at(place);
                coarse[at..at + W].copy_from_slice(&self.start[v as usize]);
            });
        }
        if !worker.is_plain {
            worker.sides.find(&sweep.surface, patches.clone(), sweep.halo, &worker.star_of);
        }
        let block = Block { patch: patches.start, at: [0, 0], pieces: size.cells };
        self.descend(0, BlockStack { first: block, patches: patches.len(), grids }, worker, target)
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

    /// Refines a stack, whose coarse grids are in the first plane, through the rounds from `round` on.
    fn descend(
        &self,
        round: usize,
        stack: BlockStack,
        worker: &mut Worker<W>,
        target: &mut impl BlockReceiver<W>,
    ) -> Result<(), Stopped> {
        let sweep = self.sweep;
        let size = sweep.size(round, W, stack.grids);
        worker.lines.clear();
        if !worker.is_plain {
            stack.blocks().for_each(|(place, block)| self.lines((size.cells, place), block, worker));
        }
        let passes = self.flat.of(sweep.surface.is_turned(stack.first.patch), round, stack.grids > 1);
        let is_last = round + 1 == sweep.rounds.len();
        let mut upcoming = if is_last { self.upcoming(size, stack, target) } else { Upcoming::default() };
        worker.planes.refine(passes, size, &worker.lines, &mut upcoming);
        if !worker.is_plain {
            for (place, block) in stack.blocks() {
                self.overlay_corners(round, size.stacked(place), block, worker);
            }
        }
        if is_last {
            worker.unreported += 4 * (stack.patches * size.cells * size.cells) as u64;
            if worker.unreported >= FACES_PER_REPORT {
                self.report(worker)?;
            }
            target.take(sweep, size, stack, &worker.planes);
            return Ok(());
        }
        if worker.woven.len() <= round {
            worker.woven.resize_with(round + 1, Vec::new);
        }
        let mut woven = std::mem::take(&mut worker.woven[round]);
        let grids = stack.grids.min(self.flat.grids(round + 1));
        let fine = GridSize { cells: 2 * size.cells, grids, ..size };
        weave::<W>(&worker.planes, size, fine, &mut woven);
        let stack = BlockStack { first: stack.first.refined(), ..stack };
        for ((place, first), woven) in stack.blocks().step_by(grids).zip(&mut woven) {
            let part = BlockStack { first, patches: grids.min(stack.patches - place), grids };
            self.divide(round, (woven, fine), part, worker, target)?;
        }
        worker.woven[round] = woven;
        Ok(())
    }

    /// Returns the memory where the points of blocks will be written, if the processor can be asked for it.
    fn upcoming<'t>(&self, size: GridSize, stack: BlockStack, target: &'t impl BlockReceiver<W>) -> Upcoming<'t> {
        let mut spans = Vec::new();
        if Upcoming::IS_FETCHED {
            stack.blocks().for_each(|(place, block)| target.expect(self.sweep, size.stacked(place), block, &mut spans));
        }
        Upcoming::new(spans)
    }

    /// Refines a stack further, whose grids were refined in `round`: whole, or part by part if they have become too
    /// large. What the grids held is lost.
    fn divide(
        &self,
        round: usize,
        (woven, fine): (&mut AlignedBuffer, GridSize),
        stack: BlockStack,
        worker: &mut Worker<W>,
        target: &mut impl BlockReceiver<W>,
    ) -> Result<(), Stopped> {
        let (next, refined) = (self.sweep.size(round + 1, W, stack.grids), stack.first);
        if fine.cells == next.cells {
            if stack.blocks().any(|(_, block)| target.wants(block, next.cells)) {
                std::mem::swap(woven, &mut worker.planes.now[0]);
                self.descend(round + 1, stack, worker, target)?;
            }
            return Ok(());
        }
        for corner in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let offset = corner.map(|x| x * next.cells);
            let at: [usize; 2] = std::array::from_fn(|axis| refined.at[axis] + offset[axis]);
            let is_beyond = self.sweep.tile() == Tile::Triangle && at[0] + at[1] >= refined.pieces;
            let part = BlockStack { first: Block { at, ..refined }, ..stack };
            if is_beyond || !part.blocks().any(|(_, block)| target.wants(block, next.cells)) {
                continue;
            }
            let rows = worker.planes.now[0].first(next.len()).chunks_exact_mut(next.stride() * next.step());
            for (j, row) in rows.enumerate() {
                let from = ((offset[1] + j) * fine.stride() + offset[0]) * fine.step();
                row.copy_from_slice(&woven[from..from + row.len()]);
            }
            self.descend(round + 1, part, worker, target)?;
        }
        Ok(())
    }

    /// Collects the lines that cross the grid of a block, which has a place in a stack.
    fn lines(&self, (cells, grid): (usize, usize), block: Block, worker: &mut Worker<W>) {
        let tile = self.sweep.surface.tile;
        for (side, special) in worker.sides.of(block.patch).iter().enumerate() {
            let Some(line) = special.line else { continue };
            if let Some(range) = block.on_side(tile, side, cells) {
                let steps = [range.start().cast_signed(), 0];
                let from = block.inside(CornerFrame::new(tile, block.pieces, side, 0).place(steps));
                worker.lines.push(GridLine { grid, line, axis: axis(tile, side), from });
            }
        }
    }

    /// Overwrites the points around the corners of the patch that lie in a block; `size` is that of the block's grid
    /// before the round.
    fn overlay_corners(&self, round: usize, size: GridSize, block: Block, worker: &mut Worker<W>) {
        let sweep = self.sweep;
        let Worker { planes, stars, sides, .. } = worker;
        // after the last round nobody reads beyond the sides
        let is_last = round + 1 == sweep.rounds.len();
        for (side, special) in sides.of(block.patch).iter().enumerate() {
            let Some(star) = special.star else { continue };
            let here = block.inside(corner(sweep.surface.tile, block.pieces, side));
            if here.iter().all(|x| (0..=size.cells.cast_signed()).contains(x)) {
                let points = star.points(round, stars);
                sweep.overlay.put(&mut planes.now, (size, here), (side, star), points, is_last);
            }
        }
    }
}
