//! Lines of a grid: rows of vertices whose indices are evenly spaced except at the two ends.

use multiversion::multiversion;

use super::topology::index;

/// Number of quads that are filled by one loop. Half of it takes twice as many calls; with twice of it the compiler's
/// loop for sixteen blocks at a time would run, which scatters single indices and takes three times as long.
const QUADS_A_LOOP: usize = 32;

/// The indices of the `n + 1` vertices along a line of a grid.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VertexLine {
    n: usize,
    first: u32,
    last: u32,
    /// The index of the vertex after the first.
    second: u32,
    /// The increment between consecutive inner vertices, modulo 2^32.
    step: u32,
}

impl VertexLine {
    /// Creates a line with `n` pieces from the indices of its vertices 0 to `n`. Those of vertices 1 to `n - 1` are
    /// evenly spaced.
    pub(super) fn new(n: usize, vertex: impl Fn(usize) -> u32) -> Self {
        let second = if n > 1 { vertex(1) } else { 0 };
        let step = if n > 2 { vertex(2).wrapping_sub(second) } else { 0 };
        Self { n, first: vertex(0), last: vertex(n), second, step }
    }

    /// Creates a line with `n` pieces from the indices of its two ends, of the vertex after the first, and from the
    /// increment between consecutive inner vertices, modulo 2^32.
    pub(super) fn between_ends(n: usize, [first, last]: [u32; 2], second: u32, step: u32) -> Self {
        Self { n, first, last, second, step }
    }

    /// Returns the index of vertex `i`.
    pub(crate) fn at(&self, i: usize) -> u32 {
        match i {
            0 => self.first,
            i if i == self.n => self.last,
            i => self.between(i),
        }
    }

    /// Returns the index of the vertex after the first, and the increment between consecutive inner vertices, modulo
    /// 2^32.
    pub(crate) fn between_the_ends(&self) -> [u32; 2] {
        [self.second, self.step]
    }

    /// Returns the index of the vertex at a position other than the first and the last; at these, the index that it
    /// would have if all were evenly spaced.
    fn between(&self, i: usize) -> u32 {
        self.second.wrapping_add(self.step.wrapping_mul(index(i).wrapping_sub(1)))
    }
}

/// Returns the lines across a quad, by their distance from its first side. `sides` are its sides, counter-clockwise,
/// and `inner` is the index of its first inner vertex: row by row, the inner vertices are numbered consecutively.
pub(super) fn lines_across(sides: &[VertexLine; 4], inner: usize) -> impl Fn(usize) -> VertexLine {
    let [lower, right, upper, left] = sides;
    let n = lower.n;
    move |j| {
        let (second, step) = match j {
            0 => (lower.second, lower.step),
            j if j < n => (index(inner + (j - 1) * (n - 1)), 1),
            // the upper side runs the other way; with one piece it has no inner vertex
            _ => (upper.between(n.max(2) - 1), upper.step.wrapping_neg()),
        };
        VertexLine { n, first: left.at(n - j), last: right.at(j), second, step }
    }
}

/// Returns the lines across a triangle, by their distance from its first side. `sides` are its sides,
/// counter-clockwise, and `inner` is the index of its first inner vertex: row by row, the inner vertices are numbered
/// consecutively.
pub(super) fn lines_across_triangle(sides: &[VertexLine; 3], inner: usize) -> impl Fn(usize) -> VertexLine {
    let [lower, slope, left] = sides;
    let n = lower.n;
    move |j| {
        let (second, step) = match j {
            0 => (lower.second, lower.step),
            // the rows before have n - 2, n - 3, ... inner vertices
            j => (index(inner + (j - 1) * (n - 1) - j * (j - 1) / 2), 1),
        };
        VertexLine { n: n - j, first: left.at(n - j), last: slope.at(j), second, step }
    }
}

/// Fills `out` with quads, row by row from quad `first`: row `j` lies between lines `j` and `j + 1`, which have `n`
/// pieces. Each quad starts at the lower line and is counter-clockwise.
pub(super) fn quads(n: usize, first: usize, mut out: &mut [[u32; 4]], line: impl Fn(usize) -> VertexLine) {
    let (mut j, mut from) = (first / n, first % n);
    while !out.is_empty() {
        let row;
        (row, out) = out.split_at_mut((n - from).min(out.len()));
        // a line is made again for the next row, since a copy would be a wide load from narrow stores
        row_of_quads(&line(j), &line(j + 1), from, row);
        (j, from) = (j + 1, 0);
    }
}

