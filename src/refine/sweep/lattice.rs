//! Lattices of quads and of triangles: directions around a point, and places of patches counted from their sides.
//!
//! A triangle lies in a square grid with its corners at `[0, 0]`, `[n, 0]` and `[0, n]`; the diagonals of the cells run
//! from `[i + 1, j]` to `[i, j + 1]`.

use crate::shape::tile::Tile;

/// Directions around a point, counter-clockwise from the first axis on.
const QUADS: [[isize; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
const TRIANGLES: [[isize; 2]; 6] = [[1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1]];

/// The direction of a side of a patch, from the corner of its number to the next one, turned counter-clockwise by so
/// many directions of the lattice, at most one turn back.
fn direction(tile: Tile, side: usize, turn: isize) -> [isize; 2] {
    match tile {
        Tile::Quad => QUADS[(side + 4).wrapping_add_signed(turn) % 4],
        Tile::Triangle => TRIANGLES[(2 * side + 6).wrapping_add_signed(turn) % 6],
    }
}

/// A corner of a patch with `n` pieces.
pub(super) fn corner(tile: Tile, n: usize, corner: usize) -> [isize; 2] {
    let n = n.cast_signed();
    match tile {
        Tile::Quad => [[0, 0], [n, 0], [n, n], [0, n]][corner],
        Tile::Triangle => [[0, 0], [n, 0], [0, n]][corner],
    }
}

/// A corner of a patch and the two sides of a face around it, as places are counted from there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    corner: [isize; 2],
    sides: [[isize; 2]; 2],
}

impl Frame {
    /// At a corner of a patch with `n` pieces: of the patch itself, or of the face so many turns farther
    /// counter-clockwise around the corner.
    pub(super) fn new(tile: Tile, n: usize, at: usize, turn: isize) -> Self {
        Self { corner: corner(tile, n, at), sides: [turn, turn + 1].map(|turn| direction(tile, at, turn)) }
    }

    /// The corner.
    pub(super) fn corner(&self) -> [isize; 2] {
        self.corner
    }

    /// The direction of the side from the corner.
    pub(super) fn along(&self) -> [isize; 2] {
        self.sides[0]
    }

    /// Steps along the side from the corner and along the side before it, seen from the corner, that lead to a place.
    pub(super) fn seen(&self, place: [isize; 2]) -> [isize; 2] {
        let [x, y] = std::array::from_fn(|k| place[k] - self.corner[k]);
        // the two sides span the lattice, counter-clockwise: their determinant is 1
        let [a, b] = self.sides;
        [x * b[1] - y * b[0], a[0] * y - a[1] * x]
    }

    /// The place `a` steps along the side from the corner and `b` steps along the side before it, seen from the corner.
    pub(super) fn place(&self, [a, b]: [isize; 2]) -> [isize; 2] {
        std::array::from_fn(|k| self.corner[k] + a * self.sides[0][k] + b * self.sides[1][k])
    }
}

/// The places `[a, b]` of a face around one of its corners, without those on the edge towards the next face: `a` steps
/// along the first edge, 1 to `reach`, and `b` along the other, as far as the face reaches with `reach` pieces.
pub(super) fn sector(tile: Tile, reach: usize) -> impl Iterator<Item = [usize; 2]> {
    (1..=reach).flat_map(move |a| (0..=last(tile, reach, a)).map(move |b| [a, b]))
}

/// The last row that the column `a` of a face with `n` pieces reaches.
pub(super) fn last(tile: Tile, n: usize, a: usize) -> usize {
    match tile {
        Tile::Quad => n,
        Tile::Triangle => n - a,
    }
}

/// How far around a vertex points are kept apart where the `halo` cells beside a patch are known. On the lattice of
/// triangles a point in the halo, beside the next face, may be `halo` steps from a face beyond that one though it is
/// farther than that from the vertex.
pub(super) fn reach(tile: Tile, halo: usize) -> usize {
    match tile {
        Tile::Quad => halo,
        Tile::Triangle => 2 * halo - 1,
    }
}

/// Whether a place lies within a patch of `n` pieces or at most `beyond` steps outside.
pub(super) fn is_within(tile: Tile, n: isize, beyond: isize, [i, j]: [isize; 2]) -> bool {
    let near = |x: isize| (-beyond..=n + beyond).contains(&x);
    near(i) && near(j) && (tile == Tile::Quad || near(i + j))
}

/// The axis that a side of a patch runs along, up or down.
pub(super) fn axis(tile: Tile, side: usize) -> usize {
    match tile {
        Tile::Quad => side % 2,
        Tile::Triangle => [0, 2, 1][side],
    }
}

/// Directions along the axes on which sides of patches lie; on the third one only those of triangles.
pub(super) const AXES: [[isize; 2]; 3] = [[1, 0], [0, 1], [-1, 1]];

/// The plane and the cell of a place on the refined grid.
pub(super) fn cell([i, j]: [isize; 2]) -> (usize, [isize; 2]) {
    (((i & 1) + 2 * (j & 1)).unsigned_abs(), [i.div_euclid(2), j.div_euclid(2)])
}

/// The place on the refined grid of the point of a plane at a cell.
pub(super) fn fine(plane: usize, cell: [isize; 2]) -> [isize; 2] {
    std::array::from_fn(|axis| 2 * cell[axis] + (plane >> axis & 1).cast_signed())
}

/// The point after the vertex at a cell along an axis: its plane and cell.
pub(super) fn after(axis: usize, vertex: [isize; 2]) -> (usize, [isize; 2]) {
    cell(std::array::from_fn(|k| 2 * vertex[k] + AXES[axis][k]))
}
