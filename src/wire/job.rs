//! The job as clients write it.

use std::sync::Arc;

use serde::Deserialize;
use utoipa::ToSchema;

use super::examined::Examined;
use super::figure::{FigureOutline, Panel};
use super::input::{InputRequest, Purpose, ResolvedInput};
use super::levels::LevelsRequest;
use super::literal::WireLiteral;
use super::output::{OutputRequest, outputs};
use super::place::InputPlace;
use super::plan::PlanRequest;
use super::polygon::PolygonRequest;
use super::text::MeshFile;
use super::variants::{InputSchema, PlanSchema};
use super::{object, whole};
use crate::fault::{Fault, under};
use crate::input::ReadLimits;
use crate::job::{Draft, Figure, Job, Levels, Output, SearchError, panel_place};
use crate::output::ShapeKind;
use crate::scheme::plan::PlanInput;
use crate::watch::Watch;

/// A job: what is refined, how, how often, and what is answered; or, with a `figure` in place of an `input`, pictures
/// of jobs in a grid.
#[derive(Debug, Clone, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct JobRequest {
    /// Version of this notation; 1 when left out.
    #[schema(minimum = 1, maximum = 1)]
    #[serde(default, deserialize_with = "whole::optional")]
    pub spec: Option<u64>,
    /// What is refined: exactly one kind of input. It has to be given unless there is a `figure`.
    #[serde(default = "InputRequest::missing", deserialize_with = "object::one")]
    #[schema(value_type = InputSchema, required = false)]
    pub input: InputRequest,
    /// How it is refined; may be left out together with `levels`, to convert or draw the input as it is.
    #[serde(default, deserialize_with = "object::optional")]
    #[schema(value_type = Option<PlanSchema>)]
    pub plan: Option<PlanRequest>,
    /// How often the plan's cycle is applied, or how close to the limit it is to come; has to be given where there is a
    /// plan.
    pub levels: Option<LevelsRequest>,
    /// The job from whose surface pictures with `"shading": "distance"` measure, in place of the control net; of its
    /// outputs at most one counts, by its `positions` and `frame`.
    #[serde(default, deserialize_with = "object::optional_box")]
    #[schema(no_recursion)]
    pub distance_to: Option<Box<JobRequest>>,
    /// Pictures of jobs in a grid, in place of `input`, `plan` and `levels`.
    #[serde(default, deserialize_with = "object::optional_box")]
    pub figure: Option<Box<FigureRequest>>,
    /// What is answered, 1 to 64 results; without any, /v1/render goes by `Accept`.
    #[serde(default)]
    #[schema(max_items = 64)]
    pub outputs: Vec<OutputRequest>,
    /// How many outputs were left out before these.
    #[serde(skip)]
    pub left_out: usize,
    /// The job as text, where outputs describe it.
    #[serde(skip)]
    pub source: Option<Arc<str>>,
}

/// Pictures of jobs in a grid.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FigureRequest {
    /// Columns of the grid; when left out, as many as rows, or one more.
    #[schema(minimum = 1, maximum = 12)]
    #[serde(default, deserialize_with = "whole::optional")]
    pub columns: Option<u64>,
    /// The panels, row by row, 1 to 64; each stands at the first free place after the one before it.
    #[serde(deserialize_with = "object::list")]
    #[schema(min_items = 1, max_items = 64)]
    pub panels: Vec<PanelRequest>,
    /// What stands above all. Greek letters and signs are written as `\\alpha`, subscripts as `x_{1}`, exponents as
    /// `x^{2}`.
    pub title: Option<String>,
    /// Whether captions begin with (a), (b), ...
    #[serde(default)]
    pub letters: bool,
    /// What all panels have in common.
    #[serde(default, deserialize_with = "object::optional")]
    pub shared: Option<SharedRequest>,
}

