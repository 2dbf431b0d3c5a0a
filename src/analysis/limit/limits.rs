//! Computes the limit positions and normals of the vertices of a net.

use std::fmt;

use super::continuity::{check, smoothness};
use super::disc::RingCount;
use super::dual::Unrefined;
use super::error::Unlimited;
use super::field::{Functional, VertexMasks};
use super::impulse::ImpulseSmoothness;
use super::mask::Finder;
use super::normals;
use super::on_net::CycleOnNet;
use super::perturbed::{self, ROWS_A_POINT, followed_points};
use super::refined_net::RefinedNet;
use super::regular::Starts;
use super::request::LimitRequest;
use crate::math::rows::blend;
use crate::refine::{Normals, Points};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::watch::{Stopped, Watch};

/// Maximum number of rings by which discs are widened. A mesh may need more rings than regular nets where it is narrow
/// at its boundary or has vertices between two faces.
/// Each further ring takes another search of all discs, and only if the last one failed. Half of it may refuse narrow
/// boundaries of dual schemes; twice of it takes about twice as long to refuse.
const MAX_WIDER: usize = 3;

/// The limits of the vertices of a net, in the order of construction.
#[derive(Debug, Default)]
pub(in crate::analysis) struct VertexLimits {
    /// Positions, `n x 3`, and the values of each channel, if requested.
    pub(in crate::analysis) points: Option<Vec<Vec<f64>>>,
    /// Normals, if requested and existing.
    pub(super) normals: Option<Normals>,
    /// Why there are no normals, or why some are missing.
    pub(super) warning: Option<String>,
}

/// Returns the warning that there are no limit normals, because of `why`.
pub(super) fn without_normals(why: impl fmt::Display) -> String {
    format!("the normals are weighted by area, as limit ones do not exist: {why}")
}

/// The masks and points from which the limits of a net are computed.
pub(super) struct Looked<'a> {
    /// The masks of all vertices; `None` if only normals are requested and there are none.
    pub(super) field: Option<&'a VertexMasks<'a>>,
    /// The sectors of all vertices.
    pub(super) sectors: &'a [(u32, usize)],
    /// The points to which the masks apply.
    pub(super) points: &'a [Points],
    /// Why there are no normals although they are requested.
    pub(super) warning: Option<String>,
}

/// Returns the limits of a net that the steps `ahead` would refine further. `given` are its points and channels.
///
/// # Errors
/// [`Unlimited`].
pub(in crate::analysis) fn limits(
    plan: &Plan,
    net: &MeshNet,
    given: &[Points],
    ahead: &[Scheduled],
    request: LimitRequest,
    watch: &Watch,
) -> Result<VertexLimits, Unlimited> {
    look((plan, ahead), (net, given), request, watch, |Looked { field, sectors, points, warning }| {
        let Some(field) = field else { return Ok(VertexLimits { warning, ..VertexLimits::default() }) };
        let vertices = &sectors[..field.n_vertices()];
        let positions = if request.positions { Some(moved(field, vertices, points, given, watch)?) } else { None };
        if warning.is_some() || !request.normals {
            return Ok(VertexLimits { points: positions, normals: None, warning });
        }
        let tangent = |i| blend(&field.rows(sectors, Functional::Tangent(i)), &points[0].now, 3, watch);
        let (normals, warning) = normals::of(field, sectors, &tangent(0)?, &tangent(1)?);
        Ok(VertexLimits { points: positions, normals: Some(normals), warning })
    })
}

/// Returns the number of steps before the first upsampling. They are applied before limits are computed: they move
/// points and may put faces in the place of vertices, but do not change the limits.
pub(super) fn before(ahead: &[Scheduled]) -> usize {
    ahead.iter().take_while(|step| !step.letter.facts().children.refine()).count()
}

/// Finds the masks of a net that the steps `ahead` would refine further, and returns what `then` makes of them.
///
/// # Errors
/// [`Unlimited`].
pub(super) fn look<T>(
    (plan, ahead): (&Plan, &[Scheduled]),
    (net, given): (&MeshNet, &[Points]),
    request: LimitRequest,
    watch: &Watch,
    then: impl FnOnce(Looked<'_>) -> Result<T, Unlimited>,
) -> Result<T, Unlimited> {
    check(plan)?;
    let before = before(ahead);
    let Unrefined { net, points, centres } = Unrefined::by(net, given, plan, &ahead[..before], watch)?;
    let starts = Starts { is_open: net.mesh.base.n_boundary() > 0, others: centres.is_some() };
    let (topology, steady) = (net.mesh.topology(), Plan { perturbation: None, ..plan.clone() });
    let on_net = CycleOnNet::of(&steady, &net, &topology, &ahead[before..], watch)?;
    let rings = on_net.rings(starts)?;
    let smoothness = smoothness(&on_net, rings.support, request.normals, watch)?;
    let perturbation = perturbed::of(plan);
    let kinked = perturbation.as_ref().filter(|_| request.normals).and_then(perturbed::no_normals);
    if kinked.is_some() && !request.positions {
        return then(Looked { field: None, sectors: &[], points: &points, warning: kinked });
    }
    let with_tangents = request.normals && smoothness == ImpulseSmoothness::Smooth && kinked.is_none();
    let around = RefinedNet::new(net, topology, centres, on_net.surroundings);
    let rows = ROWS_A_POINT * followed_points(plan, request);
    let field = widened(rings, |rings| {
        let finder = Finder::new(&on_net.cycle, rings, with_tangents);
        match perturbation {
            Some(perturbation) => perturbed::field(&around, rings, &finder, perturbation, rows, watch),
            None => VertexMasks::new(&around, &on_net, rings, &finder, watch),
        }
    })?;
    let regular = || field.no_regular_tangents().map(|why| without_normals(why.at("a regular vertex")));
    let warning = match smoothness {
        ImpulseSmoothness::Continuous => Some(without_normals("the scheme has no continuous tangents")),
        _ => kinked.or_else(regular),
    };
    then(Looked { field: Some(&field), sectors: &field.sectors(), points: &points, warning })
}

/// Returns what `find` finds with these rings or, if they may be too few, with up to [`MAX_WIDER`] more.
fn widened<T>(rings: RingCount, find: impl Fn(RingCount) -> Result<T, Unlimited>) -> Result<T, Unlimited> {
    find(rings).or_else(|error| {
        let more = if error.may_be_of_the_disc() { MAX_WIDER } else { 0 };
        let wider = |by: usize| RingCount { support: rings.support + by, disc: rings.disc + by };
        let mut found = (1..=more).map(|by| find(wider(by)));
        let done = |found: &Result<T, Unlimited>| matches!(found, Ok(_) | Err(Unlimited::Stopped(_)));
        found.find(done).unwrap_or(Err(error))
    })
}

/// Returns the limits of positions and channels. A vertex without faces that the steps before the next upsampling
/// removed keeps its `given` values.
fn moved(
    field: &VertexMasks<'_>,
    vertices: &[(u32, usize)],
    points: &[Points],
    given: &[Points],
    watch: &Watch,
) -> Result<Vec<Vec<f64>>, Stopped> {
    let blended = |(points, given): (&Points, &Points)| {
        let rows = field.rows(vertices, Functional::Position);
        let mut limits = blend(&rows, &points.now, points.width, watch)?;
        for v in field.left_out() {
            let range = v * points.width..(v + 1) * points.width;
            limits[range.clone()].copy_from_slice(&given.now[range]);
        }
        Ok(limits)
    };
    points.iter().zip(given).map(blended).collect()
}
