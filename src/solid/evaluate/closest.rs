//! Finds the place of the limit surface that is closest to a point.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::boxes::BoxTree;
use super::patch::{BezierPatch, NearestPlace};
use super::pieces::{ExtraordinaryFace, LeafRing, MAX_END_RINGS, Square, SurfacePart, SurfaceParts};
use super::place::Place;
use crate::math::vector::{Vector, length, minus};
use crate::scheme::plan::Plan;
use crate::shape::mesh::Mesh;
use crate::solid::error::SolidError;
use crate::solid::level::Refiner;
use crate::watch::Watch;

/// Resolution of distances relative to the size of the surface. Half of it costs one more quartering where no minimum
/// is certain; twice of it would do for every known use.
const DISTANCE_RESOLUTION: f64 = 1e-9;
/// Maximum number of quarterings for a point. Points at equal distance from much of the surface, such as the centre of
/// a sphere, would take any number. Half as many end more of these early; twice as many take them twice as long.
const MAX_QUARTERINGS: usize = 8_192;
/// Number of points whose ends are searched together. Half as many make rings twice as often; twice as many take twice
/// the memory.
const POINTS_PER_SEARCH: usize = 1 << 16;

/// The place closest to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// The place; on the lowest of several faces that share it.
    pub place: Place,
    /// Its position, in model units.
    pub at: Vector,
    /// Its distance from the point, in model units.
    pub distance: f64,
    /// Whether no other place is nearer by more than 1e-9 of the size of the surface.
    pub is_certain: bool,
}

/// The best place so far.
#[derive(Debug, Clone, Copy)]
struct Best {
    square: Option<Square>,
    near: NearestPlace,
    /// Number of quarterings left.
    left: usize,
    is_certain: bool,
}

impl Best {
    const NONE: Self = Self {
        square: None,
        near: NearestPlace { uv: [0.0; 2], at: [0.0; 3], distance: f64::INFINITY, is_settled: false },
        left: MAX_QUARTERINGS,
        is_certain: true,
    };

    /// Replaces the best place by one that is nearer, or equally near in a lower face.
    fn take(&mut self, square: Square, near: NearestPlace) {
        let order = near.distance.total_cmp(&self.near.distance);
        let is_lower = || self.square.is_none_or(|old| (square.face, square.corner) < (old.face, old.corner));
        if order == Ordering::Less || order == Ordering::Equal && is_lower() {
            (self.square, self.near) = (Some(square), near);
        }
    }

    /// Replaces the best place by a vertex if that is nearer.
    fn take_vertex(&mut self, square: Square, (uv, at): ([f64; 2], Vector), point: Vector) {
        self.take(square, NearestPlace { uv, at, distance: length(minus(at, point)), is_settled: true });
    }

    /// Searches a piece for a nearer place; parts of the piece are visited in the order of their bounds.
    fn search(&mut self, square: Square, patch: &BezierPatch, point: Vector, tolerance: f64) {
        let mut waiting = vec![(patch.at_least(point), patch.clone())];
        while let Some((at_least, patch)) = waiting.pop() {
            if at_least >= self.near.distance - tolerance {
                continue;
            }
            let near = patch.descend(point, tolerance);
            self.take(square, near);
            if near.is_settled && patch.is_convex(point) {
                continue;
            }
            if self.left == 0 {
                self.is_certain = false;
                continue;
            }
            self.left -= 1;
            let mut quarters = patch.quarters().map(|patch| (patch.at_least(point), patch));
            quarters.sort_by(|a, b| b.0.total_cmp(&a.0));
            waiting.extend(quarters);
        }
    }
}

/// An end with the rings made so far.
struct EndRings<'a> {
    end: ExtraordinaryFace,
    made: Vec<LeafRing>,
    refiner: &'a Refiner<'a>,
}

impl EndRings<'_> {
    /// Searches an end for a nearer place: the vertex, then ring by ring.
    fn search(&mut self, square: Square, best: &mut Best, point: Vector, tolerance: f64) -> Result<(), SolidError> {
        best.take_vertex(square, self.end.vertex, point);
        for i in 0..MAX_END_RINGS {
            if i == self.made.len() {
                let ring = self.end.ring(self.refiner)?;
                self.made.push(ring);
            }
            let ring = &self.made[i];
            ring.patches.iter().for_each(|patch| best.search(square, patch, point, tolerance));
            if ring.rest.distance(point) >= best.near.distance - tolerance {
                return Ok(());
            }
            if ring.rest.diagonal() <= tolerance {
                break;
            }
        }
        Ok(())
    }
}

