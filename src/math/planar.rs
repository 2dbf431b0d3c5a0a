//! Directions and angles in the plane, and the tangents of polygons by circles through three points.

use super::functions::{atan2, cos, sin};
use super::vector::{self, direction, dot, minus, plus, times};
use crate::watch::{Stopped, Watch};

/// A point or a vector of the plane.
pub type Vector2 = [f64; 2];

/// Number of points processed between two checks of the watch, a small part of the time in which a stop must be
/// noticed. Half of it checks twice as often for no use; twice of it notices a stop later.
const POINTS_PER_CHECK: usize = 65_536;

/// Returns half the vector from `a` to `b`; the whole vector might overflow.
pub fn half_chord(a: Vector2, b: Vector2) -> Vector2 {
    [b[0] / 2.0 - a[0] / 2.0, b[1] / 2.0 - a[1] / 2.0]
}

/// Returns the length of a vector without intermediate overflow.
pub fn length(v: Vector2) -> f64 {
    let most = v[0].abs().max(v[1].abs());
    if most > 0.0 { most * vector::length(v.map(|x| x / most)) } else { 0.0 }
}

/// Returns the cross product of two vectors: the area of their parallelogram, positive if the second is to the left.
pub fn cross(a: Vector2, b: Vector2) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Returns the angle from one direction to another, counter-clockwise, in radians in `(-pi, pi]`; pi for opposite ones.
pub fn angle(from: Vector2, to: Vector2) -> f64 {
    // adding 0 turns the -0 of opposite directions into +0
    atan2(cross(from, to) + 0.0, dot(from, to))
}

/// Returns a vector rotated counter-clockwise by an angle in radians.
pub fn rotated(v: Vector2, angle: f64) -> Vector2 {
    let (s, c) = (sin(angle), cos(angle));
    [c * v[0] - s * v[1], s * v[0] + c * v[1]]
}

/// Returns the tangent, at the middle of three points, of the circle through them: the direction of `u/|u|^2 + v/|v|^2`
/// for the chords `u` to the middle and `v` from it. Opposite chords count as a turn by +pi, so that the tangent is `u`
/// rotated to the left.
pub fn circle_tangent(u: Vector2, v: Vector2) -> Option<Vector2> {
    let (of_u, of_v) = (direction(u)?, direction(v)?);
    let (long_u, long_v) = (length(u), length(v));
    let longest = long_u.max(long_v);
    let (a, b) = (long_v / longest, long_u / longest);
    direction(plus(times(a, of_u), times(b, of_v))).or(Some([-of_u[1], of_u[0]]))
}

/// For each point of a polygon, the nearest points before and after it at a different position.
#[derive(Debug)]
pub struct Neighbours {
    n: usize,
    closed: bool,
    /// Indices before and after each point, or [`NO_POINT`]; absent if no two neighbours coincide.
    nearest: Option<Vec<[u32; 2]>>,
}

const NO_POINT: u32 = u32::MAX;

impl Neighbours {
    /// Finds the neighbours of the points of a polygon, in time proportional to its points.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub fn of(points: &[Vector2], closed: bool, watch: &Watch) -> Result<Self, Stopped> {
        let n = points.len();
        let repeated = |i: usize| half_chord(points[i], points[(i + 1) % n]) == [0.0, 0.0];
        let edges = if closed { n } else { n - 1 };
        let mut any = false;
        for start in (0..edges).step_by(POINTS_PER_CHECK) {
            watch.check()?;
            any |= (start..edges.min(start + POINTS_PER_CHECK)).any(repeated);
        }
        if !any {
            return Ok(Self { n, closed, nearest: None });
        }
        let mut found = vec![[NO_POINT; 2]; n];
        // if all points of a closed polygon coincide, no point has a neighbour
        let start = if closed { (0..n).find(|&i| !repeated((i + n - 1) % n)) } else { Some(0) };
        if let Some(start) = start {
            for k in 0..n {
                if k % POINTS_PER_CHECK == 0 {
                    watch.check()?;
                }
                // forwards for the preceding points, backwards for the following ones
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

    /// Returns the nearest preceding point at a different position.
    pub fn before(&self, i: usize) -> Option<usize> {
        match &self.nearest {
            Some(found) => known(found[i][0]),
            None if i > 0 => Some(i - 1),
            None => self.closed.then_some(self.n - 1),
        }
    }

    /// Returns the nearest following point at a different position.
    pub fn after(&self, i: usize) -> Option<usize> {
        match &self.nearest {
            Some(found) => known(found[i][1]),
            None if i + 1 < self.n => Some(i + 1),
            None => self.closed.then_some(0),
        }
    }

    /// Returns the circle tangent at point `i`; `None` at the ends of an open polygon.
    pub fn tangent(&self, points: &[Vector2], i: usize) -> Option<Vector2> {
        let (before, after) = (points[self.before(i)?], points[self.after(i)?]);
        circle_tangent(half_chord(before, points[i]), half_chord(points[i], after))
    }
}

fn index(i: usize) -> u32 {
    u32::try_from(i).expect("polygons have fewer than 2^32 points")
}

fn known(i: u32) -> Option<usize> {
    (i != NO_POINT).then_some(i as usize)
}

/// Returns the unit tangents of a polygon: the circle tangent at each point; at the ends of an open polygon, the
/// tangent of the neighbour reflected about the chord, so that the curve ends in a circular arc. Two points have the
/// direction of their chord; if all points coincide, the tangent is the first axis.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub fn tangents(points: &[Vector2], closed: bool, watch: &Watch) -> Result<Vec<Vector2>, Stopped> {
    let neighbours = Neighbours::of(points, closed, watch)?;
    let mut tangents = Vec::with_capacity(points.len());
    for i in 0..points.len() {
        if i % POINTS_PER_CHECK == 0 {
            watch.check()?;
        }
        let tangent = neighbours.tangent(points, i).or_else(|| end_tangent(points, &neighbours, i));
        tangents.push(tangent.unwrap_or([1.0, 0.0]));
    }
    Ok(tangents)
}

fn end_tangent(points: &[Vector2], neighbours: &Neighbours, i: usize) -> Option<Vector2> {
    let (a, b, inner) = match (neighbours.before(i), neighbours.after(i)) {
        (None, Some(after)) => (i, after, after),
        (Some(before), None) => (before, i, before),
        _ => return None,
    };
    let chord = direction(half_chord(points[a], points[b]))?;
    let Some(inner) = neighbours.tangent(points, inner) else { return Some(chord) };
    direction(minus(times(2.0 * dot(inner, chord), chord), inner))
}
