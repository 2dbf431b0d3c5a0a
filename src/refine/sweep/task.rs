//! Divides the patches into tasks for threads, and the result into the parts that they write.

use std::ops::Range;

use super::block::{Block, BlockReceiver, BlockStack};
use super::grid::{GridSize, Planes};
use super::lattice::CornerFrame;
use super::numbering::RowStarts;
use super::program::Sweep;
use super::upcoming::fetch;
use super::weave::GridRow;
use crate::shape::tile::Tile;
use crate::shape::topology::index;

/// Minimum number of faces that one task refines, approximately: half as many refine more stars twice; twice as many
/// let threads wait longer.
const LEAST_FACES_OF_TASK: usize = 1 << 14;

/// Maximum number of faces that one task refines, approximately. With half as many, level 5 of mixed meshes takes a
/// fiftieth longer, with an eighth a twelfth; twice as many concern results of more than eight million faces only, on
/// two threads.
const MOST_FACES_OF_TASK: usize = 1 << 17;

/// Number of tasks per thread from which on they become larger instead of more. With half as many, threads wait twice
/// as long for the last one; with twice as many, more stars are refined twice.
const TASKS_PER_THREAD: usize = 32;

/// A point, the point that follows it in a face on one side, and the value of the first one there.
pub(crate) type SideValue<const W: usize> = ([u32; 2], [f64; W]);

/// Consecutive patches and the parts of the result that hold their points.
pub(super) struct PatchRun<'a, const W: usize> {
    pub(super) patches: Range<usize>,
    /// The documented indices of the first point of `edges` and of `inner`.
    starts: [usize; 2],
    pub(super) edges: &'a mut [[f64; W]],
    pub(super) inner: &'a mut [[f64; W]],
    /// Vertices of the base and their points.
    pub(super) vertices: Vec<(u32, [f64; W])>,
    /// Values by side at points with several sectors.
    pub(super) sides: Vec<SideValue<W>>,
    /// Whether a value that is kept is zero.
    pub(super) has_zero: bool,
}

impl<const W: usize> PatchRun<'_, W> {
    /// Returns the slots of `n` points inside base faces, from a documented index on.
    pub(super) fn inside(&mut self, first: u32, n: usize) -> &mut [[f64; W]] {
        let first = first as usize - self.starts[1];
        &mut self.inner[first..first + n]
    }

    /// Asks for the memory of up to `n` points inside base faces, from a documented index on.
    pub(super) fn expect_inside(&self, first: usize, n: usize) {
        let inner = self.inner.get(first - self.starts[1]..).unwrap_or_default();
        fetch(inner[..n.min(inner.len())].as_flattened());
    }

    /// Returns the slots of `n` consecutive points that are not base vertices, if they belong to this task.
    pub(super) fn places(&mut self, first: usize, n: usize) -> Option<&mut [[f64; W]]> {
        if let Some(at) = first.checked_sub(self.starts[1]) {
            return self.inner.get_mut(at..at + n);
        }
        let at = first.checked_sub(self.starts[0])?;
        self.edges.get_mut(at..at + n)
    }
}

impl Sweep {
    /// Divides the patches into tasks of consecutive base faces, each with the points of the edges that appear there
    /// first and with the points inside the faces.
    pub(super) fn tasks<'a, const W: usize>(&self, points: &'a mut [[f64; W]]) -> Vec<PatchRun<'a, W>> {
        let (base, order) = (&self.surface.base, &self.orders[1]);
        let on_edge = order.pieces() - 1;
        let (mut edges, mut inner) = points.split_at_mut(base.n_edges() * on_edge);
        let mut at = [base.n_vertices(), base.n_vertices() + edges.len()];
        let faces_of_each = order.pieces() * order.pieces();
        let faces = base.n_faces() * faces_of_each / (TASKS_PER_THREAD * rayon::current_num_threads());
        let most = (faces.clamp(LEAST_FACES_OF_TASK, MOST_FACES_OF_TASK) / faces_of_each).max(1);
        let (mut tasks, mut e) = (Vec::new(), 0);
        for first in (0..base.n_faces()).step_by(most) {
            let last = (first + most).min(base.n_faces());
            let from = e;
            while e < base.n_edges() && base.face_of(base.halves(e)[0]) < last {
                e += 1;
            }
            let (mine, others) = std::mem::take(&mut edges).split_at_mut((e - from) * on_edge);
            let inside = (first..last).map(|f| order.inner_of(f)).sum();
            let (within, beyond) = std::mem::take(&mut inner).split_at_mut(inside);
            (edges, inner) = (others, beyond);
            let starts = at;
            at = [at[0] + mine.len(), at[1] + within.len()];
            let patches = self.surface.patches_of(first..last);
            tasks.push(PatchRun {
                patches,
                starts,
                edges: mine,
                inner: within,
                vertices: Vec::new(),
                sides: Vec::new(),
                has_zero: false,
            });
        }
        tasks
    }

    /// Divides the patches into the same tasks for several results: for each task the parts of all results.
    pub(super) fn tasks_of_each<'a, const W: usize>(
        &self,
        results: Vec<&'a mut [[f64; W]]>,
    ) -> Vec<Vec<PatchRun<'a, W>>> {
        let mut all = Vec::new();
        for points in results {
            let tasks = self.tasks(points);
            all.resize_with(tasks.len(), Vec::new);
            all.iter_mut().zip(tasks).for_each(|(parts, task)| parts.push(task));
        }
        all
    }
}

