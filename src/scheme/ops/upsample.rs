//! U: linear interpolation.

use super::{Operator, Role};
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::mesh_net::{self, MeshNet};
use crate::scheme::polygon_net::{self, Extent, Phase, PolygonNet};
use crate::scheme::step::{Action, Step, StepError, Values};
use crate::shape::topology::{Topology, index};

/// U, upsampling of arity d: `q[d i + j] = ((d - j) p[i] + j p[i + 1]) / d` on curves; on meshes (d = 2) vertices stay,
/// edges get their midpoint, faces the mean of their vertices.
#[derive(Debug)]
pub(super) struct Upsample;

impl Operator for Upsample {
    fn letter(&self) -> Option<char> {
        Some('U')
    }

    fn name(&self) -> &'static str {
        "upsample"
    }

    fn doc(&self) -> &'static str {
        "Upsamples by linear interpolation. Curves: q[2i] = p[i], q[2i+1] = (p[i] + p[i+1]) / 2. Meshes: vertices stay, \
         every edge gets its midpoint and every face the mean of its vertices, so that an n-gon becomes n quads."
    }

    fn source(&self) -> &'static str {
        "Zhang and Wang 2002, formulas (1) and (4); Zorin and Schroeder, CAGD 18 (2001), 429-454"
    }

    fn role(&self) -> Role {
        Role::Upsample
    }

    fn uses(&self) -> &'static [&'static str] {
        &["alpha"]
    }

    fn on_polygon(&self, net: &PolygonNet, values: &Values<'_>) -> Result<Step<PolygonNet>, StepError> {
        let d = values.arity as usize;
        let (controls, half) = (net.n_control(), net.extent == Extent::Half);
        let n = match net.extent {
            Extent::Closed => d * controls,
            Extent::Whole | Extent::Natural => d * (controls - 1) + 1,
            // from one end point, half a step before the first point, to the other (arity 2)
            Extent::Half => 2 * controls + 1,
        };
        let offset = usize::from(half);
        let old = net.clone();
        let rows = RowsBy::new(n, net.n, move |row, out: &mut Rows| {
            if half && (row == 0 || row == n - 1) {
                out.add(index(if row == 0 { 0 } else { old.n - 1 }), 1.0);
                return;
            }
            // shifted by one period, so that the point half a step before the first stays above 0
            let place = row + d - offset;
            let (i, j) = ((place / d).cast_signed() - 1, place % d);
            if j == 0 {
                old.add(i, 1.0, out);
            } else {
                old.add(i, ratio(d - j, d), out);
                old.add(i + 1, ratio(j, d), out);
            }
        });
        let corners = net.corners.iter().map(|&c| c * values.arity + index(offset)).collect();
        let anchor = polygon_net::Anchor {
            n: net.n,
            first: net.first(),
            n_control: controls,
            corners: net.corners.clone(),
            lost: false,
        };
        let next = PolygonNet {
            n,
            extent: if half { Extent::Whole } else { net.extent },
            duals: 0,
            phase: Some(Phase { arity: values.arity, offset: index(offset) }),
            corners,
            anchor: Some(anchor),
        };
        Ok(Step { net: next, action: Action::BlendFromAnchor(Box::new(rows)) })
    }

    fn on_mesh(&self, net: &MeshNet, _: &Values<'_>) -> Result<Step<MeshNet>, StepError> {
        let parent = net.topology();
        let anchor =
            mesh_net::Anchor { topology: parent.clone(), corners: net.corners.clone(), order: None, lost: false };
        let next = MeshNet {
            splits: net.splits + 1,
            parent: Some(parent.clone()),
            duals: 0,
            anchor: Some(anchor),
            ..net.clone()
        };
        let (n_v, n_e) = (parent.n_vertices(), parent.n_edges());
        let rows = RowsBy::new(next.n_vertices(), n_v, move |row, out: &mut Rows| {
            if row < n_v {
                out.add(index(row), 1.0);
            } else if row < n_v + n_e {
                parent.ends(row - n_v).iter().for_each(|&v| out.add(v, 0.5));
            } else {
                mean_of_face(&parent, row - n_v - n_e, out);
            }
        });
        Ok(Step { net: next, action: Action::BlendFromAnchor(Box::new(rows)) })
    }
}

fn mean_of_face(topology: &Topology, f: usize, out: &mut Rows) {
    let face = topology.face(f);
    let weight = ratio(1, face.len());
    face.iter().for_each(|&v| out.add(v, weight));
}

#[expect(clippy::cast_precision_loss, reason = "arities and face sizes are far below 2^52")]
pub(super) fn ratio(a: usize, b: usize) -> f64 {
    a as f64 / b as f64
}
