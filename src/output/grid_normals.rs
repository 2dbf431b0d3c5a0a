//! Area normals of meshes whose faces form grids: row by row, the coordinates along each axis side by side.

use std::ops::RangeInclusive;

use multiversion::multiversion;
use rayon::prelude::*;

use crate::kept::Kept;
use crate::math::vector::{plus, unit, units};
use crate::output::scene::{MeshSource, ROWS_PER_CHUNK};
use crate::output::vertex_sums::{FACES_PER_PART, PARTS_PER_SUM};
use crate::shape::grid::QuadGrid;
use crate::shape::line::VertexLine;
use crate::watch::{Stopped, Watch};

/// Numbers of pieces of an input edge for which rows are worth it. With half as many they take twice as long as the
/// faces one by one; with more than the most a grid has more faces than a part, and many threads would share few grids.
pub(super) const PIECES: RangeInclusive<usize> = 8..=64;

/// Returns the [`area`](super::normals::area) normals of a mesh of grids, to the same bits; positions are given with
/// their [`scale`](super::normals::scale).
///
/// Vertices inside input faces belong to the faces of one grid. Contributions to other vertices are kept, and added
/// grid after grid.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub(super) fn area(
    mesh: &dyn MeshSource,
    grid: &QuadGrid,
    positions: (&[[f64; 3]], f64),
    watch: &Watch,
) -> Result<Kept<[f64; 3]>, Stopped> {
    let mut normals = Kept::to_overwrite(mesh.n_vertices());
    let (shared, inner) = normals.split_at_mut(grid.first_inner());
    shared.par_chunks_mut(ROWS_PER_CHUNK).for_each(|sums| sums.fill([0.0; 3]));
    let n = grid.pieces();
    let per_grid = (n - 1) * (n - 1);
    let per_part = (FACES_PER_PART / (n * n)).min(inner.len() / per_grid).max(1);
    let n_parts = inner.len().div_ceil(per_part * per_grid).min(PARTS_PER_SUM);
    // corners take a vector each, and other vertices on sides two
    let part = |_| GridRun { given: Vec::with_capacity(per_part * (8 * n - 4)), ..GridRun::default() };
    let mut parts: Vec<GridRun> = (0..n_parts).map(part).collect();
    for (round, inner) in inner.chunks_mut(PARTS_PER_SUM * per_part * per_grid).enumerate() {
        watch.check()?;
        let work = parts.par_iter_mut().zip(inner.par_chunks_mut(per_part * per_grid)).enumerate();
        work.with_max_len(1).for_each(|(i, (part, inner))| {
            let first = (round * PARTS_PER_SUM + i) * per_part;
            for (f, inner) in (first..).zip(inner.chunks_exact_mut(per_grid)) {
                if mesh.faces_of(f).is_empty() {
                    inner.fill([0.0; 3]);
                } else {
                    part.sum(n, grid.lines(f), positions, inner);
                }
            }
        });
        for (v, vector) in parts.iter_mut().flat_map(|part| part.given.drain(..)) {
            let sum = &mut shared[v as usize];
            *sum = plus(*sum, vector);
        }
    }
    let finish = |sums: &mut [[f64; 3]]| sums.iter_mut().for_each(|sum| *sum = unit(*sum));
    shared.par_chunks_mut(ROWS_PER_CHUNK).for_each(finish);
    Ok(normals)
}

/// The coordinates of a row along each axis.
type Coordinates = [Vec<f64>; 3];

/// Consecutive grids, and memory for their rows.
#[derive(Default)]
struct GridRun {
    /// Vertices on sides of the grids with the vectors of their faces, those of each vertex in the order of its faces.
    given: Vec<(u32, [f64; 3])>,
    /// The vertices on the lower and on the upper line of a row of faces.
    lines: [Coordinates; 2],
    /// The vectors of the faces in a row, and of those in the row below.
    vectors: [Coordinates; 2],
    /// The sums at the vertices inside a grid.
    sums: Coordinates,
}

impl GridRun {
    /// Sets the normals inside a grid of `n x n` faces, given by its lines, and keeps what its faces give to the sides.
    fn sum(
        &mut self,
        n: usize,
        line: impl Fn(usize) -> VertexLine,
        (positions, scale): (&[[f64; 3]], f64),
        inner: &mut [[f64; 3]],
    ) {
        self.lines.iter_mut().flatten().for_each(|row| row.resize(n + 1, 0.0));
        self.vectors.iter_mut().flatten().for_each(|row| row.resize(n, 0.0));
        self.sums.iter_mut().for_each(|sums| sums.resize(inner.len(), 0.0));
        let mut lower = line(0);
        read(&lower, (positions, scale), &mut self.lines[1]);
        for j in 0..n {
            let upper = line(j + 1);
            self.lines.swap(0, 1);
            self.vectors.swap(0, 1);
            read(&upper, (positions, scale), &mut self.lines[1]);
            let [lower_row, upper_row] = self.lines.each_ref().map(|line| line.each_ref().map(|row| &row[..]));
            let [x, y, z] = &mut self.vectors[0];
            vectors(lower_row, upper_row, x, y, z);
            self.give(n, j, [&lower, &upper]);
            if let Some(row) = j.checked_sub(1) {
                let [above, below] = &self.vectors;
                for ((sums, below), above) in self.sums.iter_mut().zip(below).zip(above) {
                    around(&mut sums[row * (n - 1)..][..n - 1], below, above);
                }
            }
            lower = upper;
        }
        units(self.sums.each_ref().map(|sums| &sums[..]), inner);
    }

