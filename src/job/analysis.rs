//! The analysis of a plan: a computation like a job, of which only the scheme matters.

use super::key::{self, Key};
use crate::analysis::curve::NoMask;
use crate::analysis::smoothness::{BasicFunction, Report};
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
/// Products that take as long as a millisecond of one core, with matrices of the usual size.
const NODES_A_MS: u64 = 400;
/// Bytes of memory that an analysis takes at most: the exact matrices and their products.
/// It is reckoned from the widest masks: 129 entries, and products of that many fractions. Half of it is enough for all
/// presets; twice of it lets half as many analyses run at once.
const BYTES: u64 = 64 << 20;

/// What is asked about a plan.
#[derive(Debug, Clone)]
pub struct Analysis {
    study: Study,
    nodes: u64,
    grid: Option<u32>,
    key: Key,
}

/// What an analysis has found.
#[derive(Debug, Clone)]
pub struct Findings<'a> {
    /// Of the scheme, or of the one that those of the levels come close to.
    pub report: Report,
    /// The schemes of the levels, where they change.
    pub levels: &'a [Level],
    /// By what the distance of a level from the settled scheme is divided at the next.
    pub rate: Option<f64>,
    /// Values of the basic limit function, where they were asked for and there is one.
    pub values: Option<BasicFunction>,
}

impl Analysis {
    /// The analysis of a plan with so many products in the search for bounds, and with the values of the basic limit
    /// function at so fine a grid.
    ///
    /// # Errors
    /// Every fault found, with pointers into the request.
    pub fn new(plan: &PlanInput, nodes: Option<u64>, grid: Option<u32>, watch: &Watch) -> Result<Self, Vec<Fault>> {
        let nodes = nodes.unwrap_or(DEFAULT_NODES);
        let mut faults = Vec::new();
        if nodes > MAX_NODES {
            let detail = format!("{nodes} products of matrices; at most {MAX_NODES} are looked at");
            faults.push(Fault::new("/nodes", detail));
        }
        let study = match study(plan, watch) {
            Ok(study) if faults.is_empty() => study,
            Ok(_) => return Err(faults),
            Err(found) => {
                faults.extend(under("/plan", found));
                return Err(faults);
            }
        };
        if let Some(grid) = grid
            && BasicFunction::count(&study.settled, grid).is_none_or(|count| count > MAX_VALUES)
        {
            let detail =
                format!("a grid of {grid} steps has more than {MAX_VALUES} values here; ask for a coarser one");
            return Err(vec![Fault::new("/grid", detail)]);
        }
        let key = key::analysis(&study, nodes, grid);
        Ok(Self { study, nodes, grid, key })
    }

    /// The key of what it finds.
    pub fn key(&self) -> Key {
        self.key
    }

    /// Units of work, at most.
    pub fn work(&self) -> u64 {
        self.nodes
    }

    /// Milliseconds on one core, roughly.
    pub fn milliseconds(&self) -> u64 {
        self.nodes / NODES_A_MS + 10
    }

    /// Bytes of memory that it takes at most.
    pub fn bytes(&self) -> u64 {
        BYTES
    }

    /// What can be said of the plan.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn run(&self, watch: &Watch) -> Result<Findings<'_>, Stopped> {
        let report = Report::of(self.study.settled.clone(), self.nodes, watch)?;
        let values = match self.grid {
            Some(grid) => report.basic_function(grid, watch)?,
            None => None,
        };
        Ok(Findings { report, levels: &self.study.levels, rate: self.study.rate(), values })
    }
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
