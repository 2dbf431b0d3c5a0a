//! Points refined by a sweep: every patch through all rounds, straight into the documented order.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::grid::{FlatPass, Planes, SharpSide, Size, at_least};
use super::program::Sweep;
use super::star::StarWork;
use super::surface::along;
use super::weave::{Row, weave};
use crate::kept::Numbers;
use crate::shape::topology::{NONE, index};
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
            let vertices = task.vertices.iter().all(|(_, point)| all_finite(point));
            if !(vertices && all_finite(task.edges.as_flattened()) && all_finite(task.inner.as_flattened())) {
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

    /// Puts a point that is no vertex of the base where it belongs, if that is here.
    fn put(&mut self, v: usize, point: [f64; W]) {
        if v >= self.starts[1] {
            self.inner[v - self.starts[1]] = point;
        } else if let Some(place) = v.checked_sub(self.starts[0]).and_then(|at| self.edges.get_mut(at)) {
            *place = point;
        }
    }
}

impl<const W: usize> Target<W> for Task<'_, W> {
    fn wants(&self, _block: Block, _cells: usize) -> bool {
        true
    }

    fn take(&mut self, run: &Run<'_, W>, size: Size, block: Block, planes: &Planes) {
        run.emit(size, block, planes, self);
    }
}

/// Where the points of blocks go.
pub(super) trait Target<const W: usize> {
    /// Whether any point of a block with so many cells along each side is wanted.
    fn wants(&self, block: Block, cells: usize) -> bool;

    /// Takes the points of a block, which entered the last round with this size.
    fn take(&mut self, run: &Run<'_, W>, size: Size, block: Block, planes: &Planes);
}

/// What all tasks have in common.
pub(super) struct Run<'a, const W: usize> {
    pub(super) sweep: &'a Sweep,
    pub(super) flat: &'a [Vec<FlatPass>],
    pub(super) start: &'a [[f64; W]],
    pub(super) watch: &'a Watch,
}

/// The buffers of one thread.
#[derive(Debug, Default)]
pub(super) struct Worker<const W: usize> {
    planes: Planes,
    /// Refined grids of patches that are refined further block by block, by depth.
    woven: Vec<Vec<f64>>,
    /// For each vertex of the patches where the points of its star begin; [`NONE`] where they were not made yet.
    star_of: Vec<u32>,
    /// The vertices whose stars were made.
    starred: Vec<u32>,
    /// Points of stars, round after round.
    stars: Vec<[f64; W]>,
    work: StarWork<W>,
}

/// A part of a patch at a round: a grid whose first cell is at `at`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    patch: usize,
    pub(super) at: [usize; 2],
    /// Pieces of the patch's side.
    pub(super) pieces: usize,
}

impl Block {
    /// Whether its grid with so many cells touches a side of the patch.
    fn touches(self, side: usize, cells: usize) -> bool {
        match side {
            0 => self.at[1] == 0,
            1 => self.at[0] + cells == self.pieces,
            2 => self.at[1] + cells == self.pieces,
            _ => self.at[0] == 0,
        }
    }
}

impl<const W: usize> Worker<W> {
    /// Forgets the stars of another task.
    pub(super) fn begin(&mut self, sweep: &Sweep) {
        self.star_of.resize(sweep.surface.patches.n_vertices(), NONE);
        for v in self.starred.drain(..) {
            self.star_of[v as usize] = NONE;
        }
        self.stars.clear();
    }
}

