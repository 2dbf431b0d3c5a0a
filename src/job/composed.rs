//! Figures and moving pictures: their estimates, and their composition from panels or frames.

use std::collections::HashMap;
use std::io::Write;
use std::sync::{Mutex, PoisonError};

use super::complete::{Figure, FilmJobs, Job};
use super::entry::{JobFault, JobPart};
use super::error::RunError;
use super::estimate::{Estimate, panel_place};
use super::key::Key;
use super::output::Output;
use super::report::Report;
use super::shown::show;
use super::time;
use super::work::{KeepWork, Work};
use crate::output::figure::{self, FigureExtent, framed};
use crate::output::film;
use crate::output::scene::Scene;
use crate::output::{FormatError, Size};
use crate::scheme::forecast::{Count, Forecast};
use crate::watch::Watch;

/// Upper bound of the bytes of a curve's point that is written as lines, from the text formats.
const VECTOR_BYTES: u128 = 160;

/// Returns the estimate of a figure from those of its panels: their sum, as the refined meshes are kept until all
/// panels are drawn, plus the pictures.
pub(super) fn estimate(job: &Job, figure: &Figure, panels: &[Estimate]) -> Estimate {
    let last = |estimate: &Estimate| estimate.forecast.levels.last().copied().unwrap_or_default();
    let sum = panels.iter().map(last).fold(Count::default(), |sum, count| Count {
        vertices: sum.vertices.saturating_add(count.vertices),
        edges: sum.edges.saturating_add(count.edges),
        faces: sum.faces.saturating_add(count.faces),
        ..sum
    });
    let of_panels = |part: fn(&Estimate) -> u128| panels.iter().map(part).fold(0, u128::saturating_add);
    let work = of_panels(|panel| panel.forecast.work);
    let forecast = Forecast { levels: vec![sum], peak: sum, work, topology_bytes: 0 };
    let (mut outputs, mut held_bytes) = (Vec::with_capacity(job.outputs.len()), 0);
    for (output, key) in job.outputs.iter().zip(job.keys()) {
        let of = outputs.len();
        // a point in a drawing has its position, and a disc if it belongs to the control polygon
        let points = of_panels(|panel| panel.forecast.levels.iter().map(|count| count.vertices).sum());
        let own = panels.iter().map(|panel| panel.outputs[of].1.bytes()).fold(0, u128::saturating_add);
        let bytes = own.saturating_add(points.saturating_mul(VECTOR_BYTES));
        let (size, held) = match (figure.sheet(output), output.format.paper()) {
            (Ok(sheet), Some(paper)) => figure::size(paper, &sheet, bytes, points),
            _ => (Size::Exact(0), 0),
        };
        let size = output.described(size);
        outputs.push((*key, size));
        held_bytes = held.saturating_add(size.bytes()).max(held_bytes);
    }
    let sizes: Vec<Size> = outputs.iter().map(|(_, size)| *size).collect();
    Estimate {
        forecast,
        outputs,
        memory_bytes: of_panels(|panel| panel.memory_bytes).saturating_add(held_bytes),
        on_demand: false,
        // a panel is visited twice if it is framed together with others
        time_ms: of_panels(|panel| panel.time_ms).saturating_add(time::milliseconds(0, &sizes)),
    }
}

/// Composes a figure; the result depends on its panels only.
///
/// # Errors
/// [`RunError`], of a panel with its place in the request.
pub(super) fn run(
    figure: &Figure,
    (job, output): (&Job, &Output),
    kept: &dyn KeepWork,
    out: &mut dyn Write,
    watch: &Watch,
) -> Result<Report, RunError> {
    let of = job.outputs.iter().position(|known| known.name == output.name).unwrap_or(0);
    let impossible = |fault| RunError::Impossible(JobFault { part: JobPart::Request, fault });
    let sheet = figure.sheet(output).map_err(impossible)?;
    let Some(paper) = output.format.paper() else { return Ok(Report::default()) };
    let kept = FigureWork { kept, own: Mutex::default() };
    let mut warnings: Vec<String> = Vec::new();
    let mut each = |show_it: &mut dyn FnMut(usize, &Scene<'_>, &Output) -> Result<(), FormatError>| {
        for (n, panel) in figure.panels.iter().enumerate() {
            watch.check().map_err(RunError::Stopped)?;
            let shown = &panel.outputs[of];
            let report = show((panel, false), shown, &kept, watch, &mut |scene| show_it(n, scene, shown));
            let report = report.map_err(|error| match error {
                RunError::Impossible(fault) => impossible(panel.entries(shown).fault(fault).under(&panel_place(n))),
                other => other,
            })?;
            for warning in report.warnings {
                let warning = format!("panel {n}: {warning}");
                if !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
        }
        Ok::<_, RunError>(())
    };
    let alike = figure.framed_alike();
    let mut extents = vec![FigureExtent::default(); figure.panels.len()];
    if alike.iter().any(Option::is_some) {
        each(&mut |n, scene, shown| alike[n].map_or(Ok(()), |of| extents[of].add(scene, &shown.options, watch)))?;
    }
    let mut pictures = Vec::with_capacity(figure.panels.len());
    each(&mut |n, scene, shown| {
        let options = alike[n].map_or_else(|| shown.options.clone(), |of| framed(&shown.options, &extents[of]));
        let drawn = shown.format.paper().unwrap_or(paper);
        pictures.push(figure::picture((paper, drawn), scene, &options, watch)?);
        Ok(())
    })?;
    let title = figure.grid.title.as_deref().unwrap_or_default();
    figure::write(paper, (&sheet, pictures, title), &output.options, out, watch)?;
    Ok(Report { warnings })
}

/// Composes a moving picture of the scenes of its frames, all framed alike; the result depends on the frames only.
///
/// # Errors
/// [`RunError`].
pub(super) fn run_film(
    film: &FilmJobs,
    output: &Output,
    kept: &dyn KeepWork,
    out: &mut dyn Write,
    watch: &Watch,
) -> Result<Report, RunError> {
    let mut extent = FigureExtent::default();
    let mut report = Report::default();
    for frame in &film.frames {
        let options = &frame.outputs[0].options;
        let mut reach = |scene: &Scene<'_>| extent.add(scene, options, watch);
        let said = show((frame, false), &frame.outputs[0], kept, watch, &mut reach)?;
        let fresh = said.warnings.into_iter().filter(|warning| !report.warnings.contains(warning));
        let fresh: Vec<String> = fresh.collect();
        report.warnings.extend(fresh);
    }
    let mut pictures = film::Film::begin(&output.options, out)?;
    let shots = film::shots(&output.options, &extent, film.frames[0].coordinate_system);
    for (frame, shot) in film.frames.iter().zip(&shots) {
        let mut draw = |scene: &Scene<'_>| pictures.frame(scene, shot, watch);
        show((frame, false), &frame.outputs[0], kept, watch, &mut draw)?;
    }
    pictures.end()?;
    Ok(report)
}

/// Keeps work until the figure is finished, and offers it to a longer-lived store.
#[derive(Debug)]
struct FigureWork<'a> {
    kept: &'a dyn KeepWork,
    own: Mutex<HashMap<Key, Work>>,
}

impl KeepWork for FigureWork<'_> {
    fn find(&self, key: &Key) -> Option<Work> {
        let own = self.own.lock().unwrap_or_else(PoisonError::into_inner).get(key).cloned();
        own.or_else(|| self.kept.find(key))
    }

    fn keep(&self, key: Key, work: Work) {
        self.own.lock().unwrap_or_else(PoisonError::into_inner).insert(key, work.clone());
        self.kept.keep(key, work);
    }
}