fn row_of_quads(lower: &VertexLine, upper: &VertexLine, from: usize, row: &mut [[u32; 4]]) {
    for (at, part) in (from..).step_by(QUADS_A_LOOP).zip(row.chunks_mut(QUADS_A_LOOP)) {
        evenly_spaced([lower, upper].map(|line| line.between(at)), [lower.step, upper.step], part);
    }
    // the ends of the lines are the only vertices that are not evenly spaced
    let [starts, ends] = [from == 0, from + row.len() == lower.n];
    if starts && let Some(quad) = row.first_mut() {
        (quad[0], quad[3]) = (lower.first, upper.first);
    }
    if ends && let Some(quad) = row.last_mut() {
        (quad[1], quad[2]) = (lower.last, upper.last);
    }
}

/// Fills `out` with quads between two lines of evenly spaced vertices, from the vertices `starts` on.
///
/// The arguments fit into registers. A wide load from memory that narrow stores have just filled would wait until
/// these, and with them all quads of the row before, have left the processor for its cache.
#[multiversion(targets("x86_64+avx512f", "x86_64+avx2"))]
fn evenly_spaced(starts: [u32; 2], steps: [u32; 2], out: &mut [[u32; 4]]) {
    let vertex = |line: usize, i: u32| starts[line].wrapping_add(steps[line].wrapping_mul(i));
    let quad = |i: u32| [vertex(0, i), vertex(0, i + 1), vertex(1, i + 1), vertex(1, i)];
    // four quads at a time, as many as the widest registers hold
    let mut four = [quad(0), quad(1), quad(2), quad(3)];
    let strides = [steps[0], steps[0], steps[1], steps[1]].map(|step| step.wrapping_mul(4));
    let (blocks, rest) = out.as_chunks_mut::<4>();
    for block in blocks {
        *block = four;
        for quad in &mut four {
            quad.iter_mut().zip(strides).for_each(|(vertex, stride)| *vertex = vertex.wrapping_add(stride));
        }
    }
    rest.iter_mut().zip(four).for_each(|(out, quad)| *out = quad);
}

/// Fills `out` with triangles, row by row from triangle `first` of row `row`: row `j` lies between line `j`, which has
/// `n - j` pieces, and the next. Upward and downward triangles alternate.
pub(super) fn triangles(
    n: usize,
    [row, first]: [usize; 2],
    mut out: &mut [[u32; 3]],
    line: impl Fn(usize) -> VertexLine,
) {
    let (mut j, mut from) = (row, first);
    while !out.is_empty() {
        let row;
        (row, out) = out.split_at_mut((2 * (n - j) - 1 - from).min(out.len()));
        row_of_triangles(&line(j), &line(j + 1), from, row);
        (j, from) = (j + 1, 0);
    }
}

fn row_of_triangles(lower: &VertexLine, upper: &VertexLine, from: usize, row: &mut [[u32; 3]]) {
    let triangle = |k: usize| {
        let i = k / 2;
        if k.is_multiple_of(2) {
            [lower.at(i), lower.at(i + 1), upper.at(i)]
        } else {
            [upper.at(i + 1), upper.at(i), lower.at(i + 1)]
        }
    };
    let to = from + row.len();
    // pairs of an upward and a downward triangle without a vertex at an end of a line
    let pairs = from.div_ceil(2).max(1)..(to / 2).min(upper.n.saturating_sub(1));
    if pairs.is_empty() {
        (from..to).zip(row).for_each(|(k, out)| *out = triangle(k));
        return;
    }
    let (before, rest) = row.split_at_mut(2 * pairs.start - from);
    let (between, after) = rest.split_at_mut(2 * pairs.len());
    (from..).zip(before).for_each(|(k, out)| *out = triangle(k));
    (2 * pairs.end..).zip(after).for_each(|(k, out)| *out = triangle(k));
    let [mut a, mut c] = [lower, upper].map(|line| line.between(pairs.start));
    for pair in between.as_chunks_mut().0 {
        let (b, d) = (a.wrapping_add(lower.step), c.wrapping_add(upper.step));
        *pair = [[a, b, c], [d, c, b]];
        (a, c) = (b, d);
    }
}
