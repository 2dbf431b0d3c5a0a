//! C: the convolution average.

use std::sync::Arc;

use super::local_average;
use super::ring_average::{self, FaceContribution};
use crate::math::functions::ratio;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::creases::{Blend, Creases, Rule};
use crate::scheme::curve_rule::{CurveRule, triple};
use crate::scheme::mask_range::MaskRange;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Facts, Follows, Operator, Role, SplineStep};
use crate::scheme::parameters::{DEFAULT_MU, SPLIT};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::settings::LetterSettings;
use crate::scheme::stencil::{EdgeMask, FaceMask, RingMask, VertexMask};
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::shape::tile::Tile;
use crate::shape::topology::{Topology, index};

/// C, the convolution average: D twice, re-centred; on meshes the mean of the loop centres around a vertex.
#[derive(Debug)]
pub(super) struct Average;

static FACTS: Facts = Facts {
    letter: Some('C'),
    name: "average",
    doc: "The convolution average: D twice, re-centred. Curves after U: vertices (1, 2f, 1), edge points (f, 2, f), \
     each over 2(1 + f), with the kernel f in the first average after a U and 1 else. Meshes: the mean of the loop \
     centres (f^2 V + f (E1 + E2) + F) / (1 + f)^2 of the quads around a vertex, after U3 and higher with f^2 for V, f \
     for points of edges, 1 for points inside faces; with split triangle mu P + (1 - mu) times the mean of the \
     neighbours, where V has the weight f. Boundaries and creases follow the curve rule, corners stay.",
    source: "Zhang and Wang 2002, formulas (2) and (5); Zorin and Schroeder, CAGD 18 (2001), 429-454",
    curve: Some(CurveRule::Triple),
    role: Role::Average,
    uses: &["kernel", "mu"],
    parameters: &[SPLIT],
    follows: Follows::Creases,
    pointwise: true,
    symmetric: true,
    ..Facts::USUAL
};

impl Operator for Average {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn spline(&self, settings: &LetterSettings, mu: f64) -> Result<SplineStep, &'static str> {
        // the only weight for which the symbol is that of a box spline
        let even = settings.tile() == Tile::Quad || mu == DEFAULT_MU;
        if even { Ok(SplineStep::Mean) } else { Err("its C has another mu than 1/4") }
    }

    fn mask_range(&self, _: &LetterSettings, _: u32) -> Option<MaskRange> {
        Some(MaskRange::mean(3, false))
    }

    fn on_polygon(&self, net: &PolygonNet, values: &StepValues<'_>) -> Result<Step<PolygonNet>, StepError> {
        let (landed, preimages) = net.land(MaskRange::mean(3, false))?;
        let (old, f, first) = (net.clone(), values.kernel, values.first);
        let rows = preimages.rows(net.n, move |j, out: &mut Rows| {
            if old.is_corner(old.control(j)) {
                old.add(j, 1.0, out);
            } else {
                // two D: the means with the preceding and the following point, weighted by the kernel at vertices, and
                // their mean
                let [a, b, c] = triple(&[j - 1, j, j + 1].map(|i| old.weight(i, f, first)));
                old.add(j - 1, a, out);
                old.add(j, b, out);
                old.add(j + 1, c, out);
            }
        });
        let rows = if net.is_uniform(values.first) { rows.repeating(net.period(), 4 * net.period()) } else { rows };
        Ok(Step { net: landed.shifted(0), action: Action::Blend(Box::new(rows)) })
    }

    fn on_mesh(&self, net: &MeshNet, values: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        let action = match net.mesh.halved() {
            _ if values.settings.tile() == Tile::Triangle => {
                ring_average::rows(net, FaceContribution::Neighbours { mu: values.mu }, values.kernel)
            }
            Some(parent) => match net.since.local.as_ref().filter(|_| values.first) {
                Some(local) => match local.common_kernel() {
                    Some(kernel) => split_rows(net.clone(), parent.clone(), kernel),
                    None => local_average::rows(net, parent, local),
                },
                None => split_rows(net.clone(), parent.clone(), values.kernel),
            },
            None if net.mesh.parent.is_some() => ring_average::rows(net, FaceContribution::Faces, values.kernel),
            None => plain_rows(net.clone()),
        };
        Ok(Step { net: net.clone(), action })
    }
}

