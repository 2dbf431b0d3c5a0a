//! Control nets of bicubic faces.

use super::level::{Level, Sharpened};
use crate::math::vector::{Vector, minus, plus, times};

/// Points of a uniform bicubic B-spline, or of its Bezier form: `net[i][j]`, `i` along u, `j` along v.
pub(super) type BicubicNet = [[Vector; 4]; 4];

type Partial = [[Option<Vector>; 4]; 4];

/// The corners of the face in its net, counter-clockwise.
const CORNERS: [[usize; 2]; 4] = [[1, 1], [2, 1], [2, 2], [1, 2]];
/// For each side the direction outwards, and that along it.
const OUTWARD_DIRECTIONS: [[isize; 2]; 4] = [[0, -1], [1, 0], [0, 1], [-1, 0]];
const SIDE_DIRECTIONS: [[isize; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];

fn moved(at: [usize; 2], by: [isize; 2], times: isize) -> Option<[usize; 2]> {
    let [i, j] = [0, 1].map(|k| at[k].checked_add_signed(by[k] * times).filter(|&i| i < 4));
    Some([i?, j?])
}

/// Returns the Bezier points over a cell of a uniform cubic B-spline: `B = C G C^T`.
pub(super) fn bezier(net: &BicubicNet) -> BicubicNet {
    let across: BicubicNet = std::array::from_fn(|i| row(net[i]));
    let columns: BicubicNet = std::array::from_fn(|j| row(std::array::from_fn(|i| across[i][j])));
    std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]))
}

fn row([a, b, c, d]: [Vector; 4]) -> [Vector; 4] {
    let sixth = |[x, y, z]: [Vector; 3], [p, q, r]: [f64; 3]| {
        times(1.0 / 6.0, plus(plus(times(p, x), times(q, y)), times(r, z)))
    };
    let third = |x, y| times(1.0 / 3.0, plus(times(2.0, x), y));
    [sixth([a, b, c], [1.0, 4.0, 1.0]), third(b, c), third(c, b), sixth([b, c, d], [1.0, 4.0, 1.0])]
}

impl Level {
    /// Returns the control net of the face of a half-edge, whose start is the corner (0, 0) and whose side lies along
    /// u. Across infinitely sharp sides lie phantom points, `2 side - inside`. At the first corner, the point outside
    /// both sides is arbitrary if the corner is extraordinary.
    pub(super) fn net(&self, half_edge: u32) -> BicubicNet {
        let mut net = Partial::default();
        let sides: [u32; 4] = std::array::from_fn(|s| self.after(half_edge, s));
        let open = sides.map(|side| self.edge_sharpened(self.topology.edge(side)) == Sharpened::Ever);
        for s in 0..4 {
            let [i, j] = CORNERS[s];
            net[i][j] = Some(self.start(sides[s]));
        }
        for s in (0..4).filter(|&s| !open[s]) {
            let twin = self.topology.twin(sides[s]);
            let mut put = |corner: usize, n: usize| {
                if let Some([i, j]) = moved(CORNERS[corner], OUTWARD_DIRECTIONS[s], 1) {
                    net[i][j] = Some(self.start(self.after(twin, n)));
                }
            };
            put(s, 2);
            put((s + 1) % 4, 3);
        }
        for s in 0..4 {
            let before = (s + 3) % 4;
            if !open[s] && !open[before] {
                self.put_diagonal(sides[s], s, &mut net);
            }
        }
        extend(open, &mut net);
        net.map(|row| row.map(Option::unwrap_or_default))
    }

    /// Sets the point outside both sides at corner `s`, across the side that begins there and the next edge of the
    /// vertex.
    fn put_diagonal(&self, side: u32, s: usize, net: &mut Partial) {
        let across = self.topology.next(self.topology.twin(side));
        if self.edge_sharpened(self.topology.edge(across)) == Sharpened::Ever {
            return;
        }
        let outside = self.start(self.after(self.topology.twin(across), 3));
        let at =
            moved(CORNERS[s], OUTWARD_DIRECTIONS[s], 1).and_then(|at| moved(at, OUTWARD_DIRECTIONS[(s + 3) % 4], 1));
        if let Some([i, j]) = at {
            net[i][j] = Some(outside);
        }
    }
}

/// Sets phantom points across open sides, then those at corners between two of them.
fn extend(open: [bool; 4], net: &mut Partial) {
    let mut reflect = |side: [usize; 2], outwards: [isize; 2]| {
        let (Some([a, b]), Some([c, d])) = (moved(side, outwards, -1), moved(side, outwards, 1)) else { return };
        if let (Some(on), Some(inside)) = (net[side[0]][side[1]], net[a][b]) {
            net[c][d] = Some(minus(times(2.0, on), inside));
        }
    };
    for s in (0..4).filter(|&s| open[s]) {
        let places = (-1..3).filter_map(|k| moved(CORNERS[s], SIDE_DIRECTIONS[s], k));
        places.for_each(|place| reflect(place, OUTWARD_DIRECTIONS[s]));
    }
    for s in (0..4).filter(|&s| open[s] && open[(s + 3) % 4]) {
        if let Some(beside) = moved(CORNERS[s], OUTWARD_DIRECTIONS[(s + 3) % 4], 1) {
            reflect(beside, OUTWARD_DIRECTIONS[s]);
        }
    }
}