/// A panel of a figure.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PanelRequest {
    /// What it shows: a job with one picture as its output, a png when left out. `width` and `height` of the picture
    /// give its proportions; how large it is follows from the width of the figure.
    #[serde(deserialize_with = "object::one")]
    #[schema(no_recursion)]
    pub job: JobRequest,
    /// What stands below it, as `title`.
    pub caption: Option<String>,
    /// Columns and rows that it spans, `[1, 1]` when left out.
    #[schema(schema_with = super::schema::span)]
    pub span: Option<[u64; 2]>,
    /// Whether it lies on the panel before it, without a background of its own unless it names one: several levels, or
    /// several schemes, in one picture. Panels that lie on each other are framed by the box around all that they show.
    #[serde(default)]
    pub overlay: bool,
}

/// What all panels of a figure have in common.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SharedRequest {
    /// The camera of all panels, in place of theirs: see the option `camera` of png.
    #[schema(value_type = Option<Object>)]
    pub camera: Option<WireLiteral>,
    /// Whether all panels have one scale: each is framed by the box around all that any of them shows.
    #[serde(default)]
    pub scale: bool,
}

impl JobRequest {
    /// Creates the job of a figure with one output.
    pub fn of_figure(figure: FigureRequest, output: OutputRequest) -> Self {
        let (input, figure) = (InputRequest::missing(), Some(Box::new(figure)));
        Self { input, figure, outputs: vec![output], ..Self::default() }
    }

    /// Whether an output is to contain the description of its job.
    pub fn describes(&self) -> bool {
        self.outputs.iter().any(OutputRequest::describes)
    }

    /// Attaches the file of an upload to the input at `place`, unless that has a file already.
    pub fn attach(&mut self, place: InputPlace, file: MeshFile) {
        let job = match (place.panel, &mut self.figure) {
            (None, _) => Some(self),
            (Some(at), Some(figure)) => figure.panels.get_mut(at).map(|panel| &mut panel.job),
            (Some(_), None) => None,
        };
        let job = if place.is_other { job.and_then(|job| job.distance_to.as_deref_mut()) } else { job };
        if let Some(job) = job.filter(|job| job.input.file.is_none()) {
            job.input.file = Some(file);
        }
    }

    /// Returns the kind of shape of the result, as far as the unchecked request tells.
    pub fn shape_kind(&self) -> ShapeKind {
        let input = &self.input;
        if input.mesh.is_some() || (input.polygon.is_none() && input.polygons.is_none()) {
            return ShapeKind::Mesh;
        }
        let dimension = |polygon: &PolygonRequest| {
            let dimension = polygon.points.first().map_or(1, Vec::len);
            dimension.saturating_sub(usize::from(polygon.rational)).max(1)
        };
        let first = input.polygon.iter().chain(input.polygons.iter().flatten()).next();
        ShapeKind::Curves { dimension: first.map_or(2, dimension) }
    }

    /// Checks the request as a whole, with the default limits on mesh files.
    ///
    /// # Errors
    /// As [`JobRequest::resolve_within`].
    pub fn resolve(self) -> Result<Job, Vec<Fault>> {
        self.resolve_within(&ReadLimits::default())
    }

    /// Checks the request as a whole and searches for the level of a tolerance; `limits` bound the size of mesh files.
    ///
    /// # Errors
    /// All faults found.
    pub fn resolve_within(self, limits: &ReadLimits) -> Result<Job, Vec<Fault>> {
        let search = match self.draft_within(limits)? {
            Draft::Job(job) => return Ok(*job),
            Draft::Search(search) => search,
        };
        let reached = search.run(&Watch::new()).map_err(|error| match error {
            SearchError::Refused(fault) => vec![fault],
            SearchError::Stopped(stopped) => vec![Fault::new("/levels", stopped.to_string())],
        })?;
        search.complete(reached)
    }

    /// Checks the request as a whole, without the search for the level of a tolerance; `limits` bound the size of mesh
    /// files.
    ///
    /// # Errors
    /// All faults found.
    pub fn draft_within(self, limits: &ReadLimits) -> Result<Draft, Vec<Fault>> {
        if self.figure.is_some() {
            return self.drawn_together(limits);
        }
        let purpose = self.purpose();
        self.parts(purpose, limits).draft()
    }

