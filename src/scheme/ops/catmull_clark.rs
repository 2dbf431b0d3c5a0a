//! The smoothing half of Catmull-Clark, applied after U.

use super::upsample::ratio;
use super::{Operator, Role};
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::step::{Action, Step, StepError, Values};
use crate::shape::topology::{NONE, Topology, index};

/// Catmull-Clark after U, for faces of any size: `F' = F`, `E' = E/2 + (F1 + F2)/4` (which is `(V1 + V2 + F1 + F2)/4`),
/// `V' = (N-3)/N V + 2/N^2 sum E + 1/N^2 sum F`; boundaries: `E' = E`, `V' = V/2 + (E1 + E2)/4`; corners stay.
#[derive(Debug)]
pub struct CatmullClark;

impl Operator for CatmullClark {
    fn name(&self) -> &'static str {
        "catmull-clark-smoothing"
    }

    fn doc(&self) -> &'static str {
        "The smoothing of Catmull and Clark after U: face points stay, edge points E/2 + (F1 + F2)/4, vertices of valence \
         N (N-3)/N V + 2/N^2 sum E + 1/N^2 sum F; boundary curves are cubic B-splines. Used by the preset catmull-clark."
    }

    fn source(&self) -> &'static str {
        "Catmull and Clark, CAD 10 (1978), 350-355; boundaries as OpenSubdiv 3.5"
    }

    fn role(&self) -> Role {
        Role::Smooth
    }

    fn on_polygon(&self, _: &PolygonNet, _: &Values<'_>) -> Result<Step<PolygonNet>, StepError> {
        Err(StepError::WrongNet("catmull-clark refines meshes; for polygons use cubic-b-spline"))
    }

    fn on_mesh(&self, net: &MeshNet, _: &Values<'_>) -> Result<Step<MeshNet>, StepError> {
        let parent = net.parent.clone().ok_or(StepError::NoAnchor)?;
        let (n, n_v, n_e) = (net.n_vertices(), parent.n_vertices(), parent.n_edges());
        let old = net.clone();
        let rows = RowsBy::new(n, n, move |row, out: &mut Rows| {
            if row >= n_v + n_e || old.is_corner(row) || row < n_v && parent.is_isolated(row) {
                out.add(index(row), 1.0);
            } else if row < n_v {
                vertex_row(&parent, row, out);
            } else {
                edge_row(&parent, row - n_v, out);
            }
        });
        Ok(Step { net: net.clone(), action: Action::Blend(Box::new(rows)) })
    }
}

fn vertex_row(parent: &Topology, v: usize, out: &mut Rows) {
    let n_v = index(parent.n_vertices());
    if let Some(edges) = parent.boundary_edges(v) {
        out.add(index(v), 0.5);
        edges.iter().for_each(|&e| out.add(n_v + e, 0.25));
        return;
    }
    let n = ratio(parent.ring(v).count(), 1);
    out.add(index(v), (n - 3.0) / n);
    for corner in parent.ring(v) {
        out.add(n_v + parent.edge(corner), 2.0 / (n * n));
        out.add(n_v + index(parent.n_edges() + parent.face_of(corner)), 1.0 / (n * n));
    }
}

fn edge_row(parent: &Topology, e: usize, out: &mut Rows) {
    let n_v = index(parent.n_vertices());
    let corners = parent.edge_corners(e);
    let here = n_v + index(e);
    if corners[1] == NONE {
        out.add(here, 1.0);
        return;
    }
    out.add(here, 0.5);
    for corner in corners {
        out.add(n_v + index(parent.n_edges() + parent.face_of(corner)), 0.25);
    }
}
