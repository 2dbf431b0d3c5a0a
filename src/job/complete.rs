//! Jobs with a known level.

use std::sync::Arc;

use super::details::DetailOutput;
use super::entry::{InputEntry, JobEntries};
use super::input::Input;
use super::key::{self, Key};
use super::levels::ResolvedLevel;
use super::output::Output;
use super::{curves, kernels};
use crate::fault::Fault;
use crate::output::figure::{self, PanelGrid, Sheet};
use crate::output::{FORMATS, hard_edges, surface};
use crate::refine::{held_levels, is_swept, swept_from};
use crate::scheme::plan::{Plan, PlanInput, Scheduled};
use crate::shape::coordinate_system::CoordinateSystem;

/// The parts of a job that are checked before its level is known.
#[derive(Debug, Clone)]
pub(super) struct CheckedJob {
    pub(super) input: Arc<Input>,
    pub(super) entry: InputEntry,
    pub(super) plan: Plan,
    pub(super) outputs: Vec<Output>,
    pub(super) coordinate_system: CoordinateSystem,
    /// The job from whose surface pictures measure distances, if that is not the control net.
    pub(super) other: Option<Arc<Job>>,
}

/// A job whose parts are checked and fit each other.
#[derive(Debug, Clone)]
pub struct Job {
    /// The input; no polygons if the job is a figure.
    pub input: Arc<Input>,
    /// The entry of the request that holds the input.
    pub entry: InputEntry,
    /// The plan.
    pub plan: Plan,
    /// Number of applications of the plan's cycle.
    pub levels: u32,
    /// The level that was found and its bound, if the request left the level open.
    pub reached: Option<ResolvedLevel>,
    /// The outputs.
    pub outputs: Vec<Output>,
    /// The unit and up axis of the input's coordinates.
    pub coordinate_system: CoordinateSystem,
    /// The job from whose surface pictures measure distances, if that is not the control net.
    pub other: Option<Arc<Self>>,
    steps: Box<[Scheduled]>,
    keys: Vec<Key>,
    refined_keys: Vec<Key>,
    pub(super) details: Vec<DetailOutput>,
    pub(super) figure: Option<Box<Figure>>,
    pub(super) films: Vec<FilmJobs>,
}

/// An output whose frames come from jobs with plans of their own.
#[derive(Debug, Clone)]
pub(super) struct FilmJobs {
    /// The index of the output.
    pub(super) of: usize,
    /// One job per frame, each with this output alone.
    pub(super) frames: Vec<Job>,
}

/// Pictures of jobs in a grid.
#[derive(Debug, Clone)]
pub struct Figure {
    /// The jobs, each with one output per output of the figure, at the size that it has there.
    pub panels: Vec<Job>,
    /// The layout of the panels.
    pub grid: PanelGrid,
    /// Whether all panels are framed by the box around everything that they show.
    pub one_scale: bool,
}

impl Figure {
    /// Returns for each panel the first panel with which it shares its box: panel 0 for all if they have one scale,
    /// else for panels that overlay each other; `None` for single panels, which are framed by what they show.
    pub(super) fn framed_alike(&self) -> Vec<Option<usize>> {
        if self.one_scale {
            return vec![Some(0); self.panels.len()];
        }
        let mut alike = Vec::with_capacity(self.panels.len());
        for cell in &self.grid.cells {
            let lowest = alike.len();
            alike.extend(vec![(cell.layers > 1).then_some(lowest); cell.layers]);
        }
        alike
    }

    /// Returns the layout of the figure in an output.
    ///
    /// # Errors
    /// Outputs that cannot hold a figure of this layout, with pointers into the request.
    pub fn sheet(&self, output: &Output) -> Result<Sheet, Fault> {
        let (name, options) = (output.format.name(), &output.options);
        if output.format.paper().is_none() {
            let can: Vec<&str> =
                FORMATS.iter().filter(|format| format.paper().is_some()).map(|format| format.name()).collect();
            let detail = format!("{name} holds no figure; ask for {}", can.join(" or "));
            return Err(output.fault(Fault::new("/format", detail)));
        }
        if output.frame.is_some() {
            let detail = "a figure has no frames; name the frame in the outputs of its panels";
            return Err(output.fault(Fault::new("/frame", detail)));
        }
        figure::suits(options).map_err(|fault| output.fault(fault))?;
        let width = options.integer("width").and_then(|width| u32::try_from(width).ok()).unwrap_or(1024);
        self.grid.sheet(width).map_err(|detail| output.fault(Fault::new("/width", detail)))
    }
}