    /// Returns the default format of a job without outputs.
    pub fn usual_format(&self) -> &'static str {
        match self.shape_kind() {
            _ if self.figure.is_some() => "png",
            ShapeKind::Mesh => "glb",
            ShapeKind::Curves { .. } => "json",
        }
    }

    /// Checks the request as [`JobRequest::draft_within`] does, and also returns its input and plan if they are valid.
    /// `purpose` selects the defaults for the input.
    pub fn examine(self, purpose: Purpose, limits: &ReadLimits) -> Examined {
        if self.figure.is_some() {
            return Examined::of(self.drawn_together(limits), None, None);
        }
        let parts = self.parts(purpose, limits);
        let input = parts.input.as_ref().map(|resolved| resolved.input.clone());
        let plan = parts.plan.clone();
        Examined::of(parts.draft(), input, plan)
    }

    /// Checks a figure: first its layout, then its panels at their sizes.
    fn drawn_together(self, limits: &ReadLimits) -> Result<Draft, Vec<Fault>> {
        let mut faults = self.beside_figure();
        let outputs =
            keep(outputs(&self.outputs, self.left_out, self.source.as_deref()), &mut faults).unwrap_or_default();
        let Some(FigureRequest { columns, panels, title, letters, shared }) = self.figure.map(|figure| *figure) else {
            return Err(faults);
        };
        let (one_scale, camera) = shared.map_or((false, None), |shared| (shared.scale, shared.camera));
        let about = |panel: &PanelRequest| Panel {
            span: panel.span,
            caption: panel.caption.clone(),
            overlay: panel.overlay,
            outputs: panel.job.outputs.clone(),
        };
        let about: Vec<Panel> = panels.iter().map(about).collect();
        let outline = match FigureOutline::new(columns, (title, letters), &about, camera.as_ref()) {
            Ok(outline) => outline,
            Err(found) => return Err(faults.into_iter().chain(found).collect()),
        };
        let figure = Figure { panels: Vec::new(), grid: outline.grid.clone(), one_scale };
        let sheets = outputs.iter().filter_map(|output| Some((output, keep_one(figure.sheet(output), &mut faults)?)));
        let sheets: Vec<_> = sheets.collect();
        let mut jobs = Vec::with_capacity(panels.len());
        for (i, panel) in panels.into_iter().enumerate() {
            let found = outline.outputs(i, &sheets).and_then(|outputs| panel.job.of_panel(outputs, limits));
            jobs.extend(keep(found.map_err(|found| under(&panel_place(i), found)), &mut faults));
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        Job::of_figure(Figure { panels: jobs, ..figure }, outputs).map(|job| Draft::Job(Box::new(job)))
    }

    /// Creates the job of a panel with these outputs.
    fn of_panel(self, outputs: Vec<Output>, limits: &ReadLimits) -> Result<Job, Vec<Fault>> {
        if self.figure.is_some() {
            return Err(vec![Fault::new(
                "/figure",
                "a panel is a picture of an input; put its panels beside the others",
            )]);
        }
        let purpose = self.purpose();
        match self.parts_for(Ok(outputs), purpose, limits).draft()? {
            Draft::Job(job) => Ok(*job),
            Draft::Search(_) => {
                let detail = "here the level is a number; /v1/estimate tells the one that a tolerance leads to";
                Err(vec![Fault::new("/levels", detail)])
            }
        }
    }

    /// Creates the job of the surface from which distances are measured.
    fn other(self, limits: &ReadLimits) -> Result<Arc<Job>, Vec<Fault>> {
        if self.figure.is_some() {
            return Err(vec![Fault::new("/figure", "distances are measured from a surface; give the job of one")]);
        }
        let shape = OutputRequest::of_shape(self.outputs.first())?;
        self.of_panel(outputs(&[shape], 0, None)?, limits).map(Arc::new)
    }

    /// Returns the faults of fields that a figure must not have, and of an unknown `spec`.
    fn beside_figure(&self) -> Vec<Fault> {
        let said = [
            ("input", !self.input.is_missing),
            ("plan", self.plan.is_some()),
            ("levels", self.levels.is_some()),
            ("distance_to", self.distance_to.is_some()),
        ];
        let fault = |name| {
            Fault::new(
                format!("/{name}"),
                format!("a figure has no {name} of its own; it stands in the jobs of panels"),
            )
        };
        let unknown = self.spec.filter(|spec| *spec != 1).map(unknown_spec);
        said.into_iter().filter(|(_, is_said)| *is_said).map(|(name, _)| fault(name)).chain(unknown).collect()
    }

    /// Returns the purpose of the input before the outputs are settled: an input without outputs is treated as one to
    /// be refined.
    pub fn stated_purpose(&self) -> Purpose {
        if self.outputs.is_empty() { Purpose::Refine } else { self.purpose() }
    }

    /// Returns the purpose of the input: refinement if there is a plan.
    fn purpose(&self) -> Purpose {
        if self.plan.is_some() { Purpose::Refine } else { Purpose::Keep }
    }

    /// Checks each part by itself.
    fn parts(self, purpose: Purpose, limits: &ReadLimits) -> JobParts {
        let outputs = outputs(&self.outputs, self.left_out, self.source.as_deref());
        self.parts_for(outputs, purpose, limits)
    }

    /// Checks each part by itself, with outputs that are checked already.
    fn parts_for(self, outputs: Result<Vec<Output>, Vec<Fault>>, purpose: Purpose, limits: &ReadLimits) -> JobParts {
        let mut faults = Vec::new();
        faults.extend(self.spec.filter(|spec| *spec != 1).map(unknown_spec));
        let kind = self.input.is_one().then(|| self.shape_kind());
        let input = keep(self.input.resolve(purpose, limits).map_err(|found| under("/input", found)), &mut faults);
        let outputs = keep(outputs, &mut faults).unwrap_or_default();
        let other = self.distance_to.map(|other| other.other(limits).map_err(|found| under("/distance_to", found)));
        let other = other.and_then(|other| keep(other, &mut faults));
        let says_boundary = self.plan.as_ref().is_some_and(|plan| plan.boundary.is_some());
        let mut plan = self.plan.map(PlanRequest::resolve);
        let boundary = input.as_ref().and_then(|input| input.boundary);
        // the boundary rule of the plan has precedence over the rule of the file
        if let (Some(plan), Some(boundary), false) = (&mut plan, boundary, says_boundary) {
            plan.boundary = boundary;
        }
        JobParts { faults, kind, input, plan, levels: self.levels.map(|levels| levels.0), outputs, other }
    }
}

