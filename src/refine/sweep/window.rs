//! Computes points on demand: of each patch only the blocks with requested points are refined.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use super::block::{Block, BlockReceiver, BlockStack};
use super::grid::{GridSize, Planes};
use super::patches::{SweepRun, Worker};
use super::places::{Span, SweepPlaces, spans};
use super::program::{Flat, Sweep};
use super::weave::GridRow;
use crate::shape::tile::Tile;
use crate::watch::Watch;

/// Maximum number of points of a band of rows, where a patch is so wide that a band is a single row of blocks. With
/// half as many, blocks become smaller and their halos cost more for narrower patches; twice as many take twice the
/// memory for wide ones.
const MAX_BAND_POINTS: usize = 1 << 19;

/// Minimum number of rows of a block after the last round; with half as many, halos cost half as much as the points.
const LEAST_ROWS: usize = 32;

/// A window with more than this many points per requested point is divided into one window per span. With half of it
/// spans near each other compute the points around them more than once; with twice of it more points are computed that
/// nobody requested.
const MAX_POINTS_A_REQUEST: usize = 4;

/// A sweep whose points are computed when they are requested, and not kept.
#[derive(Debug)]
pub(crate) struct OnDemand {
    sweep: Sweep,
    pub(super) places: SweepPlaces,
    start: Vec<f64>,
    flat: Flat,
    /// The buffers of threads that are idle.
    idle: Mutex<Vec<WindowBuffers>>,
    watch: Watch,
}

#[derive(Debug, Default)]
struct WindowBuffers {
    worker: Worker<3>,
    points: Vec<[f64; 3]>,
}

/// A part of a patch's grid after the last round: the places between two corners, both included, row by row.
pub(super) struct GridWindow<'a> {
    low: [usize; 2],
    high: [usize; 2],
    /// Number of pieces of the patch's side.
    pieces: usize,
    /// Whether points on the diagonal of a triangle are needed. A block that holds no further points of the diagonal
    /// than its first one is not refined, so that its neighbours have to be.
    is_diagonal: bool,
    points: &'a mut [[f64; 3]],
}

impl OnDemand {
    /// Creates a source of the points that a sweep computes from `start`, three coordinates for each point of the net
    /// where the sweep begins. After the watch says stop, all further points are zero.
    pub(crate) fn new(sweep: Sweep, start: Vec<f64>, watch: &Watch) -> Self {
        let n = sweep.orders[1].pieces();
        let sweep = sweep.with_blocks((MAX_BAND_POINTS / n).max(LEAST_ROWS) / 2);
        let places = SweepPlaces::new(&sweep.surface, n);
        let flat = sweep.flat(3, 1);
        Self { sweep, places, start, flat, idle: Mutex::default(), watch: watch.clone() }
    }

    /// Returns the number of points.
    pub(crate) fn n_points(&self) -> usize {
        self.sweep.n_points()
    }

    /// Returns the best end for a range of points that starts at `v`.
    pub(crate) fn stretch(&self, v: usize) -> usize {
        self.places.stretch(v, self.rows())
    }

    /// Returns the best end for a range of faces that starts at `face`.
    pub(crate) fn stretch_of_faces(&self, face: usize) -> usize {
        self.places.stretch_of_faces(face, self.rows())
    }

    /// Returns the number of rows of a block after the last round.
    fn rows(&self) -> usize {
        2 * self.sweep.rounds.last().map_or(1, |round| round.cells)
    }

    /// Fills `out` with the points in `range`, in the documented order.
    pub(crate) fn points(&self, range: Range<usize>, out: &mut Vec<[f64; 3]>) {
        out.clear();
        out.resize(range.len(), [0.0; 3]);
        let start = self.start.as_chunks().0;
        let spans = spans(range.clone(), |v| {
            let span = self.places.span(v);
            if span.is_none() {
                // a vertex without faces keeps its position
                out[v - range.start] = start[v];
            }
            span
        });
        self.windows(&spans, [0, 0], |at, span, window| {
            let out = &mut out[at..at + span.len];
            if span.is_row() {
                out.copy_from_slice(&window.row(span.from)[..span.len]);
            } else {
                out.iter_mut().enumerate().for_each(|(k, point)| *point = window.row(span.place(k))[0]);
            }
        });
    }

    /// Fills `out` with the corner points of the faces in each of the ranges, in the documented order.
    pub(crate) fn corners(&self, ranges: impl Iterator<Item = Range<usize>> + Clone, out: &mut Vec<[[f64; 3]; 4]>) {
        out.clear();
        out.resize(ranges.clone().map(|range| range.len()).sum(), [[0.0; 3]; 4]);
        let mut at = 0;
        for range in ranges {
            let n = range.len();
            self.corners_of(range, &mut out[at..at + n]);
            at += n;
        }
    }

