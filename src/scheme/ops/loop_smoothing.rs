//! The smoothing half of Loop's scheme, applied after U on triangles.

use super::around;
use crate::math::functions::{cos, ratio};
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::creases::{Blend, Creases, Rule};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Facts, Follows, Nets, Operator, Role, SplineStep, Standard};
use crate::scheme::settings::LetterSettings;
use crate::scheme::stencil::{RingMask, TriangleEdgeMask};
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::shape::topology::index;

/// Loop after U: `E' = 3/8 (V1 + V2) + 1/8 (A + B)` with the opposite vertices A and B,
/// `V' = (1 - N beta) V + beta sum` of the N neighbours, `beta = (5/8 - (3/8 + cos(2 pi/N)/4)^2) / N`; boundaries and
/// creases: `E' = (V1 + V2)/2`, `V' = 3/4 V + 1/8 (A + B)` with the neighbours A and B along them; corners stay. At an
/// edge of sharpness s below 1, the crease rule has the weight s, but 1 if both its halves stay sharp; a vertex whose
/// rule changes in a level is a weighted mean of both rules.
#[derive(Debug)]
pub struct LoopSmoothing;

static FACTS: Facts = Facts {
    name: "loop-smoothing",
    doc: "The smoothing of Loop after U on triangles: edge points 3/8 (V1 + V2) + 1/8 (A + B), vertices of valence N \
     (1 - N beta) V + beta sum of the neighbours, beta = (5/8 - (3/8 + cos(2 pi/N)/4)^2) / N; boundaries and \
     creases are cubic B-splines, while they are sharp. Used by the preset loop.",
    source: "Loop, Smooth subdivision surfaces based on triangles, 1987; boundaries as OpenSubdiv 3.5",
    nets: Nets::Meshes("loop refines meshes; for polygons use cubic-b-spline"),
    role: Role::Smooth,
    follows: Follows::SemiSharp,
    symmetric: true,
    standard: Some(Standard::Loop),
    ..Facts::USUAL
};

impl Operator for LoopSmoothing {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn spline(&self, _: &LetterSettings, _: f64) -> Result<SplineStep, &'static str> {
        Ok(SplineStep::Mean)
    }

    fn on_mesh(&self, net: &MeshNet, _: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        let parent = net.mesh.halved_triangles().cloned().ok_or_else(around::not_upsampled)?;
        let (n, n_v) = (net.mesh.n_vertices(), parent.n_vertices());
        let old = net.clone();
        let creases = Creases::of_parent(net);
        let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
            if let Some(e) = row.checked_sub(n_v) {
                let sharpness = creases.as_ref().map_or(0.0, |creases| creases.edge(e));
                if parent.is_boundary_edge(e) || sharpness >= 1.0 {
                    out.group(|out| parent.ends(e).iter().for_each(|&v| out.add(v, 0.5)));
                } else {
                    edge_mask(sharpness).add(&parent, e, out);
                }
                return;
            }
            for (rule, weight) in Blend::of(row, &parent, &old.tags, creases.as_ref()).rules() {
                match rule {
                    Rule::Corner => out.add(index(row), weight),
                    Rule::Crease(edges) => CURVE_MASK.times(weight).add_ends(&parent, row, edges.into_iter(), out),
                    Rule::Smooth => {
                        let mask = vertex_mask(parent.valence(row)).times(weight);
                        mask.add_ends(&parent, row, parent.edges_at(row), out);
                    }
                }
            }
        });
        Ok(Step { net: net.clone(), action: Action::Blend(Box::new(rows)) })
    }
}

/// The mask along creases and boundaries, (1, 6, 1)/8: the cubic B-spline.
const CURVE_MASK: RingMask = RingMask { own: 0.75, neighbours: 0.125 };

/// The mask of a smooth vertex: `(1 - N beta) V + beta sum` over the N neighbours.
fn vertex_mask(valence: usize) -> RingMask {
    let beta = beta(valence);
    RingMask { own: 1.0 - ratio(valence, 1) * beta, neighbours: beta }
}

/// The mask of an inner edge point; a sharpness below 1 is the weight of the midpoint.
fn edge_mask(sharpness: f64) -> TriangleEdgeMask {
    let smooth = 1.0 - sharpness;
    TriangleEdgeMask { ends: 0.5 * sharpness + 0.375 * smooth, opposite: 0.125 * smooth, far: None }
}

/// Returns Loop's weight of each of the `valence` neighbours of an interior vertex.
fn beta(valence: usize) -> f64 {
    // for six neighbours, where the limit is a box spline, the value is exactly 1/16
    if valence == 6 {
        return 1.0 / 16.0;
    }
    let n = ratio(valence, 1);
    let bracket = 0.375 + 0.25 * cos(2.0 * std::f64::consts::PI / n);
    (0.625 - bracket * bracket) / n
}
