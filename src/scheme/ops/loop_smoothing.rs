//! The smoothing half of Loop's scheme, applied after U on triangles.

use super::upsample::ratio;
use crate::math::functions::cos;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::creases::{Creases, Rule};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Facts, Follows, Operator, Role, SplineStep};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::sharpness::edges_at;
use crate::scheme::step::{Action, Step, StepError, Values};
use crate::scheme::word::Letter;
use crate::shape::topology::{NONE, Topology, index};

/// Loop after U: `E' = 3/8 (V1 + V2) + 1/8 (A + B)` with the opposite vertices A and B, `V' = (1 - N beta) V + beta sum`
/// of the N neighbours, `beta = (5/8 - (3/8 + cos(2 pi/N)/4)^2) / N`; boundaries and creases:
/// `E' = (V1 + V2)/2`, `V' = 3/4 V + 1/8 (A + B)` with the neighbours A and B along them; corners stay. An edge of
/// sharpness below 1 is that much of a crease, but wholly one where both its halves stay sharp; a vertex whose rule changes
/// in a level is a mean of both.
#[derive(Debug)]
pub struct LoopSmoothing;

static FACTS: Facts = Facts {
    name: "loop-smoothing",
    doc: "The smoothing of Loop after U on triangles: edge points 3/8 (V1 + V2) + 1/8 (A + B), vertices of valence N \
     (1 - N beta) V + beta sum of the neighbours, beta = (5/8 - (3/8 + cos(2 pi/N)/4)^2) / N; boundaries and \
     creases are cubic B-splines, while they are sharp. Used by the preset loop.",
    source: "Loop, Smooth subdivision surfaces based on triangles, 1987; boundaries as OpenSubdiv 3.5",
    role: Role::Smooth,
    follows: Follows::SemiSharp,
    ..Facts::USUAL
};

impl Operator for LoopSmoothing {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn on_polygon(&self, _: &PolygonNet, _: &Values<'_>) -> Result<Step<PolygonNet>, StepError> {
        Err(StepError::WrongNet("loop refines meshes; for polygons use cubic-b-spline"))
    }

    fn spline(&self, _: &Letter, _: f64) -> Result<SplineStep, &'static str> {
        Ok(SplineStep::Mean)
    }

    fn on_mesh(&self, net: &MeshNet, _: &Values<'_>) -> Result<Step<MeshNet>, StepError> {
        let parent = net.mesh.halved_triangles().cloned().ok_or(StepError::NoAnchor)?;
        let (n, n_v) = (net.mesh.n_vertices(), parent.n_vertices());
        let old = net.clone();
        let creases = Creases::of_parent(net);
        let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
            if row >= n_v {
                let e = row - n_v;
                edge_row(&parent, e, creases.as_ref().map_or(0.0, |creases| creases.edge(e)), out);
            } else if old.tags.is_corner(row) || parent.is_isolated(row) {
                out.add(index(row), 1.0);
            } else {
                match creases.as_ref().and_then(|creases| creases.vertex(row)) {
                    None => vertex_row(&parent, row, out),
                    Some(blend) => blend.rules().for_each(|(rule, weight)| ruled_row(&parent, row, rule, weight, out)),
                }
            }
        });
        Ok(Step { net: net.clone(), action: Action::Blend(Box::new(rows)) })
    }
}

fn vertex_row(parent: &Topology, v: usize, out: &mut Rows) {
    let rule = parent.boundary_edges(v).map_or(Rule::Smooth, Rule::Crease);
    ruled_row(parent, v, rule, 1.0, out);
}

/// The row of a vertex by one rule, multiplied by `scale`.
fn ruled_row(parent: &Topology, v: usize, rule: Rule, scale: f64, out: &mut Rows) {
    match rule {
        Rule::Corner => out.add(index(v), scale),
        Rule::Crease(edges) => {
            out.add(index(v), scale * 0.75);
            edges.iter().for_each(|&e| out.add(parent.other_end(e as usize, v), scale * 0.125));
        }
        Rule::Smooth => {
            let valence = parent.valence(v);
            let beta = beta(valence);
            out.add(index(v), scale * (1.0 - ratio(valence, 1) * beta));
            edges_at(parent, v).for_each(|e| out.add(parent.other_end(e as usize, v), scale * beta));
        }
    }
}

/// The row of an edge point; a sharpness of 1 makes it the middle.
fn edge_row(parent: &Topology, e: usize, sharpness: f64, out: &mut Rows) {
    let corners = parent.halves(e);
    if corners[1] == NONE || sharpness >= 1.0 {
        parent.ends(e).iter().for_each(|&v| out.add(v, 0.5));
        return;
    }
    let smooth = 1.0 - sharpness;
    parent.ends(e).iter().for_each(|&v| out.add(v, 0.5 * sharpness + 0.375 * smooth));
    corners.iter().for_each(|&corner| out.add(parent.vertex(parent.previous(corner)), 0.125 * smooth));
}

/// Loop's weight of each of the `valence` neighbours of an interior vertex.
fn beta(valence: usize) -> f64 {
    // the value for six neighbours, where the limit is a box spline, is 1/16 without rounding
    if valence == 6 {
        return 1.0 / 16.0;
    }
    let n = ratio(valence, 1);
    let bracket = 0.375 + 0.25 * cos(2.0 * std::f64::consts::PI / n);
    (0.625 - bracket * bracket) / n
}
