//! The analysis of a plan as a curve scheme: a computation like a job, which depends on the scheme only.

use super::input::Input;
use super::key::{self, Key};
use super::matrices::{AskedMatrices, FoundMatrices, RequestedMatrices};
use super::polygon_survey::{MAX_SURVEYED_POINTS, PolygonSurvey, SurveyedPolygons};
use super::scan::{self, RequestedScan};
use crate::analysis::curve::{self, NoMask};
use crate::analysis::scan::{MAX_BETWEEN, Scan, Scanned};
use crate::analysis::smoothness::{BasicFunction, SmoothnessReport};
use crate::analysis::theorems::{Decay, Theorem, theorems};
use crate::analysis::{LevelMask, Study};
use crate::fault::{Fault, under};
use crate::scheme::plan::{Plan, PlanInput, Subject};
use crate::watch::{Stopped, Watch};

/// Default number of matrix products in the search for bounds. It decides four-point schemes to 5e-4 of the end of
/// their range, in some 10 ms. Half as many widen intervals by a third; twice as many take twice as long.
pub const DEFAULT_NODES: u64 = 100_000;
/// Maximum number of matrix products that may be requested: a hundred times the default. Half as many leave intervals
/// wider; twice as many let one request hold a thread twice as long.
pub const MAX_NODES: u64 = 10_000_000;
/// Maximum number of values of the basic limit function: four per pixel of a wide figure. Half as many make curves of
/// long masks rougher; twice as many make answers twice as long.
pub const MAX_VALUES: u64 = 1 << 14;
/// Number of matrix products per millisecond on one core. Measured: 11,000 and more with matrices of presets of few
/// points, 746 with those of the 16-point scheme, 457 with those of the 32-point scheme. Half of it would book twice
/// the time that large matrices take, twice of it half the time; smaller matrices are quicker.
const NODES_A_MS: u64 = 400;
/// Cubes of the residual's length per millisecond: whether shifts are stable is decided by as many powers of
/// polynomials as the residual has zeros. Measured on masks of 41, 67 and 129 entries of 17 digits: 0.2, 0.4 and 2.8 s.
/// Half or twice of it would be off by a factor of two.
const CUBES_A_MS: u64 = 700;
/// Upper bound of the memory of an analysis in bytes: the exact matrices and their products. Measured as the largest
/// resident memory of `planish analyse` above that of `planish --version`: 33 MiB for a word of 31 averages and a
/// push-back, 30 MiB for a mask of 41 entries of 17 digits, 22 MiB for one of 129; presets take 5. Half of it would be
/// too little for these; twice of it would let half as many analyses run at once.
const CURVE_ANALYSIS_BYTES: u64 = 48 << 20;
/// Default number of matrix products at each value of a scan. Two hundred values take some seconds. Half as many leave
/// ends of ranges wider; twice as many take twice as long where nothing is decided.
pub const DEFAULT_SCAN_NODES: u64 = 10_000;
/// Maximum number of values of a function that is plotted without a grid of its own: two per pixel. Half as many show
/// corners where there are none; twice as many make figures in lines twice as long.
const MAX_PLOTTED_VALUES: u64 = 1 << 10;
/// Finest grid level for a plot; binary schemes have no finer one with so many values.
const MAX_GRID: u32 = 10;
/// Number of polygon points per millisecond whose levels all searches examine. The bounds of tolerances of eight levels
/// take some 60 ms for 16,000 points. Half of it would book twice the time, twice of it half the time.
const POINTS_A_MS: u64 = 250;
/// Milliseconds of an analysis apart from its matrix products, for the eigenvalues and the choice of a norm. Measured
/// on masks of some ten entries: 5 to 10 ms. Half of it would book too little for scans of longer masks; twice of it
/// would let fewer scans run at once.
const BASE_MS: u64 = 10;

/// The analysis that a client requests for a plan.
#[derive(Debug, Clone)]
pub struct Analysis {
    asked: AnalysisSubject,
    nodes: u64,
    key: Key,
}

#[derive(Debug, Clone)]
enum AnalysisSubject {
    Scheme { study: Box<Study>, grid: Option<u32>, matrices: Option<AskedMatrices>, on: Option<Box<SurveyedPolygons>> },
    Scan(Box<Scan>),
}

/// The parts of an analysis that a client requests.
#[derive(Debug, Clone, Default)]
pub struct RequestedFindings {
    /// Maximum number of matrix products in the search for bounds; in a scan, at each value of the parameter.
    pub nodes: Option<u64>,
    /// The number of refinement steps of the grid on which the basic limit function is evaluated.
    pub grid: Option<u32>,
    /// The matrices of one step, if requested.
    pub matrices: Option<RequestedMatrices>,
    /// The scan of a parameter, if requested.
    pub scan: Option<RequestedScan>,
    /// Polygons to be refined by the plan, if any.
    pub input: Option<Input>,
    /// Whether functions are plotted, for which the grid is as fine as a plot shows if none is requested.
    pub is_plotted: bool,
}

