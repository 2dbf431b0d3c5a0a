//! What is known of all caps of one valence before any is made: how the plane cap runs under the leaves of each ring,
//! and how much it is stretched.

use super::bezier::{Net, restriction};
use super::characteristic::{decay, turned};
use super::composed::{Composed, Path, TERMS, part_of_cubic, raised_whole};
use super::join::Patch;
use super::rings::{LEAVES, Rings};
use super::samples::{foot, in_sector};
use crate::math::functions::{cos, ratio, real, sin, sqrt};
use crate::math::vector::{minus, plus, times};

/// A cell of a leaf of one ring, in all sectors alike.
#[derive(Debug)]
pub(super) struct Cell {
    /// Which of the three leaves of the ring.
    pub(super) leaf: usize,
    /// The weights that lead from a leaf's coefficients to those of the cell, of degree 5, along both directions.
    pub(super) part: [[[f64; 4]; 6]; 2],
    /// Patches along the path of foot points of this cell.
    pub(super) composed: Composed,
    /// How far in parameters the path is from the true foot points, at most.
    pub(super) off: f64,
}

/// Facts of one valence that hold for all its caps.
#[derive(Debug)]
pub(super) struct Proof {
    /// Cells of each ring, the outermost first.
    pub(super) rings: Vec<Vec<Cell>>,
    /// Foot points of what is inside all rings have parameters of at most so much.
    pub(super) inside: f64,
}

/// What is inside the rings that are looked at one by one has shrunk to this part, at most. It is bounded by the hulls
/// of its nets alone, which is up to a thousand times too much. At twice of it that outweighs the rings of valence 5;
/// half takes one ring more. Around regular vertices nothing else is left.
fn shrunk(n: usize) -> f64 {
    if n == 4 { 1e-10 } else { 1.5e-4 }
}

/// Rings of leaves that are looked at one by one.
pub(super) fn n_rings(n: usize) -> usize {
    let (mut rings, mut left) = (1, decay(n));
    while left > shrunk(n) {
        left *= decay(n);
        rings += 1;
    }
    rings
}

/// Cells along each side of a leaf of a ring, 1 for the outermost. Paths of foot points are off by the cube of a cell's
/// size, which caps of valence 3 feel most, since they are nearest to their surfaces. With these numbers bounds are at
/// most 2.2 times what samples find for valence 3 and 1.5 times beyond; one less makes them 3.5 times and twice.
pub(super) fn n_cells(n: usize, ring: usize) -> usize {
    match (n, ring) {
        (3, 1..=2) => 6,
        (3, 3) => 4,
        (3, 4) | (5.., 1..=2) => 3,
        (3, _) | (5.., 3..=5) => 2,
        _ => 1,
    }
}

impl Proof {
    /// The facts of a valence; `None` if the plane cap cannot be shown to be one-to-one.
    pub(super) fn of(characteristic: &Rings<2>, plane: &Patch<2>) -> Option<Self> {
        let n = characteristic.valence();
        let stretch = least_stretch(plane, n);
        if stretch <= 0.0 {
            return None;
        }
        let points: Vec<[f64; 2]> = plane.0.into_iter().flatten().collect();
        let points: [[f64; 2]; TERMS] = std::array::from_fn(|k| points[k]);
        let mut net = characteristic.clone();
        let (mut rings, mut inside) = (Vec::new(), 0.0_f64);
        for ring in 1..=n_rings(n) {
            net = net.refined();
            inside = 0.0;
            let mut cells = Vec::new();
            for (leaf, lower) in LEAVES.into_iter().enumerate() {
                let surface = net.leaf(0, lower);
                let n_cells = n_cells(n, ring);
                for at in (0..n_cells * n_cells).map(|k| [k / n_cells, k % n_cells]) {
                    let sides = at.map(|i| [ratio(i, n_cells), ratio(i + 1, n_cells)]);
                    let path = path(plane, &surface, |x| in_sector(ring, lower, x), sides);
                    let cell = Cell::of(leaf, &surface, sides, &path, &points, stretch);
                    inside = inner_side(leaf, at, &path).into_iter().fold(inside, |most, x| most.max(x + cell.off));
                    cells.push(cell);
                }
            }
            rings.push(cells);
        }
        Some(Self { rings, inside: inside.min(1.0) })
    }
}

