//! Plane sections of a mesh: the polylines in which its triangles cross a plane.

mod chain;

use rayon::prelude::*;

use crate::math::parameter::{Parameter, ParameterKind, Values};
use crate::output::scene::{MeshSource, each_chunk};
use crate::shape::topology::{NONE, index};
use crate::watch::{Stopped, Watch};

use chain::{Crossing, CutSegment, chains};

/// Maximum number of planes of one output.
const MAX_PLANES: usize = 64;

/// The option of formats that write or draw sections.
pub(super) const SECTIONS: Parameter = Parameter::optional(
    "sections",
    ParameterKind::Groups { fields: PLANE, most: MAX_PLANES },
    "Planes that cut the triangles of a mesh; each gives a list of polylines. Of a closed mesh they are closed, \
     with the inside on their left where the normal points to the viewer. Meshes only.",
);

const PLANE: &[Parameter] = &[
    Parameter::required("point", ParameterKind::Vector, "A point of the plane.").in_unit("model units"),
    Parameter::required(
        "normal",
        ParameterKind::Direction,
        "The direction across the plane; its length does not count.",
    ),
];

/// A plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    /// A point of the plane, model units.
    point: [f64; 3],
    /// The normal of the plane; its largest coordinate is 1 or -1.
    pub(super) normal: [f64; 3],
}

/// A polyline of a section.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Polyline {
    /// The points, in model units: at least two, three if the line is closed; neighbours differ.
    pub(super) points: Vec<[f64; 3]>,
    /// Whether the last point is joined to the first.
    pub(super) closed: bool,
}

/// Returns the planes that the options give.
pub(super) fn planes(options: &Values) -> Vec<Plane> {
    let plane = |values: &Values| Some(Plane { point: values.vector("point")?, normal: values.vector("normal")? });
    options.groups(SECTIONS.name).iter().filter_map(plane).collect()
}

/// Returns whether the options give any planes.
pub(super) fn asked(options: &Values) -> bool {
    !options.groups(SECTIONS.name).is_empty()
}

/// Returns the section of a mesh whose vertices have these positions (model units, finite).
///
/// The signed distance of a vertex v from the plane through p with the normal n is `h = n (v - p)`, computed in f64.
/// Every vertex is on one side: before the plane if `h >= 0`, otherwise behind it; so the section is the one just
/// behind the plane.
/// Faces are triangulated (quads by the diagonal 0-2, larger ones as fans). A triangle with vertices on both sides
/// gives the segment between its two sides that cross, and a side crosses at `a + h_a / (h_a - h_b) (b - a)`, computed
/// from the nearer end and so the same for both of its triangles. Segments run from the side that leads behind the
/// plane to the side that leads before it, so that for a viewer to whom the normal points the inside of a closed mesh
/// is on their left.
///
/// Open polylines come first, by the side at which they start; then closed ones, each starting at its lowest side, by
/// these. Sides are compared by their lower vertex, then the higher one. Points equal to the one before are left out,
/// and so are polylines with less than a segment (closed ones: a triangle) left, where the surface only touches the
/// plane.
///
/// # Errors
/// [`Stopped`] when the watch says so.
pub(super) fn section(
    mesh: &dyn MeshSource,
    positions: &[[f64; 3]],
    plane: &Plane,
    watch: &Watch,
) -> Result<Vec<Polyline>, Stopped> {
    let distances = PlaneDistances::new(plane, positions);
    let mut segments: Vec<CutSegment> = Vec::new();
    each_chunk(mesh, watch, |range, chunk| {
        let faces: Vec<(u32, &[u32])> = (index(range.start)..).zip(chunk.iter()).collect();
        let found = faces.par_iter().with_min_len(1024).flat_map_iter(|&(f, face)| distances.segments(f, face));
        segments.par_extend(found);
    })?;
    let polyline = |(crossings, closed): (Vec<Crossing>, bool)| {
        let mut points: Vec<[f64; 3]> = crossings.iter().map(|crossing| distances.point(*crossing)).collect();
        points.dedup();
        while closed && points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        (points.len() >= if closed { 3 } else { 2 }).then_some(Polyline { points, closed })
    };
    Ok(chains(segments, watch)?.into_iter().filter_map(polyline).collect())
}

/// The signed distances of vertices from a plane.
struct PlaneDistances<'a> {
    positions: &'a [[f64; 3]],
    plane: &'a Plane,
    /// A power of two that keeps distances within f64.
    scale: f64,
}

impl<'a> PlaneDistances<'a> {
    fn new(plane: &'a Plane, positions: &'a [[f64; 3]]) -> Self {
        let largest = |points: &[[f64; 3]]| points.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let far = largest(positions).max(largest(&[plane.point])) > 1e300;
        Self { positions, plane, scale: if far { 1.0 / 1024.0 } else { 1.0 } }
    }

    /// Returns the signed distance of a vertex, times the scale.
    fn of(&self, v: u32) -> f64 {
        let (v, p, n) = (self.positions[v as usize], self.plane.point, self.plane.normal);
        let along = |k: usize| n[k] * (v[k] * self.scale - p[k] * self.scale);
        along(0) + along(1) + along(2)
    }

    /// Returns the segments in the triangles of a face.
    fn segments(&self, f: u32, face: &'a [u32]) -> impl Iterator<Item = CutSegment> + use<'a> {
        let before: Vec<bool> = face.iter().map(|&v| self.of(v) >= 0.0).collect();
        let crosses = before.iter().any(|side| *side != before[0]);
        let last = face.len() - 1;
        let triangles = if crosses { 1..last } else { 1..1 };
        triangles.filter_map(move |k| {
            let corners = [0, k, k + 1];
            let side = |i: usize| {
                let [a, b] = [corners[i], corners[(i + 1) % 3]];
                let inner = i == 0 && k > 1 || i == 2 && k + 1 < last;
                let ends = [face[a].min(face[b]), face[a].max(face[b])];
                ([before[a], before[b]], Crossing { ends, inside: if inner { f } else { NONE } })
            };
            let sides = [side(0), side(1), side(2)];
            let found = |run: [bool; 2]| sides.iter().find(|side| side.0 == run).map(|side| side.1);
            Some(CutSegment { from: found([true, false])?, to: found([false, true])? })
        })
    }

    /// Returns the position of a crossing, model units.
    fn point(&self, crossing: Crossing) -> [f64; 3] {
        let [low, high] = crossing.ends.map(|v| (self.of(v), self.positions[v as usize]));
        let (near, far) = if low.0.abs() <= high.0.abs() { (low, high) } else { (high, low) };
        let share = near.0 / (near.0 - far.0);
        std::array::from_fn(|k| {
            let (a, b) = (near.1[k], far.1[k]);
            let way = b - a;
            // the difference of the ends may overflow
            (if way.is_finite() { a + share * way } else { (1.0 - share) * a + share * b }) + 0.0
        })
    }
}