/// The result of an analysis.
#[derive(Debug, Clone)]
pub enum Findings<'a> {
    /// The result for one scheme.
    Scheme(Box<SchemeFindings<'a>>),
    /// The result for the schemes at all values of a parameter.
    Scan(&'a Scan, Scanned),
}

/// The result of the analysis of one scheme.
#[derive(Debug, Clone)]
pub struct SchemeFindings<'a> {
    /// The report on the scheme, or on the limit of the schemes of the levels.
    pub report: SmoothnessReport,
    /// The schemes of the levels, if they change.
    pub levels: &'a [LevelMask],
    /// The factor by which the distance of a level from the limit scheme changes from one level to the next.
    pub rate: Option<f64>,
    /// The largest k for which limits of the plan are proved to be C^k.
    pub proved_c: i64,
    /// The least order of the sum rules of its levels.
    pub sum_rules: i64,
    /// Values of the basic limit function, if requested and if it exists.
    pub values: Option<BasicFunction>,
    /// Values of its derivatives, as far as they are proved to be continuous.
    pub derivatives: Vec<BasicFunction>,
    /// The matrices of one step, if requested.
    pub matrices: Option<FoundMatrices<'a>>,
    /// The theorems of the first paper, if levels change.
    pub theorems: Vec<Theorem>,
    /// How quickly the levels converge to the limit scheme.
    pub decay: Option<Decay>,
    /// The result for the polygons, if any were given.
    pub survey: Option<PolygonSurvey>,
}

impl Analysis {
    /// Creates the analysis of a plan.
    ///
    /// # Errors
    /// Every fault found, with pointers into the request.
    pub fn new(plan: &PlanInput, requested: &RequestedFindings, watch: &Watch) -> Result<Self, Vec<Fault>> {
        let usual = if requested.scan.is_some() { DEFAULT_SCAN_NODES } else { DEFAULT_NODES };
        let nodes = requested.nodes.unwrap_or(usual);
        let faults: Vec<Fault> = too_many_nodes(nodes).into_iter().collect();
        let asked = match &requested.scan {
            None => scheme(plan, requested, watch),
            Some(_) if requested.grid.is_some() => Err(useless_beside_scan("grid")),
            Some(_) if requested.input.is_some() => Err(useless_beside_scan("input")),
            Some(_) if requested.matrices.is_some() => Err(useless_beside_scan("matrices")),
            Some(scanned) => scan::scan(plan, scanned, [nodes, MAX_NODES], |input| study(input, watch))
                .map(|scan| AnalysisSubject::Scan(Box::new(scan))),
        };
        match asked {
            Ok(asked) if faults.is_empty() => {
                let key = match &asked {
                    AnalysisSubject::Scheme { study, grid, matrices, on } => {
                        let on = on.as_ref().map(|on| (&on.input, &on.plan));
                        key::analysis(study, nodes, *grid, matrices.as_ref().map(AskedMatrices::item), on)
                    }
                    AnalysisSubject::Scan(scan) => scan::key(scan, nodes),
                };
                Ok(Self { asked, nodes, key })
            }
            asked => Err(faults.into_iter().chain(asked.err().unwrap_or_default()).collect()),
        }
    }

    /// Returns the key of the result.
    pub fn key(&self) -> Key {
        self.key
    }

    /// Returns an upper bound of the number of schemes analysed.
    fn schemes(&self) -> u64 {
        match &self.asked {
            AnalysisSubject::Scheme { .. } => 1,
            AnalysisSubject::Scan(scan) => u64::from(scan.steps) + 1 + u64::from(MAX_BETWEEN),
        }
    }

    /// Returns an upper bound of the work, in the units of the watch.
    pub fn work(&self) -> u64 {
        self.products() + self.surveyed().map_or(0, |_| curve::MAX_CURVE_WORK)
    }

    /// Returns an upper bound of the number of matrix products.
    fn products(&self) -> u64 {
        self.nodes * self.schemes()
    }

    /// Returns the approximate time in milliseconds on one core.
    pub fn milliseconds(&self) -> u64 {
        let residual = match &self.asked {
            AnalysisSubject::Scheme { study, .. } => study.settled.residual.len() as u64,
            AnalysisSubject::Scan(_) => 0,
        };
        let search =
            self.surveyed().map_or(0, |on| on.input.n_points().min(MAX_SURVEYED_POINTS) as u64 / POINTS_A_MS + BASE_MS);
        self.products() / NODES_A_MS + BASE_MS * self.schemes() + residual.pow(3) / CUBES_A_MS + search
    }