    fn corners_of(&self, range: Range<usize>, out: &mut [[[f64; 3]; 4]]) {
        let spans = spans(range, |face| Some(self.places.cells(face)));
        self.windows(&spans, [0, 1], |at, span, window| {
            let [i, j] = span.from;
            let sides = window.row([i, j]).windows(2).zip(window.row([i, j + 1]).windows(2));
            for (corners, (lower, upper)) in out[at..at + span.len].iter_mut().zip(sides) {
                *corners = [lower[0], lower[1], upper[1], upper[0]];
            }
        });
    }

    /// Computes the points of spans, sorted by patch, with those up to `beside` steps before and after them in both
    /// directions, and calls `each` for every span.
    pub(super) fn windows(
        &self,
        spans: &[(usize, Span)],
        beside: [usize; 2],
        mut each: impl FnMut(usize, &Span, &GridWindow<'_>),
    ) {
        let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        let WindowBuffers { worker, points } = &mut idle;
        worker.begin(&self.sweep);
        let start = self.start.as_chunks().0;
        let run = SweepRun { sweep: &self.sweep, flat: &self.flat, start, watch: &self.watch };
        let block = self.rows() * self.rows();
        for of_patch in spans.chunk_by(|(_, a), (_, b)| a.patch == b.patch) {
            let wanted: usize = of_patch.iter().map(|(_, span)| span.len).sum();
            let is_sparse = GridWindow::around(of_patch, beside).1 > MAX_POINTS_A_REQUEST * wanted + block;
            for part in of_patch.chunks(if is_sparse { 1 } else { of_patch.len() }) {
                let ([low, high], n) = GridWindow::around(part, beside);
                if points.len() < n {
                    points.resize(n, [0.0; 3]);
                }
                let is_diagonal =
                    self.sweep.tile() == Tile::Triangle && part.iter().any(|(_, span)| span.is_diagonal());
                let pieces = self.places.pieces;
                let mut window = GridWindow { low, high, pieces, is_diagonal, points: &mut points[..n] };
                let patch = part[0].1.patch;
                let made = run.patches(patch..patch + 1, worker, &mut window).and_then(|()| run.report(worker));
                let Ok(()) = made else { return };
                part.iter().for_each(|(at, span)| each(*at, span, &window));
            }
        }
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(idle);
    }
}

impl GridWindow<'_> {
    /// Returns the two corners of the window around some spans, and its number of points.
    fn around(spans: &[(usize, Span)], [before, after]: [usize; 2]) -> ([[usize; 2]; 2], usize) {
        let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
        for place in spans.iter().flat_map(|(_, span)| [span.from, span.last()]) {
            for axis in [0, 1] {
                low[axis] = low[axis].min(place[axis] - before);
                high[axis] = high[axis].max(place[axis] + after);
            }
        }
        ([low, high], (high[0] - low[0] + 1) * (high[1] - low[1] + 1))
    }

    fn width(&self) -> usize {
        self.high[0] - self.low[0] + 1
    }

    /// Returns the points at the corners of a cell.
    pub(super) fn cell(&self, [i, j]: [usize; 2]) -> [[f64; 3]; 4] {
        let (low, high) = (self.row([i, j]), self.row([i, j + 1]));
        [low[0], low[1], high[1], high[0]]
    }

    /// Returns the points of a row from a place on.
    pub(super) fn row(&self, [i, j]: [usize; 2]) -> &[[f64; 3]] {
        let width = self.width();
        &self.points[(j - self.low[1]) * width..][i - self.low[0]..width]
    }
}

impl BlockReceiver<3> for GridWindow<'_> {
    /// A block holds the points on all of its sides; a point between two blocks is taken from one of them.
    fn wants(&self, block: Block, cells: usize) -> bool {
        let pieces = self.pieces / block.pieces;
        [0, 1].into_iter().all(|axis| {
            let (low, high) = (self.low[axis], self.high[axis]);
            let [start, end] = [block.at[axis], block.at[axis] + cells].map(|x| x * pieces);
            let ends = if end == self.pieces || self.is_diagonal { low <= end } else { low < end };
            ends && (start < high || start == high && low == high)
        })
    }

    fn take(&mut self, _: &Sweep, size: GridSize, stack: BlockStack, planes: &Planes) {
        let cells = 2 * size.cells;
        let at = stack.first.at.map(|x| 2 * x);
        let [columns, rows] =
            [0, 1].map(|axis| at[axis].max(self.low[axis])..(at[axis] + cells).min(self.high[axis]) + 1);
        if columns.is_empty() {
            return;
        }
        let width = self.width();
        for row in rows {
            let to = (row - self.low[1]) * width + columns.start - self.low[0];
            let out = &mut self.points[to..to + columns.len()];
            GridRow::new(planes, size, row - at[1]).copy(0, columns.start - at[0], out);
        }
    }
}
