//! Pairs triangles into quads where the pairing is unambiguous.
//!
//! Each inner edge between two triangles is a candidate: without it they form a quad. A candidate is valid if the quad
//! is nearly flat and convex, with corners between 30 and 150 degrees. Candidates are taken in the order of how square
//! their quads are. If another candidate of one of its triangles is equally good, the pairing is ambiguous, and the
//! triangles of both stay as they are.

use super::check::FaceList;
use super::topology::{NONE, index};
use crate::math::vector::{cross, direction, dot, minus, plus};

/// Cosine of the largest angle (about 25.8 degrees) between the two triangles of a quad. Half of the angle leaves
/// triangles of strongly curved surfaces unpaired; twice of it pairs triangles across edges that are meant to be seen.
const LEAST_FLATNESS: f64 = 0.9;
/// Largest cosine (of 30 degrees) of a corner of a quad. Half of the angle accepts slivers; twice of it leaves sheared
/// quads as triangles.
const MAX_SKEW: f64 = 0.866_025_403_784_438_6;
/// Two candidates whose largest cosines differ by less are equally good. It is some ten times the rounding of
/// coordinates in single precision, in which many files give them. Half or twice of it only decides about quads that
/// are almost equally good.
const COSINE_TOLERANCE: f64 = 1e-6;

/// An inner edge whose two triangles make a quad.
#[derive(Debug, Clone, Copy, PartialEq)]
struct TrianglePair {
    /// The lower triangle, then the higher one.
    faces: [u32; 2],
    /// The position in each triangle at which the edge starts.
    places: [u32; 2],
    /// The largest absolute cosine of a corner; 0 for a rectangle.
    skew: f64,
}

/// Faces after pairing.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Paired {
    /// The faces; each quad takes the place of its lower triangle.
    pub faces: FaceList,
    /// For each face the old face, or the lower of the two.
    pub kept: Vec<u32>,
    /// For each corner of the faces, the old corner it was (corners of all faces, one after another).
    pub corners: Vec<u32>,
    /// Number of quads that were made.
    pub made: usize,
}

/// Pairs triangles of an oriented manifold; `may_join` tells whether the faces at a diagonal may be joined.
pub fn pair(positions: &[[f64; 3]], faces: &FaceList, may_join: impl Fn(Diagonal) -> bool) -> Paired {
    let mut candidates = candidates(positions, faces);
    candidates.retain(|candidate| may_join(candidate.diagonal(faces)));
    candidates.sort_by(|a, b| a.skew.total_cmp(&b.skew).then(a.faces.cmp(&b.faces)));
    let partner = choose(&candidates, faces.len());
    join(faces, &candidates, &partner)
}

/// The edge that a pairing would remove.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Diagonal {
    /// The two faces at the edge, the lower first.
    pub faces: [u32; 2],
    /// The positions of its two ends in the lower face.
    pub lower: [u32; 2],
    /// The positions of the same two ends in the higher face.
    pub higher: [u32; 2],
    /// The two ends of the edge.
    pub ends: [u32; 2],
}

impl TrianglePair {
    fn diagonal(&self, faces: &FaceList) -> Diagonal {
        let [f, g] = self.faces;
        let [j, k] = self.places;
        let lower = [j, (j + 1) % 3];
        let face = faces.face(f as usize);
        let ends = lower.map(|at| face[at as usize]);
        Diagonal { faces: [f, g], lower, higher: [(k + 1) % 3, k], ends }
    }
}

/// Returns the candidates between triangles, by ascending edge.
fn candidates(positions: &[[f64; 3]], faces: &FaceList) -> Vec<TrianglePair> {
    let mut sides: Vec<([u32; 2], u32, u32, bool)> = Vec::new();
    for f in (0..faces.len()).filter(|&f| faces.face(f).len() == 3) {
        let face = faces.face(f);
        for (j, &a) in (0_u32..).zip(face) {
            let b = face[(j as usize + 1) % 3];
            sides.push(([a.min(b), a.max(b)], index(f), j, a < b));
        }
    }
    sides.sort_unstable();
    let mut found = Vec::new();
    for group in sides.chunk_by(|a, b| a.0 == b.0) {
        let &[(_, f, j, forward), (_, g, k, backward)] = group else { continue };
        if forward == backward || f == g {
            continue;
        }
        let quad = quad(faces, [f, g], [j, k]);
        if quad[1] != quad[3] {
            let places = quad.map(|v| positions[v as usize]);
            found.extend(skew(places).map(|skew| TrianglePair { faces: [f, g], places: [j, k], skew }));
        }
    }
    found
}

