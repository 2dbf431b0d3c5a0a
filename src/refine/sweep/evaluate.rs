//! Evaluates stencils at refined points: limit positions and normals from the points around each one.

use std::ops::Range;

use rayon::prelude::*;

use super::aligned::AlignedBuffer;
use super::bundle::{Bundle, FUNCTIONALS, SUMS_AT_A_TIME};
use super::lattice::last;
use super::patch_evaluator::{PatchEvaluator, ROWS_PER_BAND, ValueRule};
use super::program::Sweep;
use super::stencils::Stencils;
use super::task::{PatchRun, SideValue};
use crate::kept::Numbers;
use crate::watch::{Stopped, Watch};

/// The values of all points, in the documented order.
#[derive(Debug)]
pub(crate) struct PointValues<const W: usize> {
    /// One value per point, `n x W`.
    pub(crate) values: Numbers,
    /// Values by side at points with several sectors, sorted.
    pub(crate) sides: Vec<SideValue<W>>,
    /// Whether the value of a point with faces is zero.
    pub(crate) has_zero: bool,
}

impl Sweep {
    /// Evaluates stencils at the points where the sweep ends, which are given in the documented order. Returns the
    /// values of each pair of stencils and a rule.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    ///
    /// # Panics
    /// If the number of points differs from that of the net where the sweep ends, if stencils differ in their reach, or
    /// if there are more than [`FUNCTIONALS`] functionals.
    pub(crate) fn evaluate<const W: usize>(
        &self,
        points: &[f64],
        wanted: &[(&Stencils, ValueRule<W>)],
        watch: &Watch,
    ) -> Result<Vec<PointValues<W>>, Stopped> {
        let points = points.as_chunks::<W>().0;
        assert_eq!(points.len(), self.n_points(), "the points belong to another net");
        let n_vertices = self.surface.base.n_vertices();
        let run = BandRun::new(self, points, wanted);
        let mut values: Vec<_> = wanted.iter().map(|_| Numbers::to_overwrite(points.len() * W)).collect();
        let (mut vertices, rest): (Vec<_>, Vec<_>) =
            values.iter_mut().map(|values| values.as_chunks_mut::<W>().0.split_at_mut(n_vertices)).unzip();
        let tasks = self.tasks_of_each(rest).into_par_iter();
        let made = tasks.map_init(BandBuffers::default, |buffers, tasks| run.patches(tasks, buffers, watch));
        let mut others = vec![(Vec::new(), false); wanted.len()];
        for of_task in made.collect::<Result<Vec<_>, Stopped>>()? {
            for (part, task) in of_task.into_iter().enumerate() {
                task.vertices.into_iter().for_each(|(v, value)| vertices[part][v as usize] = value);
                others[part].0.extend(task.sides);
                others[part].1 |= task.has_zero;
            }
        }
        for v in (0..n_vertices).filter(|&v| self.surface.base.is_isolated(v)) {
            vertices.iter_mut().zip(wanted).for_each(|(values, (_, rule))| values[v] = (rule.alone)(points[v]));
        }
        let found = values.into_iter().zip(others).map(|(values, (mut sides, has_zero))| {
            sides.sort_unstable_by_key(|&(side, _)| side);
            PointValues { values, sides, has_zero }
        });
        Ok(found.collect())
    }
}

/// What is evaluated at the points of each band: several values, in one pass.
struct BandRun<'a, const W: usize> {
    points: &'a [[f64; W]],
    /// An evaluator for each value, all of one reach; there is at least one if there are tasks.
    evaluators: Vec<PatchEvaluator<'a, W>>,
    /// The regular masks of the functionals of all evaluators, over the buffer of a band.
    bundle: Bundle,
}

/// The buffers of one thread.
#[derive(Default)]
struct BandBuffers<const W: usize> {
    /// The points of a band, with those within reach around them.
    points: AlignedBuffer,
    /// The functionals of a row.
    functionals: [AlignedBuffer; FUNCTIONALS],
    /// For each evaluator the values of the band, as far as they lie on the sides of the patch.
    values: Vec<Vec<[f64; W]>>,
}

