//! Reading a job: its parts are checked and fitted to each other, as far as that goes without refining anything.

use super::complete::{Checked, Job};
use super::entry::InputEntry;
use super::finest;
use super::input::Input;
use super::levels::{self, CheckedLevels, Levels, Resolved};
use super::output::Output;
use super::search::Search;
use super::steering;
use crate::analysis::limit::{LimitError, check};
use crate::fault::{Fault, under};
use crate::output::{ShapeKind, surface};
use crate::scheme::forecast::check_delta;
use crate::scheme::plan::{Plan, PlanInput, Subject};
use crate::shape::frame::Frame;

/// What reading a job leads to.
#[derive(Debug, Clone)]
pub enum Draft {
    /// The job.
    Job(Box<Job>),
    /// The search for the level of the job.
    Search(Box<Search>),
}

impl Draft {
    /// Resolves the plan for the input and checks all that can be checked without a search.
    ///
    /// # Errors
    /// Every fault found, with pointers into the request.
    pub fn new(
        (input, entry, frame): (Input, InputEntry, Frame),
        plan: Option<&PlanInput>,
        levels: Option<Levels>,
        outputs: Vec<Output>,
    ) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        let resolved = resolved(&input, plan, &outputs);
        let levels = levels::check(plan.is_some(), levels).unwrap_or_else(|fault| {
            faults.push(fault);
            CheckedLevels::Count(0)
        });
        let kind = input.shape_kind();
        for output in &outputs {
            faults.extend(frame_fault(&input, output));
            if let Err(fault) = held(output, kind) {
                faults.push(fault);
            } else if let Err(fault) = output.format.suits(kind, input.attachments(), &output.options) {
                faults.push(output.fault(fault));
            }
        }
        let plan = match resolved {
            Ok(plan) => plan,
            Err(found) => {
                faults.extend(found);
                return Err(faults);
            }
        };
        let checked = Checked { input, entry, plan, outputs, frame };
        let fit = faults_of(&checked);
        match levels {
            CheckedLevels::Count(levels) => {
                faults.extend(fit);
                Job::new(checked, levels, None, faults).map(|job| Self::Job(Box::new(job)))
            }
            CheckedLevels::Auto => {
                faults.extend(fit);
                let level = if faults.is_empty() { finest::level(&checked) } else { Ok(0) };
                let level = level.unwrap_or_else(|fault| {
                    faults.push(fault);
                    0
                });
                let resolved = Resolved { level, bound: None };
                Job::new(checked, level, Some(resolved), faults).map(|job| Self::Job(Box::new(job)))
            }
            CheckedLevels::Tolerance(_) if checked.input.mesh().is_some_and(|mesh| !mesh.frames.is_empty()) => {
                let detail = "a tolerance is measured at one frame; with \"frames\" give a number of levels";
                faults.push(Fault::new("/levels", detail));
                faults.extend(fit);
                Err(faults)
            }
            CheckedLevels::Tolerance(tolerance) => match Search::new(checked, tolerance) {
                Ok(search) if faults.is_empty() && fit.is_empty() => Ok(Self::Search(Box::new(search))),
                search => Err(faults.into_iter().chain(search.err()).chain(fit).collect()),
            },
        }
    }

    /// The faults of all but an input that is wrong itself, of which the kind alone is known.
    pub fn faults_but_for_input(
        kind: ShapeKind,
        plan: Option<&PlanInput>,
        levels: Option<Levels>,
        outputs: &[Output],
    ) -> Vec<Fault> {
        let subject = Subject { is_mesh: kind == ShapeKind::Mesh, ..Subject::default() };
        let mut faults: Vec<Fault> = levels::check(plan.is_some(), levels).err().into_iter().collect();
        faults.extend(outputs.iter().filter_map(|output| held(output, kind).err()));
        let resolved = plan.map(|plan| Plan::resolve(plan, subject).map_err(|found| under("/plan", found)));
        faults.extend(resolved.and_then(Result::err).into_iter().flatten());
        faults
    }

    /// Bytes that its input and its steps take in memory.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Job(job) => job.bytes(),
            Self::Search(search) => search.bytes(),
        }
    }
}

/// Whether the format of an output can hold what its options make of a shape of this kind.
fn held(output: &Output, kind: ShapeKind) -> Result<(), Fault> {
    let held = (output.format.facts().holds)(kind, &output.options);
    held.map_err(|detail| output.fault(Fault::new("/format", detail)))
}

/// Why an output cannot show the frame that it names, or all frames where it names none.
fn frame_fault(input: &Input, output: &Output) -> Option<Fault> {
    let detail = match (input.mesh(), output.frame) {
        (None, Some(_)) => "only meshes have frames; leave it out".to_owned(),
        (Some(mesh), Some(frame)) if frame > mesh.frames.len() => {
            let n = mesh.frames.len() + 1;
            format!("there is no frame {frame}; the mesh has {n}, counted from 0")
        }
        (Some(mesh), None) if !mesh.frames.is_empty() && !output.format.facts().holds_frames => {
            let (name, last) = (output.format.name(), mesh.frames.len());
            format!(
                "{name} holds one frame, the mesh has {}; give a \"frame\" from 0 to {last}, or ask for glb",
                last + 1
            )
        }
        _ => return None,
    };
    Some(output.fault(Fault::new("/frame", detail)))
}

/// The faults in how plan, input and outputs fit that do not depend on the number of levels.
fn faults_of(Checked { input, entry, plan, outputs, .. }: &Checked) -> Vec<Fault> {
    let mut faults = Vec::new();
    if let Input::Mesh(mesh) = input {
        let moves_vertices = |output: &&Output| surface::limit(&output.options)[0];
        let fault = |output: &Output| {
            let error = check(plan).err()?;
            Some(output.fault(Fault::new("/positions", LimitError::from(error).to_string())))
        };
        faults.extend(outputs.iter().filter(moves_vertices).filter_map(fault));
        faults.extend(check_delta(plan, &mesh.topology).err().map(|fault| fault.under("/plan")));
    }
    faults.extend(steering::check(input, *entry, plan));
    faults
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
