//! The limits of a server, checked against the exact forecast before memory is allocated.

use std::sync::Arc;

use super::complete::{Figure, Job};
use super::composed;
pub use super::estimate::{Estimate, Refusal};
use super::input::Input;
use super::limit_cost::{limit_patches, limit_surface};
use super::memory::{self, carried, compared_discs, needed, on_demand};
use super::output::Output;
use super::places::add_places;
use super::time;
use super::weight_count;
use crate::analysis::limit::LimitCost;
use crate::fault::Fault;
use crate::input::ReadLimits;
use crate::math::amounts::{in_bytes, thousands};
use crate::output::{CAGE, Counts, Size};
use crate::refine::{mesh_net, polygon_net};
use crate::scheme::forecast::{self, Count, Forecast, ForecastError};
use crate::scheme::step_error::About;
use crate::shape::mesh::Mesh;
use crate::solid::CageCounts;
use crate::watch::Watch;

/// The limits of one job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Maximum number of faces of a mesh at any level.
    pub max_faces: u64,
    /// Maximum number of points of all polygons, or of vertices of a mesh, at any level.
    pub max_vertices: u64,
    /// Maximum size of one result in bytes.
    pub max_output_bytes: u64,
    /// Maximum memory of one job during its run, in bytes.
    pub max_job_bytes: u64,
    /// Memory in bytes above which a job is refined while its result is written, if possible.
    pub max_held_bytes: u64,
}

/// Default of `max_held_bytes`: the memory of the points of a million faces and of a binary result with them. Below it,
/// storing all points takes about half the time of computing those of vertices, edges and faces in turn; with twice of
/// it, a machine stores twice as much for jobs that could do without.
const MAX_HELD_BYTES: u64 = 256 << 20;

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_faces: 20_000_000,
            max_vertices: 40_000_000,
            max_output_bytes: 4 << 30,
            max_job_bytes: 8 << 30,
            max_held_bytes: MAX_HELD_BYTES,
        }
    }
}

/// Maximum number of vertices or faces that are read: indices have 32 bits, and a net has up to four corners per
/// vertex.
const MAX_FACES_READ: u64 = u32::MAX as u64 / 5;

/// A job that is within all limits; only [`Limits::admit`] creates one.
#[derive(Debug, Clone)]
pub struct Admitted {
    job: Job,
    estimate: Estimate,
}

impl Admitted {
    /// Returns the job.
    pub fn job(&self) -> &Job {
        &self.job
    }

    /// Returns the counts and the predicted cost of the job.
    pub fn estimate(&self) -> &Estimate {
        &self.estimate
    }
}

impl Limits {
    /// Returns the limits for reading mesh files.
    pub fn reading(&self) -> ReadLimits {
        let [max_vertices, max_faces] = [self.max_vertices, self.max_faces].map(|n| n.min(MAX_FACES_READ));
        ReadLimits { max_vertices, max_faces }
    }

    /// Admits a job, or returns why it is refused and what would be admitted.
    ///
    /// # Errors
    /// [`Refusal`].
    pub fn admit(&self, job: Job) -> Result<Admitted, Refusal> {
        self.admit_under(job, &Watch::new())
    }

    /// Admits a job like [`Limits::admit`], unless the watch says stop.
    ///
    /// # Errors
    /// [`Refusal`], which is [`Refusal::Stopped`] when the watch says stop.
    pub fn admit_under(&self, job: Job, watch: &Watch) -> Result<Admitted, Refusal> {
        let estimate = self.estimate_under(&job, watch)?;
        Ok(Admitted { job, estimate })
    }

    /// Returns the estimate of a job that is within the limits.
    ///
    /// # Errors
    /// [`Refusal`].
    pub fn estimate(&self, job: &Job) -> Result<Estimate, Refusal> {
        self.estimate_under(job, &Watch::new())
    }

