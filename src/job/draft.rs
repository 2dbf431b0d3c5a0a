//! Drafts: jobs that are read and checked, but for the level that a tolerance asks for.

use super::key::{self, Key};
use super::levels::{self, Asked, SearchCost, SearchError};
use super::{Input, Job, Levels, Output, curves, kernels, steering};
use crate::analysis::curve::Reached;
use crate::analysis::limit::{LimitError, check};
use crate::fault::{Fault, under};
use crate::output::surface;
use crate::scheme::plan::{Plan, PlanInput, Subject};
use crate::shape::frame::Frame;
use crate::watch::Watch;

/// A job that is checked as far as that goes without refining anything. Where a tolerance was asked for, its level is
/// searched for apart, as that may take long.
#[derive(Debug, Clone)]
pub struct Draft {
    input: Input,
    plan: Plan,
    asked: Asked,
    outputs: Vec<Output>,
    frame: Frame,
}

impl Draft {
    /// Resolves the plan for the input and checks all that can be checked without a search.
    ///
    /// # Errors
    /// Every fault found, with pointers below the job.
    pub fn new(
        input: Input,
        plan: Option<&PlanInput>,
        levels: Option<Levels>,
        outputs: Vec<Output>,
    ) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        let resolved = resolved(&input, plan, &outputs);
        let asked = levels::check(plan.is_some(), levels).unwrap_or_else(|fault| {
            faults.push(fault);
            Asked::Count(0)
        });
        for (i, output) in outputs.iter().enumerate() {
            if let Err(detail) = (output.format.facts().holds)(input.shape_kind(), &output.options) {
                faults.push(Fault::new(format!("/outputs/{i}/format"), detail));
            } else if let Err(fault) = output.format.suits(input.shape_kind(), input.attachments(), &output.options) {
                faults.push(fault.under(&format!("/outputs/{i}")));
            }
        }
        let plan = match resolved {
            Ok(plan) => plan,
            Err(found) => {
                faults.extend(found);
                return Err(faults);
            }
        };
        faults.extend(asked.check(&input, &plan).err());
        let draft = Self { input, plan, asked, outputs, frame: Frame::default() };
        faults.extend(draft.faults());
        if let Asked::Count(levels) = asked {
            let none_yet = faults.is_empty();
            faults.extend(draft.faults_at(levels, none_yet));
        }
        if faults.is_empty() { Ok(draft) } else { Err(faults) }
    }

    /// The same draft, its coordinates meant in this frame.
    #[must_use]
    pub fn framed(self, frame: Frame) -> Self {
        Self { frame, ..self }
    }

    /// Bytes that the input takes in memory.
    pub fn input_bytes(&self) -> u64 {
        self.input.bytes()
    }

    /// Whether a level has to be searched for before the job is complete.
    pub fn needs_search(&self) -> bool {
        matches!(self.asked, Asked::Tolerance(_))
    }

    /// The key of the search, for whoever remembers answers and refusals; `None` where nothing is searched for.
    pub fn search_key(&self) -> Option<Key> {
        match self.asked {
            Asked::Count(_) => None,
            Asked::Tolerance(tolerance) => {
                let places = levels::place_names(&self.input, &self.outputs);
                Some(key::search(&self.input, &self.plan, tolerance, &places))
            }
        }
    }

    /// What the search takes at most.
    pub fn search_cost(&self) -> SearchCost {
        self.asked.cost(&self.input)
    }

    /// Searches for the level of a tolerance; `None` where the levels were given as a number.
    ///
    /// # Errors
    /// [`SearchError`].
    pub fn search(&self, watch: &Watch) -> Result<Option<Reached>, SearchError> {
        self.asked.search(&self.input, &self.plan, &self.outputs, watch)
    }

    /// The job, with what the search has found.
    ///
    /// # Errors
    /// Every fault that shows at this level, with pointers below the job; one where a search is needed and was not made.
    pub fn complete(self, found: Option<Reached>) -> Result<Job, Vec<Fault>> {
        let (levels, reached) = match (self.asked, found) {
            (Asked::Count(levels), _) => (levels, None),
            (Asked::Tolerance(_), Some(reached)) => {
                let faults = self.faults_at(reached.level, true);
                if !faults.is_empty() {
                    return Err(faults);
                }
                (reached.level, Some(reached))
            }
            (Asked::Tolerance(tolerance), None) => {
                let detail = format!("no level was searched for that is within {tolerance} of the limit");
                return Err(vec![Fault::new("/levels/tolerance", detail)]);
            }
        };
        let Self { input, plan, outputs, frame, .. } = self;
        Ok(Job { input, plan, levels, reached, outputs, frame })
    }

    /// The faults that do not depend on the number of levels.
    fn faults(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        for (i, output) in self.outputs.iter().enumerate() {
            let fault = check_limit(&self.input, &self.plan, output).err();
            faults.extend(fault.map(|error| Fault::new(format!("/outputs/{i}/positions"), error.to_string())));
        }
        if let Input::Mesh(mesh) = &self.input {
            let fault = crate::scheme::forecast::check_delta(&self.plan, &mesh.topology).err();
            faults.extend(fault.map(|fault| fault.under("/plan")));
        }
        faults.extend(steering::check(&self.input, &self.plan));
        faults
    }

    /// The faults of so many levels; limits of curves are looked at where nothing else is wrong.
    fn faults_at(&self, levels: u32, none_yet: bool) -> Vec<Fault> {
        let mut faults = Vec::new();
        faults.extend(self.plan.schedule(levels).err().map(|fault| fault.under("/plan")));
        faults.extend(kernels::check(&self.input, &self.plan, levels));
        if let (Input::Polygons(polygons), true) = (&self.input, none_yet && faults.is_empty()) {
            for (i, output) in self.outputs.iter().enumerate() {
                let fault = curves::check_wanted(polygons, &self.plan, levels, output).err();
                faults.extend(fault.map(|fault| fault.under(&format!("/outputs/{i}"))));
            }
        }
        faults
    }
}

/// The plan of an input; what some output refers to has to stay what it is.
fn resolved(input: &Input, plan: Option<&PlanInput>, outputs: &[Output]) -> Result<Plan, Vec<Fault>> {
    let Some(plan) = plan else {
        return Ok(Plan::none(PlanInput::default().boundary, PlanInput::default().ends));
    };
    let subject = input.subject(plan);
    let told = outputs.iter().find_map(|output| output.format.refers(&output.options)).filter(|_| subject.is_mesh);
    let subject = Subject { tags: subject.tags.or(told), attached: subject.attached.or(told), ..subject };
    Plan::resolve(plan, subject).map_err(|found| under("/plan", found))
}

/// Whether limit positions of a mesh can be had where they are asked for, as far as that can be told before refining.
fn check_limit(input: &Input, plan: &Plan, output: &Output) -> Result<(), LimitError> {
    match (input, surface::limit(&output.options)) {
        (Input::Mesh(_), [true, _]) => Ok(check(plan)?),
        _ => Ok(()),
    }
}
