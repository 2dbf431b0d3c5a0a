//! Bezier pieces of the limit surface, and how near a point comes to one.
//!
//! A piece is compared with the parallelogram of its mean derivatives: no point of it is farther from that than its
//! control points are from those of the parallelogram. So pieces that are too far away are ruled out, and others are
//! quartered until they are, or until the squared distance is known to be convex on them, where Newton's method finds
//! its one minimum.

use crate::math::functions::sqrt;
use crate::math::vector::{Vector, dot, length, minus, plus, square_from_triangle, times};
use crate::solid::net::BicubicNet;

/// A bicubic Bezier piece over a square in the parameters of a face.
#[derive(Debug, Clone)]
pub(super) struct BezierPatch {
    /// Its control points, in model units.
    pub(super) net: BicubicNet,
    /// The parameters of its first corner, and the side length of its square.
    pub(super) from: [f64; 2],
    pub(super) size: f64,
}

/// The nearest place of a piece.
#[derive(Debug, Clone, Copy)]
pub(super) struct NearestPlace {
    pub(super) uv: [f64; 2],
    pub(super) at: Vector,
    pub(super) distance: f64,
    /// Whether it is a minimum to within rounding errors.
    pub(super) is_settled: bool,
}

/// Returns the Bernstein polynomials of degree 3 with their first and second derivatives.
fn basis(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    [
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t],
        [6.0 * s, 6.0 * (t - 2.0 * s), 6.0 * (s - 2.0 * t), 6.0 * t],
    ]
}

fn weighted(weights: [f64; 4], points: [Vector; 4]) -> Vector {
    (0..4).fold([0.0; 3], |sum, i| plus(sum, times(weights[i], points[i])))
}

/// Half the squared distance from a point, with its gradient and its second derivatives (uu, uv, vv).
struct Slope {
    at: Vector,
    square: f64,
    gradient: [f64; 2],
    second: [f64; 3],
    /// The squared lengths of the tangents.
    lengths: [f64; 2],
}

impl BezierPatch {
    fn slope(&self, [u, v]: [f64; 2], point: Vector) -> Slope {
        let (along_u, along_v) = (basis(u), basis(v));
        let columns = along_v.map(|weights| self.net.map(|row| weighted(weights, row)));
        let value = |i: usize, j: usize| weighted(along_u[i], columns[j]);
        let (at, du, dv) = (value(0, 0), value(1, 0), value(0, 1));
        let off = minus(at, point);
        let lengths = [dot(du, du), dot(dv, dv)];
        let second = [
            lengths[0] + dot(off, value(2, 0)),
            dot(du, dv) + dot(off, value(1, 1)),
            lengths[1] + dot(off, value(0, 2)),
        ];
        Slope { at, square: dot(off, off), gradient: [dot(off, du), dot(off, dv)], second, lengths }
    }

    /// Returns the place to which Newton's method leads from the middle of the piece; steps never increase the distance
    /// and never leave the piece. Distances are resolved down to `tolerance`.
    pub(super) fn descend(&self, point: Vector, tolerance: f64) -> NearestPlace {
        let mut uv = [0.5; 2];
        let mut here = self.slope(uv, point);
        let mut is_settled = false;
        for _ in 0..MAX_NEWTON_STEPS {
            let held = [0, 1].map(|k| {
                let g = here.gradient[k];
                uv[k] <= 0.0 && g >= 0.0 || uv[k] >= 1.0 && g <= 0.0
            });
            let steep = (0..2).filter(|&k| !held[k]).map(|k| here.gradient[k].abs()).fold(0.0, f64::max);
            let distance = sqrt(here.square);
            is_settled = distance <= tolerance || 3.0 * steep <= tolerance * distance;
            let step = step(&here, held);
            let mut shares = std::iter::successors(Some(1.0), |share| Some(0.5 * share)).take(MAX_STEP_HALVINGS);
            let tried = shares.find_map(|share| {
                let next = [0, 1].map(|k| (uv[k] + share * step[k]).clamp(0.0, 1.0));
                let there = self.slope(next, point);
                (there.square < here.square).then_some((next, there))
            });
            let Some((next, there)) = tried else { break };
            (uv, here) = (next, there);
        }
        let uv = [0, 1].map(|k| self.from[k] + self.size * uv[k]);
        NearestPlace { uv, at: here.at, distance: sqrt(here.square), is_settled }
    }

