//! The distance of a net's surface from the limit, by what some more levels measure and second differences bound.

use rayon::prelude::*;

use super::NoLevel;
use super::bend::{Box3, around, bends, spread};
use super::level::Level;
use super::sheet::Sheet;
use super::spline::Spline;
use super::vector::{Vector, length, minus, plus, times};
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
    /// For each face its sheet, where there is one.
    sheets: Vec<Option<Sheet>>,
    /// For each face how far quads near it are from themselves cut along either diagonal, at most.
    cuts: Vec<f64>,
}

impl Surface {
    fn of(base: &Level) -> Self {
        let (topology, points) = (&base.topology, base.flat.now.as_chunks().0);
        let faces = || (0..topology.n_faces()).into_par_iter().with_min_len(256);
        let sheets: Vec<Option<Sheet>> = faces().map(|f| Sheet::around(topology, points, f)).collect();
        let cut = |f: usize| {
            let cut = times(0.25, twist(topology, f, points));
            let near = sheets[f].and_then(|sheet| sheet.distance(&[cut], 0.0));
            near.map_or(length(cut), |near| near.min(length(cut)))
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
        let near = self.sheets[face].and_then(|sheet| sheet.distance(displacements, rest));
        near.map_or(far, |near| near.min(far)) + self.cuts[face]
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
    let surface = Surface::of(base);
    let (mut level, mut bound, mut greatest) = (base.clone(), 0.0_f64, 0.0_f64);
    for ahead in 0..=AHEAD {
        let known = known(&level, &surface, spline);
        greatest = known.iter().map(|face| face.moved).fold(greatest, f64::max);
        if ahead < WHOLE && level.faces_after(1) <= FOLLOWED_FACES {
            level = level.next(&spline.plan, spline.round(ahead), watch)?;
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
            Some(part) => level = part.next(&spline.plan, spline.round(ahead), watch)?,
        }
    }
    Ok(bound)
}
