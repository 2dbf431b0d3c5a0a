//! The analysis of a plan: a computation like a job, of which only the scheme matters.

use super::input::Input;
use super::key::{self, Key};
use super::matrices::{AskedMatrices, FoundMatrices, MatricesWish};
use super::polygon_survey::{MAX_POINTS, PolygonSurvey, SurveyedPolygons};
use super::scan::{self, ScanWish};
use crate::analysis::curve::{self, NoMask};
use crate::analysis::scan::{MOST_BETWEEN, Scan, Scanned};
use crate::analysis::smoothness::{BasicFunction, Report};
use crate::analysis::theorems::{Decay, Theorem, theorems};
use crate::analysis::{Level, Study};
use crate::fault::{Fault, under};
use crate::scheme::plan::{Plan, PlanInput, Subject};
use crate::watch::{Stopped, Watch};

/// Products of matrices that the search for bounds looks at when nothing is said.
/// It decides four-point schemes to 5e-4 of the end of their range, in some 10 ms. Half of it widens intervals by a
/// third, twice of it takes twice as long.
pub const DEFAULT_NODES: u64 = 100_000;
/// Most products that may be asked for: a hundred times the usual number.
/// Half of it leaves intervals wider, twice of it lets one request hold a thread for twice as long.
pub const MAX_NODES: u64 = 10_000_000;
/// Most values of the basic limit function.
/// It is four for each pixel of a wide figure. Half of it makes curves of long masks rougher; twice of it makes answers
/// twice as long.
pub const MAX_VALUES: u64 = 1 << 14;
/// Products that take as long as a millisecond of one core. Measured: 11,000 and more with matrices of presets of few
/// points, 746 with those of the 16-point scheme, 457 with those of the 32-point scheme.
/// Half of it books twice the time that they take, twice of it half of it; smaller matrices are quicker.
const NODES_A_MS: u64 = 400;
/// Cubes of the residual's length that take as long as a millisecond: whether shifts are stable is decided by as many
/// powers of polynomials as the residual has zeros.
/// Measured on masks of 41, 67 and 129 entries of 17 digits: 0.2, 0.4 and 2.8 s. Half and twice of it are off by two.
const CUBES_A_MS: u64 = 700;
/// Bytes of memory that an analysis takes at most: the exact matrices and their products.
/// Measured as the largest resident memory of `planish analyse` over that of `planish --version`: 33 MiB for a word of
/// 31 averages and a push-back, 30 MiB for a mask of 41 entries of 17 digits, 22 MiB for one of 129; presets take 5.
/// Half of it is too little for these; twice of it lets half as many analyses run at once.
const BYTES: u64 = 48 << 20;
/// Products of matrices at each value of a scan when nothing is said.
/// Two hundred values take some seconds. Half of it leaves ends of ranges wider, twice of it takes twice as long where
/// nothing is decided.
pub const DEFAULT_SCAN_NODES: u64 = 10_000;
/// Most values of a function that is plotted without a grid of its own: two for each pixel.
/// Half of it shows corners where there are none; twice of it makes figures in lines twice as long.
const PLOTTED: u64 = 1 << 10;
/// Finest grid that is looked at for a plot: binary schemes have no finer one of so many values.
const MAX_GRID: u32 = 10;
/// Points of polygons whose levels are looked at in a millisecond, all searches together.
/// It is what the bounds of tolerances take, of eight levels: some 60 ms for 16,000 points. Half of it books twice of
/// what they take, twice of it half of it.
const POINTS_A_MS: u64 = 250;
/// Milliseconds of an analysis without its products: those that look for an eigenvalue, and choose a norm.
/// Measured on masks of some ten entries: 5 to 10 ms. Half of it books scans of longer masks too short; twice of it
/// lets fewer scans run at once.
const BASE_MS: u64 = 10;

/// What is asked about a plan.
#[derive(Debug, Clone)]
pub struct Analysis {
    asked: Asked,
    nodes: u64,
    key: Key,
}