/// Returns the quad of two triangles: it starts at the end of the shared edge and runs around the first triangle, then
/// around the other.
fn quad(faces: &FaceList, [f, g]: [u32; 2], [j, k]: [u32; 2]) -> [u32; 4] {
    let (face, other) = (faces.face(f as usize), faces.face(g as usize));
    let at = |face: &[u32], j: u32| face[j as usize % 3];
    [at(face, j + 1), at(face, j + 2), at(face, j), at(other, k + 2)]
}

/// Returns the largest absolute cosine of a corner of the quad `(a, b, c, d)` with the diagonal `(a, c)`; `None` if the
/// quad is bent, not convex, or too skewed.
fn skew([a, b, c, d]: [[f64; 3]; 4]) -> Option<f64> {
    let first = direction(cross(minus(b, a), minus(c, a)))?;
    let second = direction(cross(minus(c, a), minus(d, a)))?;
    if dot(first, second) < LEAST_FLATNESS {
        return None;
    }
    let normal = direction(plus(first, second))?;
    let corners = [[d, a, b], [a, b, c], [b, c, d], [c, d, a]];
    let mut largest = 0.0_f64;
    for [before, at, after] in corners {
        let (inward, outward) = (direction(minus(before, at))?, direction(minus(after, at))?);
        if dot(cross(outward, inward), normal) <= 0.0 {
            return None;
        }
        largest = largest.max(dot(inward, outward).abs());
    }
    (largest <= MAX_SKEW).then_some(largest)
}

/// Returns the candidate that pairs each face, or [`NONE`].
fn choose(candidates: &[TrianglePair], n_faces: usize) -> Vec<u32> {
    let mut of_face: Vec<[u32; 3]> = vec![[NONE; 3]; n_faces];
    for (i, candidate) in candidates.iter().enumerate() {
        for f in candidate.faces {
            if let Some(slot) = of_face[f as usize].iter_mut().find(|slot| **slot == NONE) {
                *slot = index(i);
            }
        }
    }
    let mut chosen = vec![NONE; n_faces];
    let mut settled = vec![false; n_faces];
    let is_open = |candidate: &TrianglePair, settled: &[bool]| candidate.faces.iter().all(|&f| !settled[f as usize]);
    for (i, candidate) in candidates.iter().enumerate() {
        if !is_open(candidate, &settled) {
            continue;
        }
        let around = candidate.faces.iter().flat_map(|&f| of_face[f as usize]);
        let others =
            around.filter(|&other| other != NONE && other as usize != i).map(|other| candidates[other as usize]);
        let is_free = |other: &TrianglePair| other.faces.iter().all(|&f| chosen[f as usize] == NONE);
        let rivals = others.filter(|other| (other.skew - candidate.skew).abs() < COSINE_TOLERANCE && is_free(other));
        let rivals: Vec<TrianglePair> = rivals.collect();
        if rivals.is_empty() {
            candidate.faces.iter().for_each(|&f| chosen[f as usize] = index(i));
        }
        rivals.iter().chain([candidate]).flat_map(|one| one.faces).for_each(|f| settled[f as usize] = true);
    }
    chosen
}

fn join(faces: &FaceList, candidates: &[TrianglePair], chosen: &[u32]) -> Paired {
    let mut paired = Paired::default();
    let starts: Vec<u32> = (0..faces.len())
        .scan(0, |at, f| {
            let start = *at;
            *at += index(faces.face(f).len());
            Some(start)
        })
        .collect();
    for f in 0..faces.len() {
        let start = starts[f];
        let Some(candidate) = candidates.get(chosen[f] as usize) else {
            paired.faces.push(faces.face(f).iter().copied());
            paired.kept.push(index(f));
            paired.corners.extend(start..start + index(faces.face(f).len()));
            continue;
        };
        let [lower, higher] = candidate.faces;
        if lower as usize != f {
            continue;
        }
        let [j, k] = candidate.places;
        let other = starts[higher as usize];
        paired.faces.push(quad(faces, candidate.faces, candidate.places));
        paired.kept.push(lower);
        paired.corners.extend([start + (j + 1) % 3, start + (j + 2) % 3, start + j, other + (k + 2) % 3]);
        paired.made += 1;
    }
    paired
}