impl<const W: usize> BlockReceiver<W> for PatchRun<'_, W> {
    fn wants(&self, _block: Block, _cells: usize) -> bool {
        true
    }

    fn expect<'a>(&'a self, sweep: &Sweep, size: GridSize, block: Block, spans: &mut Vec<&'a [f64]>) {
        let mut span = 0..0;
        let block = block.refined();
        let (start, rows) = rows_inside(sweep.surface.tile, size, block);
        let starts = sweep.orders[1].rows(block.patch, start, rows.len());
        for ((_, columns), first) in rows.zip(starts) {
            let first = first as usize - self.starts[1];
            if first != span.end {
                spans.push(self.inner[span].as_flattened());
                span = first..first;
            }
            span.end += columns.len();
        }
        spans.push(self.inner[span].as_flattened());
    }

    fn take(&mut self, sweep: &Sweep, size: GridSize, stack: BlockStack, planes: &Planes) {
        let first = stack.first.refined();
        let (start, rows) = rows_inside(sweep.surface.tile, size, first);
        let starts = |(_, block): (usize, Block)| sweep.orders[1].rows(block.patch, start, rows.len());
        let mut starts: Vec<RowStarts> = stack.blocks().map(starts).collect();
        // row by row, as all grids of a stack share the lines of memory of a row
        for (row, columns) in rows {
            let points = GridRow::new(planes, size, row - first.at[1]);
            for (place, start) in starts.iter_mut().filter_map(Iterator::next).enumerate() {
                points.copy(place, columns.start - first.at[0], self.inside(start, columns.len()));
            }
        }
        stack.blocks().for_each(|(place, block)| self.take_sides(sweep, size.stacked(place), block.refined(), planes));
    }
}

impl<const W: usize> PatchRun<'_, W> {
    /// Receives the points on the sides of a refined block.
    fn take_sides(&mut self, sweep: &Sweep, size: GridSize, block: Block, planes: &Planes) {
        let (order, surface) = (&sweep.orders[1], &sweep.surface);
        let tile = surface.tile;
        let (n, cells) = (block.pieces, 2 * size.cells);
        for (side, half_edge) in surface.patches.half_edges(block.patch).enumerate() {
            let Some(range) = block.on_side(tile, side, cells) else { continue };
            let frame = CornerFrame::new(tile, n, side, 0);
            let place = |steps: usize| frame.place([steps.cast_signed(), 0]);
            let vertex = |steps: usize| order.vertex(block.patch, place(steps)) as usize;
            let first = *range.start();
            let line = planes.line(size, block.inside(place(first)), frame.along());
            let point = |steps: usize| line(steps - first);
            let within = (*range.start()).max(1)..(*range.end() + 1).min(n);
            // the patch in which an edge appears first writes its points
            if !within.is_empty() && surface.patches.halves(surface.patches.edge(half_edge) as usize)[0] == half_edge {
                let ends = [within.start, within.end - 1].map(vertex);
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
                let corner = surface.patches.vertex(half_edge) as usize;
                if corner >= surface.base.n_vertices() {
                    self.places(vertex(0), 1).into_iter().flatten().for_each(|place| *place = point(0));
                } else if surface.patches.ring_start(corner) == half_edge {
                    self.vertices.push((index(corner), point(0)));
                }
            }
        }
    }
}

/// Returns the first place of a refined block inside the patch, and the rows with such places, each with the columns of
/// these; `size` is that of the block's grid before the last round.
fn rows_inside(
    tile: Tile,
    size: GridSize,
    block: Block,
) -> ([usize; 2], impl ExactSizeIterator<Item = (usize, Range<usize>)>) {
    let (n, start) = (block.pieces, block.at.map(|at| at.max(1)));
    let end = block.at.map(|at| at + 2 * size.cells + 1);
    let last = move |row: usize| if tile == Tile::Quad { n } else { n - row };
    let rows = start[1]..end[1].min(last(start[0]));
    (start, rows.map(move |row| (row, start[0]..end[0].min(last(row)))))
}
