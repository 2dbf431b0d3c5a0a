//! A level of Doo-Sabin subdivision.

use std::collections::BTreeMap;

use super::around;
use super::cosines::cosine;
use super::dual::no_manifold;
use crate::math::functions::ratio;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::forecast::{Census, sum};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Children, Facts, Nets, Operator, Role};
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::shape::topology::{NONE, Topology, index};

/// Doo and Sabin: a new vertex for each corner of a face of n vertices, with the weights `w[0] = (n + 5)/(4n)` of the
/// corner itself and `w[i] = (3 + 2 cos(2 pi i/n))/(4n)` of the vertex i places further; a face for each face, edge and
/// vertex (order: see [`Topology::cut_corners`]).
///
/// The surface is reflected at its boundary, which is the quadratic B-spline of the boundary polygon. In the first step
/// a boundary edge `(a, b)` gets the vertices `(3a + b)/4` and `(a + 3b)/4`, and the strip between them and the new
/// vertices inside consists of half faces. From then on a half face `(a, b, c[1], ..., c[k])` stands for the face of 2k
/// vertices `c[1], ..., c[k], 2 m[k] - c[k], ..., 2 m[1] - c[1]` with the axis
/// `m[i] = (a + b)/2 + (b - a)/2 cos(pi (i - 1/2)/k) / cos(pi/2k)`, which the step maps to itself. Corners, which have
/// one face, stay; the quarter face there gives the mean of its vertices, and its boundary edges their middles.
#[derive(Debug)]
pub struct DooSabin;

static FACTS: Facts = Facts {
    name: "doo-sabin",
    doc: "A level of Doo and Sabin: a new vertex for each corner of a face of n vertices, with weights (n + 5)/(4n) \
     for the corner and (3 + 2 cos(2 pi i/n))/(4n) for the others; a face for each face, edge and vertex. Boundaries \
     follow Chaikin, and the surface is reflected at them. Used by the preset doo-sabin.",
    source: "Doo and Sabin, CAD 10 (1978), 356-360; Doo, Proc. Interactive Techniques in CAD (1978), 157-165",
    nets: Nets::Meshes("doo-sabin refines meshes; for polygons use chaikin"),
    role: Role::Smooth,
    children: Children::Faces,
    rebuilds: true,
    ..Facts::USUAL
};

impl Operator for DooSabin {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn admits(&self, net: &MeshNet) -> Result<(), StepError> {
        let topology = &net.mesh.base;
        if !net.tags.holes.is_empty() {
            return Err(around::cannot_follow("doo-sabin", "holes (boundary \"none\" makes some)"));
        }
        around::check("doo-sabin", topology)?;
        for v in 0..topology.n_vertices() {
            let n = topology.ring(v).count();
            let inner = topology.boundary_edges(v).is_none();
            if inner && n == 2 {
                return Err(around::two_faces("doo-sabin", v));
            }
            if net.tags.is_corner(v) && (inner || n != 1) {
                return Err(inner_corner(v));
            }
        }
        Ok(())
    }

    fn census(&self, before: &Census) -> Census {
        let Census { count, boundary: b, corners: q, isolated, rounds } = *before;
        let (v, e, f, c) = (count.vertices, count.edges, count.faces, count.corners);
        if rounds == 0 {
            let vertices = sum(&[(1, c), (2, b), (1, q)]);
            let faces = sum(&[(1, f), (1, e), (1, v.saturating_sub(isolated))]);
            let corners = sum(&[(2, c), (4, e), (2, b), (1, q)]);
            let largest = count.largest_face.max(count.largest_fan).max(4);
            let after = before.after([vertices, faces, corners, largest], sum(&[(2, b), (1, q)]));
            return Census { isolated: 0, ..after };
        }
        let inner = e.saturating_sub(b);
        let faces = sum(&[(1, f), (1, inner), (1, v.saturating_sub(b))]);
        let corners = sum(&[(2, c), (4, inner), (1, q)]).saturating_sub(sum(&[(2, b)]));
        // all interior vertices have four faces
        let largest = count.largest_face.max(4);
        before.after([c, faces, corners, largest], sum(&[(2, b)]).saturating_sub(q))
    }

