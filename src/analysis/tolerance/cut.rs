//! Bounds the distance between faces and their triangulations.

use std::f64::consts::TAU;

use super::level::ComparedNet;
use crate::math::functions::{cos, real, sin};
use crate::math::vector::{Vector, cross, dot, length, minus, plus, times};
use crate::shape::topology::Topology;

/// Returns an upper bound of the distance between a bilinear quad and the quad cut along either diagonal; 0 for other
/// faces.
pub(super) fn twist(topology: &Topology, face: usize, points: &[Vector]) -> f64 {
    match topology.face(face) {
        &[a, b, c, d] => twisted([a, b, c, d].map(|v| points[v as usize])),
        _ => 0.0,
    }
}

/// Returns the bound for a quad with these corners: the length of `(a - b + c - d) / 4`, which bounds the distance
/// point by point, or the height of the quad if that is less.
fn twisted(p: [Vector; 4]) -> f64 {
    let [a, b, c, d] = p;
    let quarter = length(minus(plus(a, c), plus(b, d))) / 4.0;
    height(&p).map_or(quarter, |height| height.min(quarter))
}

/// Returns an upper bound of the distance between the live faces of a surface, split into quads around their centres,
/// and the same faces cut into triangles.
pub(super) fn cut(base: &ComparedNet) -> f64 {
    let points = base.flat.now.as_chunks::<3>().0;
    let of_face = |&f: &u32| {
        let p: Vec<Vector> = base.topology.face(f as usize).iter().map(|&v| points[v as usize]).collect();
        if let &[a, b, c, d] = p.as_slice() {
            return twisted([a, b, c, d]);
        }
        let apart = irregularity(&p);
        height(&p).map_or(apart, |height| height.min(apart))
    };
    base.live.iter().map(of_face).fold(0.0, f64::max)
}

/// Returns the height of a face along its area vector n: the difference between the greatest and the least `n p / |n|`
/// of its corners p. `None` unless all corners, and all triangles of the fan around corner 0, are counter-clockwise
/// seen along n. If they are, the projection along n is convex, and however the face is cut, it is a graph over the
/// projection within that height.
fn height(p: &[Vector]) -> Option<f64> {
    let n = p.len();
    let area = |[a, b, c]: [usize; 3]| cross(minus(p[b % n], p[a % n]), minus(p[c % n], p[a % n]));
    let fan: Vec<Vector> = (1..n - 1).map(|i| area([0, i, i + 1])).collect();
    let whole = fan.iter().copied().fold([0.0; 3], plus);
    let mut areas = (0..n).map(|i| area([i, i + 1, i + 2])).chain(fan);
    if !areas.all(|x| dot(whole, x) > 0.0) {
        return None;
    }
    let heights = p.iter().map(|&x| dot(whole, minus(x, p[0])) / length(whole));
    let (low, high) = heights.fold((0.0_f64, 0.0_f64), |(low, high), h| (low.min(h), high.max(h)));
    Some(high - low)
}

/// Returns twice the greatest distance between the corners of a face and those of an affine image of a regular polygon,
/// `c + a cos(2 pi i/n) + b sin(2 pi i/n)`. The image is flat, and both surfaces of the face, split and cut, are within
/// once that distance of it.
fn irregularity(p: &[Vector]) -> f64 {
    let n = real(p.len());
    let turned = |i: usize| [cos, sin].map(|of| of(TAU * real(i) / n));
    let sum =
        |weight: &dyn Fn(usize) -> f64| p.iter().enumerate().map(|(i, &x)| times(weight(i), x)).fold([0.0; 3], plus);
    let (c, [a, b]) = (sum(&|_| 1.0 / n), [0, 1].map(|k| sum(&|i| 2.0 * turned(i)[k] / n)));
    let regular = |i: usize| plus(c, plus(times(turned(i)[0], a), times(turned(i)[1], b)));
    2.0 * p.iter().enumerate().map(|(i, &x)| length(minus(x, regular(i)))).fold(0.0, f64::max)
}