    /// Returns the estimate of a job that is within the limits, unless the watch says stop.
    ///
    /// # Errors
    /// [`Refusal`], which is [`Refusal::Stopped`] when the watch says stop.
    pub fn estimate_under(&self, job: &Job, watch: &Watch) -> Result<Estimate, Refusal> {
        if let Some(figure) = &job.figure {
            return self.estimate_figure(job, figure, watch);
        }
        let forecast = match &*job.input {
            Input::Polygons(polygons) => {
                let nets: Vec<_> = polygons.iter().map(|polygon| polygon_net(polygon, &job.plan)).collect();
                forecast::of_polygons(&nets, job.steps())
            }
            Input::Mesh(mesh) => {
                forecast::of_mesh(&mesh_net(mesh, &job.plan), job.steps(), self.max_vertices.into(), watch)
            }
        };
        let mut forecast = forecast.map_err(|error| self.no_forecast(&error))?;
        add_places(job, &mut forecast, self.max_vertices.into(), watch).map_err(|error| self.no_forecast(&error))?;
        let carried = carried(job, frames(job) - 1);
        self.check_levels(job, &forecast)?;
        let counts = counts(job, &forecast, forecast.levels.len() - 1);
        let sizes: Vec<Size> = job.outputs.iter().map(|output| output.size(&counts)).collect();
        for (i, size) in sizes.iter().enumerate() {
            self.check_bytes(job, i, *size, &forecast)?;
        }
        check_fits(job, &counts)?;
        // the rows are made once more for each channel and each frame
        forecast.work = forecast.work.saturating_mul(1 + carried.channels + carried.frames);
        let (limit_rows, limit_bytes) = limit_surface(job, &forecast);
        let (detail_bytes, detail_work) = memory::details(job, &forecast, &carried);
        let work = forecast.work.saturating_add(limit_rows).saturating_add(detail_work);
        let forecast = Forecast { work, ..forecast };
        let local = if limit_rows > 0 { limit_patches(job, &forecast) } else { LimitCost::default() };
        let compared = if limit_rows > 0 { compared_discs(job, &forecast) } else { 0 };
        let limit_bytes = limit_bytes.saturating_add(local.bytes).saturating_add(compared);
        let options = job
            .outputs
            .iter()
            .map(|output| output.format.memory(&output.shown(&counts), &output.options))
            .max()
            .unwrap_or(0);
        let needed = needed(job, &forecast, &sizes, &carried);
        let mut memory_bytes = needed.saturating_add(limit_bytes).saturating_add(options).saturating_add(detail_bytes);
        let is_large = memory_bytes > self.max_held_bytes.into();
        let held_levels = if is_large { job.held_levels() } else { None };
        if let Some(levels) = held_levels {
            memory_bytes = on_demand(&forecast, levels, &sizes);
        } else if forecast.peak.corners > u32::MAX.into() {
            let reason = format!(
                "the net has {} corners of faces, which are counted up to {}",
                thousands(forecast.peak.corners),
                thousands(u32::MAX.into())
            );
            return Err(self.too_large(job, &forecast, &reason, |_, count| count.corners <= u32::MAX.into()));
        }
        if memory_bytes > self.max_job_bytes.into() {
            let place = format!("the job needs about {} of memory", in_bytes(memory_bytes));
            let bound = format!("this server allows {} a job", in_bytes(self.max_job_bytes.into()));
            return Err(self.too_large(job, &forecast, &format!("{place}; {bound}"), |_, _| false));
        }
        let rows = forecast.work.saturating_add(local.points).saturating_add(time::rows(job, &counts));
        let time_ms = time::milliseconds(rows, &sizes);
        let outputs = job.keys().iter().copied().zip(sizes).collect();
        let estimate = Estimate { forecast, outputs, memory_bytes, on_demand: held_levels.is_some(), time_ms };
        self.with_films(job, self.with_other(job, estimate, watch)?, watch)
    }

    /// Returns the estimate of a figure: its panels, and their composition.
    fn estimate_figure(&self, job: &Job, figure: &Figure, watch: &Watch) -> Result<Estimate, Refusal> {
        let panels = figure.panels.iter().enumerate();
        let panels = panels.map(|(n, panel)| self.estimate_under(panel, watch).map_err(|refusal| refusal.of_panel(n)));
        let estimate = composed::estimate(job, figure, &panels.collect::<Result<Vec<_>, _>>()?);
        let most = u128::from(self.max_job_bytes);
        if estimate.memory_bytes > most {
            let detail = format!(
                "the panels of the figure need about {} of memory together; this server allows {} a job; ask for fewer \
                 panels, or for fewer levels in them",
                in_bytes(estimate.memory_bytes),
                in_bytes(most)
            );
            return Err(Refusal::TooLarge { faults: vec![Fault::new("/figure/panels", detail.clone())], detail });
        }
        Ok(estimate)
    }

    /// Adds to an estimate the surface from which pictures measure distances, which is stored beside the job's own.
    fn with_other(&self, job: &Job, mut estimate: Estimate, watch: &Watch) -> Result<Estimate, Refusal> {
        let Some(other) = &job.other else { return Ok(estimate) };
        let of_other = self.estimate_under(other, watch).map_err(Refusal::of_other)?;
        let bytes = of_other.memory_bytes.saturating_add(memory::measured_from(&of_other.forecast));
        estimate.memory_bytes = estimate.memory_bytes.saturating_add(bytes);
        estimate.forecast.work = estimate.forecast.work.saturating_add(of_other.forecast.work);
        estimate.time_ms = estimate.time_ms.saturating_add(of_other.time_ms);
        if estimate.memory_bytes > self.max_job_bytes.into() {
            let detail = format!(
                "the job and the surface from which it measures distances need about {} of memory together; this \
                 server allows {} a job; ask for fewer levels of one of them",
                in_bytes(estimate.memory_bytes),
                in_bytes(self.max_job_bytes.into())
            );
            return Err(Refusal::TooLarge { faults: vec![Fault::new("/distance_to", detail.clone())], detail });
        }
        Ok(estimate)
    }