#[derive(Debug, Clone)]
enum Asked {
    Scheme { study: Box<Study>, grid: Option<u32>, matrices: Option<AskedMatrices>, on: Option<Box<SurveyedPolygons>> },
    Scan(Box<Scan>),
}

/// What is to be found out about a plan.
#[derive(Debug, Clone, Default)]
pub struct Wishes {
    /// Products of matrices in the search for bounds, at each value where a parameter is scanned.
    pub nodes: Option<u64>,
    /// The steps of the grid of values of the basic limit function.
    pub grid: Option<u32>,
    /// The matrices of one step.
    pub matrices: Option<MatricesWish>,
    /// The parameter that is scanned.
    pub scan: Option<ScanWish>,
    /// Polygons that are refined.
    pub input: Option<Input>,
    /// Whether functions are plotted: then the grid is as fine as a plot shows, where none is named.
    pub is_plotted: bool,
}

/// What an analysis has found.
#[derive(Debug, Clone)]
pub enum Findings<'a> {
    /// Of one scheme.
    Scheme(Box<SchemeFindings<'a>>),
    /// Of the schemes for all values of a parameter.
    Scan(&'a Scan, Scanned),
}

/// What is found of a scheme.
#[derive(Debug, Clone)]
pub struct SchemeFindings<'a> {
    /// Of the scheme, or of the one that those of the levels come close to.
    pub report: Report,
    /// The schemes of the levels, where they change.
    pub levels: &'a [Level],
    /// By what the distance of a level from the settled scheme is multiplied at the next.
    pub rate: Option<f64>,
    /// The largest k for which limits of the plan are proved to be C^k.
    pub proved_c: i64,
    /// The least order of the sum rules of its levels.
    pub sum_rules: i64,
    /// Values of the basic limit function, where they were asked for and there is one.
    pub values: Option<BasicFunction>,
    /// Values of its derivatives, as far as they are proved to be continuous.
    pub derivatives: Vec<BasicFunction>,
    /// The matrices of one step, where they were asked for.
    pub matrices: Option<FoundMatrices<'a>>,
    /// The theorems of the first paper, where levels change.
    pub theorems: Vec<Theorem>,
    /// How quickly levels come close to the settled scheme.
    pub decay: Option<Decay>,
    /// What is found of the polygons, where some were given.
    pub survey: Option<PolygonSurvey>,
}

impl Analysis {
    /// The analysis of a plan.
    ///
    /// # Errors
    /// Every fault found, with pointers into the request.
    pub fn new(plan: &PlanInput, wishes: &Wishes, watch: &Watch) -> Result<Self, Vec<Fault>> {
        let usual = if wishes.scan.is_some() { DEFAULT_SCAN_NODES } else { DEFAULT_NODES };
        let nodes = wishes.nodes.unwrap_or(usual);
        let mut faults = Vec::new();
        if nodes > MAX_NODES {
            let detail = format!("{nodes} products of matrices; at most {MAX_NODES} are looked at");
            faults.push(Fault::new("/nodes", detail));
        }
        let asked = match &wishes.scan {
            None => scheme(plan, wishes, watch),
            Some(_) if wishes.grid.is_some() => Err(useless_beside_scan("grid")),
            Some(_) if wishes.input.is_some() => Err(useless_beside_scan("input")),
            Some(_) if wishes.matrices.is_some() => Err(useless_beside_scan("matrices")),
            Some(wish) => scan::scan(plan, wish, [nodes, MAX_NODES], |input| study(input, watch))
                .map(|scan| Asked::Scan(Box::new(scan))),
        };
        match asked {
            Ok(asked) if faults.is_empty() => {
                let key = match &asked {
                    Asked::Scheme { study, grid, matrices, on } => {
                        let on = on.as_ref().map(|on| (&on.input, &on.plan));
                        key::analysis(study, nodes, *grid, matrices.as_ref().map(AskedMatrices::item), on)
                    }
                    Asked::Scan(scan) => scan::key(scan, nodes),
                };
                Ok(Self { asked, nodes, key })
            }
            asked => Err(faults.into_iter().chain(asked.err().unwrap_or_default()).collect()),
        }
    }

