//! The analysis of a plan as a surface scheme: a computation like a job, which depends on the scheme only.

use std::ops::RangeInclusive;

use super::analysis::{DEFAULT_NODES, too_many_nodes};
use super::input::Input;
use super::key::{self, Key};
use super::mesh_survey::{Survey, Surveyed};
use crate::analysis::limit::Unlimited;
use crate::analysis::surface::{BoundaryReport, RegularSmoothness, SurfaceStudy, ValenceReport};
use crate::analysis::tolerance;
use crate::fault::{Fault, under};
use crate::math::expression::Expression;
use crate::scheme::plan::{Plan, PlanInput, Subject};
use crate::watch::{Stopped, Watch};

/// The valences that are analysed by default.
const DEFAULT_VALENCES: RangeInclusive<usize> = 3..=12;
/// The numbers of faces at boundary vertices that are analysed by default.
const DEFAULT_FACES: RangeInclusive<usize> = 1..=6;
/// Maximum number of faces at a boundary vertex. Without rotations to decompose them, the matrices grow with it. Half
/// as many would refuse fans that meshes have; twice as many would take eight times as long.
pub const MAX_FAN_FACES: usize = 24;
/// Maximum valence. Matrices have some dozens of rows per Fourier index. Half as many would refuse poles of fine
/// spheres; twice as many would take twice as long, and characteristic maps would become so thin that proofs fail.
pub const MAX_VALENCE: usize = 50;
/// Milliseconds per vertex and edge. Measured for the default 96 edges: 0.04 with cubic splines on quads and quartic
/// ones on triangles, 0.9 with splines of degree 7, 1.9 where an interpolating scheme on quads has characteristic maps
/// that are followed to the last level. With half of it, such schemes would take longer than their share; with twice of
/// it, all would wait longer.
const MS_AN_EDGE: u64 = 2;
/// Milliseconds for the spectral radius of a regular scheme that is neither a spline nor a tensor product. Measured:
/// 0.8 s where triangles are interpolated and where the grid of triangles turns at each level, mostly for the fractions
/// of norms. With half of it, such schemes would take longer than their share; with twice, they would wait longer.
const MS_OF_RADIUS: u64 = 800;
/// Approximate milliseconds for bounds of distances from the limit: half a second per level of the largest meshes. With
/// half of it, searches would take longer than their share; with twice of it, they would wait longer.
const MS_OF_BOUNDS: u64 = 3000;
/// Upper bound of the memory of an analysis in bytes: the largest star, the rows of its operators and the blocks. It is
/// derived from 2^18 points with some 200 bytes each. Half of it suffices for all presets; twice of it would let half
/// as many analyses run at once.
const SURFACE_ANALYSIS_BYTES: u64 = 64 << 20;

/// The analysis of a plan on meshes that a client requests.
#[derive(Debug)]
pub struct SurfaceAnalysis {
    study: SurfaceStudy,
    follows_alpha: bool,
    drops_tags: bool,
    valences: Vec<usize>,
    boundaries: Vec<usize>,
    surveyed: Option<Surveyed>,
    nodes: u64,
    key: Key,
}

/// The result of an analysis.
#[derive(Debug)]
pub struct SurfaceFindings<'a> {
    /// The plan as a scheme.
    pub study: &'a SurfaceStudy,
    /// Whether the levels differ from the level at alpha = 0, which was analysed.
    pub follows_alpha: bool,
    /// Whether what is said of vertices is said of the mesh without its latitude and longitude tags.
    pub drops_tags: bool,
    /// The smoothness of limits on regular nets.
    pub smoothness: RegularSmoothness,
    /// The report on each valence, or the reason for which there is none.
    pub valences: Reports<ValenceReport>,
    /// The report on boundary vertices with each number of faces, or the reason for which there is none.
    pub boundaries: Reports<BoundaryReport>,
    /// The survey of the mesh, if one was given.
    pub survey: Option<Survey>,
}

/// The vertices that are analysed.
#[derive(Debug, Clone, Copy, Default)]
pub struct AnalysedVertices<'a> {
    /// Valences of interior vertices.
    pub valences: Option<&'a [u64]>,
    /// Numbers of faces at boundary vertices.
    pub boundaries: Option<&'a [u64]>,
}