    /// Adds to an estimate the frames of the job's films.
    fn with_films(&self, job: &Job, mut estimate: Estimate, watch: &Watch) -> Result<Estimate, Refusal> {
        for frame in job.films.iter().flat_map(|film| &film.frames) {
            let of_frame = self.estimate_under(frame, watch)?;
            // each frame is refined once to find the box around all frames, and once more to be drawn
            let work = of_frame.forecast.work.saturating_mul(2);
            estimate.forecast.work = estimate.forecast.work.saturating_add(work);
            estimate.time_ms = estimate.time_ms.saturating_add(time::milliseconds(work, &[]));
            estimate.memory_bytes = estimate.memory_bytes.max(of_frame.memory_bytes);
        }
        Ok(estimate)
    }

    fn no_forecast(&self, error: &ForecastError) -> Refusal {
        match error {
            ForecastError::Step { error, .. } if error.about == About::Ends => {
                Refusal::Impossible(vec![Fault::new("/plan/ends", error.to_string())])
            }
            ForecastError::Step { .. } => Refusal::Impossible(vec![Fault::new("/plan", error.to_string())]),
            ForecastError::Cap { level, .. } => {
                let remedy = fewer_levels(*level);
                let bound = format!("this server allows {}; {remedy}", thousands(self.max_vertices.into()));
                let detail =
                    format!("level {level} has more than {} vertices; {bound}", thousands(self.max_vertices.into()));
                Refusal::TooLarge { detail, faults: vec![Fault::new("/levels", remedy)] }
            }
            ForecastError::Bytes { level, bytes, bound } => {
                let remedy = fewer_levels(*level);
                let detail = format!(
                    "level {level}: to count what D leaves along the boundary takes {}; a forecast may take {}; \
                        {remedy}",
                    in_bytes(*bytes),
                    in_bytes(*bound)
                );
                Refusal::TooLarge { detail, faults: vec![Fault::new("/levels", remedy)] }
            }
            ForecastError::Stopped(_) => Refusal::Stopped,
        }
    }

    /// Returns whether a net is within the limits; each frame counts its own vertices.
    fn fits(&self, job: &Job, count: &Count) -> bool {
        let vertices = count.vertices.saturating_mul(frames(job));
        count.faces <= self.max_faces.into() && vertices.max(count.unfolded) <= self.max_vertices.into()
    }

    fn check_levels(&self, job: &Job, forecast: &Forecast) -> Result<(), Refusal> {
        let Some(level) = forecast.levels.iter().position(|count| !self.fits(job, count)) else {
            return if self.fits(job, &forecast.peak) { Ok(()) } else { Err(self.peak(job, forecast)) };
        };
        // name the requested level, as this is what the client wrote
        let asked = forecast.levels.len() - 1;
        let count =
            if self.fits(job, &forecast.levels[asked]) { forecast.levels[level] } else { forecast.levels[asked] };
        let level = if self.fits(job, &forecast.levels[asked]) { level } else { asked };
        let counts = counts(job, forecast, level);
        let size = job.outputs.first().map(|output| {
            let bytes = in_bytes(output.size(&counts).bytes());
            format!(" ({bytes} as {})", output.format.name())
        });
        let (n, what, bound) = if count.faces > self.max_faces.into() {
            (count.faces, "faces", self.max_faces)
        } else if count.vertices.saturating_mul(frames(job)) <= self.max_vertices.into() {
            (count.unfolded, "places at the corners of faces", self.max_vertices)
        } else {
            let what = match frames(job) {
                1 if count.faces > 0 => "vertices",
                1 => "points",
                _ => "vertices in all frames",
            };
            (count.vertices.saturating_mul(frames(job)), what, self.max_vertices)
        };
        let size = size.unwrap_or_default();
        let subject = if count.faces > 0 { "mesh" } else { "polygon" };
        let reason = format!(
            "level {level} of this {subject} has {} {what}{size}; this server allows {} {what}",
            thousands(n),
            thousands(bound.into())
        );
        Err(self.too_large(job, forecast, &reason, |_, count| self.fits(job, count)))
    }