impl Job {
    /// Creates a figure with these outputs.
    ///
    /// # Errors
    /// Outputs that cannot hold a figure, with pointers into the request.
    pub fn of_figure(figure: Figure, outputs: Vec<Output>) -> Result<Self, Vec<Fault>> {
        let faults: Vec<Fault> = outputs.iter().filter_map(|output| figure.sheet(output).err()).collect();
        if !faults.is_empty() {
            return Err(faults);
        }
        let Figure { panels, grid, one_scale } = &figure;
        let key = |(i, output)| key::figure(panels.iter().map(|panel| panel.keys[i]), (grid, *one_scale), output);
        let keys: Vec<Key> = outputs.iter().enumerate().map(key).collect();
        Ok(Self {
            input: Arc::new(Input::Polygons(Vec::new())),
            entry: InputEntry::Polygons,
            plan: Plan::none(PlanInput::default().boundary, PlanInput::default().ends),
            levels: 0,
            reached: None,
            outputs,
            coordinate_system: CoordinateSystem::default(),
            other: None,
            steps: Box::default(),
            refined_keys: keys.clone(),
            keys,
            details: Vec::new(),
            figure: Some(Box::new(figure)),
            films: Vec::new(),
        })
    }

    /// Returns the jobs of the panels, if the job is a figure.
    pub fn panels(&self) -> &[Self] {
        self.figure.as_ref().map_or(&[], |figure| &figure.panels)
    }

    /// Returns whether the mesh is refined patch by patch for at least one output, that is, not only limits are shown.
    pub fn is_swept(&self) -> bool {
        let as_refined = |output: &Output| surface::limit(&output.options) == [false; 2];
        let Input::Mesh(mesh) = &*self.input else { return false };
        self.outputs.iter().any(as_refined) && is_swept(mesh, &self.plan, &self.steps)
    }

    /// Returns how many levels of the mesh are refined by rows before the sweep, for all outputs.
    pub(super) fn swept_from(&self) -> Option<usize> {
        let Input::Mesh(mesh) = &*self.input else { return None };
        let as_refined = self.outputs.iter().all(|output| surface::limit(&output.options) == [false; 2]);
        if as_refined { swept_from(mesh, &self.plan, &self.steps) } else { None }
    }

    /// Returns how many levels are refined as whole nets before all outputs can be written while the rest is refined;
    /// `None` if that is not possible.
    pub(super) fn held_levels(&self) -> Option<usize> {
        let Input::Mesh(mesh) = &*self.input else { return None };
        let (levels, tile) = held_levels(mesh, &self.plan, &self.steps)?;
        let streams = |output: &Output| {
            let is_refined = surface::limit(&output.options) == [false; 2];
            is_refined && output.format.streams(mesh, &output.options).contains(&tile)
        };
        self.outputs.iter().all(streams).then_some(levels)
    }

