//! Limit surfaces: where the vertices of a refined mesh end up, and the normals there.
//!
//! The limit of a vertex is that of its descendants: of itself under schemes that keep vertices, of the centre of the
//! face that takes its place under dual ones. It is a weighted mean of the points around it. The weights are not typed
//! in but computed from the operators themselves: one more cycle is applied to the patch of faces around the vertex, the
//! rows of the points around the child form a matrix, and so on with the child's patch. After a few levels a patch is
//! its own child, and the weights are the left eigenvector of the eigenvalue 1. While the numbers of a plan change
//! from level to level, the matrices of these levels are multiplied; a fixed matrix is used once nothing changes by more
//! than rounding. Equal patches are computed once.
//!
//! Source: M. Halstead, M. Kass, T. DeRose, SIGGRAPH 1993, 35-44 (limits from eigenvectors); math in [`mask`] and
//! [`tangent`].

mod cost;
mod cycle;
mod dual;
mod field;
mod field_rows;
mod frame;
mod heir;
mod impulse;
mod mask;
mod normals;
mod numbers;
mod own;
mod patch;
mod perturbed;
mod places;
mod probe;
mod record;
mod sector;
mod skeleton;
mod small;
mod tangent;
#[cfg(test)]
mod tests;
mod turn;

use crate::math::rows::blend;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::sharpness::Creasing;
use crate::scheme::step_error::StepError;
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::watch::{Stopped, Watch};

use crate::fault::Fault;
use crate::refine::{Normals, Points, RefineError, RefinedMesh, act_on, assembled, mesh_net, numbers, refined_uvs};
use crate::shape::mesh::Mesh;
pub use cost::{Cost, Follow, cost, sees_whole_fans};
pub(super) use cycle::AHEAD;
use cycle::Cycle;
use dual::Led;
use field::{Field, Wish};
use field_rows::FieldRows;
use frame::Frame;
use impulse::{Impulse, Smoothness};
use mask::Finder;
use own::Common;
use patch::Rings;
pub use perturbed::{ROWS_A_POINT, followed_points};
use places::Starts;
use probe::Regular;

/// Rings by which patches are wider at most where regular nets need fewer than a mesh: where it is narrow at its boundary,
/// or has vertices between two faces.
const MOST_WIDER: usize = 3;

/// What of the limit surface is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Asked {
    /// Limit positions instead of the refined ones.
    pub positions: bool,
    /// Limit normals.
    pub normals: bool,
}

impl Asked {
    /// Whether anything is asked for.
    pub fn anything(self) -> bool {
        self.positions || self.normals
    }
}

/// The limit of each vertex of a net, in the order of construction.
#[derive(Debug, Default)]
pub(super) struct Limits {
    /// Positions, `n x 3`, and the numbers of each channel, where they were asked for.
    pub(super) points: Option<Vec<Vec<f64>>>,
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

/// Why there is no limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unlimited {
    /// It was asked to stop.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A later level cannot be computed.
    #[error("the limit needs later levels, of which one cannot be computed: {0}")]
    Later(String),
    /// Nothing in the cycle refines.
    #[error("there is no limit surface where no operator of the plan's cycle refines")]
    NoUpsampling,
    /// A D that leaves nothing of a vertex.
    #[error(
        "a vertex has no limit, as D leaves no faces near it, where all vertices lie on the boundary; widen the mesh there, \
         or close it"
    )]
    Lost,
    /// A D that leaves several things of a vertex.
    #[error(
        "a vertex has no limit, as D parts the faces near it, where the mesh is one face wide; widen it there, or refine \
         once more"
    )]
    Parted,
    /// New points are no weighted means of old ones.
    #[error("limits are known for linear schemes only")]
    NotLinear,
    /// More perturbed points than are followed.
    #[error(
        "the vertices of a perturbed plan have more than {} points around them in all, with which each is followed by itself, \
             beyond which no limit is computed; ask for fewer levels",
        perturbed::MAX_POINTS
    )]
    Followed,
    /// Perturbations that do not fade.
    #[error(
        "the perturbation keeps the points around a vertex apart for more than {} levels, beyond which no limit is computed; \
             choose a smaller amplitude or decay",
        perturbed::MAX_LEVELS
    )]
    Wild,
    /// More vertices with different numbers than are followed.
    #[error(
        "the parameters around more than {} vertices differ, each of which is followed by itself, beyond which no limit is \
             computed; ask for fewer levels",
        field::MAX_PATCHES
    )]
    Different,
    /// More rings than are followed.
    #[error("the scheme reaches farther than {} rings of faces, beyond which no limit is computed", probe::MAX_RINGS)]
    Reach,
    /// A patch beyond the bound.
    #[error(
        "a vertex has more than {} others near it, beyond which no limit is computed; refine once more",
        patch::MAX_VERTICES
    )]
    Size,
    /// More points than are followed.
    #[error(
        "a level of the plan makes more than {} points of those near a vertex, beyond which no limit is computed; write a \
         cycle with fewer or smaller upsamplings",
        cycle::MAX_POINTS
    )]
    Fine,
    /// Neighbourhoods that never look alike, or weights that never settle.
    #[error("the plan has no limit, as its levels do not settle")]
    Unsettled,
    /// Differences that do not shrink.
    #[error(
        "the plan has no continuous limit, as differences between neighbours do not shrink from level to level; choose \
         tamer parameters"
    )]
    Rough,
}