impl Cell {
    /// The cell of a leaf of the characteristic surface between the given sides, with its path of foot points.
    fn of(
        leaf: usize,
        surface: &Net<2, 4>,
        sides: [[f64; 2]; 2],
        path: &Path,
        plane: &[[f64; 2]; TERMS],
        stretch: f64,
    ) -> Self {
        let composed = Composed::along(path);
        let part = sides.map(part_of_cubic);
        let target = surface.mapped(&part[0], &part[1]);
        let target = [0, 1].map(|d| {
            let flat: Vec<f64> = target.0.iter().flatten().map(|point| point[d]).collect();
            raised_whole(5, &flat)
        });
        let off = (composed.distance(&target, plane) + ROUNDING) / stretch;
        Self { leaf, part, composed: composed.without_exact(), off }
    }
}

/// More than all roundings of a plane distance: its coefficients are below 4, and each passes through fewer than 2000
/// roundings of 2^-53, the products of [`Composed`] included.
const ROUNDING: f64 = 1e-12;

/// Coefficients of the path of foot points under a part of a leaf: it goes through nine of them, and is kept in the
/// square.
fn path(
    plane: &Patch<2>,
    surface: &Net<2, 4>,
    start: impl Fn([f64; 2]) -> [f64; 2],
    [along, across]: [[f64; 2]; 2],
) -> Path {
    let between = |[a, b]: [f64; 2], k: usize| a + (b - a) * real(k) / 2.0;
    let feet: [[[f64; 2]; 3]; 3] = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let x = [between(along, i), between(across, j)];
            foot(plane, surface.at(x), start(x))
        })
    });
    let through = |[a, b, c]: [f64; 3]| [a, 2.0 * b - 0.5 * (a + c), c];
    [0, 1].map(|d| {
        let rows = feet.map(|row| through(row.map(|foot| foot[d])));
        let columns: [[f64; 3]; 3] = std::array::from_fn(|j| through(rows.map(|row| row[j])));
        std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i].clamp(0.0, 1.0)))
    })
}

/// Coefficients of a path along the part of a cell's boundary that is the boundary of what is further inside.
fn inner_side(leaf: usize, [i, j]: [usize; 2], path: &Path) -> Vec<f64> {
    let coefficients = |side: &dyn Fn(usize) -> [usize; 2]| {
        let points = (0..3).map(side);
        points.flat_map(|[a, b]| [path[0][a][b], path[1][a][b]]).collect()
    };
    match (leaf, i, j) {
        (0, 0, _) => coefficients(&|k| [0, k]),
        (1, _, 0) => coefficients(&|k| [k, 0]),
        _ => Vec::new(),
    }
}

/// Parts along each side of the domain on which the stretch is bounded.
const PARTS: usize = 8;

/// A number s such that the images of any two parameters under the plane cap of one sector are at least s times as far
/// apart as they are: the least eigenvalue of the symmetric part of its derivative, turned so that the sector's middle
/// is the diagonal of the square, at any coefficient of its parts. It is concave, so that coefficients bound it between
/// them, and on a convex domain it bounds the quotient: `(a - b) (X(a) - X(b)) = integral of (a - b) DX (a - b)`.
fn least_stretch(plane: &Patch<2>, n: usize) -> f64 {
    let angle = std::f64::consts::PI * (0.25 - ratio(1, n));
    let turn = [cos(angle), sin(angle)];
    let turned = Net(plane.0.map(|row| row.map(|point| turned(turn, point))));
    let (by_u, by_v) = (slopes(&turned), slopes(&turned.transposed()).transposed());
    let mut least = f64::INFINITY;
    for i in 0..PARTS {
        for j in 0..PARTS {
            let [along, across] = [i, j].map(|i| restriction::<6>([ratio(i, PARTS), ratio(i + 1, PARTS)]));
            let (u, v) = (by_u.mapped(&along, &across), by_v.mapped(&along, &across));
            for (u, v) in u.0.iter().flatten().zip(v.0.iter().flatten()) {
                let (sum, difference, off) = (u[0] + v[1], u[0] - v[1], v[0] + u[1]);
                least = least.min((sum - sqrt(difference * difference + off * off)) / 2.0);
            }
        }
    }
    least - ROUNDING
}

/// The derivative along the first direction, in degree 5.
fn slopes(net: &Patch<2>) -> Patch<2> {
    let step = |i: usize, j: usize| minus(net.0[i + 1][j], net.0[i][j]);
    Net(std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            // of degree 4 and raised: coefficient i is i/5 of the one before, and the rest of its own
            let before = if i > 0 { times(real(i), step(i - 1, j)) } else { [0.0; 2] };
            let own = if i < 5 { times(real(5 - i), step(i, j)) } else { [0.0; 2] };
            plus(before, own)
        })
    }))
}
