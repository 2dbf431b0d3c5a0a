//! The rows of values at refined points: the terms that an evaluation adds, in the same order.

use std::ops::Range;

use super::lattice::{CornerFrame, LATTICE_AXES, axis, last};
use super::patch_evaluator::{PatchEvaluator, ROWS_PER_BAND, ValueRule};
use super::program::Sweep;
use super::stencils::{Stencil, Stencils};
use crate::math::rows::Rows;
use crate::shape::topology::NONE;
use crate::watch::{Stopped, Watch};

/// Rows over the points where a sweep ends, in the documented order.
#[derive(Debug)]
pub(crate) struct TracedRows {
    /// The rows of all points: for each point those of its first sector, one per functional, then those of its other
    /// sectors.
    pub(crate) rows: Rows,
    /// For each point its first row and its number of sectors; `None` for points without faces.
    pub(crate) of_points: Vec<Option<(usize, usize)>>,
}

/// A placeholder for the rule of an evaluation, which is never applied.
const UNUSED_RULE: ValueRule<1> = ValueRule { of: |_| [0.0], of_all: |_, _| {}, join: |_| [0.0], alone: |value| value };

impl Sweep {
    /// Returns the rows that [`Sweep::evaluate`] adds up at the points where the sweep ends.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub(crate) fn traced(&self, stencils: &Stencils, watch: &Watch) -> Result<TracedRows, Stopped> {
        let base = &self.surface.base;
        // for each point the bits of the index of its entry, counted from 1; if several patches compute a point, the
        // entry of the one whose value is kept
        let mut found = vec![[0.0]; self.n_points()];
        let (vertices, rest) = found.split_at_mut(base.n_vertices());
        let run = PatchEvaluator::new(self, stencils, UNUSED_RULE);
        let mut trace = RowTrace { sweep: self, run: &run, stencils, rows: Rows::default(), entries: Vec::new() };
        let len = run.band_points(ROWS_PER_BAND);
        let (mut points, mut numbers) = (vec![NONE; len], vec![[0.0]; len]);
        for mut task in self.tasks(rest) {
            for patch in task.patches.clone() {
                for first in (0..=run.n).step_by(ROWS_PER_BAND) {
                    watch.check()?;
                    let rows = first..(first + ROWS_PER_BAND).min(run.n + 1);
                    run.gather(
                        patch,
                        &rows,
                        |first, out| out.iter_mut().zip(first..).for_each(|(slot, v)| *slot = v),
                        &mut points,
                    );
                    trace.band(patch, &rows, &points, &mut numbers);
                    for j in rows.clone() {
                        let start = run.at(rows.start, [0, j.cast_signed()]);
                        let row = &numbers[start..=start + last(self.surface.tile, run.n, j)];
                        run.emit_row(patch, j, row, &mut task);
                    }
                    run.emit_sides(patch, &rows, &numbers, &mut task);
                }
                watch.advance((run.n * run.n) as u64);
            }
            task.vertices.iter().for_each(|&(v, number)| vertices[v as usize] = number);
        }
        let RowTrace { rows, entries, .. } = trace;
        let of_point = |[number]: &[f64; 1]| {
            let place = usize::try_from(number.to_bits()).ok()?.checked_sub(1)?;
            entries.get(place).copied()
        };
        Ok(TracedRows { rows, of_points: found.iter().map(of_point).collect() })
    }
}

/// The rows found so far.
struct RowTrace<'a> {
    sweep: &'a Sweep,
    run: &'a PatchEvaluator<'a, 1>,
    stencils: &'a Stencils,
    rows: Rows,
    /// First row and number of sectors of each entry.
    entries: Vec<(usize, usize)>,
}

impl RowTrace<'_> {
    /// Adds the rows of a point and returns the index of its entry as the bits of an f64.
    fn add<P: Copy>(&mut self, stencil: &Stencil<P>, point: impl Fn(P) -> u32) -> [f64; 1] {
        let first = self.rows.len();
        for weights in stencil.sectors.iter().flatten() {
            for &(p, weight) in weights {
                self.rows.add(point(p), weight);
            }
            self.rows.end_row();
        }
        self.entries.push((first, stencil.sectors.len()));
        [f64::from_bits(self.entries.len() as u64)]
    }

    /// Adds the rows of the points in some rows of a patch, given the indices of the points.
    fn band(&mut self, patch: usize, rows: &Range<usize>, points: &[u32], numbers: &mut [[f64; 1]]) {
        let (surface, run, n) = (&self.sweep.surface, self.run, self.run.n);
        let place = |[i, j]: [isize; 2], [a, b]: [isize; 2]| points[run.at(rows.start, [i + a, j + b])];
        let wanted = rows.start.cast_signed()..rows.end.cast_signed();
        for j in rows.clone() {
            for i in 0..=last(surface.tile, n, j) {
                let here = [i, j].map(usize::cast_signed);
                // entries on lines and in stars are replaced below
                numbers[run.at(rows.start, here)] = self.add(&self.stencils.regular, |by| place(here, by));
            }
        }
        for (side, half_edge) in surface.patches.half_edges(patch).enumerate() {
            let Some(along) = surface.line(half_edge).and_then(|line| self.stencils.lines[line].as_ref()) else {
                continue;
            };
            let stencil = &along[axis(surface.tile, side)];
            let frame = CornerFrame::new(surface.tile, n, side, 0);
            let turn = if frame.along() == LATTICE_AXES[axis(surface.tile, side)] { 1 } else { -1 };
            for steps in run.steps(frame.along(), frame.corner()[1], &wanted) {
                let here = frame.place([steps, 0]);
                numbers[run.at(rows.start, here)] = self.add(stencil, |by| place(here, by.map(|x| turn * x)));
            }
        }
        run.near_stars(patch, rows, |_, here, stencil, star| {
            numbers[run.at(rows.start, here)] = self.add(stencil, |point| star[point]);
        });
    }
}
