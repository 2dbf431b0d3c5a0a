//! Applies rows to points, block by block.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::source::RowSource;
use super::table::{Rows, weighted};
use crate::watch::{Stopped, Watch};

/// Number of rows made and applied at a time: small enough for the cache, large enough to share among threads. With
/// half of it the points that blocks of a run compute twice and the switching weigh more; with twice of it the points
/// between the tables of a run need twice the cache, and short polygons leave threads idle.
const ROWS_PER_TASK: usize = 4096;

/// Maximum number of tables that are applied to a block in turn. Half of it stores the points between tables more
/// often; twice of it saves less with each table, while blocks compute more points twice and follow the rows at the
/// ends through more tables.
pub const MAX_RUN: usize = 4;

/// The result of applying rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Blended {
    /// Coordinates of the new points, `n x width`, point after point.
    pub points: Vec<f64>,
    /// Whether all coordinates are finite numbers.
    pub finite: bool,
}

/// Returns `rows x points`: `points` is `n_columns x width`, the result `n_rows x width`, both point after point.
///
/// Blocks of rows are divided among threads; each sum is ordered, so any number of threads gives the same bits.
///
/// # Errors
/// [`Stopped`] when the watch says so.
///
/// # Panics
/// If `points` does not have `n_columns x width` coordinates, or `width` is not 1 to 4.
pub fn blend(source: &dyn RowSource, points: &[f64], width: usize, watch: &Watch) -> Result<Vec<f64>, Stopped> {
    blend_run(&[source], points, width, watch).map(|blended| blended.points)
}

/// Applies several tables in turn, the first of `run` first, without storing the points between them: each block of new
/// points is computed from the few intermediate points that it needs, which stay in the cache. The sums have the same
/// bits as with one table at a time. This pays if all tables but the first have a pattern.
///
/// # Errors
/// [`Stopped`] when the watch says so.
///
/// # Panics
/// If the sizes do not fit, `width` is not 1 to 4, or the number of tables is not 1 to [`MAX_RUN`].
pub fn blend_run(run: &[&dyn RowSource], points: &[f64], width: usize, watch: &Watch) -> Result<Blended, Stopped> {
    assert!((1..=MAX_RUN).contains(&run.len()), "a run has 1 to {MAX_RUN} tables, not {}", run.len());
    assert_eq!(points.len(), run[0].n_columns() * width, "the rows belong to another net");
    assert!(run.array_windows().all(|[a, b]| a.n_rows() == b.n_columns()), "the rows belong to another net");
    match width {
        1 => blend_points::<1>(run, points, watch),
        2 => blend_points::<2>(run, points, watch),
        3 => blend_points::<3>(run, points, watch),
        4 => blend_points::<4>(run, points, watch),
        _ => panic!("points have 1 to 4 coordinates, not {width}"),
    }
}

fn blend_points<const W: usize>(run: &[&dyn RowSource], points: &[f64], watch: &Watch) -> Result<Blended, Stopped> {
    let n_rows = run.last().map_or(0, |source| source.n_rows());
    let (points, _) = points.as_chunks::<W>();
    let mut out = vec![0.0; n_rows * W];
    let finite = AtomicBool::new(true);
    out.par_chunks_mut(ROWS_PER_TASK * W).enumerate().try_for_each_init(Rows::default, |rows, (block, out)| {
        watch.check()?;
        let start = block * ROWS_PER_TASK;
        fill(run, points, start, out.as_chunks_mut::<W>().0, rows);
        // checks all sums, since a sample would not do: a sum that overflows stays infinite or NaN
        if !out.iter().fold(true, |finite, x| finite & x.is_finite()) {
            finite.store(false, Ordering::Relaxed);
        }
        watch.advance((out.len() / W) as u64);
        Ok(())
    })?;
    watch.advance(run[..run.len() - 1].iter().map(|source| source.n_rows() as u64).sum());
    Ok(Blended { points: out, finite: finite.into_inner() })
}

/// Fills `out` with the points from `start` on after the tables of `run`.
fn fill<const W: usize>(
    run: &[&dyn RowSource],
    points: &[[f64; W]],
    start: usize,
    out: &mut [[f64; W]],
    rows: &mut Rows,
) {
    let Some((last, before)) = run.split_last() else {
        out.copy_from_slice(&points[start..start + out.len()]);
        return;
    };
    let all = start..start + out.len();
    let repeated = last.pattern().map_or(all.end..all.end, |pattern| pattern.part_of(&all));
    for single in [all.start..repeated.start, repeated.end..all.end] {
        let out = &mut out[single.start - start..single.end - start];
        fill_singly(*last, before, points, single, out, rows);
    }
    let Some(pattern) = last.pattern().filter(|_| !repeated.is_empty()) else { return };
    let out = &mut out[repeated.start - start..repeated.end - start];
    if before.is_empty() {
        pattern.apply(repeated.start, points, 0, out);
    } else {
        let needs = pattern.needs(&repeated);
        let mut between = vec![[0.0; W]; needs.len()];
        fill(before, points, needs.start, &mut between, rows);
        pattern.apply(repeated.start, &between, needs.start, out);
    }
}

/// Applies the rows `range` of `last` one by one to the points after the tables `before`.
fn fill_singly<const W: usize>(
    last: &dyn RowSource,
    before: &[&dyn RowSource],
    points: &[[f64; W]],
    range: Range<usize>,
    out: &mut [[f64; W]],
    rows: &mut Rows,
) {
    if range.is_empty() {
        return;
    }
    rows.clear();
    last.make(range, rows);
    if before.is_empty() {
        rows.apply(points, out);
        return;
    }
    // the few rows near the ends, and the points that they need
    let ends = std::mem::take(rows);
    for (r, target) in out.iter_mut().enumerate() {
        let (indices, weights) = ends.row(r);
        let needed: Vec<[f64; W]> = indices
            .iter()
            .map(|&index| {
                let mut point = [[0.0; W]];
                fill(before, points, index as usize, &mut point, rows);
                point[0]
            })
            .collect();
        *target = weighted(weights.iter().zip(&needed));
    }
}