    /// Returns an upper bound of the memory in bytes.
    pub fn bytes(&self) -> u64 {
        let input = self.surveyed().map_or(0, |on| on.input.bytes() + curve::search_bytes(on.input.n_points()));
        input.saturating_add(CURVE_ANALYSIS_BYTES)
    }

    /// Returns the polygons of the request, if any.
    fn surveyed(&self) -> Option<&SurveyedPolygons> {
        if let AnalysisSubject::Scheme { on, .. } = &self.asked { on.as_deref() } else { None }
    }

    /// Runs the analysis.
    ///
    /// # Errors
    /// [`Stopped`] when the watch says so.
    pub fn run(&self, watch: &Watch) -> Result<Findings<'_>, Stopped> {
        match &self.asked {
            AnalysisSubject::Scheme { study, grid, matrices, on } => {
                let survey = on.as_ref().map(|on| on.survey(watch)).transpose()?;
                let report = SmoothnessReport::of(study.settled.clone(), self.nodes, watch)?;
                let (values, derivatives) = match grid {
                    Some(grid) => (report.basic_function(*grid, watch)?, report.derivatives(*grid, watch)?),
                    None => (None, Vec::new()),
                };
                let proved_c = study.concluded(report.smoothness.proved_c, report.smoothness.contracts_c);
                let (levels, rate) = (study.levels.as_slice(), study.rate());
                let matrices = matrices.as_ref().map(|matrices| matrices.found(&report));
                let converges = report.smoothness.proved_c >= 0;
                let theorems = if levels.is_empty() { Vec::new() } else { theorems(study, converges) };
                let decay = Decay::of(study);
                let found = SchemeFindings {
                    report,
                    levels,
                    rate,
                    proved_c,
                    sum_rules: study.sum_rules(),
                    values,
                    derivatives,
                    matrices,
                    theorems,
                    decay,
                    survey,
                };
                Ok(Findings::Scheme(Box::new(found)))
            }
            AnalysisSubject::Scan(scan) => {
                Ok(Findings::Scan(scan, scan.run(|input| self::study(input, watch), self.nodes, watch)?))
            }
        }
    }
}

fn scheme(input: &PlanInput, requested: &RequestedFindings, watch: &Watch) -> Result<AnalysisSubject, Vec<Fault>> {
    let study = study(input, watch).map_err(|found| under("/plan", found))?;
    let on = requested.input.as_ref().map(|shape| {
        let plan = shape.plan(input).map_err(|found| under("/plan", found))?;
        Ok::<_, Vec<Fault>>(Box::new(SurveyedPolygons { input: shape.clone(), plan }))
    });
    let on = on.transpose()?;
    let count = |grid: u32| BasicFunction::count(&study.settled, grid);
    let plotted =
        || (1..=MAX_GRID).take_while(|grid| count(*grid).is_some_and(|n| n <= MAX_PLOTTED_VALUES)).last().unwrap_or(1);
    let grid = requested.grid.or_else(|| requested.is_plotted.then(plotted));
    if let Some(grid) = grid
        && count(grid).is_none_or(|count| count > MAX_VALUES)
    {
        let detail = format!("a grid of {grid} steps has more than {MAX_VALUES} values here; ask for a coarser one");
        return Err(vec![Fault::new("/grid", detail)]);
    }
    let of_plan =
        |matrices: RequestedMatrices| AskedMatrices::of(&Plan::resolve(input, Subject::default())?, &study, matrices);
    let matrices = requested.matrices.map(of_plan).transpose()?;
    Ok(AnalysisSubject::Scheme { study: Box::new(study), grid, matrices, on })
}

/// Refuses more products of matrices than are looked at.
pub(super) fn too_many_nodes(nodes: u64) -> Option<Fault> {
    let detail = || format!("{nodes} products of matrices; at most {MAX_NODES} are looked at");
    (nodes > MAX_NODES).then(|| Fault::new("/nodes", detail()))
}

fn useless_beside_scan(name: &str) -> Vec<Fault> {
    let detail = format!("a scan says of each value what is proved and no more; leave \"{name}\" or \"scan\" out");
    vec![Fault::new(format!("/{name}"), detail)]
}

fn study(input: &PlanInput, watch: &Watch) -> Result<Study, Vec<Fault>> {
    let plan = Plan::resolve(input, Subject::default())?;
    Study::of(&plan, watch).map_err(|error| {
        let remedy = match error {
            NoMask::Perturbed => "; leave the perturbation out",
            NoMask::NotLinear(_) => "; only linear schemes have a mask that could be analysed",
            NoMask::NoUpsampling => "; begin the cycle with a U",
            NoMask::TooWide => "; ask about a shorter cycle",
            _ => "",
        };
        let place = if input.preset.is_some() { "/preset" } else { "/word" };
        vec![Fault::new(place, format!("{error}{remedy}"))]
    })
}