impl SurfaceAnalysis {
    /// Creates the analysis of a plan around some vertices, with a maximum number of matrix products in the search for
    /// bounds; on a mesh, around its own vertices if none are given.
    ///
    /// # Errors
    /// Every fault found, with pointers into the request.
    pub fn new(
        plan: &PlanInput,
        around: AnalysedVertices<'_>,
        nodes: Option<u64>,
        input: Option<Input>,
        watch: &Watch,
    ) -> Result<Self, Vec<Fault>> {
        let nodes = nodes.unwrap_or(DEFAULT_NODES);
        let mut faults = Vec::new();
        faults.extend(too_many_nodes(nodes));
        let mut numbers = |asked: Option<&[u64]>, name: &str, range: RangeInclusive<usize>| {
            let checked = asked.map(|asked| checked(asked, name, &range)).transpose();
            checked.unwrap_or_else(|found| {
                faults.extend(found);
                None
            })
        };
        let asked = numbers(around.valences, "valences", 3..=MAX_VALENCE);
        let faces = numbers(around.boundaries, "boundaries", 1..=MAX_FAN_FACES);
        let resolved = match &input {
            Some(input) => input.plan(plan),
            None => Plan::resolve(plan, Subject { is_mesh: true, ..Subject::default() }),
        };
        let place = if plan.preset.is_some() { "/plan/preset" } else { "/plan/word" };
        let study = resolved.map_err(|found| under("/plan", found)).and_then(|plan| {
            let settled = at_alpha_zero(&plan).map_err(|detail| vec![Fault::new(place, detail)])?;
            let study = SurfaceStudy::of(&settled, watch).map_err(|error| vec![Fault::new(place, refusal(&error))])?;
            Ok((study, settled, plan))
        });
        let (study, settled, plan) = match study {
            Ok(found) if faults.is_empty() => found,
            other => {
                faults.extend(other.err().unwrap_or_default());
                return Err(faults);
            }
        };
        let (follows_alpha, drops_tags) = (follows_alpha(&plan), plan.latitude.is_some());
        let surveyed = input.map(|input| Surveyed { input, plan });
        let of_mesh = surveyed.as_ref().and_then(Surveyed::mesh).map(|mesh| study.survey(&mesh.topology));
        let usual = || match of_mesh {
            Some(found) => found.into_keys().filter(|valence| (3..=MAX_VALENCE).contains(valence)).collect(),
            None => DEFAULT_VALENCES.collect(),
        };
        let valences = asked.unwrap_or_else(usual);
        let on_boundary = || match surveyed.as_ref().and_then(Surveyed::mesh) {
            Some(mesh) => {
                study.on_boundary(&mesh.topology).into_keys().filter(|faces| *faces <= MAX_FAN_FACES).collect()
            }
            None => DEFAULT_FACES.collect(),
        };
        let boundaries = faces.unwrap_or_else(on_boundary);
        let on = surveyed.as_ref().map(|surveyed| (&surveyed.input, &surveyed.plan));
        let key = key::surface_analysis(&settled, follows_alpha, [&valences, &boundaries], nodes, on);
        Ok(Self { study, follows_alpha, drops_tags, valences, boundaries, surveyed, nodes, key })
    }

    /// Returns the key of the result.
    pub fn key(&self) -> Key {
        self.key
    }

    /// Returns the number of edges at all analysed vertices.
    fn edges(&self) -> u64 {
        self.valences.iter().chain(&self.boundaries).sum::<usize>() as u64
    }

    /// Returns an upper bound of the work, in the units of the watch.
    pub fn work(&self) -> u64 {
        let search = self.surveyed.as_ref().map_or(0, |_| tolerance::MAX_MESH_WORK);
        self.nodes + self.edges() + search
    }

    /// Returns the approximate time in milliseconds on one core.
    pub fn milliseconds(&self) -> u64 {
        let search = self.surveyed.as_ref().map_or(0, |_| MS_OF_BOUNDS);
        let regular = &self.study.regular;
        let is_known = regular.spline_smoothness().is_some() || regular.tensor().is_some();
        let radius = if is_known { 0 } else { MS_OF_RADIUS };
        self.edges() * MS_AN_EDGE + radius + 10 + search
    }

