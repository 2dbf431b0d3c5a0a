//! The distance of a net's surface from the limit, by what some more levels measure and second differences bound.

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::NoLevel;
use super::bend::{Box3, around, bends, spread};
use super::level::Level;
use super::sheet::Sheet;
use super::spline::Spline;
use crate::math::functions::{cos, sin};
use crate::refine::vector::{Vector, cross, dot, length, minus, plus, times};
use crate::shape::topology::Topology;
use crate::watch::Watch;

/// Faces of a net up to which it is refined further.
pub(super) const FOLLOWED_FACES: usize = 1 << 16;
/// Levels that are measured at all faces, where they are not too many: what is bounded after them is a 16th of the whole.
const WHOLE: usize = 2;
/// Most levels that are measured around vertices where the net is not regular.
const AHEAD: usize = 40;
/// Faces are followed while their bound is above the greatest distance that was measured, times this.
const SLACK: f64 = 1.25;

/// What is known of one face.
struct Known {
    face: u32,
    /// Whether second differences bound the rest.
    regular: bool,
    /// How far its corners are from the surface, at most.
    moved: f64,
    /// How far its limit is from the surface, at most.
    whole: f64,
}

/// The surface of a net.
struct Surface {
    /// For each face its sheets.
    sheets: Vec<Vec<Sheet>>,
    /// For each face how far quads near it are from themselves cut along either diagonal, at most.
    cuts: Vec<f64>,
}

impl Surface {
    fn of(base: &Level, rings: usize) -> Self {
        let (topology, points) = (&base.topology, base.flat.now.as_chunks().0);
        let faces = || (0..topology.n_faces()).into_par_iter().with_min_len(256);
        let around = |f: usize| (1..=rings).filter_map(|n| Sheet::around(topology, points, f, n)).collect();
        let sheets: Vec<Vec<Sheet>> = faces().map(around).collect();
        let cut = |f: usize| {
            let cut = times(0.25, twist(topology, f, points));
            sheets[f].iter().filter_map(|sheet| sheet.distance(&[cut], 0.0)).fold(length(cut), f64::min)
        };
        let cuts: Vec<f64> = faces().map(cut).collect();
        let of_vertex = |v: usize| topology.ring(v).map(|c| cuts[topology.face_of(c)]).fold(0.0, f64::max);
        let of_vertices: Vec<f64> =
            (0..topology.n_vertices()).into_par_iter().with_min_len(256).map(of_vertex).collect();
        let around = |f: usize| topology.face(f).iter().map(|&v| of_vertices[v as usize]).fold(0.0, f64::max);
        Self { cuts: faces().map(around).collect(), sheets }
    }

    /// How far points of a face, displaced by any mean of these vectors and as far as `rest` by anything else, are from the
    /// surface, however its quads are cut.
    fn distance(&self, face: u32, displacements: &[Vector], rest: f64) -> f64 {
        let face = face as usize;
        let far = displacements.iter().map(|&x| length(x)).fold(0.0, f64::max) + rest;
        let near = self.sheets[face].iter().filter_map(|sheet| sheet.distance(displacements, rest));
        near.fold(far, f64::min) + self.cuts[face]
    }
}

/// `a - b + c - d` of a quad, four times as much as its diagonals are apart in the middle from its bilinear surface.
pub(super) fn twist(topology: &Topology, face: usize, points: &[Vector]) -> Vector {
    match topology.face(face) {
        &[a, b, c, d] => {
            let [a, b, c, d] = [a, b, c, d].map(|v| points[v as usize]);
            minus(plus(a, c), plus(b, d))
        }
        _ => [0.0; 3],
    }
}

/// How far the faces of a surface, split into quads around their centres, are from the same faces cut into triangles, at
/// most.
pub(super) fn cut(base: &Level) -> f64 {
    let points = base.flat.now.as_chunks::<3>().0;
    let of_face = |&f: &u32| {
        let p: Vec<Vector> = base.topology.face(f as usize).iter().map(|&v| points[v as usize]).collect();
        let apart = if p.len() == 4 { length(twist(&base.topology, f as usize, points)) / 4.0 } else { irregular(&p) };
        height(&p).map_or(apart, |height| height.min(apart))
    };
    base.live.iter().map(of_face).fold(0.0, f64::max)
}

/// The height of a face seen along its area vector n, where all its corners and its triangles at corner 0 turn to the left
/// there: then it is convex, and however it is cut, it is a graph over it between the least and the greatest n p of a
/// corner.
fn height(p: &[Vector]) -> Option<f64> {
    let n = p.len();
    let area = |[a, b, c]: [usize; 3]| cross(minus(p[b % n], p[a % n]), minus(p[c % n], p[a % n]));
    let fan: Vec<Vector> = (1..n - 1).map(|i| area([0, i, i + 1])).collect();
    let whole = fan.iter().copied().fold([0.0; 3], plus);
    let mut turns = (0..n).map(|i| area([i, i + 1, i + 2])).chain(fan);
    if !turns.all(|x| dot(whole, x) > 0.0) {
        return None;
    }
    let heights = p.iter().map(|&x| dot(whole, minus(x, p[0])) / length(whole));
    let (low, high) = heights.fold((0.0_f64, 0.0_f64), |(low, high), h| (low.min(h), high.max(h)));
    Some(high - low)
}

