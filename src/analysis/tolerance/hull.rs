//! Bounds the distance between a face and its limit where the net is not regular, by the convex hull of the points that
//! the limit depends on.

use std::sync::OnceLock;

use super::level::ComparedNet;
use super::sheet::{flat, normal, windings};
use crate::math::distinct::distinct;
use crate::math::functions::{real, sqrt};
use crate::math::vector::{Vector, cross, dot, length, mean, minus, plus, times, unit};
use crate::shape::topology::NONE;

/// Maximum number of corrections to the normal of a separating line.
/// Half of it misses lines that are found at the ninth correction or later, and the bound is larger there; twice of it
/// takes up to twice as long where no line separates the points.
const MAX_NORMAL_CORRECTIONS: usize = 16;
/// Maximum number of rings of faces that a limit may depend on; with more, there are too many points to project.
/// Their number grows with the fourth power of the rings and is 1,764 per face at 2. Half of it leaves out limits that
/// depend on two rings; twice of it projects 12,100 points per face.
pub(super) const MAX_REACH: usize = 2;
/// Maximum number of points that are projected for all faces of a level together.
/// At about 25 ns a point they take a second. Half and twice of it halve and double that time and the number of faces
/// up to which hulls are used; beyond, faces are bounded by second differences or by boxes.
const MAX_PROJECTED_POINTS: usize = 1 << 25;

/// The points that the limits of faces depend on.
///
/// Let W be the faces around a face within one ring more than its limit depends on. Let all their normals have positive
/// products with a direction n, and let them wind around no inner vertex more than once, so that W is locally a graph
/// over the plane across n. Let K(g) be the convex hull of the points that the limit of a face g depends on; it
/// contains both g and its limit.
///
/// 1. If K of the central face does not meet the boundary of W, seen along n, the graph can be lifted over all of K:
///    each point of the limit of the central face is above or below some point of W.
/// 2. If K of no face beyond the boundary of W meets the central face, the straight homotopy from the boundary to its
///    limit does not meet it either. So the limit of W winds around each point of the central face as often as W does,
///    which is at least once: some point of the limit is above or below it (invariance of the degree).
///
/// If both hold, the distance either way is at most the height along n of the corners of W and of those K(g) of its
/// faces that meet the central face.
pub(super) struct Hulls<'a> {
    level: &'a ComparedNet,
    /// Number of rings of faces that the limit of a face depends on.
    reach: usize,
    /// For each face the vertices that its limit depends on, once they are needed.
    near: Vec<OnceLock<Vec<u32>>>,
}

impl<'a> Hulls<'a> {
    pub(super) fn of(level: &'a ComparedNet, reach: usize) -> Self {
        Self { level, reach, near: (0..level.topology.n_faces()).map(|_| OnceLock::new()).collect() }
    }

    /// Returns `self` if the heights of `faces` faces are not too much work.
    pub(super) fn affordable(&self, faces: usize) -> Option<&Self> {
        (self.reach <= MAX_REACH && self.work(faces) <= MAX_PROJECTED_POINTS).then_some(self)
    }

    /// Returns the number of points that are projected for `faces` faces: on regular quads, each has `(2 reach + 3)^2`
    /// faces in W, whose limits depend on `(2 reach + 2)^2` points each.
    pub(super) fn work(&self, faces: usize) -> usize {
        let square = |side: usize| side * side;
        faces.saturating_mul(square(2 * self.reach + 3) * square(2 * self.reach + 2))
    }

    /// Returns an upper bound of the distance of a face from the limit, and of its limit from the net. `None` if the
    /// conditions of [`Hulls`] are not found to hold or a face of W does not belong to the surface, as `belongs` tells.
    pub(super) fn height(&self, face: usize, belongs: impl Fn(usize) -> bool) -> Option<f64> {
        let topology = &self.level.topology;
        let points = self.level.points.now.as_chunks::<3>().0;
        let around = self.around(face, self.reach + 1);
        if !around.iter().all(|&f| belongs(f)) {
            return None;
        }
        let at = |half_edge: u32| points[topology.vertex(half_edge) as usize];
        let end = |half_edge: u32| at(topology.next(half_edge));
        let area = |half_edge: u32| normal(topology, points, half_edge);
        let half_edges = || around.iter().flat_map(|&f| topology.half_edges(f));
        let sum = half_edges().map(area).fold([0.0; 3], plus);
        let size = Some(length(sum)).filter(|&size| size > 0.0)?;
        let n = times(1.0 / size, sum);
        if !half_edges().all(|half_edge| dot(n, area(half_edge)) > 0.0) {
            return None;
        }
        let plane = WhitenedPlane::of(n, half_edges().map(at))?;
        let of_near = |face: usize| self.near(face).iter().map(|&v| points[v as usize]);
        let seen = |face: usize| -> Vec<PlanePoint> { of_near(face).map(|p| plane.project(p)).collect() };
        let face_points: Vec<PlanePoint> =
            topology.face(face).iter().map(|&v| plane.project(points[v as usize])).collect();
        let hull = seen(face);
        for half_edge in half_edges() {
            let twin = topology.twin(half_edge);
            let across = if twin == NONE { return None } else { topology.face_of(twin) };
            let is_boundary = around.binary_search(&across).is_err();
            let edge = [at(half_edge), end(half_edge)].map(|p| plane.project(p));
            if is_boundary && !(are_apart(&hull, &edge) && are_apart(&face_points, &seen(across))) {
                return None;
            }
        }
        let ends = |half_edge: u32| minus(end(half_edge), at(half_edge));
        let is_inside = |v: u32| topology.ring(v as usize).all(|c| around.binary_search(&topology.face_of(c)).is_ok());
        let inner = distinct(around.iter().flat_map(|&f| topology.face(f)).copied());
        if inner.iter().any(|&v| is_inside(v) && windings(n, topology.ring(v as usize).map(ends)) > 1) {
            return None;
        }
        let start = points[topology.face(face)[0] as usize];
        let height = |p: Vector| dot(n, minus(p, start));
        let reaching = around.iter().filter(|&&g| !are_apart(&face_points, &seen(g)));
        let all = reaching.flat_map(|&g| of_near(g)).chain(half_edges().map(at)).map(height);
        let (low, high) = all.fold((0.0_f64, 0.0_f64), |(low, high), h| (low.min(h), high.max(h)));
        Some(high - low)
    }