    fn peak(&self, job: &Job, forecast: &Forecast) -> Refusal {
        let reason = format!(
            "between two operators the net has {} vertices and {} faces; this server allows {} and {}",
            thousands(forecast.peak.vertices),
            thousands(forecast.peak.faces),
            thousands(self.max_vertices.into()),
            thousands(self.max_faces.into())
        );
        self.too_large(job, forecast, &reason, |_, _| false)
    }

    fn check_bytes(&self, job: &Job, output: usize, size: Size, forecast: &Forecast) -> Result<(), Refusal> {
        let bound = u128::from(self.max_output_bytes);
        if size.bytes() <= bound {
            return Ok(());
        }
        let asked = &job.outputs[output];
        let format = asked.format.name();
        let reason = format!(
            "the {format} output would take {}; this server allows {}",
            in_bytes(size.bytes()),
            in_bytes(bound)
        );
        let fits = |level, _: &Count| asked.size(&counts(job, forecast, level)).bytes() <= bound;
        Err(self.too_large(job, forecast, &reason, fits))
    }

    /// Returns a refusal with the highest level that fits as its remedy.
    fn too_large(&self, job: &Job, forecast: &Forecast, reason: &str, fits: impl Fn(usize, &Count) -> bool) -> Refusal {
        let fitting = |&(level, count): &(usize, &Count)| self.fits(job, count) && fits(level, count);
        let fitting = forecast.levels.iter().enumerate().take_while(fitting).count();
        let remedy = match fitting {
            0 => "send a smaller input".to_owned(),
            n if job.reached.is_some_and(|reached| reached.bound.is_some()) => {
                format!("ask for a coarser tolerance, or for at most {} levels", n - 1)
            }
            n if job.levels > 0 => format!("ask for at most {} levels", n - 1),
            _ => "send a smaller input".to_owned(),
        };
        let short = if fitting == 0 { remedy.clone() } else { format!("at most {} for this input", fitting - 1) };
        Refusal::TooLarge { detail: format!("{reason}; {remedy}"), faults: vec![Fault::new("/levels", short)] }
    }
}

/// Returns the remedy if a level is too large to be counted.
fn fewer_levels(level: u32) -> String {
    match level {
        0 => "send a smaller mesh or a shorter prefix".to_owned(),
        level => format!("ask for at most {} levels", level - 1),
    }
}

/// Checks that the formats can hold so many vertices and faces.
fn check_fits(job: &Job, counts: &Counts) -> Result<(), Refusal> {
    let fits = |output: &Output| output.format.fits(&output.shown(counts), &output.options);
    let fault = |output| Some(Output::fault(output, fits(output).err()?));
    let faults: Vec<Fault> = job.outputs.iter().filter_map(fault).collect();
    if faults.is_empty() { Ok(()) } else { Err(Refusal::Impossible(faults)) }
}

/// Returns the number of frames that an output shows at once.
fn frames(job: &Job) -> u128 {
    let all = job.input.mesh().map_or(1, |mesh| mesh.frames.len() as u128 + 1);
    if job.outputs.iter().any(|output| output.frame.is_none()) { all } else { 1 }
}

/// Returns the counts of the net of a level as writers see it, without hidden faces.
fn counts(job: &Job, forecast: &Forecast, level: usize) -> Counts {
    let count = forecast.levels.get(level).copied().unwrap_or_default();
    let polygons = if let Input::Polygons(polygons) = &*job.input { polygons.len() as u128 } else { 1 };
    let mesh = job.input.mesh();
    let makes_solid = job.outputs.iter().any(|output| output.format.makes_solid(&output.options));
    let stays = job.levels == 0 || job.outputs.iter().any(|output| output.options.flag(CAGE));
    let tags = |mesh: &Mesh| mesh.creases.len() + mesh.corners.len() + mesh.semi_sharp_corners.len();
    Counts {
        kind: job.input.shape_kind(),
        polygons,
        control: job.input.n_points() as u128,
        vertices: count.vertices,
        faces: count.faces - count.hidden_faces,
        half_edges: count.corners - count.hidden_corners,
        largest_face: count.largest_face,
        split_vertices: count.split_vertices,
        uvs: count.uvs,
        seamed: count.seamed,
        unfolded: count.unfolded,
        frames: mesh.map_or(0, |mesh| mesh.frames.len()),
        coordinate_system: job.coordinate_system,
        attachments: mesh.map_or_else(Arc::default, |mesh| mesh.attachments.clone()),
        input_faces: mesh.map_or(0, |mesh| mesh.topology.n_faces()),
        input_edges: mesh.map_or(0, |mesh| mesh.topology.n_edges()),
        cage: mesh.filter(|_| makes_solid).map(CageCounts::of).unwrap_or_default(),
        weights: weight_count::most(job, forecast, level),
        tags: mesh.filter(|_| stays).map_or(0, tags),
    }
}
