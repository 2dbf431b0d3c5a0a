//! Sheets: the faces around a face, where they lie over their plane like a graph that is nearly flat.

use crate::refine::vector::{Vector, cross, dot, length, minus, plus, times};
use crate::shape::topology::{NONE, Topology};

/// Height of an equilateral triangle of side 1.
const HEIGHT: f64 = 0.866_025_403_784_438_6;

/// The surroundings of a face, seen along a direction.
///
/// The surface of the faces is made of bilinear quads and triangles, or of quads cut along either diagonal. Where all
/// normals at corners of faces have positive products with n, so do the normals everywhere, which are sums of them with
/// positive weights; then the projection along n is open, and straight paths in the plane can be lifted to the surface
/// as long as they do not come to the rim. A path as long as w climbs by `slope w` at most. So with a point y of the
/// face and a displacement x the surface has a point within `|n x| + slope |x - (n x) n|` of y + x.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sheet {
    /// Unit vector.
    normal: Vector,
    /// The greatest tangent of the angle between a normal and it.
    slope: f64,
    /// Coordinates in the plane, in which the face is about a unit square or an equilateral triangle.
    axes: [Vector; 2],
    /// Paths shorter than this, in these coordinates, do not come to the rim.
    exit: f64,
}

impl Sheet {
    /// The sheet of so many rings of faces around a face; `None` where it folds or has no direction.
    pub(super) fn around(topology: &Topology, points: &[Vector], face: usize, rings: usize) -> Option<Self> {
        let mut faces: Vec<usize> = vec![face];
        for _ in 0..rings {
            let inner = faces.clone();
            for &v in inner.iter().flat_map(|&f| topology.face(f)) {
                for corner in topology.ring(v as usize) {
                    let f = topology.face_of(corner);
                    if !faces.contains(&f) {
                        faces.push(f);
                    }
                }
            }
        }
        let at = |corner: u32| points[topology.vertex(corner) as usize];
        let normal = |corner: u32| {
            let (here, next, before) = (at(corner), at(topology.next(corner)), at(topology.previous(corner)));
            cross(minus(next, here), minus(before, here))
        };
        let sum = topology.corners(face).map(normal).fold([0.0; 3], plus);
        let size = length(sum);
        if size.is_nan() || size <= 0.0 {
            return None;
        }
        let n = times(1.0 / size, sum);
        let flat = |p: Vector| minus(p, times(dot(n, p), n));
        let corners: Vec<Vector> = topology.corners(face).map(at).collect();
        let axes = axes(&corners, n)?;
        let place = |p: Vector| seen(axes, minus(p, corners[0]));
        let outline: Vec<Vector> = corners.iter().map(|&p| place(p)).collect();
        let (mut slope, mut exit) = (0.0_f64, f64::INFINITY);
        for corner in faces.iter().flat_map(|&f| topology.corners(f)) {
            let here = normal(corner);
            let up = dot(n, here);
            if up.is_nan() || up <= 0.0 {
                return None;
            }
            slope = slope.max(length(flat(here)) / up);
            let twin = topology.twin(corner);
            if twin == NONE || !faces.contains(&topology.face_of(twin)) {
                exit = exit.min(apart(&outline, [corner, topology.next(corner)].map(|c| place(at(c)))));
            }
        }
        Some(Self { normal: n, slope, axes, exit })
    }

    /// How far the surface is from its points in the face when they are displaced by any mean of these vectors and as far
    /// as `rest` by anything else, at most; `None` where that leads out of the sheet.
    pub(super) fn distance(&self, displacements: &[Vector], rest: f64) -> Option<f64> {
        let up = |x: Vector| dot(self.normal, x).abs();
        let along = |x: Vector| length(minus(x, times(dot(self.normal, x), self.normal)));
        let path = |x: Vector| length(seen(self.axes, x));
        let most = |of: &dyn Fn(Vector) -> f64| displacements.iter().map(|&x| of(x)).fold(0.0, f64::max);
        let [x, y] = self.axes.map(length);
        let inside = most(&path) + length([x, y, 0.0]) * rest < self.exit;
        inside.then(|| most(&up) + self.slope * most(&along) + (1.0 + self.slope) * rest)
    }
}

/// Coordinates along two sides of a face, seen along the unit vector `n`; `None` where the sides are one line.
fn axes(corners: &[Vector], n: Vector) -> Option<[Vector; 2]> {
    let (first, second) = match *corners {
        [a, b, c, d] => (minus(plus(b, c), plus(a, d)), minus(plus(c, d), plus(a, b))),
        [a, b, c] => (minus(b, a), minus(c, a)),
        _ => return None,
    };
    let size = dot(cross(first, second), n);
    if size.is_nan() || size <= 0.0 {
        return None;
    }
    let scale = if corners.len() == 4 { 2.0 } else { 1.0 };
    let (x, y) = (times(scale / size, cross(second, n)), times(scale / size, cross(n, first)));
    Some(if corners.len() == 4 { [x, y] } else { [plus(x, times(0.5, y)), times(HEIGHT, y)] })
}

/// The coordinates of a vector.
fn seen([x, y]: [Vector; 2], of: Vector) -> Vector {
    [dot(x, of), dot(y, of), 0.0]
}

/// The distance in the plane of a segment from a convex polygon, counter-clockwise.
fn apart(polygon: &[Vector], [a, b]: [Vector; 2]) -> f64 {
    let n = polygon.len();
    let left = |[p, q]: [Vector; 2], x: Vector| cross(minus(q, p), minus(x, p))[2];
    let sides = || (0..n).map(|i| [polygon[i], polygon[(i + 1) % n]]);
    let inside = |x: Vector| sides().all(|side| left(side, x) >= 0.0);
    let crosses =
        |[p, q]: [Vector; 2]| left([p, q], a) * left([p, q], b) <= 0.0 && left([a, b], p) * left([a, b], q) <= 0.0;
    if inside(a) || inside(b) || sides().any(crosses) {
        return 0.0;
    }
    let corners = polygon.iter().map(|&p| from_segment(p, [a, b]));
    let ends = sides().map(|side| from_segment(a, side).min(from_segment(b, side)));
    corners.chain(ends).fold(f64::INFINITY, f64::min)
}

/// The distance of a point from a segment.
fn from_segment(p: Vector, [a, b]: [Vector; 2]) -> f64 {
    let along = minus(b, a);
    let square = dot(along, along);
    let at = if square > 0.0 { (dot(minus(p, a), along) / square).clamp(0.0, 1.0) } else { 0.0 };
    length(minus(p, plus(a, times(at, along))))
}
