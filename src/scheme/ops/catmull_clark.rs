//! The smoothing half of Catmull-Clark, applied after U.

use super::upsample::ratio;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::creases::{Creases, Rule};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Facts, Follows, Operator, Role, SplineStep};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::rules::TriangleRule;
use crate::scheme::step::{Action, Step, StepError, Values};
use crate::scheme::word::Letter;
use crate::shape::topology::{NONE, Topology, index};

/// Catmull-Clark after U, for faces of any size: `F' = F`, `E' = E/2 + (F1 + F2)/4` (which is `(V1 + V2 + F1 + F2)/4`),
/// `V' = (N-3)/N V + 2/N^2 sum E + 1/N^2 sum F`; boundaries and creases: `E' = E`, `V' = V/2 + (E1 + E2)/4`; corners
/// stay. An edge of sharpness below 1 is that much of a crease, but wholly one where both its halves stay sharp; a vertex
/// whose rule changes in a level is a mean of both.
#[derive(Debug)]
pub struct CatmullClark;

static FACTS: Facts = Facts {
    name: "catmull-clark-smoothing",
    doc: "The smoothing of Catmull and Clark after U: face points stay, edge points E/2 + (F1 + F2)/4, vertices of valence \
     N (N-3)/N V + 2/N^2 sum E + 1/N^2 sum F; boundaries and creases are cubic B-splines, while they are sharp. Used by the preset catmull-clark.",
    source: "Catmull and Clark, CAD 10 (1978), 350-355; boundaries as OpenSubdiv 3.5",
    role: Role::Smooth,
    follows: Follows::SemiSharp,
    ..Facts::USUAL
};

impl Operator for CatmullClark {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn on_polygon(&self, _: &PolygonNet, _: &Values<'_>) -> Result<Step<PolygonNet>, StepError> {
        Err(StepError::WrongNet("catmull-clark refines meshes; for polygons use cubic-b-spline"))
    }

    fn spline(&self, _: &Letter, _: f64) -> Result<SplineStep, &'static str> {
        Ok(SplineStep::Mean)
    }

    fn on_mesh(&self, net: &MeshNet, _: &Values<'_>) -> Result<Step<MeshNet>, StepError> {
        let parent = net.mesh.halved().cloned().ok_or(StepError::NoAnchor)?;
        let (n, n_v, n_e) = (net.mesh.n_vertices(), parent.n_vertices(), parent.n_edges());
        let old = net.clone();
        let creases = Creases::of_parent(net);
        let triangles = if parent.is_quads() { TriangleRule::Catmark } else { net.rules.triangles };
        let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
            if row >= n_v + n_e || old.tags.is_corner(row) || row < n_v && parent.is_isolated(row) {
                out.add(index(row), 1.0);
            } else if row < n_v {
                match creases.as_ref().and_then(|creases| creases.vertex(row)) {
                    None => vertex_row(&parent, row, out),
                    Some(blend) => blend.rules().for_each(|(rule, weight)| ruled_row(&parent, row, rule, weight, out)),
                }
            } else {
                let e = row - n_v;
                let sharpness = creases.as_ref().map_or(0.0, |creases| creases.edge(e));
                let weight = match triangles {
                    TriangleRule::Catmark => 0.25,
                    TriangleRule::Smooth => smooth_weight(&parent, e),
                };
                edge_row(&parent, e, (1.0 - sharpness) * weight, out);
            }
        });
        Ok(Step { net: net.clone(), action: Action::Blend(Box::new(rows)) })
    }
}

fn vertex_row(parent: &Topology, v: usize, out: &mut Rows) {
    match parent.boundary_edges(v) {
        Some(edges) => ruled_row(parent, v, Rule::Crease(edges), 1.0, out),
        None => ruled_row(parent, v, Rule::Smooth, 1.0, out),
    }
}

/// The row of a vertex by one rule, multiplied by `scale`.
#[inline]
fn ruled_row(parent: &Topology, v: usize, rule: Rule, scale: f64, out: &mut Rows) {
    let n_v = index(parent.n_vertices());
    match rule {
        Rule::Corner => out.add(index(v), scale),
        Rule::Crease(edges) => {
            out.add(index(v), scale * 0.5);
            edges.iter().for_each(|&e| out.add(n_v + e, scale * 0.25));
        }
        Rule::Smooth => {
            let n = ratio(parent.ring(v).count(), 1);
            let (edge, face) = (scale * (2.0 / (n * n)), scale * (1.0 / (n * n)));
            out.add(index(v), scale * ((n - 3.0) / n));
            for corner in parent.ring(v) {
                out.add(n_v + parent.edge(corner), edge);
                out.add(n_v + index(parent.n_edges() + parent.face_of(corner)), face);
            }
        }
    }
}

/// The weight of the face points under the triangle rule `smooth`: the mean of 0.47 for a triangle and 1/4 for others.
///
/// Source: OpenSubdiv 3.5, class `Sdc::Scheme` of Catmull-Clark.
fn smooth_weight(parent: &Topology, e: usize) -> f64 {
    let weight = |corner: u32| {
        let triangle = corner != NONE && parent.face(parent.face_of(corner)).len() == 3;
        if triangle { 0.47 } else { 0.25 }
    };
    let [first, second] = parent.halves(e);
    0.5 * (weight(first) + weight(second))
}

/// The row of an edge point; `weight` is that of each face point.
fn edge_row(parent: &Topology, e: usize, weight: f64, out: &mut Rows) {
    let n_v = index(parent.n_vertices());
    let corners = parent.halves(e);
    let here = n_v + index(e);
    if corners[1] == NONE || weight == 0.0 {
        out.add(here, 1.0);
        return;
    }
    out.add(here, 1.0 - 2.0 * weight);
    for corner in corners {
        out.add(n_v + index(parent.n_edges() + parent.face_of(corner)), weight);
    }
}
