//! U: linear interpolation.

use std::sync::Arc;

use crate::math::rows::{Rows, RowsBy};
use crate::scheme::anchor::Anchor;
use crate::scheme::curve_rule::{CurveRule, between};
use crate::scheme::local::LocalValues;
use crate::scheme::local_mesh::MeshLocal;
use crate::scheme::mask_range::{MaskRange, steps};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Children, Facts, Follows, Operator, Role, SplineStep, Standard};
use crate::scheme::parameters::{ARITY, SPLIT};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::settings::LetterSettings;
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::{About, StepError};
use crate::shape::tile::Tile;

/// U, upsampling of arity d: `q[d i + j] = ((d - j) p[i] + j p[i + 1]) / d` on curves; on meshes vertices stay, edges
/// are interpolated linearly, quads bilinearly, triangles linearly, other faces through the mean of their vertices.
#[derive(Debug)]
pub(super) struct Upsample;

static FACTS: Facts = Facts {
    letter: Some('U'),
    name: "upsample",
    doc: "Upsamples by linear interpolation. Curves, arity d (U is U2): q[di+j] = ((d-j) p[i] + j p[i+1]) / d. Meshes: \
     vertices stay, every edge gets its midpoint and every face the mean of its vertices, so that an n-gon becomes n \
     quads; arity d splits quads into d x d bilinearly, after a U where a mesh has other faces. With split triangle \
     every triangle becomes d x d triangles.",
    source: "Zhang and Wang 2002, formulas (1) and (4); Zorin and Schroeder, CAGD 18 (2001), 429-454",
    curve: Some(CurveRule::Interpolate),
    role: Role::Upsample,
    uses: &["alpha", "split"],
    parameters: &[ARITY, SPLIT],
    children: Children::Vertices,
    follows: Follows::Creases,
    smooths: false,
    pointwise: true,
    symmetric: true,
    standard: Some(Standard::Bilinear),
    ..Facts::USUAL
};

impl Operator for Upsample {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn spline(&self, settings: &LetterSettings, _: f64) -> Result<SplineStep, &'static str> {
        if settings.arity() == 2 { Ok(SplineStep::Upsample) } else { Err("its U has an arity above 2") }
    }

    fn mask_range(&self, settings: &LetterSettings, _: u32) -> Option<MaskRange> {
        Some(MaskRange::upsample(settings.arity()))
    }

    fn on_polygon(&self, net: &PolygonNet, values: &StepValues<'_>) -> Result<Step<PolygonNet>, StepError> {
        let arity = values.settings.arity();
        let (landed, preimages) = net.land(MaskRange::upsample(arity))?;
        let old = net.clone();
        let rows = preimages.rows(net.n, move |j, out: &mut Rows| {
            let d = steps(arity);
            let (i, j) = (j.div_euclid(d), j.rem_euclid(d));
            if j == 0 {
                old.add(i, 1.0, out);
            } else {
                let [first, second] = between(j as i64, arity.into());
                old.add(i, first, out);
                old.add(i + 1, second, out);
            }
        });
        let rows = rows.repeating(arity as usize, 4 * arity as usize);
        let anchor = net.as_anchor();
        let local = values.sources.as_ref().map_or(Ok(None), |sources| {
            let edges = if net.is_closed() { net.n_control() } else { net.n_control() - 1 };
            LocalValues::of([net.n_control(), edges], net.attributes.as_deref(), arity, sources)
        })?;
        let attributes = net.attributes.as_ref().map(|kept| Arc::new(kept.upsampled(arity, net.is_closed())));
        let phase = Some(net.phase_after(arity));
        let next = PolygonNet { duals: 0, phase, anchor: Some(anchor), attributes, local, ..landed };
        Ok(Step { net: next, action: Action::BlendFromAnchor(Box::new(rows)) })
    }

    fn on_mesh(&self, net: &MeshNet, values: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        let entered = net.mesh.topology();
        let (tile, pieces) = (values.settings.tile(), values.settings.arity());
        if tile == Tile::Triangle
            && let Some(face) = entered.first_other_than_triangle()
        {
            return Err(not_triangles(face, entered.face(face).len()));
        }
        let is_quads = || entered.is_quads() && net.surroundings.is_none_or(|all| all.quads);
        let quads = tile == Tile::Quad && pieces != 2 && !is_quads();
        let anchor = Anchor {
            quads: quads.then(|| Arc::new(entered.split())),
            topology: entered.clone(),
            tile,
            pieces,
            corners: net.tags.corners.clone(),
            sharpness: net.sharpness.clone(),
            directions: net.annotations.directions.clone(),
            order: None,
            lost: false,
        };
        let local =
            values.sources.as_ref().map_or(Ok(None), |sources| MeshLocal::of(&net.annotations, &entered, sources))?;
        let next = net.after_split(anchor.clone(), local);
        let rows = RowsBy::new(next.mesh.n_vertices(), entered.n_vertices(), move |row, out: &mut Rows| {
            out.group(|out| anchor.shares(row, [1.0; 3], |v, weight| out.add(v, weight)));
        });
        Ok(Step { net: next, action: Action::BlendFromAnchor(Box::new(rows)) })
    }
}

/// Returns the error for a face that cannot be split into triangles.
pub(in crate::scheme) fn not_triangles(face: usize, size: usize) -> StepError {
    let found = format!("face {face} has {size} vertices, and only triangles are split into triangles");
    let remedy = "send a mesh of triangles, or use a scheme for any faces, such as catmull-clark or a word with \
                  \"split\": \"quad\"";
    StepError::about(About::Triangles, format!("{found}; {remedy}"))
}
