//! The smoothing half of Catmull-Clark, applied after U.

use super::around;
use crate::math::functions::ratio;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::creases::{Blend, Creases, Rule};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Facts, Follows, Nets, Operator, Role, SplineStep, Standard};
use crate::scheme::rules::TriangleRule;
use crate::scheme::settings::LetterSettings;
use crate::scheme::stencil::{EdgeMask, RingMask, VertexMask};
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::shape::topology::{NONE, Topology, index};

/// Catmull-Clark after U, for faces of any size: `F' = F`, `E' = E/2 + (F1 + F2)/4` (which is `(V1 + V2 + F1 + F2)/4`),
/// `V' = (N-3)/N V + 2/N^2 sum E + 1/N^2 sum F`; boundaries and creases: `E' = E`, `V' = V/2 + (E1 + E2)/4`; corners
/// stay. At an edge of sharpness s below 1, the crease rule has the weight s, but 1 if both its halves stay sharp; a
/// vertex whose rule changes in a level is a weighted mean of both rules.
#[derive(Debug)]
pub struct CatmullClark;

static FACTS: Facts = Facts {
    name: "catmull-clark-smoothing",
    doc: "The smoothing of Catmull and Clark after U: face points stay, edge points E/2 + (F1 + F2)/4, vertices of \
     valence N (N-3)/N V + 2/N^2 sum E + 1/N^2 sum F; boundaries and creases are cubic B-splines, while they are \
     sharp. Used by the preset catmull-clark.",
    source: "Catmull and Clark, CAD 10 (1978), 350-355; boundaries as OpenSubdiv 3.5",
    nets: Nets::Meshes("catmull-clark refines meshes; for polygons use cubic-b-spline"),
    role: Role::Smooth,
    follows: Follows::SemiSharp,
    symmetric: true,
    bicubic: true,
    standard: Some(Standard::CatmullClark),
    ..Facts::USUAL
};

impl Operator for CatmullClark {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn spline(&self, _: &LetterSettings, _: f64) -> Result<SplineStep, &'static str> {
        Ok(SplineStep::Mean)
    }

    fn on_mesh(&self, net: &MeshNet, _: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        let parent = net.mesh.halved().cloned().ok_or_else(around::not_upsampled)?;
        let (n, n_v, n_e) = (net.mesh.n_vertices(), parent.n_vertices(), parent.n_edges());
        let old = net.clone();
        let creases = Creases::of_parent(net);
        let triangles = if parent.is_quads() { TriangleRule::Catmark } else { net.rules.triangles };
        let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
            if row >= n_v + n_e {
                out.add(index(row), 1.0);
            } else if row < n_v {
                for (rule, weight) in Blend::of(row, &parent, &old.tags, creases.as_ref()).rules() {
                    match rule {
                        Rule::Corner => out.add(index(row), weight),
                        Rule::Crease(edges) => RingMask::CUBIC.times(weight).add_edge_points(&parent, row, edges, out),
                        Rule::Smooth => vertex_mask(parent.ring(row).count()).times(weight).add(&parent, row, out),
                    }
                }
            } else {
                let e = row - n_v;
                let sharpness = creases.as_ref().map_or(0.0, |creases| creases.edge(e));
                let weight = match triangles {
                    TriangleRule::Catmark => 0.25,
                    TriangleRule::Smooth => smooth_weight(&parent, e),
                };
                let faces = if parent.is_boundary_edge(e) { 0.0 } else { (1.0 - sharpness) * weight };
                edge_mask(faces).add(&parent, e, out);
            }
        });
        Ok(Step { net: net.clone(), action: Action::Blend(Box::new(rows)) })
    }
}

/// The mask of a smooth vertex: `(N-3)/N V + 2/N^2 sum E + 1/N^2 sum F`.
fn vertex_mask(valence: usize) -> VertexMask {
    let n = ratio(valence, 1);
    VertexMask { own: (n - 3.0) / n, edges: 2.0 / (n * n), faces: 1.0 / (n * n) }
}

/// The mask of an edge point with the weight `faces` for each face point: 1/4 on smooth edges, 0 along creases.
fn edge_mask(faces: f64) -> EdgeMask {
    let faces = Some(faces).filter(|&faces| faces != 0.0);
    EdgeMask { own: 1.0 - 2.0 * faces.unwrap_or(0.0), ends: None, faces, sides: None }
}

/// Returns the weight of the face points under the triangle rule `smooth`: the mean of 0.47 per triangle and 1/4 per
/// other face.
///
/// Source: OpenSubdiv 3.5, class `Sdc::Scheme` of Catmull-Clark.
fn smooth_weight(parent: &Topology, e: usize) -> f64 {
    let weight = |half_edge: u32| {
        let triangle = half_edge != NONE && parent.face(parent.face_of(half_edge)).len() == 3;
        if triangle { 0.47 } else { 0.25 }
    };
    let [first, second] = parent.halves(e);
    0.5 * (weight(first) + weight(second))
}
