//! Reads a job: checks its parts, and whether they fit each other, as far as no refinement is needed.

use std::sync::Arc;

use super::complete::{CheckedJob, Job};
use super::entry::InputEntry;
use super::films;
use super::finest;
use super::fit::{faults_of, other_faults, resolved};
use super::input::Input;
use super::levels::{self, CheckedLevels, Levels, ResolvedLevel};
use super::output::Output;
use super::search::Search;
use crate::fault::{Fault, under};
use crate::output::ShapeKind;
use crate::scheme::plan::{Plan, PlanInput, Subject};
use crate::shape::coordinate_system::CoordinateSystem;

/// The result of reading a job.
#[derive(Debug, Clone)]
pub enum Draft {
    /// A complete job.
    Job(Box<Job>),
    /// A search for the level of a job.
    Search(Box<Search>),
}

impl Draft {
    /// Resolves the plan for the input and checks everything that does not need a search.
    ///
    /// # Errors
    /// Every fault found, with pointers into the request.
    pub fn new(
        (input, entry, coordinate_system): (Input, InputEntry, CoordinateSystem),
        plan: Option<&PlanInput>,
        levels: Option<Levels>,
        outputs: Vec<Output>,
        other: Option<Arc<Job>>,
    ) -> Result<Self, Vec<Fault>> {
        let mut faults = Vec::new();
        let given = plan;
        let levels = levels.or(no_level(&outputs).then_some(Levels::Count(0)));
        let resolved = resolved(&input, plan, &outputs);
        let levels = levels::check(plan.is_some(), levels).unwrap_or_else(|fault| {
            faults.push(fault);
            CheckedLevels::Count(0)
        });
        let kind = input.shape_kind();
        for output in &outputs {
            faults.extend(frame_fault(&input, output));
            if let Err(fault) = check_shape_kind(output, kind) {
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
        let checked = CheckedJob { input: Arc::new(input), entry, plan, outputs, coordinate_system, other };
        let fit = [faults_of(&checked), other_faults(&checked)].concat();
        let asked = films::film_outputs(&checked.outputs);
        match levels {
            CheckedLevels::Count(levels) => {
                faults.extend(fit);
                let filmed = asked.map_or(Ok(Vec::new()), |asked| films::of(&asked, &checked, given, levels));
                let films = filmed.unwrap_or_else(|found| {
                    faults.extend(found);
                    Vec::new()
                });
                Job::new(checked, levels, None, faults).map(|job| Self::Job(Box::new(job.with_films(films))))
            }
            CheckedLevels::Tolerance(_) | CheckedLevels::Auto if asked.is_some() => {
                let detail = "the plans of a \"sweep\" may need different levels; give a number of levels";
                faults.push(Fault::new("/levels", detail));
                faults.extend(fit);
                Err(faults)
            }
            CheckedLevels::Auto => {
                faults.extend(fit);
                let level = if faults.is_empty() { finest::level(&checked) } else { Ok(0) };
                let level = level.unwrap_or_else(|fault| {
                    faults.push(fault);
                    0
                });
                let resolved = ResolvedLevel { level, bound: None };
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

    /// Returns all faults of a request whose input is itself at fault, so that only its kind is known.
    pub fn faults_but_for_input(
        kind: ShapeKind,
        plan: Option<&PlanInput>,
        levels: Option<Levels>,
        outputs: &[Output],
    ) -> Vec<Fault> {
        let subject = Subject { is_mesh: kind == ShapeKind::Mesh, ..Subject::default() };
        let levels = levels.or(no_level(outputs).then_some(Levels::Count(0)));
        let mut faults: Vec<Fault> = levels::check(plan.is_some(), levels).err().into_iter().collect();
        faults.extend(outputs.iter().filter_map(|output| check_shape_kind(output, kind).err()));
        let resolved = plan.map(|plan| Plan::resolve(plan, subject).map_err(|found| under("/plan", found)));
        faults.extend(resolved.and_then(Result::err).into_iter().flatten());
        faults
    }

    /// Returns the memory in bytes of the input and the steps.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Job(job) => job.bytes(),
            Self::Search(search) => search.bytes(),
        }
    }
}

/// Checks that the format of an output can hold a shape of this kind under its options.
fn check_shape_kind(output: &Output, kind: ShapeKind) -> Result<(), Fault> {
    let held = (output.format.facts().holds)(kind, &output.options);
    held.map_err(|detail| output.fault(Fault::new("/format", detail)))
}

/// Returns why an output cannot show the frame that it names, or all frames if it names none.
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

/// Whether all outputs are of the limit, which no number of levels changes.
fn no_level(outputs: &[Output]) -> bool {
    !outputs.is_empty() && outputs.iter().all(|output| output.format.is_of_limit())
}