/// The place of the limit surface of a mesh that is closest to each of some points, in their order, under a plan whose
/// regular pieces are bicubic. Holes are no part of the surface.
///
/// Pieces that are too far away are ruled out by boxes and by [`BezierPatch::at_least`]; in the others Newton's method
/// looks for minima, and pieces are quartered until there is but one, or they are ruled out.
///
/// # Errors
/// When the watch says stop, nothing of the surface is shown, or a coordinate is no longer finite.
pub fn closest(mesh: &Mesh, plan: &Plan, points: &[Vector], watch: &Watch) -> Result<Vec<Closest>, SolidError> {
    let refiner = Refiner::new(plan, watch)?;
    let parts = SurfaceParts::of(mesh, plan, &refiner)?;
    if parts.all.is_empty() {
        return Err(SolidError::empty());
    }
    let tree = BoxTree::of(&parts.boxes);
    let tolerance = DISTANCE_RESOLUTION * tree.diagonal();
    let mut found = Vec::with_capacity(points.len());
    for points in points.chunks(POINTS_PER_SEARCH) {
        let in_leaves = |&point: &Vector| {
            watch.check()?;
            Ok::<_, SolidError>(in_leaves(&parts, &tree, point, tolerance))
        };
        let (mut best, open): (Vec<Best>, Vec<Vec<u32>>) =
            points.par_iter().map(in_leaves).collect::<Result<Vec<_>, _>>()?.into_iter().unzip();
        let looked_at = in_ends(&parts, &refiner, (points, &best, &open), tolerance)?;
        for (i, candidate) in looked_at {
            let best = &mut best[i as usize];
            let certain = best.is_certain && candidate.is_certain;
            if let Some(square) = candidate.square {
                best.take(square, candidate.near);
            }
            best.is_certain = certain;
        }
        found.extend(best.iter().filter_map(|best| {
            let NearestPlace { uv, at, distance, .. } = best.near;
            let place = best.square?.place(uv).lowest(&mesh.topology, &parts.is_shown);
            Some(Closest { place, at, distance, is_certain: best.is_certain })
        }));
        watch.advance(points.len() as u64);
    }
    Ok(found)
}

/// Returns the best place in bicubic pieces, and the ends that may have a better one.
fn in_leaves(parts: &SurfaceParts, tree: &BoxTree, point: Vector, tolerance: f64) -> (Best, Vec<u32>) {
    let mut best = Best::NONE;
    let mut ends = Vec::new();
    tree.visit(point, |number| {
        let (square, part) = &parts.all[number as usize];
        let distance = parts.boxes[number as usize].distance(point);
        if distance < best.near.distance {
            match part {
                SurfacePart::Leaf(patch) => best.search(*square, patch, point, tolerance),
                SurfacePart::End(end) => {
                    // the distance of any of its points is an upper bound
                    best.take_vertex(*square, end.across, point);
                    ends.push((distance, number));
                }
            }
        }
        best.near.distance
    });
    let open = ends.into_iter().filter(|&(distance, _)| distance < best.near.distance - tolerance);
    (best, open.map(|(_, number)| number).collect())
}

/// Returns the nearer places in ends: the index of a point and its best place, end after end.
fn in_ends(
    parts: &SurfaceParts,
    refiner: &Refiner<'_>,
    (points, best, open): (&[Vector], &[Best], &[Vec<u32>]),
    tolerance: f64,
) -> Result<Vec<(u32, Best)>, SolidError> {
    let mut pairs: Vec<(u32, u32)> =
        (0..).zip(open).flat_map(|(i, ends)| ends.iter().map(move |&end| (end, i))).collect();
    pairs.sort_unstable();
    let runs: Vec<&[(u32, u32)]> = pairs.chunk_by(|a, b| a.0 == b.0).collect();
    let looked_at = runs.into_par_iter().map(|run| {
        let mut found = Vec::new();
        let (square, SurfacePart::End(end)) = &parts.all[run[0].0 as usize] else { return Ok(found) };
        let mut rings = EndRings { end: (**end).clone(), made: Vec::new(), refiner };
        for &(_, i) in run {
            refiner.watch.check()?;
            let mut candidate = best[i as usize];
            rings.search(*square, &mut candidate, points[i as usize], tolerance)?;
            found.push((i, candidate));
        }
        Ok(found)
    });
    let found: Vec<Vec<(u32, Best)>> = looked_at.collect::<Result<_, SolidError>>()?;
    Ok(found.into_iter().flatten().collect())
}