    /// Keeps the vectors of row `j` for the vertices on sides. No face of the input has a vertex twice, so those of
    /// each vertex come in the order of its faces.
    fn give(&mut self, n: usize, j: usize, [lower, upper]: [&VertexLine; 2]) {
        let Self { given, vectors: [[x, y, z], _], .. } = self;
        let vector = |i: usize| [x[i], y[i], z[i]];
        let mut give_line = |line: &VertexLine| {
            for i in 0..n {
                given.extend([i, i + 1].map(|at| (line.at(at), vector(i))));
            }
        };
        if j == 0 {
            give_line(lower);
        }
        if j + 1 == n {
            give_line(upper);
        }
        for (i, at) in [(0, 0), (n - 1, n)] {
            if j > 0 {
                given.push((lower.at(at), vector(i)));
            }
            if j + 1 < n {
                given.push((upper.at(at), vector(i)));
            }
        }
    }
}

/// Sets a row to the positions along a line, multiplied by `scale`.
fn read(line: &VertexLine, (positions, scale): (&[[f64; 3]], f64), row: &mut Coordinates) {
    let [x, y, z] = row.each_mut().map(|row| &mut row[..]);
    let n = x.len() - 1;
    for i in [0, n] {
        let point = positions[line.at(i) as usize];
        [x[i], y[i], z[i]] = [point[0] * scale, point[1] * scale, point[2] * scale];
    }
    let [first, step] = line.between_the_ends();
    let (x, y, z) = (&mut x[1..n], &mut y[1..n], &mut z[1..n]);
    let between = x.iter_mut().zip(y).zip(z);
    if step == 1 {
        let rows = &positions[first as usize..][..n - 1];
        between.zip(rows).for_each(|(((x, y), z), point)| {
            (*x, *y, *z) = (point[0] * scale, point[1] * scale, point[2] * scale);
        });
    } else {
        let mut v = first;
        for ((x, y), z) in between {
            let point = &positions[v as usize];
            (*x, *y, *z) = (point[0] * scale, point[1] * scale, point[2] * scale);
            v = v.wrapping_add(step);
        }
    }
}

/// Sets each vector to twice Newell's area vector of the face between two lines, as
/// [`area_vector`](super::normals::area_vector) does.
#[multiversion(targets("x86_64+avx512f", "x86_64+avx2"))]
fn vectors(lower: [&[f64]; 3], upper: [&[f64]; 3], x: &mut [f64], y: &mut [f64], z: &mut [f64]) {
    let n = x.len();
    let (y, z) = (&mut y[..n], &mut z[..n]);
    let [ax, ay, az] = lower.map(|row| &row[..n]);
    let [bx, by, bz] = lower.map(|row| &row[1..][..n]);
    let [cx, cy, cz] = upper.map(|row| &row[1..][..n]);
    let [dx, dy, dz] = upper.map(|row| &row[..n]);
    for i in 0..n {
        let a = [ax[i], ay[i], az[i]];
        let b = [bx[i] - a[0], by[i] - a[1], bz[i] - a[2]];
        let c = [cx[i] - a[0], cy[i] - a[1], cz[i] - a[2]];
        let d = [dx[i] - a[0], dy[i] - a[1], dz[i] - a[2]];
        // the sum starts from zero, as in `area_vector`
        x[i] = (0.0 + (b[1] * c[2] - b[2] * c[1])) + (c[1] * d[2] - c[2] * d[1]);
        y[i] = (0.0 + (b[2] * c[0] - b[0] * c[2])) + (c[2] * d[0] - c[0] * d[2]);
        z[i] = (0.0 + (b[0] * c[1] - b[1] * c[0])) + (c[0] * d[1] - c[1] * d[0]);
    }
}

/// Sets each sum to that of the four faces around a vertex: two of the row below and two of the row above, in order.
#[multiversion(targets("x86_64+avx512f", "x86_64+avx2"))]
fn around(sums: &mut [f64], below: &[f64], above: &[f64]) {
    let n = sums.len();
    let [left_below, right_below] = [&below[..n], &below[1..][..n]];
    let [left_above, right_above] = [&above[..n], &above[1..][..n]];
    for i in 0..n {
        sums[i] = (((0.0 + left_below[i]) + right_below[i]) + left_above[i]) + right_above[i];
    }
}
