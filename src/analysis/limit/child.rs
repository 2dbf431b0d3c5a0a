//! The children of vertices, edges and faces in one step.
//!
//! Upsamplings keep vertices; the middle of an edge or a face becomes a vertex, or at odd arities the middle of a
//! piece. A D makes a face of a vertex and a vertex of a face. A boundary vertex with m faces has no face in the dual
//! but a path of m points on its boundary, whose middle takes its place: a vertex where m is odd, an edge where it is
//! even. An inner vertex with two faces becomes the edge between these.

use super::disc::Centre;
use super::dual::DualNet;
use super::error::Unlimited;
use super::record::CycleRecord;
use crate::math::functions::real;
use crate::math::rows::Rows;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::Children;
use crate::shape::topology::{Topology, index};

/// Tolerance within which two weights are equal, relative to a weight of a middle. It is far above the rounding of such
/// a weight, a few times 2e-16, and far below the differences between the weights of different rules, so that half and
/// twice of it decide alike.
const WEIGHT_TOLERANCE: f64 = 1e-9;

/// Returns the child in the net `after` of a centre in the net `before` a step. The step is the last one on `record`.
///
/// # Errors
/// [`Unlimited::Lost`] and [`Unlimited::Separated`].
pub(in crate::analysis) fn child(
    centre: Centre,
    children: Children,
    [before, after]: [&MeshNet; 2],
    record: &CycleRecord,
) -> Result<Centre, Unlimited> {
    match (children, centre) {
        (Children::Same, _) | (Children::Vertices, Centre::Vertex(_)) => Ok(centre),
        (Children::Vertices, _) => {
            let (topology, finer) = (before.mesh.topology(), after.mesh.topology());
            record.last().and_then(|rows| middle(centre, &topology, &finer, &rows)).ok_or(Unlimited::Lost)
        }
        (Children::Dual, _) => DualNet::of(before, after)?.child(centre),
        (Children::Faces, _) => cut(centre, before, after),
    }
}

/// Returns the vertices of a centre: one vertex, two of an edge, or all of a face.
fn cell(centre: Centre, topology: &Topology) -> Vec<u32> {
    match centre {
        Centre::Vertex(v) => vec![v],
        Centre::Edge(half_edge) => vec![topology.vertex(half_edge), topology.vertex(topology.next(half_edge))],
        Centre::Face(f) => topology.face(f as usize).to_vec(),
    }
}

/// Returns the vertex at the mean of the vertices of an edge or a face, or else the edge or face with that mean.
fn middle(centre: Centre, topology: &Topology, finer: &Topology, rows: &Rows) -> Option<Centre> {
    let old = cell(centre, topology);
    let is_middle = |new: &[u32]| is_mean(&old, new, rows);
    let vertex = (0..index(rows.len())).find(|&row| is_middle(&[row]));
    let piece = || match centre {
        Centre::Vertex(_) => None,
        Centre::Edge(_) => {
            let corners = 0..index(finer.n_half_edges());
            corners.map(Centre::Edge).find(|&piece| is_middle(&cell(piece, finer)))
        }
        Centre::Face(_) => (0..index(finer.n_faces())).find(|&f| is_middle(finer.face(f as usize))).map(Centre::Face),
    };
    vertex.map(Centre::Vertex).or_else(piece)
}

/// Returns whether the mean of some new vertices is the mean of some old ones.
fn is_mean(old: &[u32], new: &[u32], rows: &Rows) -> bool {
    let mut weights = vec![0.0; old.len()];
    for &row in new {
        let (columns, values) = rows.row(row as usize);
        for (column, value) in columns.iter().zip(values) {
            match old.iter().position(|v| v == column) {
                Some(at) => weights[at] += value,
                None => return false,
            }
        }
    }
    weights
        .iter()
        .all(|&weight| (weight * real(old.len()) - real(new.len())).abs() <= WEIGHT_TOLERANCE * real(new.len()))
}

/// Returns the child of a centre under a step whose new vertices lie in the corners of faces. A boundary vertex has two
/// of them, and the edge between takes its place; a corner that stays has one of its own.
fn cut(centre: Centre, before: &MeshNet, after: &MeshNet) -> Result<Centre, Unlimited> {
    let (old, new) = (&before.mesh.base, &after.mesh.base);
    let face_of = |corners: &[u32]| {
        let found = (0..new.n_faces()).find(|&f| same_set(new.face(f), corners));
        found.map(|f| Centre::Face(index(f))).ok_or(Unlimited::Lost)
    };
    let edge_of = |ends: [u32; 2]| new.between(ends).map(Centre::Edge).ok_or(Unlimited::Lost);
    match centre {
        Centre::Face(f) => face_of(&old.half_edges(f as usize).collect::<Vec<_>>()),
        Centre::Edge(half_edge) => edge_of([half_edge, old.next(half_edge)]),
        Centre::Vertex(v) => {
            let ring: Vec<u32> = old.ring(v as usize).collect();
            let first = || old.cut_corners_first_at(v, &before.tags.corners);
            let on_boundary = if before.mesh.rounds == 0 { first() } else { Some(ring.clone()) };
            match on_boundary.filter(|_| old.boundary_edges(v as usize).is_some()).as_deref() {
                None => face_of(&ring),
                Some(&[only]) => Ok(Centre::Vertex(only)),
                Some(&[a, b]) => edge_of([a, b]),
                Some(_) => Err(Unlimited::Lost),
            }
        }
    }
}

fn same_set(a: &[u32], b: &[u32]) -> bool {
    a.len() == b.len() && a.iter().all(|x| b.contains(x))
}