impl<const W: usize> Run<'_, W> {
    /// Refines a patch.
    pub(super) fn patch(
        &self,
        patch: usize,
        worker: &mut Worker<W>,
        target: &mut impl Target<W>,
    ) -> Result<(), Stopped> {
        let sweep = self.sweep;
        let size = sweep.size(0, W);
        let corners = sweep.surface.patches.half_edges(patch).map(|half| sweep.surface.patches.vertex(half) as usize);
        corners.for_each(|v| self.star(v, worker));
        let coarse = &mut worker.planes.now[0];
        at_least(coarse, size.len());
        coarse[..size.len()].fill(0.0);
        let grid = [size.cells, sweep.halo];
        sweep.surface.gather(&sweep.orders[0], patch, grid, |place, v| {
            let at = size.at(place);
            coarse[at..at + W].copy_from_slice(&self.start[v as usize]);
        });
        self.descend(0, Block { patch, at: [0, 0], pieces: size.cells }, worker, target)
    }

    /// Refines the star around a vertex through all rounds, if it has one and that was not done yet.
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

    /// Refines a block whose coarse grid is in the first plane through the rounds from `round` on.
    fn descend(
        &self,
        round: usize,
        block: Block,
        worker: &mut Worker<W>,
        target: &mut impl Target<W>,
    ) -> Result<(), Stopped> {
        let sweep = self.sweep;
        let size = sweep.size(round, W);
        let patches = &sweep.surface.patches;
        let mut sides = [None; 4];
        for (side, half_edge) in patches.half_edges(block.patch).enumerate() {
            let line = sweep.surface.line(half_edge).filter(|_| block.touches(side, size.cells));
            sides[side] = line.map(|line| SharpSide { side, line });
        }
        let sides: Vec<SharpSide> = sides.into_iter().flatten().collect();
        worker.planes.refine(&self.flat[round], size, &sides);
        for (side, half_edge) in patches.half_edges(block.patch).enumerate() {
            let before = (side + 3) % 4;
            let v = patches.vertex(half_edge) as usize;
            if block.touches(side, size.cells) && block.touches(before, size.cells) && worker.star_of[v] != NONE {
                self.overlay(round, side, half_edge, worker);
            }
        }
        if round + 1 == sweep.rounds.len() {
            self.watch.check()?;
            target.take(self, size, block, &worker.planes);
            self.watch.advance(4 * (size.cells * size.cells) as u64);
            return Ok(());
        }
        if worker.woven.len() <= round {
            worker.woven.resize_with(round + 1, Vec::new);
        }
        let mut woven = std::mem::take(&mut worker.woven[round]);
        let next = sweep.size(round + 1, W);
        let fine = Size { cells: 2 * size.cells, ..size };
        weave::<W>(&worker.planes, size, fine, &mut woven);
        let refined = Block { at: block.at.map(|at| 2 * at), pieces: 2 * block.pieces, ..block };
        if fine.cells == next.cells {
            std::mem::swap(&mut woven, &mut worker.planes.now[0]);
            worker.woven[round] = woven;
            return self.descend(round + 1, refined, worker, target);
        }
        for corner in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let offset = corner.map(|x| x * next.cells);
            let at = std::array::from_fn(|axis| refined.at[axis] + offset[axis]);
            let part = Block { at, ..refined };
            if !target.wants(part, next.cells) {
                continue;
            }
            let coarse = &mut worker.planes.now[0];
            at_least(coarse, next.len());
            let rows = coarse[..next.len()].chunks_exact_mut(next.stride() * W);
            for (j, row) in rows.enumerate() {
                let from = ((offset[1] + j) * fine.stride() + offset[0]) * W;
                row.copy_from_slice(&woven[from..from + row.len()]);
            }
            self.descend(round + 1, part, worker, target)?;
        }
        worker.woven[round] = woven;
        Ok(())
    }

    /// Overwrites what the loops made around a corner by the points of its star.
    fn overlay(&self, round: usize, side: usize, half_edge: u32, worker: &mut Worker<W>) {
        let sweep = self.sweep;
        let (size, surface) = (sweep.size(round, W), &sweep.surface);
        let v = surface.patches.vertex(half_edge) as usize;
        let Some(kind) = surface.kind_of(v) else { return };
        let shape = sweep.shape(kind);
        let Worker { planes, star_of, stars, .. } = worker;
        let star = &stars[star_of[v] as usize + round * shape.len()..][..shape.len()];
        let sector = surface.patches.ring(v).position(|ring| ring == half_edge).unwrap_or(0);
        let n = 2 * size.cells;
        let mut put = |[i, j]: [isize; 2], point: usize| {
            let plane = ((i & 1) + 2 * (j & 1)).unsigned_abs();
            let at = size.at([i, j].map(|x| x.div_euclid(2)));
            planes.now[plane][at..at + W].copy_from_slice(&star[point]);
        };
        let reach = 0..=shape.reach;
        for (ab, [a, b]) in
            reach.clone().flat_map(|b| reach.clone().map(move |a| ([a, b], [a, b].map(usize::cast_signed))))
        {
            put(along(n, side, a, b), shape.point(sector, ab));
            // the face before lies below the side, the next one beside it
            if let Some(before) = shape.neighbour(sector, false) {
                put(along(n, side, b, -a), shape.point(before, ab));
            }
            if let Some(next) = shape.neighbour(sector, true) {
                put(along(n, side, -b, a), shape.point(next, ab));
            }
        }
    }

    /// Writes the points of a block after the last round.
    fn emit(&self, size: Size, block: Block, planes: &Planes, task: &mut Task<'_, W>) {
        let order = &self.sweep.orders[1];
        let (cells, n) = (2 * size.cells, 2 * block.pieces);
        let at = block.at.map(|at| 2 * at);
        let columns = at[0].max(1)..(at[0] + cells + 1).min(n);
        for row in at[1].max(1)..(at[1] + cells + 1).min(n) {
            let first = order.patch_vertex(block.patch, [columns.start, row]);
            let row = Row::new(planes, size, row - at[1]);
            row.copy(columns.start - at[0], task.inside(first, columns.len()));
        }
        let patches = &self.sweep.surface.patches;
        for (side, half_edge) in patches.half_edges(block.patch).enumerate() {
            if !block.touches(side, size.cells) {
                continue;
            }
            let first = at[side % 2];
            // counted along the axis of the side
            let across = if matches!(side, 1 | 2) { n } else { 0 };
            let place = |steps: usize| if side % 2 == 0 { [steps, across] } else { [across, steps] };
            let vertex = |steps: usize| order.patch_vertex(block.patch, place(steps));
            let point = |steps: usize| {
                let [i, j] = place(steps);
                Row::new(planes, size, j - at[1]).point(i - at[0])
            };
            // the numbers of the points of a side go up or down by the same everywhere
            let along = first.max(1)..(first + cells + 1).min(n);
            let v = vertex(along.start) as usize;
            let forward = along.len() < 2 || vertex(along.start + 1) as usize > v;
            let stride = if along.len() < 2 { 0 } else { v.abs_diff(vertex(along.start + 1) as usize) };
            for (k, steps) in along.enumerate() {
                task.put(if forward { v + k * stride } else { v - k * stride }, point(steps));
            }
            let start = if matches!(side, 0 | 1) { 0 } else { n };
            if (first..=first + cells).contains(&start) {
                let (v, corner) = (vertex(start), patches.vertex(half_edge) as usize);
                if (v as usize) >= self.sweep.surface.base.n_vertices() {
                    task.put(v as usize, point(start));
                } else if patches.ring(corner).next() == Some(half_edge) {
                    task.vertices.push((v, point(start)));
                }
            }
        }
    }
}