impl Unlimited {
    /// Whether a wider patch may have what this one lacks.
    fn may_be_of_the_patch(&self) -> bool {
        matches!(self, Self::Reach | Self::Later(_) | Self::Lost | Self::Parted)
    }
}

impl From<StepError> for Unlimited {
    fn from(error: StepError) -> Self {
        Self::Later(error.to_string())
    }
}

impl From<RefineError> for Unlimited {
    fn from(error: RefineError) -> Self {
        match error {
            RefineError::Stopped(stopped) => Self::Stopped(stopped),
            RefineError::Step { error, .. } => error.into(),
            other => Self::Later(other.to_string()),
        }
    }
}

/// Whether a plan can have a limit, as far as its word tells.
///
/// # Errors
/// [`Unlimited`].
pub fn check(plan: &Plan) -> Result<(), Unlimited> {
    let cycle = &plan.word.cycle;
    if !cycle.iter().any(|letter| letter.facts().children.refine()) {
        return Err(Unlimited::NoUpsampling);
    }
    if cost::is_beyond(cycle) { Err(Unlimited::Fine) } else { Ok(()) }
}

/// Whether edges of a net hand on sharpness that depends on the edges at both their ends. Then a patch has all faces around
/// the vertices that decide about the limit.
fn evens_out(net: &MeshNet) -> bool {
    let semi_sharp = |&(_, sharpness): &(u32, f64)| sharpness < INFINITE_SHARPNESS;
    let any = net.sharpness.as_ref().is_some_and(|sharpness| sharpness.edges().iter().any(semi_sharp));
    any && net.rules.creasing == Creasing::Chaikin
}

/// How smooth the limit is where it is regular, with all of these numbers at vertices.
fn smoothness(impulse: Impulse<'_>, own: Vec<Common>, tangents: bool, watch: &Watch) -> Result<Smoothness, Unlimited> {
    let mut smoothness = Smoothness::Smooth;
    for common in if own.is_empty() { vec![Common::default()] } else { own } {
        smoothness = smoothness.min(Impulse { common, ..impulse }.smoothness(tangents, watch)?);
    }
    if smoothness == Smoothness::Rough { Err(Unlimited::Rough) } else { Ok(smoothness) }
}

/// Whether a plan whose cycle starts with an upsampling, and perturbs nothing, has a continuous limit on a net.
///
/// # Errors
/// [`Unlimited`], also where that cannot be told.
pub(super) fn check_continuous(plan: &Plan, net: &MeshNet) -> Result<(), Unlimited> {
    check(plan)?;
    let steps = plan.schedule(AHEAD).map_err(|fault| Unlimited::Later(fault.detail))?;
    let own = net.annotations.attributes.as_deref().map_or_else(Vec::new, own::extremes);
    let alphas: Vec<f64> = own.iter().filter_map(Common::alpha).chain([plan.alpha]).collect();
    let ahead = (&steps[plan.word.prefix.len()..], plan.word.cycle.len());
    let cycle = Cycle::new(plan, ahead, Frame::of(plan, &net.mesh.base), &alphas, &Watch::new());
    let (regular, tagged) = (Regular::of(&cycle, &net.mesh.base)?, net.annotations.directions.is_some());
    let (support, common) = (cost::support(&plan.word.cycle), Common::default());
    let impulse = Impulse { cycle: &cycle, regular, tagged, common, support };
    smoothness(impulse, own, false, &Watch::new()).map(drop)
}

/// Why a mesh could not be refined to its limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LimitError {
    /// It could not be refined.
    #[error(transparent)]
    Refine(#[from] RefineError),
    /// There is no limit.
    #[error("{0}; ask for \"positions\": \"refined\"")]
    Unlimited(Unlimited),
}

impl From<Unlimited> for LimitError {
    fn from(error: Unlimited) -> Self {
        match error {
            Unlimited::Stopped(stopped) => Self::Refine(stopped.into()),
            error => Self::Unlimited(error),
        }
    }
}