    /// Creates the job at a level, or returns all faults, after those found before.
    pub(super) fn new(
        checked: CheckedJob,
        levels: u32,
        reached: Option<ResolvedLevel>,
        mut faults: Vec<Fault>,
    ) -> Result<Self, Vec<Fault>> {
        let details = details(&checked, levels).unwrap_or_else(|found| {
            faults.extend(found);
            Vec::new()
        });
        let CheckedJob { input, entry, plan, mut outputs, coordinate_system, other } = checked;
        let steps = plan.schedule(levels).unwrap_or_else(|fault| {
            faults.push(fault.under("/plan"));
            Vec::new()
        });
        faults.extend(kernels::check(&input, entry, &plan, levels));
        // limits of curves need a search for eigenvectors, which is done only if everything else is correct
        if let (Input::Polygons(polygons), true) = (&*input, faults.is_empty()) {
            let check = |output: &Output| curves::check_wanted(polygons, &plan, levels, output).err();
            faults.extend(outputs.iter().filter_map(|output| Some(output.fault(check(output)?))));
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        for Output { options, .. } in outputs.iter_mut().filter(|_| input.mesh().is_some()) {
            let refines = levels > 0 || surface::limit(options) != [false; 2];
            hard_edges::settle(options, refines && plan.smooths());
        }
        let other_surface = other.as_ref().map(|other| other.refined_keys[0]);
        let (keys, refined_keys) =
            key::artifacts((&input, coordinate_system), (&plan, levels), &outputs, other_surface);
        let steps = steps.into();
        let (figure, films) = (None, Vec::new());
        Ok(Self {
            input,
            entry,
            plan,
            levels,
            reached,
            outputs,
            coordinate_system,
            other,
            steps,
            keys,
            refined_keys,
            details,
            figure,
            films,
        })
    }

    /// Returns the job with the frames of its films.
    pub(super) fn with_films(mut self, films: Vec<FilmJobs>) -> Self {
        for FilmJobs { of, frames } in &films {
            self.keys[*of] = key::film(frames.iter().map(|frame| frame.keys[0]));
        }
        self.films = films;
        self
    }

    /// Returns the film that an output shows, if it is one.
    pub(super) fn film(&self, output: &Output) -> Option<&FilmJobs> {
        let at = self.outputs.iter().position(|known| known.name == output.name)?;
        self.films.iter().find(|film| film.of == at)
    }

    /// Returns the operators in the order of application, each with the values of its place.
    pub fn steps(&self) -> &[Scheduled] {
        &self.steps
    }

    /// Returns the keys of the outputs.
    pub fn keys(&self) -> &[Key] {
        &self.keys
    }

    /// Returns the key of the refined mesh that an output shows, if the output belongs to the job.
    pub(super) fn refined_key(&self, output: &Output) -> Option<Key> {
        let at = self.outputs.iter().position(|known| known.name == output.name)?;
        Some(self.refined_keys[at])
    }

    /// Returns the key of the whole job: over the names and keys of all outputs.
    pub fn id(&self) -> Key {
        key::job(self.outputs.iter().map(|output| output.name.as_str()).zip(&self.keys))
    }

    /// Returns where the request has the parts of the job, for the computation of one output.
    pub fn entries(&self, output: &Output) -> JobEntries {
        JobEntries { input: self.entry, output: output.index }
    }

    /// Returns the keys of all results to which the outputs refer.
    pub fn detail_keys(&self) -> impl Iterator<Item = Key> + '_ {
        self.details.iter().map(|detail| detail.key)
    }

    /// Returns the jobs of the results to which an output refers, by ascending level.
    pub fn details(&self, output: &Output) -> Vec<Self> {
        let of = self.outputs.iter().position(|known| known.name == output.name);
        self.jobs(|detail| Some(detail.of) == of)
    }

    /// Returns the job of a result to which an output refers.
    pub fn detail(&self, key: &Key) -> Option<Self> {
        self.jobs(|detail| detail.key == *key).pop()
    }

    fn jobs(&self, wanted: impl Fn(&DetailOutput) -> bool) -> Vec<Self> {
        let mut wanted = self.details.iter().filter(|detail| wanted(detail)).peekable();
        if wanted.peek().is_none() {
            return Vec::new();
        }
        let (input, plan) = (self.input.clone(), self.plan.clone());
        let (entry, coordinate_system, outputs) = (self.entry, self.coordinate_system, Vec::new());
        let checked = CheckedJob { input, entry, plan, outputs, coordinate_system, other: None };
        // each job was already made once when this job was checked
        wanted.filter_map(|detail| job_of(detail, &checked).ok()).collect()
    }
}

/// Returns the results to which the outputs of a job refer, as if each were the output of a job of its own.
///
/// # Errors
/// Levels beyond that of the job, or at which there is no such job.
fn details(checked: &CheckedJob, levels: u32) -> Result<Vec<DetailOutput>, Vec<Fault>> {
    let mut found = Vec::new();
    for (of, output) in checked.outputs.iter().enumerate() {
        let Some(details) = output.format.details(&output.options) else { continue };
        let fault = |detail: String| vec![output.fault(Fault::new(format!("/{}", details.option), detail))];
        if details.levels.last() != Some(&levels) {
            return Err(fault(format!("the last level of detail is that of the job, {levels}; end the list with it")));
        }
        for &levels in &details.levels {
            let options = output.options.without(details.option);
            let output = Output { format: details.format, options, description: None, ..output.clone() };
            let detail = DetailOutput { of, levels, output, key: Key::LEAST };
            let job = job_of(&detail, checked).map_err(|faults| {
                let said: Vec<String> = faults.into_iter().map(|fault| fault.detail).collect();
                fault(format!("at level {levels}: {}", said.join("; ")))
            })?;
            found.push(DetailOutput { key: job.keys()[0], ..detail });
        }
    }
    Ok(found)
}

fn job_of(detail: &DetailOutput, checked: &CheckedJob) -> Result<Job, Vec<Fault>> {
    Job::new(CheckedJob { outputs: vec![detail.output.clone()], ..checked.clone() }, detail.levels, None, Vec::new())
}