    /// Returns the vertices that the limit of a face depends on.
    fn near(&self, face: usize) -> &[u32] {
        self.near[face].get_or_init(|| {
            let faces = self.around(face, self.reach);
            distinct(faces.iter().flat_map(|&f| self.level.topology.face(f)).copied())
        })
    }

    /// Returns a face and the faces within `rings` rings around it, ascending.
    fn around(&self, face: usize, rings: usize) -> Vec<usize> {
        let topology = &self.level.topology;
        let mut all = vec![face];
        let mut outermost = vec![face];
        for _ in 0..rings {
            let half_edges = outermost.iter().flat_map(|&f| topology.face(f)).flat_map(|&v| topology.ring(v as usize));
            let mut next = distinct(half_edges.map(|half_edge| topology.face_of(half_edge)));
            next.retain(|f| all.binary_search(f).is_err());
            all.extend(&next);
            all.sort_unstable();
            outermost = next;
        }
        all
    }
}

/// A point of a plane.
type PlanePoint = [f64; 2];

/// A plane across a direction, with affine coordinates in which given points have the same variance in all directions.
/// Whether a line separates points does not depend on the coordinates.
struct WhitenedPlane {
    origin: Vector,
    axes: [Vector; 2],
}

impl WhitenedPlane {
    /// Creates the plane across `n` for some points; `None` if their projections lie on a line.
    fn of(n: Vector, points: impl Iterator<Item = Vector> + Clone) -> Option<Self> {
        let origin = mean(points.clone());
        let longest = |most: Vector, p: Vector| {
            let x = flat(n, minus(p, origin));
            if length(x) > length(most) { x } else { most }
        };
        let along = points.clone().fold([0.0; 3], longest);
        let along = times(1.0 / length(along), along);
        let across = cross(n, along);
        let mut moments = [0.0; 3];
        for x in points.map(|p| minus(p, origin)) {
            let (u, v) = (dot(along, x), dot(across, x));
            moments.iter_mut().zip([u * u, u * v, v * v]).for_each(|(sum, part)| *sum += part);
        }
        // the Cholesky factor of the matrix of moments
        let [uu, uv, vv] = moments;
        let first = sqrt(uu);
        let mixed = uv / first;
        let second = sqrt(vv - mixed * mixed);
        let along = times(1.0 / first, along);
        let across = times(1.0 / second, minus(across, times(mixed, along)));
        (length(along).is_finite() && length(across).is_finite()).then_some(Self { origin, axes: [along, across] })
    }

    fn project(&self, p: Vector) -> PlanePoint {
        self.axes.map(|axis| dot(axis, minus(p, self.origin)))
    }
}

/// Returns whether a line is found that separates two sets of points. As with the perceptron, its normal is corrected
/// up to [`MAX_NORMAL_CORRECTIONS`] times by the pair of points that it separates worst.
/// Source: F. Rosenblatt, Psychological Review 65 (1958), 386-408.
fn are_apart(a: &[PlanePoint], b: &[PlanePoint]) -> bool {
    let mean_of = |points: &[PlanePoint]| points.iter().copied().fold([0.0; 2], plus).map(|x| x / real(points.len()));
    let mut normal = unit(minus(mean_of(b), mean_of(a)));
    for _ in 0..MAX_NORMAL_CORRECTIONS {
        let extreme = |points: &[PlanePoint], sign: f64| {
            let ahead = |p: &PlanePoint| sign * dot(normal, *p);
            points.iter().copied().reduce(|most, p| if ahead(&p) > ahead(&most) { p } else { most })
        };
        let (Some(far), Some(near)) = (extreme(a, 1.0), extreme(b, -1.0)) else { return false };
        let gap = minus(near, far);
        if dot(normal, gap) > 0.0 {
            return true;
        }
        normal = plus(normal, unit(gap));
    }
    false
}
