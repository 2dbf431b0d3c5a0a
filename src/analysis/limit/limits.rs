//! The limits of the vertices of a net.

use super::continuity::{check, smoothness};
use super::cycle::Cycle;
use super::dual::Unrefined;
use super::error::Unlimited;
use super::field::{Field, Functional};
use super::field_rows::FieldRows;
use super::impulse::{Impulse, Smoothness};
use super::mask::Finder;
use super::normals;
use super::patch::Rings;
use super::patch_rules::PatchRules;
use super::perturbed::{self, ROWS_A_POINT, followed_points};
use super::refined_net::{RefinedNet, carries};
use super::regular::{Regular, Starts};
use super::request::LimitRequest;
use super::vertex_parameters::{self, CommonParameters};
use crate::math::rows::blend;
use crate::refine::{Normals, Points};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::watch::{Stopped, Watch};

/// Rings by which patches are wider at most where regular nets need fewer than a mesh: where it is narrow at its
/// boundary, or has vertices between two faces.
const MOST_WIDER: usize = 3;

/// The limit of each vertex of a net, in the order of construction.
#[derive(Debug, Default)]
pub(in crate::analysis) struct Limits {
    /// Positions, `n x 3`, and the numbers of each channel, where they were asked for.
    pub(in crate::analysis) points: Option<Vec<Vec<f64>>>,
    /// Normals where they were asked for and exist.
    pub(super) normals: Option<Normals>,
    /// Why there are no normals, or some are missing.
    pub(super) warning: Option<String>,
}

impl Limits {
    /// Nothing, as `why` says.
    pub(super) fn without_normals(why: &dyn std::fmt::Display) -> Self {
        let warning = format!("the normals are weighted by area, as limit ones do not exist: {why}");
        Self { warning: Some(warning), ..Self::default() }
    }
}

/// Whether edges of a net hand on sharpness that depends on the edges at both their ends. Then a patch has all faces
/// around the vertices that decide about the limit.
fn evens_out(net: &MeshNet) -> bool {
    let semi_sharp = |&(_, sharpness): &(u32, f64)| sharpness < INFINITE_SHARPNESS;
    let any = net.sharpness.as_ref().is_some_and(|sharpness| sharpness.edges().iter().any(semi_sharp));
    any && net.rules.creasing.evens_out()
}

/// The limits of a net that `ahead` would refine further.
pub(in crate::analysis) fn limits(
    plan: &Plan,
    net: &MeshNet,
    points: &[Points],
    ahead: &[Scheduled],
    request: LimitRequest,
    watch: &Watch,
) -> Result<Limits, Unlimited> {
    check(plan)?;
    // what comes before the first upsampling moves points, and puts faces in the place of vertices: the limits stay
    let before = ahead.iter().take_while(|step| !step.letter.facts().children.refine()).count();
    let given = points;
    let Unrefined { net, points, centres } = Unrefined::by(net, points, plan, &ahead[..before], watch)?;
    let is_open = net.mesh.base.n_boundary() > 0;
    let (perturbation, rows) = (perturbed::of(plan), ROWS_A_POINT * followed_points(plan, request));
    let plan = &Plan { perturbation: None, ..plan.clone() };
    let parameters = net.annotations.attributes.as_deref().map_or_else(Vec::new, vertex_parameters::extremes);
    let alphas: Vec<f64> = parameters.iter().filter_map(CommonParameters::alpha).chain([plan.alpha]).collect();
    let length = plan.word.cycle.len();
    let patch_rules = PatchRules::of(plan, &net.mesh.base);
    let alphas = if carries(&net) { &alphas[..] } else { &[] };
    let cycle = Cycle::new(plan, (&ahead[before..], length), patch_rules, alphas, watch);
    let topology = net.mesh.topology();
    let regular = Regular::of(&cycle, &topology)?;
    let tagged = net.annotations.directions.is_some();
    let rings = regular.rings(&cycle, tagged, Starts { is_open, others: centres.is_some() })?;
    let rings = if evens_out(&net) { Rings { patch: rings.patch.max(rings.support + 1), ..rings } } else { rings };
    let impulse =
        Impulse { cycle: &cycle, regular, tagged, common: CommonParameters::default(), support: rings.support };
    let smoothness = smoothness(impulse, parameters, request.normals, watch)?;
    let kinked = perturbation.as_ref().filter(|_| request.normals).and_then(perturbed::no_normals);
    if kinked.is_some() && !request.positions {
        return Ok(Limits { warning: kinked, ..Limits::default() });
    }
    let with_tangents = request.normals && smoothness == Smoothness::Smooth && kinked.is_none();
    let surroundings = cycle.surroundings(&topology);
    let around = RefinedNet::new(net, topology, centres, surroundings);
    let field = |wider: usize| {
        let rings = Rings { support: rings.support + wider, patch: rings.patch + wider };
        let finder = Finder::new(&cycle, rings, with_tangents);
        match perturbation {
            Some(perturbation) => perturbed::field(&around, rings, &finder, perturbation, rows, watch),
            None => Field::new(&around, regular, rings, &finder, watch),
        }
    };
    let field = field(0).or_else(|error| {
        let more = if error.may_be_of_the_patch() { MOST_WIDER } else { 0 };
        let mut found = (1..=more).map(&field);
        let done = |found: &Result<Field<'_>, Unlimited>| matches!(found, Ok(_) | Err(Unlimited::Stopped(_)));
        found.find(done).unwrap_or(Err(error))
    })?;
    let places = field.sectors();
    let rows = |places, functional| FieldRows { field: &field, places, functional };
    let vertices = &places[..field.n_vertices()];
    let blended = |(points, given): (&Points, &Points)| -> Result<Vec<f64>, Stopped> {
        let mut limits = blend(&rows(vertices, Functional::Position), &points.now, points.width, watch)?;
        // a D leaves nothing of a vertex without faces, which stays
        for v in field.left_out() {
            let range = v * points.width..(v + 1) * points.width;
            limits[range.clone()].copy_from_slice(&given.now[range]);
        }
        Ok(limits)
    };
    let all = points.iter().zip(given);
    let moved = if request.positions { Some(all.map(blended).collect::<Result<_, _>>()?) } else { None };
    if !request.normals {
        return Ok(Limits { points: moved, ..Limits::default() });
    }
    if smoothness == Smoothness::Continuous {
        return Ok(Limits { points: moved, ..Limits::without_normals(&"the scheme has no continuous tangents") });
    }
    if kinked.is_some() {
        return Ok(Limits { points: moved, warning: kinked, ..Limits::default() });
    }
    if let Some(why) = field.no_regular_tangents() {
        return Ok(Limits { points: moved, ..Limits::without_normals(&why.at("a regular vertex")) });
    }
    let tangent = |i| blend(&rows(&places, Functional::Tangent(i)), &points[0].now, 3, watch);
    let (normals, missing) = normals::of(&field, &places, &tangent(0)?, &tangent(1)?);
    Ok(Limits { points: moved, normals: Some(normals), warning: missing })
}
