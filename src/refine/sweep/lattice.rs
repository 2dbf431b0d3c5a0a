//! Lattices of quads and of triangles: the directions around a point, and coordinates relative to the sides of a
//! patch.
//!
//! A triangle lies in a square grid with its corners at `[0, 0]`, `[n, 0]` and `[0, n]`; the diagonals of the cells run
//! from `[i + 1, j]` to `[i, j + 1]`.

use crate::shape::tile::Tile;

/// The directions around a point, counter-clockwise from the first axis.
const QUADS: [[isize; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
const TRIANGLES: [[isize; 2]; 6] = [[1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1]];

/// Returns the direction of a side of a patch, from its start to its end, rotated counter-clockwise by `turn`
/// directions of the lattice; `turn` is at least -1.
#[inline]
fn direction(tile: Tile, side: usize, turn: isize) -> [isize; 2] {
    match tile {
        Tile::Quad => QUADS[(side + 4).wrapping_add_signed(turn) % 4],
        Tile::Triangle => TRIANGLES[(2 * side + 6).wrapping_add_signed(turn) % 6],
    }
}

/// The corners of a patch with one piece per side. Those of a triangle are the same but for the third.
const CORNERS: [[isize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

/// Returns the place of a corner of a patch with `n` pieces per side.
#[inline]
pub(super) fn corner(tile: Tile, n: usize, corner: usize) -> [isize; 2] {
    let [i, j] = match tile {
        Tile::Quad => CORNERS[corner],
        Tile::Triangle => [CORNERS[0], CORNERS[1], CORNERS[3]][corner],
    };
    [n.cast_signed() * i, n.cast_signed() * j]
}

/// A local coordinate frame at a corner of a patch: the corner, and the two sides of a face there.
#[derive(Debug, Clone, Copy)]
pub(super) struct CornerFrame {
    corner: [isize; 2],
    sides: [[isize; 2]; 2],
}

impl CornerFrame {
    /// Creates the frame at a corner of a patch with `n` pieces per side, for the face that is `turn` faces
    /// counter-clockwise around the corner from the patch itself.
    #[inline]
    pub(super) fn new(tile: Tile, n: usize, at: usize, turn: isize) -> Self {
        Self { corner: corner(tile, n, at), sides: [turn, turn + 1].map(|turn| direction(tile, at, turn)) }
    }

    /// Returns the corner, the origin of the frame.
    pub(super) fn corner(&self) -> [isize; 2] {
        self.corner
    }

    /// Returns the direction of the side that starts at the corner.
    pub(super) fn along(&self) -> [isize; 2] {
        self.sides[0]
    }

    /// Returns the coordinates of a place in the frame: steps along the side from the corner, and along the side
    /// before it.
    pub(super) fn seen(&self, place: [isize; 2]) -> [isize; 2] {
        let [x, y] = std::array::from_fn(|k| place[k] - self.corner[k]);
        // the two sides span the lattice counter-clockwise, so their determinant is 1
        let [a, b] = self.sides;
        [x * b[1] - y * b[0], a[0] * y - a[1] * x]
    }

    /// Returns the place `a` steps along the side from the corner and `b` steps along the side before it.
    #[inline]
    pub(super) fn place(&self, [a, b]: [isize; 2]) -> [isize; 2] {
        std::array::from_fn(|k| self.corner[k] + a * self.sides[0][k] + b * self.sides[1][k])
    }
}

/// Returns the places `[a, b]` of a face around one of its corners, without those on the edge to the next face: `a`
/// steps along the first edge, from 1 to `reach`, and `b` along the other, within a face of `reach` pieces.
pub(super) fn sector(tile: Tile, reach: usize) -> impl Iterator<Item = [usize; 2]> {
    (1..=reach).flat_map(move |a| (0..=last(tile, reach, a)).map(move |b| [a, b]))
}

/// Returns the last row of column `a` of a face with `n` pieces per side.
pub(super) fn last(tile: Tile, n: usize, a: usize) -> usize {
    match tile {
        Tile::Quad => n,
        Tile::Triangle => n - a,
    }
}

/// Returns how many cells around a vertex a star must have if the `halo` cells next to a patch are known. On the
/// lattice of triangles, a point in the halo, next to the adjacent face, may be `halo` steps from the face beyond that
/// one and thus farther from the vertex.
pub(super) fn reach(tile: Tile, halo: usize) -> usize {
    match tile {
        Tile::Quad => halo,
        Tile::Triangle => 2 * halo - 1,
    }
}

/// Returns whether a place lies within a patch of `n` pieces or at most `beyond` steps outside.
pub(super) fn is_within(tile: Tile, n: isize, beyond: isize, [i, j]: [isize; 2]) -> bool {
    let near = |x: isize| (-beyond..=n + beyond).contains(&x);
    near(i) && near(j) && (tile == Tile::Quad || near(i + j))
}

/// Returns the axis along which a side of a patch runs, forwards or backwards.
pub(super) fn axis(tile: Tile, side: usize) -> usize {
    match tile {
        Tile::Quad => side % 2,
        Tile::Triangle => [0, 2, 1][side],
    }
}

/// The directions of the axes along which sides of patches run; only triangles have sides along the third one.
pub(super) const LATTICE_AXES: [[isize; 2]; 3] = [[1, 0], [0, 1], [-1, 1]];

/// Returns the plane and the cell of a place on the refined grid.
#[inline]
pub(super) fn cell([i, j]: [isize; 2]) -> (usize, [isize; 2]) {
    (((i & 1) + 2 * (j & 1)).unsigned_abs(), [i.div_euclid(2), j.div_euclid(2)])
}

/// Returns the place on the refined grid of the point of a plane at a cell.
pub(super) fn fine(plane: usize, cell: [isize; 2]) -> [isize; 2] {
    std::array::from_fn(|axis| 2 * cell[axis] + (plane >> axis & 1).cast_signed())
}

/// Returns the plane and the cell of the point that follows the vertex at a cell along an axis.
pub(super) fn after(axis: usize, vertex: [isize; 2]) -> (usize, [isize; 2]) {
    cell(std::array::from_fn(|k| 2 * vertex[k] + LATTICE_AXES[axis][k]))
}