    /// Returns a lower bound of the distance of the piece from a point.
    pub(super) fn at_least(&self, point: Vector) -> f64 {
        let (middle, [du, dv]) = self.plane();
        let off = self.off(middle, [du, dv]);
        let corner = |u: f64, v: f64| plus(middle, plus(times(u, du), times(v, dv)));
        let [a, b, c, d] = [corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
        let square = square_from_triangle(point, [a, b, c]).min(square_from_triangle(point, [a, c, d]));
        sqrt(square) - off
    }

    /// Returns the centre and the sides of the parallelogram with which the piece is compared.
    fn plane(&self) -> (Vector, [Vector; 2]) {
        let [a, b, c, d] = [self.net[0][0], self.net[3][0], self.net[0][3], self.net[3][3]];
        let middle = times(0.25, plus(plus(a, b), plus(c, d)));
        (middle, [times(0.5, minus(plus(b, d), plus(a, c))), times(0.5, minus(plus(c, d), plus(a, b)))])
    }

    /// Returns the largest distance of a control point from that of the parallelogram.
    fn off(&self, middle: Vector, [du, dv]: [Vector; 2]) -> f64 {
        let share = [-0.5, -1.0 / 6.0, 1.0 / 6.0, 0.5];
        let cells = (0..4).flat_map(|i| (0..4).map(move |j| (i, j)));
        let square = cells.map(|(i, j)| {
            let there = plus(middle, plus(times(share[i], du), times(share[j], dv)));
            let off = minus(self.net[i][j], there);
            dot(off, off)
        });
        sqrt(square.fold(0.0, f64::max))
    }

    /// Whether the squared distance from a point is known to be convex on the piece: its second derivative along any
    /// unit direction is at least `(s - e)^2 - r m`, with the least singular value s of the parallelogram's sides, the
    /// largest change e of the derivatives, the largest distance r and the largest second derivative m.
    pub(super) fn is_convex(&self, point: Vector) -> bool {
        let (_, [du, dv]) = self.plane();
        let (a, b, c) = (dot(du, du), dot(du, dv), dot(dv, dv));
        let least = 0.5 * (a + c - sqrt((a - c) * (a - c) + 4.0 * b * b));
        let net = &self.net;
        let (mut change, mut second) = ([0.0_f64; 2], [0.0_f64; 3]);
        let cells = |n: usize, m: usize| (0..n).flat_map(move |i| (0..m).map(move |j| (i, j)));
        for (i, j) in cells(4, 3) {
            let [along_u, along_v] = [minus(net[j + 1][i], net[j][i]), minus(net[i][j + 1], net[i][j])];
            change[0] = change[0].max(length(minus(times(3.0, along_u), du)));
            change[1] = change[1].max(length(minus(times(3.0, along_v), dv)));
        }
        for (i, j) in cells(4, 2) {
            let bend = |a: Vector, b: Vector, c: Vector| 6.0 * length(plus(minus(a, times(2.0, b)), c));
            second[0] = second[0].max(bend(net[j][i], net[j + 1][i], net[j + 2][i]));
            second[2] = second[2].max(bend(net[i][j], net[i][j + 1], net[i][j + 2]));
        }
        for (i, j) in cells(3, 3) {
            let twist = minus(minus(net[i + 1][j + 1], net[i][j + 1]), minus(net[i + 1][j], net[i][j]));
            second[1] = second[1].max(9.0 * length(twist));
        }
        let change = length(change);
        let bend = sqrt(second[0] * second[0] + 2.0 * second[1] * second[1] + second[2] * second[2]);
        let farthest = net.iter().flatten().map(|&p| length(minus(p, point))).fold(0.0, f64::max);
        let least = sqrt(least.max(0.0)) - change;
        least > 0.0 && least * least > farthest * bend
    }

    /// Returns the four quarters of the piece.
    pub(super) fn quarters(&self) -> [Self; 4] {
        let [low, high] = halves(&self.net);
        let quarters = [low, high].map(|half| halves(&transposed(&half)).map(|net| transposed(&net)));
        let size = 0.5 * self.size;
        [0, 1, 2, 3].map(|i| {
            let (a, b) = (i % 2, i / 2);
            let by = |bit: usize| if bit == 1 { size } else { 0.0 };
            Self { net: quarters[a][b], from: [self.from[0] + by(a), self.from[1] + by(b)], size }
        })
    }
}

/// Maximum number of Newton steps, each of which doubles the correct digits. With half as many, some starts do not
/// converge and pieces are quartered instead; twice as many find the same.
const MAX_NEWTON_STEPS: usize = 12;
/// Maximum number of halvings of a step that increases the distance. Half of it gives up at an eighth of the step,
/// where the model of the distance may still hold; twice of it tries steps that change little.
const MAX_STEP_HALVINGS: usize = 8;

/// Returns the step to the minimum of the quadratic model if it has one, else a descent step along each direction
/// separately.
fn step(here: &Slope, held: [bool; 2]) -> [f64; 2] {
    let Slope { gradient: [g, h], second: [a, b, c], lengths, .. } = *here;
    let alone = |g: f64, a: f64, square: f64| -g / if a > 0.0 { a } else { square.max(f64::MIN_POSITIVE) };
    let along_u = if held[0] { 0.0 } else { alone(g, a, lengths[0]) };
    let along_v = if held[1] { 0.0 } else { alone(h, c, lengths[1]) };
    let determinant = a * c - b * b;
    if held[0] || held[1] || a <= 0.0 || determinant <= 0.0 {
        return [along_u, along_v];
    }
    [(b * h - c * g) / determinant, (b * g - a * h) / determinant]
}

/// Returns the two halves of a net along its first index.
fn halves(net: &BicubicNet) -> [BicubicNet; 2] {
    let mid = |a: [Vector; 4], b: [Vector; 4]| [0, 1, 2, 3].map(|j| times(0.5, plus(a[j], b[j])));
    let [a, b, c, d] = *net;
    let [ab, bc, cd] = [mid(a, b), mid(b, c), mid(c, d)];
    let [abc, bcd] = [mid(ab, bc), mid(bc, cd)];
    let middle = mid(abc, bcd);
    [[a, ab, abc, middle], [middle, bcd, cd, d]]
}

fn transposed(net: &BicubicNet) -> BicubicNet {
    [0, 1, 2, 3].map(|i| [0, 1, 2, 3].map(|j| net[j][i]))
}