/// Twice the distance of the corners of a face from those of a regular polygon under an affine map, `c + a cos(2 pi i/n) +
/// b sin(2 pi i/n)`: that polygon is flat, and either surface is once the distance from it at most.
fn irregular(p: &[Vector]) -> f64 {
    let n = real(p.len());
    let turned = |i: usize| [cos, sin].map(|of| of(TAU * real(i) / n));
    let sum =
        |weight: &dyn Fn(usize) -> f64| p.iter().enumerate().map(|(i, &x)| times(weight(i), x)).fold([0.0; 3], plus);
    let (c, [a, b]) = (sum(&|_| 1.0 / n), [0, 1].map(|k| sum(&|i| 2.0 * turned(i)[k] / n)));
    let regular = |i: usize| plus(c, plus(times(turned(i)[0], a), times(turned(i)[1], b)));
    2.0 * p.iter().enumerate().map(|(i, &x)| length(minus(x, regular(i)))).fold(0.0, f64::max)
}

fn real(n: usize) -> f64 {
    f64::from(u32::try_from(n).unwrap_or(u32::MAX))
}

/// The most by which second differences and boxes around points let the limit leave the surface of a net, for each live
/// face: of second differences alone, and the lesser of both.
pub(super) fn rests(level: &Level, spline: &Spline) -> Vec<[f64; 2]> {
    if spline.reach == 0 {
        return vec![[0.0; 2]; level.live.len()];
    }
    let (topology, points) = (&level.topology, level.points.now.as_chunks::<3>().0);
    let bends = bends(&level.net, topology, spline.tile, &level.points.now);
    let bends = spread(topology, bends, spline.reach, f64::max);
    let boxes: Vec<Box3> = points.iter().map(|&p| [p, p]).collect();
    let boxes = spread(topology, boxes, spline.reach, around);
    let of_face = |&f: &u32| {
        let face = topology.face(f as usize);
        let bend = spline.factor * face.iter().map(|&v| bends[v as usize]).fold(0.0, f64::max);
        let hull =
            face.iter().map(|&v| boxes[v as usize]).reduce(around).map_or(0.0, |[low, high]| length(minus(high, low)));
        [bend, bend.min(hull)]
    };
    level.live.par_iter().with_min_len(256).map(of_face).collect()
}

fn known(level: &Level, surface: &Surface, spline: &Spline) -> Vec<Known> {
    let rests = rests(level, spline);
    let (points, flat) = (level.points.now.as_chunks::<3>().0, level.flat.now.as_chunks::<3>().0);
    let of_face = |(&face, [bend, rest]): (&u32, &[f64; 2])| {
        let mut displacements = [[0.0; 3]; 4];
        let corners = level.topology.face(face as usize);
        for (x, &v) in displacements.iter_mut().zip(corners) {
            *x = minus(points[v as usize], flat[v as usize]);
        }
        let displacements = &displacements[..corners.len().min(4)];
        let home = level.home[face as usize];
        Known {
            face,
            regular: bend.is_finite(),
            moved: surface.distance(home, displacements, 0.0),
            whole: surface.distance(home, displacements, *rest),
        }
    };
    level.live.par_iter().zip(&rests).with_min_len(256).map(of_face).collect()
}

/// The distance of the limit of the live faces of a net from the surface that the net is compared with, which has the
/// same faces, at most.
///
/// # Errors
/// [`NoLevel`], when a level cannot be computed.
pub(super) fn bound(base: &Level, spline: &Spline, watch: &Watch) -> Result<f64, NoLevel> {
    // points of nets that are looked at after an upsampling move by twice as many faces
    let surface = Surface::of(base, if spline.halved { 2 } else { 1 });
    let (mut level, mut bound, mut greatest) = (base.clone(), 0.0_f64, 0.0_f64);
    for ahead in 0..=AHEAD {
        let known = known(&level, &surface, spline);
        greatest = known.iter().map(|face| face.moved).fold(greatest, f64::max);
        let next = if spline.halved { Level::next_halved } else { Level::next };
        let next = |level: &Level| next(level, &spline.plan, spline.round(ahead), watch);
        if ahead < WHOLE && level.faces_after(1) <= FOLLOWED_FACES {
            level = next(&level)?;
            continue;
        }
        let enough = bound.max(SLACK * greatest);
        let mut keep = |wanted: &dyn Fn(&Known) -> bool| {
            let left = known.iter().filter(|face| !wanted(face)).map(|face| face.whole).fold(0.0, f64::max);
            bound = bound.max(left);
            let kept: Vec<u32> = known.iter().filter(|face| wanted(face)).map(|face| face.face).collect();
            (!kept.is_empty()).then(|| level.focused(&kept, spline.margin()))
        };
        let fits = |part: &Level| part.faces_after(1) <= FOLLOWED_FACES;
        let part = match keep(&|face| face.whole > enough) {
            Some(part) if !fits(&part) => keep(&|face| face.whole > enough && !face.regular),
            part => part,
        };
        match part {
            None => return Ok(bound),
            Some(part) if ahead == AHEAD || !fits(&part) => {
                return Ok(known.iter().map(|face| face.whole).fold(bound, f64::max));
            }
            Some(part) => level = next(&part)?,
        }
    }
    Ok(bound)
}
