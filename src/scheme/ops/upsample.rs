//! U: linear interpolation.

use std::sync::Arc;

use super::{Follows, Operator, Role};
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::local::Local;
use crate::scheme::mesh_net::{self, MeshNet};
use crate::scheme::polygon_net::{self, From, PolygonNet};
use crate::scheme::step::{Action, Step, StepError, Values};
use crate::scheme::window::{Window, steps};
use crate::scheme::word::Letter;
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
        "Upsamples by linear interpolation. Curves, arity d (U is U2): q[di+j] = ((d-j) p[i] + j p[i+1]) / d. Meshes: vertices stay, \
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

    fn follows(&self) -> Follows {
        Follows::Creases
    }

    fn window(&self, letter: &Letter, _: u32) -> Option<Window> {
        Some(Window::upsample(letter.arity))
    }

    fn on_polygon(&self, net: &PolygonNet, values: &Values<'_>) -> Result<Step<PolygonNet>, StepError> {
        let arity = values.letter.arity;
        let (landed, origin) = net.land(Window::upsample(arity))?;
        let old = net.clone();
        let rows = RowsBy::new(landed.n, net.n, move |row, out: &mut Rows| match origin.of(row) {
            From::End(end) => out.add(index(end), 1.0),
            From::Point(j) => {
                let d = steps(arity);
                let (i, j) = (j.div_euclid(d), j.rem_euclid(d).unsigned_abs());
                let d = arity as usize;
                if j == 0 {
                    old.add(i, 1.0, out);
                } else {
                    old.add(i, ratio(d - j, d), out);
                    old.add(i + 1, ratio(j, d), out);
                }
            }
        });
        let anchor = polygon_net::Anchor::of(net);
        let local = values.sources.as_ref().map_or(Ok(None), |sources| Local::of(net, arity, sources))?;
        let attributes = net.attributes.as_ref().map(|kept| Arc::new(kept.upsampled(arity, net.is_closed())));
        let phase = Some(net.phase_after(arity));
        let next = PolygonNet { duals: 0, phase, anchor: Some(anchor), attributes, local, ..landed };
        Ok(Step { net: next, action: Action::BlendFromAnchor(Box::new(rows)) })
    }

    fn on_mesh(&self, net: &MeshNet, values: &Values<'_>) -> Result<Step<MeshNet>, StepError> {
        if values.letter.arity != 2 {
            return Err(StepError::WrongNet(
                "meshes are upsampled by U, which is of arity 2; U3 and higher refine polygons",
            ));
        }
        let parent = net.topology();
        let anchor = mesh_net::Anchor {
            topology: parent.clone(),
            corners: net.corners.clone(),
            sharpness: net.sharpness.clone(),
            order: None,
            lost: false,
        };
        let halves = net.sharpness.as_ref().and_then(|sharpness| sharpness.split(&parent, net.rules.creasing));
        let next = MeshNet {
            sharpness: halves.map(Arc::new),
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