    fn on_mesh(&self, net: &MeshNet, _: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        if net.mesh.rounds == 0 {
            self.admits(net)?;
        }
        let old = net.mesh.base.clone();
        let (n_c, n_old) = (index(old.n_half_edges()), old.n_vertices());
        let weights = FaceWeights::of(&old);
        if net.mesh.rounds > 0 {
            let next = net.after_rebuild(old.cut_corners(), later_corners(net));
            let is_open = old.n_boundary() > 0;
            let rows = RowsBy::new(next.mesh.n_vertices(), n_old, move |row, out: &mut Rows| {
                let half_edge = index(row);
                if is_open {
                    later_row(&old, &weights, half_edge, out);
                } else {
                    face_row(&old, &weights, half_edge, out);
                }
            });
            return Ok(Step { net: next, action: Action::Blend(Box::new(rows)) });
        }
        let topology = old.cut_corners_first(&net.tags.corners).map_err(|faults| no_manifold(&faults))?;
        let boundary: Vec<u32> = (0..old.n_edges()).filter(|&e| old.is_boundary_edge(e)).map(index).collect();
        let (fixed, n_on_boundary) = (net.tags.corners.clone(), 2 * boundary.len());
        let first_fixed = n_c + index(n_on_boundary);
        let next = net.after_rebuild(topology, (first_fixed..).take(fixed.len()).collect());
        let rows = RowsBy::new(next.mesh.n_vertices(), n_old, move |row, out: &mut Rows| {
            let Some(beyond) = row.checked_sub(n_c as usize) else {
                return face_row(&old, &weights, index(row), out);
            };
            if let Some(&edge) = boundary.get(beyond / 2).filter(|_| beyond < n_on_boundary) {
                let [a, b] = old.ends(edge as usize);
                let [near, far] = if beyond.is_multiple_of(2) { [a, b] } else { [b, a] };
                out.add(near, CHAIKIN_WEIGHTS[0]);
                out.add(far, CHAIKIN_WEIGHTS[1]);
            } else {
                out.add(fixed[beyond - n_on_boundary], 1.0);
            }
        });
        Ok(Step { net: next, action: Action::Blend(Box::new(rows)) })
    }
}

/// Returns the corners after a step that is not the first: each has one face, in whose corner the new vertex lies.
fn later_corners(net: &MeshNet) -> Vec<u32> {
    let mut corners: Vec<u32> =
        net.tags.corners.iter().filter_map(|&v| net.mesh.base.ring(v as usize).next()).collect();
    corners.sort_unstable();
    corners
}

/// The weights of faces by size; those of quads are stored separately, so that no table is searched for them.
#[derive(Debug)]
struct FaceWeights {
    quad: [f64; 4],
    others: BTreeMap<usize, Vec<f64>>,
}

/// The weights of Chaikin's scheme, which the boundary follows.
const CHAIKIN_WEIGHTS: [f64; 2] = [0.75, 0.25];

impl FaceWeights {
    fn of(topology: &Topology) -> Self {
        let mut others = BTreeMap::from([(2, CHAIKIN_WEIGHTS.to_vec())]);
        for f in 0..topology.n_faces() {
            // a half face of n vertices has n - 2 vertices inside and as many reflected ones
            let n = topology.face(f).len();
            for n in [n, 2 * n - 4].into_iter().filter(|&n| n != 4) {
                others.entry(n).or_insert_with(|| (0..n).map(|i| weight(i, n)).collect());
            }
        }
        Self { quad: std::array::from_fn(|i| weight(i, 4)), others }
    }

    #[inline]
    fn of_size(&self, n: usize) -> &[f64] {
        if n == 4 { &self.quad } else { &self.others[&n] }
    }
}

