//! Vectors of three numbers.

use crate::math::functions::sqrt;

pub type Vector = [f64; 3];

pub fn plus(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn times(k: f64, a: Vector) -> Vector {
    [k * a[0], k * a[1], k * a[2]]
}

pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn length(a: Vector) -> f64 {
    sqrt(dot(a, a))
}

/// The mean of some vectors; zero of none.
pub fn mean(all: impl Iterator<Item = Vector>) -> Vector {
    let (sum, n) = all.fold(([0.0; 3], 0.0), |(sum, n), x| (plus(sum, x), n + 1.0));
    times(1.0 / f64::max(n, 1.0), sum)
}

/// The square of the distance of a point from a segment.
pub fn to_segment(p: Vector, [a, b]: [Vector; 2]) -> f64 {
    let along = minus(b, a);
    let square = dot(along, along);
    let at = if square > 0.0 { (dot(minus(p, a), along) / square).clamp(0.0, 1.0) } else { 0.0 };
    let apart = minus(p, plus(a, times(at, along)));
    dot(apart, apart)
}

/// The distance of a point from a segment.
pub fn from_segment(p: Vector, segment: [Vector; 2]) -> f64 {
    sqrt(to_segment(p, segment))
}

/// A vector of length 1; zero for zero.
pub fn unit(x: Vector) -> Vector {
    let size = length(x);
    if size > 0.0 { times(1.0 / size, x) } else { [0.0; 3] }
}