    /// Returns an upper bound of the memory in bytes.
    pub fn bytes(&self) -> u64 {
        let mesh = self.surveyed.as_ref().and_then(Surveyed::mesh);
        let input = self.surveyed.as_ref().map_or(0, |surveyed| surveyed.input.bytes());
        mesh.map_or(0, tolerance::search_bytes).saturating_add(input).saturating_add(SURFACE_ANALYSIS_BYTES)
    }

    /// Runs the analysis.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub fn run(&self, watch: &Watch) -> Result<SurfaceFindings<'_>, Stopped> {
        let smoothness = self.study.smoothness(self.nodes, watch)?;
        let valences = reports(&self.valences, |valence| self.study.valence(valence, &smoothness, watch))?;
        let boundaries = reports(&self.boundaries, |faces| self.study.boundary(faces, &smoothness, watch))?;
        let survey = match &self.surveyed {
            Some(surveyed) => surveyed.survey(&self.study, &smoothness, watch)?,
            None => None,
        };
        let Self { study, follows_alpha, drops_tags, .. } = self;
        let (follows_alpha, drops_tags) = (*follows_alpha, *drops_tags);
        Ok(SurfaceFindings { study, follows_alpha, drops_tags, smoothness, valences, boundaries, survey })
    }
}

/// Reports about numbers that were asked for, or why there is none.
type Reports<T> = Vec<(usize, Result<T, String>)>;

/// Makes the reports about the numbers that were asked for.
fn reports<T>(asked: &[usize], report: impl Fn(usize) -> Result<T, Unlimited>) -> Result<Reports<T>, Stopped> {
    let found = asked.iter().map(|&number| match report(number) {
        Err(Unlimited::Stopped(stopped)) => Err(stopped),
        found => Ok((number, found.map_err(|error| error.to_string()))),
    });
    found.collect()
}

/// Checks a list of numbers; returns them ascending and without repetition.
fn checked(asked: &[u64], name: &str, range: &RangeInclusive<usize>) -> Result<Vec<usize>, Vec<Fault>> {
    let mut found = Vec::with_capacity(asked.len().min(*range.end()));
    let mut faults = Vec::new();
    for (i, &number) in asked.iter().enumerate() {
        match usize::try_from(number) {
            Ok(number) if range.contains(&number) => found.push(number),
            _ => {
                let [from, to] = [range.start(), range.end()];
                let detail =
                    format!("{number} is none of the {name} that are analysed; give numbers from {from} to {to}");
                faults.push(Fault::new(format!("/{name}/{i}"), detail));
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}

/// Returns the plan at alpha = 0, with its functions replaced by their values.
fn at_alpha_zero(plan: &Plan) -> Result<Plan, String> {
    let number = |function: &Expression| match function.value(0.0) {
        Ok(value) => Ok(Expression::constant(value)),
        Err(error) => Err(format!("the limit alpha = 0 is analysed, where {error}")),
    };
    let functions: Result<Vec<Expression>, String> = plan.kernel.iter().map(number).collect();
    Ok(Plan {
        alpha: 0.0,
        compensation_alpha: None,
        kernel: functions?,
        compensation: number(&plan.compensation)?,
        latitude: None,
        ..plan.clone()
    })
}

/// Returns whether levels differ from the level at alpha = 0.
fn follows_alpha(plan: &Plan) -> bool {
    let in_kernel = plan.kernel.iter().any(|kernel| !kernel.is_constant());
    plan.alpha != 0.0 && (in_kernel || !plan.compensation.is_constant())
}

fn refusal(error: &Unlimited) -> String {
    match error {
        Unlimited::NoUpsampling => "no operator of the cycle refines; begin it with a U".into(),
        Unlimited::NotLinear => "only linear schemes have weights that could be analysed".into(),
        Unlimited::Unsettled => "the cycle turns nets from level to level, so that no levels are alike".into(),
        Unlimited::Reach | Unlimited::Fine => "the cycle reaches too far; ask about a shorter one".into(),
        error => error.to_string(),
    }
}