/// Returns the weight of the vertex `i` places from the corner in a face of `n` vertices, at least 3.
fn weight(i: usize, n: usize) -> f64 {
    let own = if i == 0 { ratio(1, 4) } else { 0.0 };
    own + (3.0 + 2.0 * cosine(i, n)) / ratio(4 * n, 1)
}

/// Adds the row of the new vertex at a corner of a whole face.
#[inline]
fn face_row(old: &Topology, weights: &FaceWeights, half_edge: u32, out: &mut Rows) {
    let range = old.half_edges(old.face_of(half_edge));
    let around = (half_edge..range.end).chain(range.start..half_edge);
    let weights = weights.of_size((range.end - range.start) as usize);
    around.zip(weights).for_each(|(other, &weight)| out.add(old.vertex(other), weight));
}

/// Adds the row of the new vertex at a corner after the first step of an open mesh.
fn later_row(old: &Topology, weights: &FaceWeights, half_edge: u32, out: &mut Rows) {
    let is_boundary = |half_edge: u32| old.twin(half_edge) == NONE;
    let before = old.previous(half_edge);
    match (is_boundary(before), is_boundary(half_edge)) {
        (true, true) => out.add(old.vertex(half_edge), 1.0),
        (false, true) => boundary_row(old, half_edge, old.next(half_edge), is_boundary(old.next(half_edge)), out),
        (true, false) => boundary_row(old, half_edge, before, is_boundary(old.previous(before)), out),
        (false, false) => {
            let mut boundaries = old.half_edges(old.face_of(half_edge)).filter(|&half_edge| is_boundary(half_edge));
            match (boundaries.next(), boundaries.next()) {
                (None, _) => face_row(old, weights, half_edge, out),
                (Some(boundary), None) => half_row(old, weights, half_edge, boundary, out),
                (Some(_), Some(_)) => {
                    let face = old.face(old.face_of(half_edge));
                    face.iter().for_each(|&v| out.add(v, ratio(1, face.len())));
                }
            }
        }
    }
}

/// Adds the row of a vertex on a boundary edge, near one end; an edge that ends in a corner is half as long as others.
fn boundary_row(old: &Topology, near: u32, far: u32, to_corner: bool, out: &mut Rows) {
    let share = if to_corner { 0.5 } else { CHAIKIN_WEIGHTS[1] };
    out.add(old.vertex(near), 1.0 - share);
    out.add(old.vertex(far), share);
}

/// Adds the row of a vertex inside a half face whose boundary edge is `boundary`.
fn half_row(old: &Topology, weights: &FaceWeights, half_edge: u32, boundary: u32, out: &mut Rows) {
    let end = old.next(boundary);
    let k = old.face(old.face_of(boundary)).len() - 2;
    let weights = weights.of_size(2 * k);
    let axis = |i: usize| if k == 1 { 0.0 } else { cosine(2 * i + 1, 4 * k) / cosine(1, 4 * k) };
    let around = || std::iter::successors(Some(old.next(end)), |&other| Some(old.next(other))).take(k);
    let own = around().position(|other| other == half_edge).unwrap_or(0);
    // the axis maps to itself at half the length; points off the axis are weighted directly and by their reflection
    let (mut centre, mut along) = (1.0, axis(own) / 2.0);
    for (i, other) in around().enumerate() {
        let weight = weights[own.abs_diff(i)] - weights[(own + i + 1) % (2 * k)];
        out.add(old.vertex(other), weight);
        centre -= weight;
        along -= weight * axis(i);
    }
    out.add(old.vertex(boundary), 0.5 * centre - 0.5 * along);
    out.add(old.vertex(end), 0.5 * centre + 0.5 * along);
}

/// Returns the error for a tagged corner that has no vertex after the step.
fn inner_corner(v: usize) -> StepError {
    let kept = "doo-sabin, which makes faces of vertices, keeps corners only on the boundary where one face meets them";
    StepError::new(format!("vertex {v} is tagged as a corner; {kept}: leave the tag out"))
}
