//! Distances of points from a surface of triangles.

use std::collections::BTreeMap;

use planish::math::functions::sqrt;

use super::nets::Net;

type Point = [f64; 3];

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn at(a: Point, t: f64, u: Point) -> Point {
    [a[0] + t * u[0], a[1] + t * u[1], a[2] + t * u[2]]
}

fn to_segment(p: Point, a: Point, b: Point) -> f64 {
    let u = minus(b, a);
    let square = dot(u, u);
    let t = if square > 0.0 { (dot(minus(p, a), u) / square).clamp(0.0, 1.0) } else { 0.0 };
    let d = minus(p, at(a, t, u));
    dot(d, d)
}

/// Returns the squared distance of a point from a triangle: from its plane if the foot lies inside, else from its
/// sides.
fn to_triangle(p: Point, [a, b, c]: [Point; 3]) -> f64 {
    let (u, v, w) = (minus(b, a), minus(c, a), minus(p, a));
    let (uu, uv, vv, uw, vw) = (dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w));
    let determinant = uu * vv - uv * uv;
    let (s, t) = ((vv * uw - uv * vw) / determinant, (uu * vw - uv * uw) / determinant);
    if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
        let d = minus(p, at(at(a, s, u), t, v));
        return dot(d, d);
    }
    to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a))
}

/// The triangles of a net, sorted into the cells of a grid.
pub(crate) struct Surface {
    triangles: Vec<[Point; 3]>,
    cells: BTreeMap<[i64; 3], Vec<usize>>,
    side: f64,
}

impl Surface {
    /// Cuts the faces into triangles from corner `first`.
    pub(crate) fn cut(net: &Net, first: usize) -> Self {
        let triangles: Vec<[Point; 3]> = net
            .faces
            .iter()
            .flat_map(|face| {
                let n = face.len();
                let point = move |i: usize| net.positions[face[(first + i) % n]];
                (1..n - 1).map(move |i| [point(0), point(i), point(i + 1)])
            })
            .collect();
        let extent = |t: &[Point; 3]| {
            (0..3)
                .map(|k| {
                    t.iter().map(|p| p[k]).fold(f64::MIN, f64::max) - t.iter().map(|p| p[k]).fold(f64::MAX, f64::min)
                })
                .fold(0.0, f64::max)
        };
        let side = triangles.iter().map(extent).fold(1e-9, f64::max);
        let mut cells: BTreeMap<[i64; 3], Vec<usize>> = BTreeMap::new();
        for (i, triangle) in triangles.iter().enumerate() {
            let low = Self::cell([0, 1, 2].map(|k| triangle.iter().map(|p| p[k]).fold(f64::MAX, f64::min)), side);
            let high = Self::cell([0, 1, 2].map(|k| triangle.iter().map(|p| p[k]).fold(f64::MIN, f64::max)), side);
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    (low[2]..=high[2]).for_each(|z| cells.entry([x, y, z]).or_default().push(i));
                }
            }
        }
        Self { triangles, cells, side }
    }

    #[expect(clippy::cast_possible_truncation, reason = "test nets are small and finite")]
    fn cell(p: Point, side: f64) -> [i64; 3] {
        p.map(|x| (x / side).floor() as i64)
    }

    /// Returns the distance of a point from the surface.
    pub(crate) fn distance(&self, p: Point) -> f64 {
        let [x, y, z] = Self::cell(p, self.side);
        let mut least = f64::INFINITY;
        for reach in 1..1000_i32 {
            let r = i64::from(reach);
            for i in x - r..=x + r {
                for j in y - r..=y + r {
                    let near = self.cells.range([i, j, z - r]..=[i, j, z + r]).flat_map(|(_, list)| list);
                    least = near.map(|&t| to_triangle(p, self.triangles[t])).fold(least, f64::min);
                }
            }
            if sqrt(least) <= f64::from(reach) * self.side {
                break;
            }
        }
        sqrt(least)
    }

    /// Returns the greatest distance of the points from the surface.
    pub(crate) fn farthest(&self, points: &[Point]) -> f64 {
        points.iter().map(|&p| self.distance(p)).fold(0.0, f64::max)
    }

    /// Returns the corners, the midpoints of the sides and the centres of the triangles.
    pub(crate) fn samples(&self) -> Vec<Point> {
        let middle = |a: Point, b: Point| at(a, 0.5, minus(b, a));
        let of = |&[a, b, c]: &[Point; 3]| {
            let centre = at(a, 2.0 / 3.0, minus(middle(b, c), a));
            [a, b, c, middle(a, b), middle(b, c), middle(c, a), centre]
        };
        self.triangles.iter().flat_map(of).collect()
    }
}
