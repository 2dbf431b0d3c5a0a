//! Points refined by a sweep: every patch through all rounds, straight into the documented order.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::descent::{Block, Run, Target, Worker};
use super::grid::{Planes, Size};
use super::lattice::Frame;
use super::program::Sweep;
use super::weave::Row;
use crate::kept::Numbers;
use crate::shape::tile::Tile;
use crate::watch::{Stopped, Watch};

/// Faces that one task makes, about: small enough that two threads end together, large enough that what neighbouring
/// patches share of stars is made once. Half of it makes more stars twice, twice of it lets a thread wait longer.
const TASK: usize = 1 << 14;

/// Points in the documented order.
#[derive(Debug)]
pub(crate) struct Swept {
    /// Their numbers, point after point.
    pub(crate) points: Numbers,
    /// Whether all are finite.
    pub(crate) finite: bool,
}

impl Sweep {
    /// Refines points of `width` numbers, 1 to 4, from the documented order where the sweep begins to that where it
    /// ends.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    ///
    /// # Panics
    /// When the points are not as many as those of the net where the sweep begins.
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
        let run = Run { sweep: self, flat: &self.flat(W), start, watch };
        let (vertices, rest) = all.as_chunks_mut::<W>().0.split_at_mut(base.n_vertices());
        let tasks = self.tasks(rest);
        let made = tasks.into_par_iter().map_init(Worker::<W>::default, |worker, mut task| {
            worker.begin(self);
            for patch in task.patches.clone() {
                run.patch(patch, worker, &mut task)?;
            }
            let vertices = || task.vertices.iter().all(|(_, point)| all_finite(point));
            let others = || all_finite(task.edges.as_flattened()) && all_finite(task.inner.as_flattened());
            if !bounded && !(vertices() && others()) {
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

    /// The patches of consecutive base faces, each with the points of the edges that appear there first and with those
    /// inside.
    fn tasks<'a, const W: usize>(&self, points: &'a mut [[f64; W]]) -> Vec<Task<'a, W>> {
        let (base, order) = (&self.surface.base, &self.orders[1]);
        let on_edge = order.pieces() - 1;
        let (mut edges, mut inner) = points.split_at_mut(base.n_edges() * on_edge);
        let mut at = [base.n_vertices(), base.n_vertices() + edges.len()];
        let most = (TASK / (order.pieces() * order.pieces())).max(1);
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
            tasks.push(Task { patches, starts, edges: mine, inner: within, vertices: Vec::new() });
        }
        tasks
    }
}

/// Whether all numbers are finite: a sum of them times zero is NaN as soon as one is not.
fn all_finite(numbers: &[f64]) -> bool {
    let (lines, rest) = numbers.as_chunks::<16>();
    let mut sums = [0.0; 16];
    for line in lines {
        sums.iter_mut().zip(line).for_each(|(sum, x)| *sum += 0.0 * x);
    }
    sums.iter().all(|&sum| sum == 0.0) && rest.iter().all(|x| x.is_finite())
}

/// Consecutive patches and where their points go.
struct Task<'a, const W: usize> {
    patches: Range<usize>,
    /// The documented numbers of the first of `edges` and of `inner`.
    starts: [usize; 2],
    edges: &'a mut [[f64; W]],
    inner: &'a mut [[f64; W]],
    /// Vertices of the base and their points.
    vertices: Vec<(u32, [f64; W])>,
}

impl<const W: usize> Task<'_, W> {
    /// The places of points inside base faces from a documented number on.
    fn inside(&mut self, first: u32, n: usize) -> &mut [[f64; W]] {
        let first = first as usize - self.starts[1];
        &mut self.inner[first..first + n]
    }

    /// The places of consecutive points that are no vertices of the base, if they are here.
    fn places(&mut self, first: usize, n: usize) -> Option<&mut [[f64; W]]> {
        if let Some(at) = first.checked_sub(self.starts[1]) {
            return self.inner.get_mut(at..at + n);
        }
        let at = first.checked_sub(self.starts[0])?;
        self.edges.get_mut(at..at + n)
    }
}

impl<const W: usize> Target<W> for Task<'_, W> {
    fn wants(&self, _block: Block, _cells: usize) -> bool {
        true
    }

    fn take(&mut self, sweep: &Sweep, size: Size, block: Block, planes: &Planes) {
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
                let row = Row::new(planes, size, row - at[1]);
                row.copy(columns.start - at[0], self.inside(first, columns.len()));
            }
        }
        for (side, half_edge) in surface.patches.half_edges(block.patch).enumerate() {
            let Some(range) = block.on_side(tile, side, cells) else { continue };
            let frame = Frame::new(tile, n, side, 0);
            let place = |steps: usize| frame.place([steps.cast_signed(), 0]);
            let vertex = |steps: usize| order.vertex(block.patch, place(steps));
            let point = |steps: usize| planes.point(size, block.inside(place(steps)));
            let within = (*range.start()).max(1)..(*range.end() + 1).min(n);
            // the patch where an edge appears first has its points
            if !within.is_empty() && surface.patches.halves(surface.patches.edge(half_edge) as usize)[0] == half_edge {
                let ends = [within.start, within.end - 1].map(|steps| vertex(steps) as usize);
                let places = self.places(ends[0].min(ends[1]), within.len()).into_iter().flatten();
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