impl<'a, const W: usize> BandRun<'a, W> {
    fn new(sweep: &'a Sweep, points: &'a [[f64; W]], wanted: &[(&'a Stencils, ValueRule<W>)]) -> Self {
        let evaluators: Vec<_> = wanted.iter().map(|&(of, rule)| PatchEvaluator::new(sweep, of, rule)).collect();
        let stride = evaluators.first().map_or(0, PatchEvaluator::stride).cast_signed();
        let term = |&([i, j], weight): &([isize; 2], f64)| (weight, (j * stride + i) * W.cast_signed());
        assert!(
            evaluators.iter().all(|evaluator| evaluator.stride() == evaluators[0].stride()),
            "stencils differ in their reach"
        );
        let masks = evaluators.iter().flat_map(|evaluator| &evaluator.stencils.regular.sectors[0]);
        let masks: Vec<Vec<_>> = masks.map(|mask| mask.iter().map(term).collect()).collect();
        Self { points, bundle: Bundle::new(&masks), evaluators }
    }

    /// Evaluates the patches of a task, given its part of each result.
    fn patches<'t>(
        &self,
        mut tasks: Vec<PatchRun<'t, W>>,
        buffers: &mut BandBuffers<W>,
        watch: &Watch,
    ) -> Result<Vec<PatchRun<'t, W>>, Stopped> {
        let n = self.evaluators[0].n;
        for patch in tasks[0].patches.clone() {
            for first in (0..=n).step_by(ROWS_PER_BAND) {
                watch.check()?;
                self.band(patch, &(first..(first + ROWS_PER_BAND).min(n + 1)), buffers, &mut tasks);
            }
            watch.advance((n * n * self.evaluators.len()) as u64);
        }
        Ok(tasks)
    }

    /// Evaluates the points in some rows of a patch.
    fn band(&self, patch: usize, rows: &Range<usize>, buffers: &mut BandBuffers<W>, tasks: &mut [PatchRun<'_, W>]) {
        let BandBuffers { points, functionals, values } = buffers;
        let grid = &self.evaluators[0];
        let len = grid.band_points(ROWS_PER_BAND);
        let points = points.first(len * W + SUMS_AT_A_TIME);
        values.resize_with(self.evaluators.len(), || vec![[0.0; W]; len]);
        let copy = |first: u32, out: &mut [[f64; W]]| out.copy_from_slice(&self.points[first as usize..][..out.len()]);
        grid.gather(patch, rows, copy, points.as_chunks_mut().0);
        let stars = self.evaluators.iter().zip(&mut *tasks);
        let stars: Vec<_> =
            stars.map(|(evaluator, task)| evaluator.stars(patch, rows, self.points, &mut task.sides)).collect();
        for j in rows.clone() {
            let len = last(grid.sweep.surface.tile, grid.n, j) + 1;
            let start = grid.at(rows.start, [0, j.cast_signed()]);
            self.bundle.sums(functionals, len * W, points, start * W);
            let mut functionals = functionals.each_mut().map(|row| row.as_chunks_mut().0).into_iter();
            for (((evaluator, task), values), stars) in
                self.evaluators.iter().zip(&mut *tasks).zip(&mut *values).zip(&stars)
            {
                let mut mine = functionals.by_ref().take(evaluator.n_functionals());
                let Some(row) = mine.next().map(|row| &mut row[..len]) else { continue };
                (evaluator.rule.of_all)(row, mine.next().map_or(&[], |second| &second[..len]));
                for ([i, _], value) in stars.iter().filter(|([_, row], _)| *row == j.cast_signed()) {
                    row[i.unsigned_abs()] = *value;
                }
                evaluator.emit_row(patch, j, row, task);
                // only values on the sides of the patch are needed later
                let step = if j == 0 || j == grid.n { 1 } else { len.saturating_sub(1).max(1) };
                for i in (0..len).step_by(step) {
                    values[start + i] = row[i];
                }
            }
        }
        for (((evaluator, task), values), stars) in self.evaluators.iter().zip(tasks).zip(values).zip(stars) {
            evaluator.lines(patch, rows, points.as_chunks().0, (values, &mut task.sides));
            stars.into_iter().for_each(|(place, value)| values[evaluator.at(rows.start, place)] = value);
            evaluator.emit_sides(patch, rows, values, task);
        }
    }
}