    /// The key of what it finds.
    pub fn key(&self) -> Key {
        self.key
    }

    /// How many schemes are analysed, at most.
    fn schemes(&self) -> u64 {
        match &self.asked {
            Asked::Scheme { .. } => 1,
            Asked::Scan(scan) => u64::from(scan.steps) + 1 + u64::from(MOST_BETWEEN),
        }
    }

    /// Units of work, at most.
    pub fn work(&self) -> u64 {
        self.products() + self.surveyed().map_or(0, |_| curve::MAX_WORK)
    }

    /// Products of matrices, at most.
    fn products(&self) -> u64 {
        self.nodes * self.schemes()
    }

    /// Milliseconds on one core, roughly.
    pub fn milliseconds(&self) -> u64 {
        let residual = match &self.asked {
            Asked::Scheme { study, .. } => study.settled.residual.len() as u64,
            Asked::Scan(_) => 0,
        };
        let search = self.surveyed().map_or(0, |on| on.input.n_points().min(MAX_POINTS) as u64 / POINTS_A_MS + BASE_MS);
        self.products() / NODES_A_MS + BASE_MS * self.schemes() + residual.pow(3) / CUBES_A_MS + search
    }

    /// Bytes of memory that it takes at most.
    pub fn bytes(&self) -> u64 {
        let input = self.surveyed().map_or(0, |on| on.input.bytes() + curve::search_bytes(on.input.n_points()));
        input.saturating_add(BYTES)
    }

    /// The polygons that are asked about.
    fn surveyed(&self) -> Option<&SurveyedPolygons> {
        if let Asked::Scheme { on, .. } = &self.asked { on.as_deref() } else { None }
    }

    /// What can be said of the plan.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn run(&self, watch: &Watch) -> Result<Findings<'_>, Stopped> {
        match &self.asked {
            Asked::Scheme { study, grid, matrices, on } => {
                let survey = on.as_ref().map(|on| on.survey(watch)).transpose()?;
                let report = Report::of(study.settled.clone(), self.nodes, watch)?;
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
            Asked::Scan(scan) => {
                Ok(Findings::Scan(scan, scan.run(|input| self::study(input, watch), self.nodes, watch)?))
            }
        }
    }
}

fn scheme(input: &PlanInput, wishes: &Wishes, watch: &Watch) -> Result<Asked, Vec<Fault>> {
    let study = study(input, watch).map_err(|found| under("/plan", found))?;
    let on = wishes.input.as_ref().map(|shape| {
        let plan = shape.plan(input).map_err(|found| under("/plan", found))?;
        Ok::<_, Vec<Fault>>(Box::new(SurveyedPolygons { input: shape.clone(), plan }))
    });
    let on = on.transpose()?;
    let count = |grid: u32| BasicFunction::count(&study.settled, grid);
    let plotted = || (1..=MAX_GRID).take_while(|grid| count(*grid).is_some_and(|n| n <= PLOTTED)).last().unwrap_or(1);
    let grid = wishes.grid.or_else(|| wishes.is_plotted.then(plotted));
    if let Some(grid) = grid
        && count(grid).is_none_or(|count| count > MAX_VALUES)
    {
        let detail = format!("a grid of {grid} steps has more than {MAX_VALUES} values here; ask for a coarser one");
        return Err(vec![Fault::new("/grid", detail)]);
    }
    let of_plan = |wish: MatricesWish| AskedMatrices::of(&Plan::resolve(input, Subject::default())?, &study, wish);
    let matrices = wishes.matrices.map(of_plan).transpose()?;
    Ok(Asked::Scheme { study: Box::new(study), grid, matrices, on })
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