/// Refines a mesh by `levels` levels and finds what is asked for of its limit; the warnings say what has none.
///
/// # Errors
/// [`LimitError`], also where there is no limit.
pub fn refine_mesh_to_limit(
    mesh: &Mesh,
    plan: &Plan,
    levels: u32,
    asked: Asked,
    watch: &Watch,
) -> Result<(RefinedMesh, Vec<String>), LimitError> {
    let later = |fault: Fault| Unlimited::Later(fault.detail);
    let steps = plan.schedule(levels + AHEAD).map_err(later)?;
    let (steps, ahead) = steps.split_at(plan.word.prefix.len() + levels as usize * plan.word.cycle.len());
    let (net, points) = act_on(mesh_net(mesh, plan), numbers(mesh), plan, steps, watch)?;
    let found = match limits(plan, &net, &points, ahead, asked, watch) {
        Err(error) if !asked.positions && !matches!(error, Unlimited::Stopped(_)) => Limits::without_normals(&error),
        found => found?,
    };
    let refined = || points.into_iter().map(|points| points.now).collect();
    let uvs = refined_uvs(mesh, plan, steps, watch)?;
    let mesh = assembled(mesh, &net, found.points.unwrap_or_else(refined), uvs).with_normals(found.normals);
    Ok((mesh, found.warning.into_iter().collect()))
}

/// The limits of a net that `ahead` would refine further.
pub(in crate::analysis) fn limits(
    plan: &Plan,
    net: &MeshNet,
    points: &[Points],
    ahead: &[Scheduled],
    asked: Asked,
    watch: &Watch,
) -> Result<Limits, Unlimited> {
    check(plan)?;
    // what comes before the first upsampling moves points, and puts faces in the place of vertices: the limits stay
    let before = ahead.iter().take_while(|step| !step.letter.facts().children.refine()).count();
    let given = points;
    let Led { net, points, centres } = Led::by(net, points, plan, &ahead[..before], watch)?;
    let is_open = net.mesh.base.n_boundary() > 0;
    let (perturbation, rows) = (perturbed::of(plan), ROWS_A_POINT * followed_points(plan, asked));
    let plan = &Plan { perturbation: None, ..plan.clone() };
    let own = net.annotations.attributes.as_deref().map_or_else(Vec::new, own::extremes);
    let alphas: Vec<f64> = own.iter().filter_map(Common::alpha).chain([plan.alpha]).collect();
    let length = plan.word.cycle.len();
    let frame = Frame::of(plan, &net.mesh.base);
    let alphas = if field::carries(&net) { &alphas[..] } else { &[] };
    let cycle = Cycle::new(plan, (&ahead[before..], length), frame, alphas, watch);
    let regular = Regular::of(&cycle, &net.mesh.topology())?;
    let tagged = net.annotations.directions.is_some();
    let rings = regular.rings(&cycle, tagged, Starts { is_open, others: centres.is_some() })?;
    let rings = if evens_out(&net) { Rings { patch: rings.patch.max(rings.support + 1), ..rings } } else { rings };
    let impulse = Impulse { cycle: &cycle, regular, tagged, common: Common::default(), support: rings.support };
    let smoothness = smoothness(impulse, own, asked.normals, watch)?;
    let kinked = perturbation.as_ref().filter(|_| asked.normals).and_then(perturbed::no_normals);
    if kinked.is_some() && !asked.positions {
        return Ok(Limits { warning: kinked, ..Limits::default() });
    }
    let with_tangents = asked.normals && smoothness == Smoothness::Smooth && kinked.is_none();
    let field = |wider: usize| {
        let rings = Rings { support: rings.support + wider, patch: rings.patch + wider };
        let finder = Finder::new(&cycle, rings, with_tangents);
        match perturbation {
            Some(perturbation) => perturbed::field(net.clone(), rings, &finder, perturbation, rows, watch),
            None => Field::new(net.clone(), centres.clone(), regular, rings, &finder, watch),
        }
    };
    let field = field(0).or_else(|error| {
        let more = if error.may_be_of_the_patch() { MOST_WIDER } else { 0 };
        let mut found = (1..=more).map(&field);
        let done = |found: &Result<Field, Unlimited>| matches!(found, Ok(_) | Err(Unlimited::Stopped(_)));
        found.find(done).unwrap_or(Err(error))
    })?;
    let places = field.sectors();
    let rows = |places, wish| FieldRows { field: &field, places, wish };
    let vertices = &places[..field.n_vertices()];
    let blended = |(points, given): (&Points, &Points)| -> Result<Vec<f64>, Stopped> {
        let mut limits = blend(&rows(vertices, Wish::Position), &points.now, points.width, watch)?;
        // a D leaves nothing of a vertex without faces, which stays
        for v in field.left_out() {
            let range = v * points.width..(v + 1) * points.width;
            limits[range.clone()].copy_from_slice(&given.now[range]);
        }
        Ok(limits)
    };
    let all = points.iter().zip(given);
    let moved = if asked.positions { Some(all.map(blended).collect::<Result<_, _>>()?) } else { None };
    if !asked.normals {
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
    let tangent = |i| blend(&rows(&places, Wish::Tangent(i)), &points[0].now, 3, watch);
    let (normals, missing) = normals::of(&field, &places, &tangent(0)?, &tangent(1)?);
    Ok(Limits { points: moved, normals: Some(normals), warning: missing })
}
