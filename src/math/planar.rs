//! Directions and angles in the plane, and the tangents of polygons by circles through three points.

use super::functions::{atan2, cos, sin};
use super::vector::{self, direction, dot, minus, plus, times};
use crate::watch::{Stopped, Watch};

/// A point or a vector of the plane.
pub type Vector = [f64; 2];

/// Points passed over between two questions whether to stop.
const BLOCK: usize = 65_536;

/// Half the way from `a` to `b`; the whole might exceed the largest number.
pub fn half_chord(a: Vector, b: Vector) -> Vector {
    [b[0] / 2.0 - a[0] / 2.0, b[1] / 2.0 - a[1] / 2.0]
}

/// The length of a vector, without overflow on the way.
pub fn length(v: Vector) -> f64 {
    let most = v[0].abs().max(v[1].abs());
    if most > 0.0 { most * vector::length(v.map(|x| x / most)) } else { 0.0 }
}

/// The angle from one direction to another, counter-clockwise, radians in `(-pi, pi]`; opposite ones are pi apart.
pub fn angle(from: Vector, to: Vector) -> f64 {
    let cross = from[0] * to[1] - from[1] * to[0];
    // adding 0 makes the 0 of opposite directions a positive one
    atan2(cross + 0.0, dot(from, to))
}

/// A vector rotated counter-clockwise by an angle, radians.
pub fn rotated(v: Vector, angle: f64) -> Vector {
    let (s, c) = (sin(angle), cos(angle));
    [c * v[0] - s * v[1], s * v[0] + c * v[1]]
}

/// The tangent, at the middle one of three points, of the circle through them: the direction of `u/|u|^2 + v/|v|^2` for
/// the chords `u` to it and `v` from it. Chords that cancel each other turn by +pi, so that the tangent is `u` turned
/// left.
pub fn circle_tangent(u: Vector, v: Vector) -> Option<Vector> {
    let (of_u, of_v) = (direction(u)?, direction(v)?);
    let (long_u, long_v) = (length(u), length(v));
    let longest = long_u.max(long_v);
    let (a, b) = (long_v / longest, long_u / longest);
    direction(plus(times(a, of_u), times(b, of_v))).or(Some([-of_u[1], of_u[0]]))
}

/// For each point of a polygon the nearest points before and after it that lie elsewhere.
#[derive(Debug)]
pub struct Neighbours {
    n: usize,
    closed: bool,
    /// Indices before and after, [`NONE`] where there is none; absent while no two neighbours lie at one place.
    nearest: Option<Vec<[u32; 2]>>,
}

const NONE: u32 = u32::MAX;

impl Neighbours {
    /// Finds the neighbours of the points of a polygon, in time proportional to its points.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub fn of(points: &[Vector], closed: bool, watch: &Watch) -> Result<Self, Stopped> {
        let n = points.len();
        let repeated = |i: usize| half_chord(points[i], points[(i + 1) % n]) == [0.0, 0.0];
        let edges = if closed { n } else { n - 1 };
        let mut any = false;
        for start in (0..edges).step_by(BLOCK) {
            watch.check()?;
            any |= (start..edges.min(start + BLOCK)).any(repeated);
        }
        if !any {
            return Ok(Self { n, closed, nearest: None });
        }
        let mut found = vec![[NONE; 2]; n];
        // where a closed polygon has only one place, no point has a neighbour
        let start = if closed { (0..n).find(|&i| !repeated((i + n - 1) % n)) } else { Some(0) };
        if let Some(start) = start {
            for k in 0..n {
                if k % BLOCK == 0 {
                    watch.check()?;
                }
                // forwards for what stands before, backwards for what stands after
                let (i, j) = ((start + k) % n, (start + n - 1 - k) % n);
                if k > 0 || closed {
                    let (before, after) = ((i + n - 1) % n, (j + 1) % n);
                    found[i][0] = if repeated(before) { found[before][0] } else { index(before) };
                    found[j][1] = if repeated(j) { found[after][1] } else { index(after) };
                }
            }
        }
        Ok(Self { n, closed, nearest: Some(found) })
    }

    /// The nearest point before point `i` that lies elsewhere.
    pub fn before(&self, i: usize) -> Option<usize> {
        match &self.nearest {
            Some(found) => known(found[i][0]),
            None if i > 0 => Some(i - 1),
            None => self.closed.then_some(self.n - 1),
        }
    }

    /// The nearest point after point `i` that lies elsewhere.
    pub fn after(&self, i: usize) -> Option<usize> {
        match &self.nearest {
            Some(found) => known(found[i][1]),
            None if i + 1 < self.n => Some(i + 1),
            None => self.closed.then_some(0),
        }
    }

    /// The circle tangent at point `i`; `None` at the ends of an open polygon.
    pub fn tangent(&self, points: &[Vector], i: usize) -> Option<Vector> {
        let (before, after) = (points[self.before(i)?], points[self.after(i)?]);
        circle_tangent(half_chord(before, points[i]), half_chord(points[i], after))
    }
}

fn index(i: usize) -> u32 {
    u32::try_from(i).expect("polygons have fewer than 2^32 points")
}

fn known(i: u32) -> Option<usize> {
    (i != NONE).then_some(i as usize)
}

/// Unit tangents of a polygon: the circle tangent at each point; at the ends of an open polygon that of the neighbour
/// mirrored about the chord to it, so that the curve ends in an arc of a circle. Two points alone have their chord's
/// direction, one place alone has the first axis.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub fn tangents(points: &[Vector], closed: bool, watch: &Watch) -> Result<Vec<Vector>, Stopped> {
    let neighbours = Neighbours::of(points, closed, watch)?;
    let mut tangents = Vec::with_capacity(points.len());
    for i in 0..points.len() {
        if i % BLOCK == 0 {
            watch.check()?;
        }
        let tangent = neighbours.tangent(points, i).or_else(|| end_tangent(points, &neighbours, i));
        tangents.push(tangent.unwrap_or([1.0, 0.0]));
    }
    Ok(tangents)
}

fn end_tangent(points: &[Vector], neighbours: &Neighbours, i: usize) -> Option<Vector> {
    let (a, b, inner) = match (neighbours.before(i), neighbours.after(i)) {
        (None, Some(after)) => (i, after, after),
        (Some(before), None) => (before, i, before),
        _ => return None,
    };
    let chord = direction(half_chord(points[a], points[b]))?;
    let Some(inner) = neighbours.tangent(points, inner) else { return Some(chord) };
    direction(minus(times(2.0 * dot(inner, chord), chord), inner))
}