/// The parts of a request, each checked by itself, and their faults.
struct JobParts {
    faults: Vec<Fault>,
    /// The kind of shape of the input, if exactly one kind of input is given.
    kind: Option<ShapeKind>,
    input: Option<ResolvedInput>,
    plan: Option<PlanInput>,
    levels: Option<Levels>,
    outputs: Vec<Output>,
    other: Option<Arc<Job>>,
}

impl JobParts {
    /// Checks that the parts fit each other. If one is invalid, the others are checked all the same, so that all faults
    /// are reported together.
    fn draft(self) -> Result<Draft, Vec<Fault>> {
        let Self { mut faults, kind, input, plan, levels, outputs, other } = self;
        let found = match (input, kind) {
            (Some(ResolvedInput { input, entry, coordinate_system, .. }), _) => {
                match Draft::new((input, entry, coordinate_system), plan.as_ref(), levels, outputs, other) {
                    Ok(draft) if faults.is_empty() => return Ok(draft),
                    Ok(_) => Vec::new(),
                    Err(found) => found,
                }
            }
            (None, Some(kind)) => Draft::faults_but_for_input(kind, plan.as_ref(), levels, &outputs),
            (None, None) => Vec::new(),
        };
        faults.extend(found);
        Err(faults)
    }
}

fn unknown_spec(spec: u64) -> Fault {
    Fault::new("/spec", format!("{spec} is unknown; this server speaks 1"))
}

fn keep_one<T>(result: Result<T, Fault>, faults: &mut Vec<Fault>) -> Option<T> {
    result.map_err(|fault| faults.push(fault)).ok()
}

fn keep<T>(result: Result<T, Vec<Fault>>, faults: &mut Vec<Fault>) -> Option<T> {
    result.map_err(|found| faults.extend(found)).ok()
}
