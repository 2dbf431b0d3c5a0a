//! One face split `d x d`: its cells, inner points and inner edges, by arithmetic alone.
//!
//! A place is `[i, j]`: `i` steps from corner 0 towards corner 1 and `j` steps towards the last corner; of a quad
//! `0 <= i, j <= d`, of a triangle `i + j <= d`. Rows are those of equal `j`. A triangle's row holds upward cells
//! (`[i, j]`, `[i + 1, j]`, `[i, j + 1]`) and between them downward ones (`[i + 1, j + 1]`, `[i, j + 1]`,
//! `[i + 1, j]`), from left to right. Cells are counter-clockwise like their face.

/// How the faces of a mesh are split.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tile {
    /// Quads into `d x d` quads.
    #[default]
    Quad,
    /// Triangles into `d x d` triangles.
    Triangle,
}

/// A cell of a face: its lower left corner, and whether it is a downward triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Cell {
    at: [usize; 2],
    down: bool,
}

impl Cell {
    /// Returns the cell whose corner 0 is an inner place.
    pub(super) const fn at(at: [usize; 2]) -> Self {
        Self { at, down: false }
    }
}

/// The position of a place in a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TilePosition {
    /// At this corner of the face.
    Corner(u32),
    /// On the side from this corner to the next, this many steps from the corner.
    Side(u32, usize),
    /// Inside, with its index row by row.
    Inside(usize),
}

/// The kind of a side of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CellSide {
    /// A piece, counted from 0, of the side that starts at this corner of the face.
    Outer(u32, usize),
    /// An edge inside the face.
    Inner(usize),
}

/// Rows of `n, n - 1, ..., 1` entries, numbered from 0.
#[derive(Debug, Clone, Copy)]
struct Stairs(usize);

impl Stairs {
    const fn len(self) -> usize {
        self.0 * (self.0 + 1) / 2
    }

    /// Returns the index of the first entry of a row.
    const fn first(self, row: usize) -> usize {
        row * (2 * self.0 + 1 - row) / 2
    }

    /// Returns column and row of an entry.
    const fn find(self, number: usize) -> [usize; 2] {
        // counted from the end, the last s rows hold s (s + 1) / 2 entries
        let left = self.len() - number;
        let row = self.0 - (8 * left - 7).isqrt().div_ceil(2);
        [number - self.first(row), row]
    }
}

impl Tile {
    /// Number of sides of a face.
    pub const fn sides(self) -> u32 {
        match self {
            Self::Quad => 4,
            Self::Triangle => 3,
        }
    }

    /// The valence of an interior vertex of a regular mesh.
    pub const fn regular_valence(self) -> usize {
        match self {
            Self::Quad => 4,
            Self::Triangle => 6,
        }
    }

    /// Number of points inside a face.
    pub const fn inner_vertices(self, d: usize) -> usize {
        match self {
            Self::Quad => (d - 1) * (d - 1),
            Self::Triangle => (d - 1) * (d - 1).saturating_sub(1) / 2,
        }
    }

    /// Number of edges inside a face.
    pub const fn inner_edges(self, d: usize) -> usize {
        match self {
            Self::Quad => 2 * d * (d - 1),
            Self::Triangle => 3 * Stairs(d - 1).len(),
        }
    }

    /// Returns the cell with this index, row by row.
    pub(super) const fn cell(self, d: usize, number: usize) -> Cell {
        match self {
            Self::Quad => Cell { at: [number % d, number / d], down: false },
            Self::Triangle => {
                let [row, along] = self.row(d, number);
                Cell { at: [along / 2, row], down: along % 2 == 1 }
            }
        }
    }

    /// Returns the row of the cell with this index, and its position in the row.
    pub(super) const fn row(self, d: usize, number: usize) -> [usize; 2] {
        match self {
            Self::Quad => [number / d, number % d],
            Self::Triangle => {
                // the rows from the top hold 1, 4, 9, ... cells in all
                let row = d - (d * d - number - 1).isqrt() - 1;
                [row, number - (d * d - (d - row) * (d - row))]
            }
        }
    }

    /// Returns the index of a cell, row by row.
    pub(super) const fn number(self, d: usize, cell: Cell) -> usize {
        let [i, j] = cell.at;
        match self {
            Self::Quad => j * d + i,
            Self::Triangle => d * d - (d - j) * (d - j) + 2 * i + cell.down as usize,
        }
    }