/// Returns the action of C on a mesh whose vertices are the V, E, F of a split.
fn split_rows(net: MeshNet, parent: Arc<Topology>, f: f64) -> Action {
    let (n_v, n_e) = (parent.n_vertices(), parent.n_edges());
    let n = net.mesh.n_vertices();
    let creases = Creases::of_parent(&net);
    let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
        if row < n_v {
            // edges are either smooth or infinitely sharp here
            match Blend::of(row, &parent, &net.tags, creases.as_ref()).before {
                Rule::Corner => out.add(index(row), 1.0),
                Rule::Crease(edges) => curve_mask(f).add_edge_points(&parent, row, edges, out),
                Rule::Smooth => vertex_mask(parent.ring(row).count(), f).add(&parent, row, out),
            }
        } else if row < n_v + n_e {
            let e = row - n_v;
            let sharp = parent.is_boundary_edge(e) || creases.as_ref().is_some_and(|creases| creases.edge(e) > 0.0);
            let mask = if sharp { curve_edge_mask(f) } else { edge_mask(f) };
            mask.add(&parent, e, out);
        } else {
            let face = row - n_v - n_e;
            face_mask(parent.face(face).len(), f).add(&parent, face, out);
        }
    });
    Action::Blend(Box::new(rows))
}

/// The mask of V on creases and boundaries: `(E + 2 f V + E) / (2 (1 + f))`.
fn curve_mask(f: f64) -> RingMask {
    let sum = 2.0 * (1.0 + f);
    RingMask { own: 2.0 * f / sum, neighbours: 1.0 / sum }
}

/// The mask of a smooth V: `(N f^2 V + 2 f sum E + sum F) / (N (1 + f)^2)`.
fn vertex_mask(valence: usize, f: f64) -> VertexMask {
    let valence = ratio(valence, 1);
    let sum = valence * (1.0 + f) * (1.0 + f);
    VertexMask { own: valence * f * f / sum, edges: 2.0 * f / sum, faces: 1.0 / sum }
}

/// The mask of E on creases and boundaries: `(f V1 + 2 E + f V2) / (2 (1 + f))`.
fn curve_edge_mask(f: f64) -> EdgeMask {
    let sum = 2.0 * (1.0 + f);
    EdgeMask { own: 2.0 / sum, ends: Some(f / sum), faces: None, sides: None }
}

/// The mask of a smooth E: `(2 f^2 (V1 + V2) + 4 f E + 2 (F1 + F2) + f (Ea + Eb + Ec + Ed)) / (4 (1 + f)^2)`.
fn edge_mask(f: f64) -> EdgeMask {
    let sum = 4.0 * (1.0 + f) * (1.0 + f);
    EdgeMask { own: 4.0 * f / sum, ends: Some(2.0 * f * f / sum), faces: Some(2.0 / sum), sides: Some(f / sum) }
}

/// The mask of F: `(n F + f^2 sum V + 2 f sum E) / (n (1 + f)^2)`.
fn face_mask(size: usize, f: f64) -> FaceMask {
    let size = ratio(size, 1);
    let sum = size * (1.0 + f) * (1.0 + f);
    FaceMask { own: size / sum, vertices: f * f / sum, edges: 2.0 * f / sum }
}

/// Returns the action of C on a net without labels: the mean of the centroids of the faces around a vertex;
/// `(1, 2, 1) / 4` on boundaries and creases.
fn plain_rows(net: MeshNet) -> Action {
    let n = net.mesh.n_vertices();
    let creases = Creases::of_net(&net, &net.mesh.base);
    let rows = RowsBy::new(n, n, move |v, out: &mut Rows| {
        let topology = &net.mesh.base;
        match Blend::of(v, topology, &net.tags, creases.as_ref()).before {
            Rule::Corner => out.add(index(v), 1.0),
            Rule::Crease(edges) => RingMask::CUBIC.add_ends(topology, v, edges.into_iter(), out),
            Rule::Smooth => {
                let valence = topology.ring(v).count();
                for half_edge in topology.ring(v) {
                    let face = topology.face(topology.face_of(half_edge));
                    face.iter().for_each(|&u| out.add(u, ratio(1, valence * face.len())));
                }
            }
        }
    });
    Action::Blend(Box::new(rows))
}