    /// Returns the corners of a cell; for a triangle, only the first three are used.
    pub(super) const fn corners(self, cell: Cell) -> [[usize; 2]; 4] {
        let [i, j] = cell.at;
        match (self, cell.down) {
            (Self::Quad, _) => [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]],
            (Self::Triangle, false) => [[i, j], [i + 1, j], [i, j + 1], [i, j]],
            (Self::Triangle, true) => [[i + 1, j + 1], [i, j + 1], [i + 1, j], [i + 1, j + 1]],
        }
    }

    /// Returns the position of a place in the face.
    pub(super) const fn place(self, d: usize, [i, j]: [usize; 2]) -> TilePosition {
        match self {
            Self::Quad => match (i, j) {
                (0, 0) => TilePosition::Corner(0),
                (i, 0) if i == d => TilePosition::Corner(1),
                (i, j) if i == d && j == d => TilePosition::Corner(2),
                (0, j) if j == d => TilePosition::Corner(3),
                (i, 0) => TilePosition::Side(0, i),
                (i, j) if i == d => TilePosition::Side(1, j),
                (i, j) if j == d => TilePosition::Side(2, d - i),
                (0, j) => TilePosition::Side(3, d - j),
                _ => TilePosition::Inside((j - 1) * (d - 1) + i - 1),
            },
            Self::Triangle => match (i, j) {
                (0, 0) => TilePosition::Corner(0),
                (i, 0) if i == d => TilePosition::Corner(1),
                (0, j) if j == d => TilePosition::Corner(2),
                (i, 0) => TilePosition::Side(0, i),
                (i, j) if i + j == d => TilePosition::Side(1, j),
                (0, j) => TilePosition::Side(2, d - j),
                _ => TilePosition::Inside(Stairs(d - 2).first(j - 1) + i - 1),
            },
        }
    }

    /// Returns the place of the inner point with this index.
    pub const fn inside(self, d: usize, number: usize) -> [usize; 2] {
        match self {
            Self::Quad => [number % (d - 1) + 1, number / (d - 1) + 1],
            Self::Triangle => {
                let [i, j] = Stairs(d - 2).find(number);
                [i + 1, j + 1]
            }
        }
    }

    /// Returns the place that is `at` steps along the side from a corner to the next.
    pub(super) const fn along(self, d: usize, side: u32, at: usize) -> [usize; 2] {
        match (self, side) {
            (_, 0) => [at, 0],
            (Self::Quad, 1) => [d, at],
            (Self::Quad, 2) => [d - at, d],
            (Self::Triangle, 1) => [d - at, at],
            (Self::Quad | Self::Triangle, _) => [0, d - at],
        }
    }

    /// Returns the cell at a piece of a side; the piece is the cell's side of the same index.
    pub(super) const fn at_side(self, d: usize, side: u32, piece: usize) -> Cell {
        let at = match (self, side) {
            (_, 0) => [piece, 0],
            (Self::Quad, 1) => [d - 1, piece],
            (Self::Quad, 2) => [d - 1 - piece, d - 1],
            (Self::Triangle, 1) => [d - 1 - piece, piece],
            (Self::Quad | Self::Triangle, _) => [0, d - 1 - piece],
        };
        Cell { at, down: false }
    }

    /// Returns what side `side` of a cell is. Inside a triangle every edge belongs to one downward cell.
    pub(super) fn side(self, d: usize, cell: Cell, side: u32) -> CellSide {
        let [i, j] = cell.at;
        match self {
            Self::Quad => match side {
                0 if j == 0 => CellSide::Outer(0, i),
                1 if i == d - 1 => CellSide::Outer(1, j),
                2 if j == d - 1 => CellSide::Outer(2, d - 1 - i),
                3 if i == 0 => CellSide::Outer(3, d - 1 - j),
                0 => CellSide::Inner((j - 1) * d + i),
                2 => CellSide::Inner(j * d + i),
                1 => CellSide::Inner(d * (d - 1) + i * d + j),
                _ => CellSide::Inner(d * (d - 1) + (i - 1) * d + j),
            },
            Self::Triangle => {
                let inner =
                    |i: usize, j: usize, side: u32| CellSide::Inner(3 * (Stairs(d - 1).first(j) + i) + side as usize);
                match (cell.down, side) {
                    (true, side) => inner(i, j, side),
                    (_, 0) if j == 0 => CellSide::Outer(0, i),
                    (_, 1) if i + j == d - 1 => CellSide::Outer(1, j),
                    (_, 2) if i == 0 => CellSide::Outer(2, d - 1 - j),
                    (_, 0) => inner(i, j - 1, 0),
                    (_, 1) => inner(i, j, 1),
                    _ => inner(i - 1, j, 2),
                }
            }
        }
    }

    /// Returns the two cells at an inner edge, with the sides that the edge is; it runs in the direction of the first.
    pub(super) fn at_edge(self, d: usize, edge: usize) -> [(Cell, u32); 2] {
        let up = |i: usize, j: usize| Cell { at: [i, j], down: false };
        match self {
            Self::Quad => {
                let n = d * (d - 1);
                if edge < n {
                    let [i, j] = [edge % d, edge / d];
                    [(up(i, j + 1), 0), (up(i, j), 2)]
                } else {
                    let [i, j] = [(edge - n) / d, (edge - n) % d];
                    [(up(i, j), 1), (up(i + 1, j), 3)]
                }
            }
            Self::Triangle => {
                let [i, j] = Stairs(d - 1).find(edge / 3);
                let down = Cell { at: [i, j], down: true };
                match edge % 3 {
                    0 => [(down, 0), (up(i, j + 1), 0)],
                    1 => [(down, 1), (up(i, j), 1)],
                    _ => [(down, 2), (up(i + 1, j), 2)],
                }
            }
        }
    }

    /// Returns a cell that contains the place, and the place relative to it; a face has `cells` cells of `step` steps
    /// per side.
    pub(super) const fn enter(self, cells: usize, step: usize, [i, j]: [usize; 2]) -> (Cell, [usize; 2]) {
        let [a, b] = [i / step, j / step];
        match self {
            Self::Quad => {
                let a = if a == cells { a - 1 } else { a };
                let b = if b == cells { b - 1 } else { b };
                (Cell { at: [a, b], down: false }, [i - a * step, j - b * step])
            }
            Self::Triangle => {
                let [x, y] = [i % step, j % step];
                if a + b == cells {
                    // a corner of cells on the side from corner 1 to corner 2
                    let (at, place) = if a > 0 { ([a - 1, b], [step, 0]) } else { ([a, b - 1], [0, step]) };
                    (Cell { at, down: false }, place)
                } else if x + y <= step {
                    (Cell { at: [a, b], down: false }, [x, y])
                } else {
                    (Cell { at: [a, b], down: true }, [step - x, step - y])
                }
            }
        }
    }
}
